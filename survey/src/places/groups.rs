//! Cells that change, in groups: those of a door, those of an object that comes and goes, and neighboring ones.

use super::PlaceKind;
use interfaces::{Cell, GridFrame};
use mapper::Mapper;
use nalgebra::{Matrix2, Vector2};
use std::collections::BTreeSet;

/// Cells that change belong to one place if they are at most this far apart, m.
const APART_M: f64 = 0.3;
/// A place has at least this area, m²: less is noise of the laser at an edge.
const MIN_M2: f64 = 0.02;
/// Of a thing that is seen from one side, only the front changes, one cell deep: it is a place from this width on, m, if it
/// was seen to come and go twice.
const MIN_FRONT_M: f64 = 0.25;
const MIN_FRONT_CHANGES: u32 = 4;
/// A larger place is divided, m: in a room full of people all changes are connected.
const MAX_M: f64 = 3.0;

/// Cells that belong to one place, by their index.
pub(super) struct Group {
    pub(super) cells: Vec<usize>,
    /// The door or the object that they are; `None` if they are none.
    pub(super) kind: Option<PlaceKind>,
}

impl Group {
    /// Whether the group is a place, if its cell with the most changes has this number of them.
    pub(super) fn counts(&self, mapper: &Mapper, changes: u32) -> bool {
        let (cell_m, cells) = (mapper.frame().resolution_m(), self.cells.len() as f64);
        let is_front = cells * cell_m >= MIN_FRONT_M && changes >= MIN_FRONT_CHANGES;
        self.kind.is_some() || cells * cell_m.powi(2) >= MIN_M2 || is_front
    }
}

/// All groups of cells that changed: doors, objects, and then the others.
pub(super) fn groups(mapper: &Mapper) -> Vec<Group> {
    let mut left: BTreeSet<usize> = mapper.changed().collect();
    let mut found = Vec::new();
    let doors = mapper.doors().iter().map(|door| (PlaceKind::Door { thing: door.id }, door.cells.clone()));
    let objects = mapper.objects().map(|object| (PlaceKind::Object { thing: object.id }, object.cells));
    for (kind, cells) in doors.chain(objects) {
        let cells = cells.iter().map(|cell| *cell as usize);
        let cells: Vec<usize> = cells.filter(|cell| left.remove(cell)).collect();
        if !cells.is_empty() {
            found.push(Group { cells, kind: Some(kind) });
        }
    }
    let reach = (APART_M / mapper.frame().resolution_m()).round().max(1.0) as i32;
    while let Some(cells) = mapper.frame().take_connected(&mut left, reach) {
        found.extend(divided(mapper.frame(), cells).into_iter().map(|cells| Group { cells, kind: None }));
    }
    found
}

/// Cells in groups that are at most [`MAX_M`] long: a longer group is cut across its longer side, in the middle half of it,
/// where the fewest cells are.
fn divided(frame: &GridFrame, cells: Vec<usize>) -> Vec<Vec<usize>> {
    let most = (MAX_M / frame.resolution_m()).round().max(1.0) as i32;
    let at = |index: usize, axis: usize| {
        let Cell { x, y } = frame.cell(index);
        [x, y][axis]
    };
    let [x, y] = [0, 1].map(|axis| {
        let places = || cells.iter().map(|index| at(*index, axis));
        let low = places().min().unwrap_or_default();
        (low, places().max().unwrap_or_default() - low + 1)
    });
    let (axis, (low, length)) = if x.1 >= y.1 { (0, x) } else { (1, y) };
    if length <= most {
        return vec![cells];
    }
    let mut counts = vec![0_usize; length as usize];
    cells.iter().for_each(|index| counts[(at(*index, axis) - low) as usize] += 1);
    let quarter = counts.len() / 4;
    let middle = quarter.max(1)..(counts.len() - quarter);
    let half = counts.len() / 2;
    // Of two equal ones, the one nearer to the middle.
    let cut = middle.min_by_key(|line| (counts[*line], line.abs_diff(half))).unwrap_or(half) as i32 + low;
    let (before, after): (Vec<usize>, Vec<usize>) =
        cells.iter().copied().partition(|index| at(*index, axis) < cut);
    [before, after].into_iter().flat_map(|part| divided(frame, part)).collect()
}

// Changes along a thin line: the leaf of a door, or the surface of a wall that a small error of the poses moves by a cell.

/// What is at most this wide across its line, in cells, is no body.
const THIN_CELLS: f64 = 1.5;
/// A line is at least this long, m: the front of a person is shorter.
const LONG_M: f64 = 0.6;

/// Whether cells, by their indices, are a thin line, as long as a narrow door or longer. People, carts and boxes are wider.
pub fn is_line(mapper: &Mapper, cells: &[usize]) -> bool {
    let at = |index: &usize| {
        let cell = mapper.frame().cell(*index);
        Vector2::new(f64::from(cell.x), f64::from(cell.y))
    };
    let count = cells.len().max(1) as f64;
    let middle = cells.iter().map(at).sum::<Vector2<f64>>() / count;
    let spread = |index: &usize| (at(index) - middle) * (at(index) - middle).transpose();
    let variances = (cells.iter().map(spread).sum::<Matrix2<f64>>() / count).symmetric_eigenvalues();
    // The variance of a row of cells that is n cells long is (n² − 1) / 12.
    let cells_of = |variance: f64| (12.0 * variance.max(0.0) + 1.0).sqrt();
    let length_m = cells_of(variances.max()) * mapper.frame().resolution_m();
    cells_of(variances.min()) <= THIN_CELLS && length_m >= LONG_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    #[test]
    fn a_long_place_is_cut_where_little_changes() {
        let frame = GridFrame::new(Point2::origin(), 0.1, 80, 10).unwrap();
        // Two areas, and a line between them.
        let is_in = |cell: Cell| !(35..40).contains(&cell.x) || cell.y == 4;
        let cells: Vec<usize> = (0..frame.len()).filter(|index| is_in(frame.cell(*index))).collect();
        let groups = divided(&frame, cells.clone());
        assert_eq!(groups.iter().map(Vec::len).sum::<usize>(), cells.len());
        for group in &groups {
            let columns: BTreeSet<i32> = group.iter().map(|index| frame.cell(*index).x).collect();
            let (first, last) = (*columns.first().unwrap(), *columns.last().unwrap());
            assert!(last - first < 30 && (last < 40 || first >= 35), "{first} to {last}");
        }
        let small: Vec<usize> = cells.into_iter().filter(|index| frame.cell(*index).x < 30).collect();
        assert_eq!(divided(&frame, small.clone()), [small]);
    }
}

#[cfg(test)]
mod line_tests {
    use super::*;
    use interfaces::{Cell, GridFrame};
    use mapper::MapperSettings;
    use nalgebra::Point2;

    #[test]
    fn rows_of_cells_are_lines_in_every_direction_and_bodies_are_not() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 60, 60).unwrap();
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let is = |cells: &[(i32, i32)]| {
            let cells: Vec<usize> =
                cells.iter().filter_map(|(x, y)| frame.index(Cell { x: *x, y: *y })).collect();
            is_line(&mapper, &cells)
        };
        let row: Vec<(i32, i32)> = (5..20).map(|x| (x, 7)).collect();
        let slanted: Vec<(i32, i32)> = (5..25).map(|x| (x, x / 2)).collect();
        let body: Vec<(i32, i32)> = (5..11).flat_map(|x| (5..9).map(move |y| (x, y))).collect();
        assert!(is(&row) && is(&slanted) && !is(&body));
        assert!(!is(&row[..8]) && !is(&[]), "too short");
    }
}
