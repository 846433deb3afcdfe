//! The cells that a blocked cell hides, computed once for a radius, in integers.

use super::BlockedCells;
use interfaces::Cell;
use std::cmp::Ordering;
use std::ops::Range;

/// A direction or an offset: columns to the right, rows up.
type Offset = (i32, i32);

/// The cells around a robot, numbered, and the cells that each of them hides.
#[derive(Clone, Debug)]
pub(super) struct Shadows {
    /// The side of the square that holds all cells in reach, cells.
    pub(super) side: usize,
    /// The cells in reach: the cell of the robot, then by direction counter-clockwise from the right and from near
    /// to far. The index of a cell here is the index of its bit in every set of cells. A shadow is an angle, and
    /// so a run of a few words.
    pub(super) reach: Vec<Reach>,
    /// The set of all of them.
    pub(super) everything: Vec<u64>,
    /// For every word of the square, the bits that matter.
    pub(super) masks: Vec<Mask>,
    /// The cells that each cell of the square hides.
    pub(super) cells: Vec<Shadow>,
    /// The cells that the upper right corner of each cell of the square hides if the corner is closed.
    pub(super) corners: Vec<Shadow>,
    /// The words of all shadows.
    pub(super) words: Vec<u64>,
    /// For every distance, the cells farther away than that to the right, above, to the left, below.
    beyond: [Vec<Vec<u64>>; 4],
}

/// A cell in reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// The offset from the robot.
    pub(super) offset: Offset,
    /// The index of its bit in the square, row by row from the bottom.
    pub(super) bit: u32,
}

/// The run of words of a set that are not all zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadow {
    /// The index of the first word in the set.
    first: u32,
    /// The words, in [`Shadows::words`].
    words: Range<u32>,
}

impl Shadow {
    /// Adds the shadow to a set.
    #[inline]
    pub(super) fn unite(&self, set: &mut [u64], words: &[u64]) {
        let words = &words[self.words.start as usize..self.words.end as usize];
        set[self.first as usize..].iter_mut().zip(words).for_each(|(set, word)| *set |= word);
    }
}

/// Which bits of a word of the square matter.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mask {
    /// Cells that hide others.
    pub(super) cells: u64,
    /// Corners on the upper right of a cell that lines of sight cross rising to the right: the
    /// cells beside are the one above and the one to the right.
    pub(super) rising: u64,
    /// The same for lines that fall to the right: the cells beside are this one and the one above
    /// and to the right.
    pub(super) falling: u64,
}

impl Shadows {
    pub(super) fn new(radius: i32) -> Self {
        let side = 2 * radius as usize + 1;
        let index = |(x, y): Offset| (y + radius) as usize * side + (x + radius) as usize;
        let offsets = in_reach(radius);
        let reach = |&offset: &Offset| Reach { offset, bit: index(offset) as u32 };
        let mut shadows = Self {
            side,
            reach: offsets.iter().map(reach).collect(),
            everything: set(offsets.len(), 0..offsets.len()),
            masks: vec![Mask::default(); (side * side).div_ceil(64)],
            cells: vec![Shadow::default(); side * side],
            corners: vec![Shadow::default(); side * side],
            words: Vec::new(),
            beyond: beyond(&offsets, radius),
        };
        for &offset in &offsets[1..] {
            let (index, behind) = (index(offset), behind_cell(&offsets, offset));
            if !behind.is_empty() {
                shadows.cells[index] = shadows.shadow(behind);
                shadows.masks[index / 64].cells |= 1 << (index % 64);
            }
        }
        for (x, y) in (-radius..radius).flat_map(|y| (-radius..radius).map(move |x| (x, y))) {
            let corner = (2 * x + 1, 2 * y + 1);
            let (index, behind) = (index((x, y)), behind_corner(&offsets, corner));
            if !behind.is_empty() {
                shadows.corners[index] = shadows.shadow(behind);
                let mask = &mut shadows.masks[index / 64];
                let is_rising = (corner.0 > 0) == (corner.1 > 0);
                *(if is_rising { &mut mask.rising } else { &mut mask.falling }) |= 1 << (index % 64);
            }
        }
        shadows
    }

    /// Stores the set of these indices, which are sorted.
    fn shadow(&mut self, indices: Vec<usize>) -> Shadow {
        let (first, last) = (indices[0] / 64, indices[indices.len() - 1] / 64);
        let start = self.words.len();
        self.words.resize(start + last - first + 1, 0);
        for index in indices {
            self.words[start + index / 64 - first] |= 1 << (index % 64);
        }
        Shadow { first: first as u32, words: start as u32..self.words.len() as u32 }
    }

    /// The sets of cells that lie outside of the grid, seen from `robot`.
    #[inline]
    pub(super) fn outside(&self, blocked: &BlockedCells, robot: Cell) -> impl Iterator<Item = &[u64]> {
        let room = [blocked.width - 1 - robot.x, blocked.height - 1 - robot.y, robot.x, robot.y];
        self.beyond.iter().zip(room).filter_map(|(beyond, room)| Some(beyond.get(room as usize)?.as_slice()))
    }
}

/// The indices of the cells that a blocked cell hides: strictly between the directions of its outermost corners,
/// and behind the cell. A line of sight is monotonic in x and in y, so that a cell behind is farther away in
/// columns plus rows.
fn behind_cell(offsets: &[Offset], (x, y): Offset) -> Vec<usize> {
    let [corner, others @ ..] = [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(dx, dy)| (2 * x + dx, 2 * y + dy));
    let low = others.into_iter().fold(corner, |low, other| if cross(low, other) < 0 { other } else { low });
    let high =
        others.into_iter().fold(corner, |high, other| if cross(high, other) > 0 { other } else { high });
    let start = first_index(offsets, |offset| by_direction(offset, low).is_gt());
    let end = first_index(offsets, |offset| by_direction(offset, high).is_ge());
    let is_behind = |&index: &usize| steps(offsets[index]) > steps((x, y));
    if by_direction(low, high).is_lt() {
        (start..end).filter(is_behind).collect()
    } else {
        // The direction to the right, where the order begins, is between them.
        (1..end).chain(start..offsets.len()).filter(is_behind).collect()
    }
}

/// The indices of the cells that a closed corner hides, given in halves of a cell: exactly in its
/// direction, and behind it.
fn behind_corner(offsets: &[Offset], corner: Offset) -> Vec<usize> {
    let start = first_index(offsets, |offset| by_direction(offset, corner).is_ge());
    let end = first_index(offsets, |offset| by_direction(offset, corner).is_gt());
    (start..end).filter(|&index| 2 * steps(offsets[index]) > steps(corner)).collect()
}

/// The index of the first cell for which `is_reached` holds, as for all after it; the robot's own
/// has no direction and is left out.
fn first_index(offsets: &[Offset], is_reached: impl Fn(Offset) -> bool) -> usize {
    1 + offsets[1..].partition_point(|&offset| !is_reached(offset))
}

/// The offsets of all cells in reach, in the order of [`Shadows::reach`].
fn in_reach(radius: i32) -> Vec<Offset> {
    let square = (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y)));
    let mut offsets: Vec<Offset> = square.filter(|(x, y)| x * x + y * y <= radius * radius).collect();
    let is_away = |offset: Offset| offset != (0, 0);
    offsets.sort_unstable_by(|&a, &b| {
        let by_angle = if is_away(a) && is_away(b) { by_direction(a, b) } else { Ordering::Equal };
        is_away(a).cmp(&is_away(b)).then(by_angle).then(steps(a).cmp(&steps(b)))
    });
    offsets
}

/// For each of the four sides, and for each distance up to the radius, the set of cells beyond.
fn beyond(offsets: &[Offset], radius: i32) -> [Vec<Vec<u64>>; 4] {
    [(1, 0), (0, 1), (-1, 0), (0, -1)].map(|(dx, dy)| {
        let sets = (0..radius).map(|room| {
            set(offsets.len(), (0..offsets.len()).filter(|&i| offsets[i].0 * dx + offsets[i].1 * dy > room))
        });
        sets.collect()
    })
}

/// A set of indices below `length`.
fn set(length: usize, indices: impl IntoIterator<Item = usize>) -> Vec<u64> {
    let mut words = vec![0; length.div_ceil(64)];
    for index in indices {
        words[index / 64] |= 1 << (index % 64);
    }
    words
}

/// The order of directions, counter-clockwise from the right.
fn by_direction(a: Offset, b: Offset) -> Ordering {
    let is_lower_half = |(x, y): Offset| y < 0 || (y == 0 && x < 0);
    is_lower_half(a).cmp(&is_lower_half(b)).then(0.cmp(&cross(a, b)))
}

/// Positive if `b` lies counter-clockwise of `a`.
fn cross(a: Offset, b: Offset) -> i64 {
    i64::from(a.0) * i64::from(b.1) - i64::from(a.1) * i64::from(b.0)
}

/// The number of columns and rows to get there.
fn steps((x, y): Offset) -> i32 {
    x.abs() + y.abs()
}
