//! The drawing of the map: one character per cell, the top row first.

use crate::error::{Source, WorldError};
use interfaces::{Cell, Grid, GridFrame};
use nalgebra::Point2;
use serde_spanned::Spanned;
use std::ops::Range;

/// More cells than this are refused before anything is allocated for them.
const MAX_CELLS: usize = 4_000_000;
/// A map has at least so many rows and columns: a cell with a wall around it.
const MIN_SIDE: usize = 3;

/// What the drawing says.
pub(super) struct Drawing {
    pub(super) walls: Grid<bool>,
    pub(super) start: Cell,
}

/// A row of the drawing and where it stands in the file.
struct Row<'a> {
    text: &'a str,
    place: Range<usize>,
}

pub(super) fn drawing(source: &Source<'_>, map: &Spanned<String>) -> Result<Drawing, WorldError> {
    let rows = rows(source, map);
    let frame = frame(source, map, &rows)?;
    let mut walls = Grid::filled(frame, false);
    let mut start: Option<(Cell, Range<usize>)> = None;
    for (row, y) in rows.iter().zip((0..frame.height() as i32).rev()) {
        for ((at, character), x) in row.text.char_indices().zip(0..) {
            let cell = Cell::new(x, y);
            let place = row.character(at, character);
            match character {
                '.' => {}
                '#' => walls.get_mut(cell).into_iter().for_each(|wall| *wall = true),
                'R' => {
                    if let Some((_, first)) = start {
                        let marks = [(first, "first here")];
                        let help = "there is one robot: draw one `R`, or none for the centre of the map";
                        return Err(source.error(
                            "the robot starts twice",
                            (place, "again here"),
                            &marks,
                            help,
                        ));
                    }
                    start = Some((cell, place));
                }
                _ => {
                    let what = format!("unknown character `{}` in the map", character.escape_debug());
                    let help = "`#` is a wall, `.` is free, `R` is where the robot starts";
                    return Err(source.error(&what, (place, "not known here"), &[], help));
                }
            }
        }
    }
    if walls.cells().iter().all(|wall| *wall) {
        let help = "draw free cells as `.`";
        return Err(source.error("no cell of the map is free", (map.span(), "all wall"), &[], help));
    }
    let start = match start {
        Some((cell, _)) => cell,
        None => centre(source, &walls, &rows)?,
    };
    Ok(Drawing { walls, start })
}

/// The centre of the map, where the robot starts if the drawing does not say.
fn centre(source: &Source<'_>, walls: &Grid<bool>, rows: &[Row<'_>]) -> Result<Cell, WorldError> {
    let frame = walls.frame();
    let centre = Cell::new(frame.width() as i32 / 2, frame.height() as i32 / 2);
    if walls.get(centre) == Some(&false) {
        return Ok(centre);
    }
    let row = &rows[frame.height() - 1 - centre.y as usize];
    // All characters are known by now, so that columns are bytes.
    let place = row.character(centre.x as usize, '#');
    let help = format!(
        "without an `R` the robot starts in the centre of the map, [{}, {}]: draw an `R`, or a `.` there",
        centre.x, centre.y
    );
    Err(source.error("the robot starts in a wall", (place, "the centre of the map"), &[], &help))
}

/// The cells of the drawing, of 1 m each.
fn frame(source: &Source<'_>, map: &Spanned<String>, rows: &[Row<'_>]) -> Result<GridFrame, WorldError> {
    let width = rows.first().map_or(0, |row| row.text.chars().count());
    let height = rows.len();
    let said = |what: &str| {
        let label = format!("{width} × {height} cells");
        let help = "3 × 3 cells are the least, 4 million the most; one row of text is one row of cells";
        source.error(what, (map.span(), &label), &[], help)
    };
    for row in rows {
        let length = row.text.chars().count();
        if length != width {
            let label = format!("this one has {}", characters(length));
            let first = format!("the first row has {}", characters(width));
            let marks = [(rows[0].place.clone(), first.as_str())];
            let help = "every row must be as long as the first; draw the outside as `#`";
            let what = "the rows of the map are not equally long";
            return Err(source.error(what, (row.place.clone(), &label), &marks, help));
        }
    }
    if width < MIN_SIDE || height < MIN_SIDE {
        return Err(said("the map is too small"));
    }
    if width * height > MAX_CELLS {
        return Err(said("the map is too large"));
    }
    GridFrame::new(Point2::origin(), 1.0, width, height).ok_or_else(|| said("the map is too large"))
}

fn characters(count: usize) -> String {
    if count == 1 { "1 character".to_owned() } else { format!("{count} characters") }
}

/// The rows of the drawing from the top, each with its place in the file. Where escapes make the
/// file differ from what it says, the place is that of the whole map.
fn rows<'a>(source: &Source<'a>, map: &'a Spanned<String>) -> Vec<Row<'a>> {
    let whole = map.span();
    let raw = source.text.get(whole.clone()).unwrap_or_default();
    let mut at = whole.start + raw.len() - raw.trim_start_matches(['"', '\'']).len();
    let body = &raw[at - whole.start..];
    // TOML leaves out a line break right after the opening quotes.
    let body = body.strip_prefix("\r\n").or_else(|| body.strip_prefix('\n')).unwrap_or(body);
    at = whole.end - body.len();
    let mut written = body.split_inclusive('\n');
    let mut rows = Vec::new();
    for text in map.get_ref().lines() {
        let line = written.next().unwrap_or_default();
        let is_exact = line.starts_with(text);
        rows.push(Row { text, place: if is_exact { at..at + text.len() } else { whole.clone() } });
        at += line.len();
    }
    rows
}

impl Row<'_> {
    /// Where the character at byte `at` of the row stands in the file.
    fn character(&self, at: usize, character: char) -> Range<usize> {
        if self.place.len() == self.text.len() {
            self.place.start + at..self.place.start + at + character.len_utf8()
        } else {
            self.place.clone()
        }
    }
}
