//! The path of a block: from way points to cells.

use super::file::{BlockFile, WayPoint};
use super::map::Drawing;
use crate::error::{Source, WorldError};
use crate::together::Together;
use interfaces::Cell;
use sim::grid::Course;
use std::ops::Range;

/// Longer paths are refused before anything is allocated for them.
const MAX_CELLS: usize = 1_000_000;

/// Every cell of the path, in order.
pub(super) fn cells(
    source: &Source<'_>,
    block: &BlockFile,
    course: Course,
    drawing: &Drawing,
) -> Result<Vec<Cell>, WorldError> {
    let name = block.name.get_ref();
    let mut path: Vec<Cell> = Vec::new();
    let mut previous: Option<&WayPoint> = None;
    let points = block.path.get_ref();
    let ends = points.iter().map(|point| cell(source, name, point, drawing)).collect::<Vec<_>>();
    for (point, end) in points.iter().zip(ends.together()?) {
        match (path.last().copied(), previous) {
            (Some(start), Some(previous)) => {
                let marks = [(previous.span(), "from here")];
                let mark = (point.span(), "to here");
                if (start.x == end.x) == (start.y == end.y) {
                    let (what, help) = if start == end {
                        ("stands still", "leave out a way point that repeats the one before")
                    } else {
                        ("jumps", "two way points must lie in one row or in one column")
                    };
                    return Err(source.error(
                        &format!("the path of the block `{name}` {what}"),
                        mark,
                        &marks,
                        help,
                    ));
                }
                let length = (start.x.abs_diff(end.x) + start.y.abs_diff(end.y)) as usize;
                if path.len() + length > MAX_CELLS {
                    let what = format!("the path of the block `{name}` is too long");
                    return Err(source.error(&what, mark, &marks, "1 million cells are the most"));
                }
                let (dx, dy) = ((end.x - start.x).signum(), (end.y - start.y).signum());
                for step in 1..=length as i32 {
                    let next = Cell::new(start.x + dx * step, start.y + dy * step);
                    free(source, name, next, point, &marks, drawing)?;
                    path.push(next);
                }
            }
            _ => {
                free(source, name, end, point, &[], drawing)?;
                path.push(end);
            }
        }
        previous = Some(point);
    }
    if course == Course::Loop {
        close(source, block, &mut path)?;
    }
    if path.len() < 2 {
        let what =
            format!("the path of the block `{name}` has {} cells", path.len()).replace("1 cells", "1 cell");
        let help = "a block moves over two cells or more, as in `path = [[1, 2], [5, 2]]`";
        return Err(source.error(&what, (block.path.span(), "too short"), &[], help));
    }
    Ok(path)
}

/// A loop goes on from its last cell to its first. Coming back to the first cell is another way to
/// say so: that cell counts once.
fn close(source: &Source<'_>, block: &BlockFile, path: &mut Vec<Cell>) -> Result<(), WorldError> {
    if path.len() > 1 && path.first() == path.last() {
        path.pop();
    }
    let (Some(first), Some(last)) = (path.first(), path.last()) else { return Ok(()) };
    if path.len() == 1 || first.neighbours4().contains(last) {
        return Ok(());
    }
    let points = block.path.get_ref();
    let what = format!("the loop of the block `{}` is open", block.name.get_ref());
    let marks = [(points[0].span(), "begins here")];
    let help = "the last cell must share a side with the first, or be the first again; `course = \"back-and-forth\"` turns round instead";
    Err(source.error(&what, (points[points.len() - 1].span(), "ends here"), &marks, help))
}

/// The cell of a way point, if it is in the map.
fn cell(source: &Source<'_>, name: &str, point: &WayPoint, drawing: &Drawing) -> Result<Cell, WorldError> {
    let &[x, y] = point.get_ref().as_slice() else {
        let what = format!("a way point of the block `{name}` is not a cell");
        let label = format!("{} numbers", point.get_ref().len()).replace("1 numbers", "1 number");
        let help = "a cell is its column and its row, as in `[1, 2]`";
        return Err(source.error(&what, (point.span(), &label), &[], help));
    };
    let frame = drawing.walls.frame();
    match (i32::try_from(x), i32::try_from(y)) {
        (Ok(x), Ok(y)) if frame.contains(Cell::new(x, y)) => Ok(Cell::new(x, y)),
        _ => {
            let what = format!("the path of the block `{name}` leaves the map");
            let help = format!(
                "the cells of the map are [0, 0] (lower left) to [{}, {}]",
                frame.width() - 1,
                frame.height() - 1
            );
            Err(source.error(&what, (point.span(), "outside of the map"), &[], &help))
        }
    }
}

/// Refuses a path through a wall.
fn free(
    source: &Source<'_>,
    name: &str,
    cell: Cell,
    point: &WayPoint,
    marks: &[(Range<usize>, &str)],
    drawing: &Drawing,
) -> Result<(), WorldError> {
    if drawing.walls.get(cell) == Some(&false) {
        return Ok(());
    }
    let what = format!("the path of the block `{name}` crosses a wall");
    let label = if marks.is_empty() { "a wall" } else { "to here" };
    let help = format!(
        "[{}, {}] is a wall: x counts columns from the left, y rows from the bottom, both from 0",
        cell.x, cell.y
    );
    Err(source.error(&what, (point.span(), label), marks, &help))
}
