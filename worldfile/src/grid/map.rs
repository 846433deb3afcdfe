//! The drawing of the map: one character per cell, the top row first.

use crate::reader::File;
use interfaces::{Cell, Grid, GridFrame};
use nalgebra::Point2;
use std::ops::Range;

/// The maximum number of cells; larger maps are refused before memory is allocated.
const MAX_CELLS: usize = 4_000_000;
/// The minimum number of rows and of columns: one cell with a wall around it.
const MIN_SIDE: usize = 3;

/// The content of the drawing.
pub(super) struct Drawing {
    pub(super) walls: Grid<bool>,
    pub(super) start: Cell,
}

/// A row of the drawing and its place in the file.
struct Row<'a> {
    text: &'a str,
    place: Range<usize>,
}

/// Reads the drawing `map`, which stands at `span`.
pub(super) fn drawing(file: &File<'_>, map: &str, span: Range<usize>) -> Option<Drawing> {
    let rows = rows(file, map, &span);
    let frame = frame(file, &span, &rows)?;
    let mut walls = Grid::filled(frame, false);
    let mut start: Option<(Cell, Range<usize>)> = None;
    for (row, y) in rows.iter().zip((0..frame.height() as i32).rev()) {
        for ((at, character), x) in row.text.char_indices().zip(0..) {
            let cell = Cell::new(x, y);
            let place = row.character(at, character);
            match (character, &start) {
                ('.', _) => {}
                ('#', _) => walls.set(cell, true),
                ('R', None) => start = Some((cell, place)),
                ('R', Some((_, first))) => {
                    let others = [(first.clone(), "first here")];
                    let help = "there is one robot: draw one `R`, or none for the center of the map";
                    return file.error("the robot starts twice", (place, "again here"), &others, help);
                }
                _ => {
                    let what = format!("unknown character `{}` in the map", character.escape_debug());
                    let help = "`#` is a wall, `.` is free, `R` is where the robot starts";
                    return file.error(&what, (place, "not known here"), &[], help);
                }
            }
        }
    }
    if walls.cells().iter().all(|wall| *wall) {
        return file.error("no cell of the map is free", (span, "all wall"), &[], "draw free cells as `.`");
    }
    let start = match start {
        Some((cell, _)) => cell,
        None => center(file, &walls, &rows)?,
    };
    Some(Drawing { walls, start })
}

/// The center of the map, where the robot starts if the drawing has no `R`.
fn center(file: &File<'_>, walls: &Grid<bool>, rows: &[Row<'_>]) -> Option<Cell> {
    let frame = walls.frame();
    let center = Cell::new(frame.width() as i32 / 2, frame.height() as i32 / 2);
    if walls.get(center) == Some(&false) {
        return Some(center);
    }
    let row = &rows[frame.height() - 1 - center.y as usize];
    // All characters are known by now, so that columns are bytes.
    let place = row.character(center.x as usize, '#');
    let help = format!(
        "without an `R` the robot starts in the center of the map, [{}, {}]: draw an `R`, or a `.` there",
        center.x, center.y
    );
    file.error("the robot starts in a wall", (place, "the center of the map"), &[], &help)
}

/// The cells of the drawing, of 1 m each.
fn frame(file: &File<'_>, map: &Range<usize>, rows: &[Row<'_>]) -> Option<GridFrame> {
    let width = rows.first().map_or(0, |row| row.text.chars().count());
    let height = rows.len();
    for row in rows {
        let length = row.text.chars().count();
        if length != width {
            let label = format!("this one has {}", characters(length));
            let first = format!("the first row has {}", characters(width));
            let others = [(rows[0].place.clone(), first.as_str())];
            let help = "every row must be as long as the first; draw the outside as `#`";
            let what = "the rows of the map are not equally long";
            return file.error(what, (row.place.clone(), &label), &others, help);
        }
    }
    let is_small = width < MIN_SIDE || height < MIN_SIDE;
    let frame = (!is_small && width * height <= MAX_CELLS)
        .then(|| GridFrame::new(Point2::origin(), 1.0, width, height));
    frame.flatten().or_else(|| {
        let what = if is_small { "the map is too small" } else { "the map is too large" };
        let label = format!("{width} × {height} cells");
        let help = "3 × 3 cells are the least, 4 million the most; one row of text is one row of cells";
        file.error(what, (map.clone(), &label), &[], help)
    })
}

fn characters(count: usize) -> String {
    if count == 1 { "1 character".to_owned() } else { format!("{count} characters") }
}

/// The rows of the drawing from the top, each with its place in the file. Where the file has escapes, so that its
/// text differs from the drawing, the place is that of the whole map.
fn rows<'a>(file: &File<'_>, map: &'a str, whole: &Range<usize>) -> Vec<Row<'a>> {
    let raw = file.text(whole.clone());
    let mut at = whole.start + raw.len() - raw.trim_start_matches(['"', '\'']).len();
    let body = &raw[at - whole.start..];
    // TOML leaves out a line break right after the opening quotes.
    let body = body.strip_prefix("\r\n").or_else(|| body.strip_prefix('\n')).unwrap_or(body);
    at = whole.end - body.len();
    let mut written = body.split_inclusive('\n');
    let mut rows = Vec::new();
    for text in map.lines() {
        let line = written.next().unwrap_or_default();
        let is_exact = line.starts_with(text);
        rows.push(Row { text, place: if is_exact { at..at + text.len() } else { whole.clone() } });
        at += line.len();
    }
    rows
}

impl Row<'_> {
    /// The place in the file of the character at byte `at` of the row.
    fn character(&self, at: usize, character: char) -> Range<usize> {
        if self.place.len() == self.text.len() {
            self.place.start + at..self.place.start + at + character.len_utf8()
        } else {
            self.place.clone()
        }
    }
}
