//! The path of a block: from waypoints to cells.

use super::map::Drawing;
use crate::findings::Mark;
use crate::reader::{Table, Value};
use interfaces::Cell;
use sim::grid::Course;

/// The maximum length of a path; longer paths are refused before memory is allocated.
const MAX_CELLS: usize = 1_000_000;

/// Every cell of the path of the block `name`, in order; none if there is no map.
pub(super) fn cells(
    table: &Table<'_>,
    name: &str,
    course: Course,
    drawing: Option<&Drawing>,
) -> Option<Vec<Cell>> {
    let value = table.needed("path")?;
    let points: Vec<Vec<i64>> = value.list(|point| point.list(Value::integer))?;
    let Some(drawing) = drawing else { return Some(Vec::new()) };
    let path = BlockPath { table, name, drawing };
    let ends: Vec<Option<Cell>> = points.iter().enumerate().map(|(i, point)| path.cell(i, point)).collect();
    let ends: Vec<Cell> = ends.into_iter().collect::<Option<_>>()?;
    let mut cells: Vec<Cell> = Vec::new();
    for (i, &end) in ends.iter().enumerate() {
        path.extend(&mut cells, i, end)?;
    }
    if course == Course::Loop {
        path.close(&mut cells, ends.len())?;
    }
    if cells.len() < 2 {
        let is = format!("has {} cells", cells.len()).replace("1 cells", "1 cell");
        let help = "a block moves over two cells or more, as in `path = [[1, 2], [5, 2]]`";
        return path.error(&is, (value.span(), "too short"), &[], help);
    }
    Some(cells)
}

/// The path of a block, and the map that it leads through.
struct BlockPath<'a> {
    table: &'a Table<'a>,
    name: &'a str,
    drawing: &'a Drawing,
}

impl BlockPath<'_> {
    fn error<T>(&self, does: &str, mark: Mark<'_>, others: &[Mark<'_>], help: &str) -> Option<T> {
        self.table.error(&format!("the path of the block `{}` {does}", self.name), mark, others, help)
    }

    /// The place of a waypoint in the file, with a label.
    fn mark<'l>(&self, index: usize, label: &'l str) -> Mark<'l> {
        (self.table.at_item("path", index), label)
    }

    /// The cell of a waypoint, if it is in the map.
    fn cell(&self, index: usize, point: &[i64]) -> Option<Cell> {
        let &[x, y] = point else {
            let what = format!("a way point of the block `{}` is not a cell", self.name);
            let label = format!("{} numbers", point.len()).replace("1 numbers", "1 number");
            let help = "a cell is its column and its row, as in `[1, 2]`";
            return self.table.error(&what, self.mark(index, &label), &[], help);
        };
        let frame = self.drawing.walls.frame();
        match (i32::try_from(x), i32::try_from(y)) {
            (Ok(x), Ok(y)) if frame.contains(Cell::new(x, y)) => Some(Cell::new(x, y)),
            _ => {
                let (right, top) = (frame.width() - 1, frame.height() - 1);
                let help = format!("the cells of the map are [0, 0] (lower left) to [{right}, {top}]");
                self.error("leaves the map", self.mark(index, "outside of the map"), &[], &help)
            }
        }
    }

    /// Goes on to the waypoint `index` in a straight line.
    fn extend(&self, cells: &mut Vec<Cell>, index: usize, end: Cell) -> Option<()> {
        let Some(&start) = cells.last() else {
            self.is_free(end, self.mark(index, "a wall"), &[])?;
            cells.push(end);
            return Some(());
        };
        let others = [self.mark(index - 1, "from here")];
        let mark = self.mark(index, "to here");
        if (start.x == end.x) == (start.y == end.y) {
            let (does, help) = if start == end {
                ("stands still", "leave out a way point that repeats the one before")
            } else {
                ("jumps", "two way points must lie in one row or in one column")
            };
            return self.error(does, mark, &others, help);
        }
        let length = (start.x.abs_diff(end.x) + start.y.abs_diff(end.y)) as usize;
        if cells.len() + length > MAX_CELLS {
            return self.error("is too long", mark, &others, "1 million cells are the most");
        }
        let (dx, dy) = ((end.x - start.x).signum(), (end.y - start.y).signum());
        for step in 1..=length as i32 {
            let next = Cell::new(start.x + dx * step, start.y + dy * step);
            self.is_free(next, mark.clone(), &others)?;
            cells.push(next);
        }
        Some(())
    }

    /// A loop goes on from its last cell to its first. A path that comes back to the first cell describes the same
    /// loop: that cell counts once.
    fn close(&self, cells: &mut Vec<Cell>, points: usize) -> Option<()> {
        if cells.len() > 1 && cells.first() == cells.last() {
            cells.pop();
        }
        let (Some(first), Some(last)) = (cells.first(), cells.last()) else { return Some(()) };
        if cells.len() == 1 || first.neighbours4().contains(last) {
            return Some(());
        }
        let what = format!("the loop of the block `{}` is open", self.name);
        let help = "the last cell must share a side with the first, or be the first again; `course = \"back-and-forth\"` turns round instead";
        self.table.error(&what, self.mark(points - 1, "ends here"), &[self.mark(0, "begins here")], help)
    }

    /// Records a path through a wall.
    fn is_free(&self, cell: Cell, mark: Mark<'_>, others: &[Mark<'_>]) -> Option<()> {
        if self.drawing.walls.get(cell) == Some(&false) {
            return Some(());
        }
        let help = format!(
            "[{}, {}] is a wall: x counts columns from the left, y rows from the bottom, both from 0",
            cell.x, cell.y
        );
        self.error("crosses a wall", mark, others, &help)
    }
}
