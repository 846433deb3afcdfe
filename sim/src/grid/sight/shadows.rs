//! What a blocked cell hides, worked out once for a radius, in whole numbers.

use super::BlockedCells;
use interfaces::Cell;
use std::cmp::Ordering;
use std::ops::Range;

/// A direction or an offset: columns to the right, rows up.
type Offset = (i32, i32);

/// The cells around a robot, numbered, and what each of them hides.
#[derive(Clone, Debug)]
pub(super) struct Shadows {
    /// The side of the square that holds all cells in reach, cells.
    pub(super) side: usize,
    /// The cells in reach: the robot's own, then by direction counter-clockwise from the right and
    /// from near to far. A cell's place here is the place of its bit in every set of them. So a
    /// shadow, being an angle, is a run of a few words.
    pub(super) reach: Vec<Reach>,
    /// The set of all of them.
    pub(super) everything: Vec<u64>,
    /// For every word of the square, which bits matter.
    pub(super) masks: Vec<Mask>,
    /// What each cell of the square hides.
    pub(super) cells: Vec<Shadow>,
    /// What the corner on the upper right of each cell of the square hides if it is closed.
    pub(super) corners: Vec<Shadow>,
    /// The words of all shadows.
    pub(super) words: Vec<u64>,
    /// The cells more than so many columns or rows away, to the right, above, to the left, below.
    beyond: [Vec<Vec<u64>>; 4],
}

/// A cell in reach.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Where it is, seen from the robot.
    pub(super) offset: Offset,
    /// Its place in the square, row by row from the bottom.
    pub(super) place: u32,
}

/// The run of words of a set that are not all zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Shadow {
    /// The place of the first word in the set.
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
        let place = |(x, y): Offset| (y + radius) as usize * side + (x + radius) as usize;
        let offsets = in_reach(radius);
        let reach = |&offset: &Offset| Reach { offset, place: place(offset) as u32 };
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
            let (place, behind) = (place(offset), behind_cell(&offsets, offset));
            if !behind.is_empty() {
                shadows.cells[place] = shadows.shadow(behind);
                shadows.masks[place / 64].cells |= 1 << (place % 64);
            }
        }
        for (x, y) in (-radius..radius).flat_map(|y| (-radius..radius).map(move |x| (x, y))) {
            let corner = (2 * x + 1, 2 * y + 1);
            let (place, behind) = (place((x, y)), behind_corner(&offsets, corner));
            if !behind.is_empty() {
                shadows.corners[place] = shadows.shadow(behind);
                let mask = &mut shadows.masks[place / 64];
                let is_rising = (corner.0 > 0) == (corner.1 > 0);
                *(if is_rising { &mut mask.rising } else { &mut mask.falling }) |= 1 << (place % 64);
            }
        }
        shadows
    }

    /// Keeps the set of these places, the first the lowest and the last the highest.
    fn shadow(&mut self, places: Vec<usize>) -> Shadow {
        let (first, last) = (places[0] / 64, places[places.len() - 1] / 64);
        let start = self.words.len();
        self.words.resize(start + last - first + 1, 0);
        for place in places {
            self.words[start + place / 64 - first] |= 1 << (place % 64);
        }
        Shadow { first: first as u32, words: start as u32..self.words.len() as u32 }
    }

    /// The sets of cells that lie outside of the grid, seen from `robot`.
    #[inline]
    pub(super) fn outside(&self, blocked: &BlockedCells, robot: Cell) -> impl Iterator<Item = &[u64]> {
        let room = [blocked.width() - 1 - robot.x, blocked.height() - 1 - robot.y, robot.x, robot.y];
        self.beyond.iter().zip(room).filter_map(|(beyond, room)| Some(beyond.get(room as usize)?.as_slice()))
    }
}

/// The places of the cells hidden by a blocked one: strictly between the directions of its outermost
/// corners, and behind it. A line of sight goes on in x and in y, so that what is behind is farther in
/// columns and rows together.
fn behind_cell(offsets: &[Offset], (x, y): Offset) -> Vec<usize> {
    let [corner, others @ ..] = [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(dx, dy)| (2 * x + dx, 2 * y + dy));
    let low = others.into_iter().fold(corner, |low, other| if cross(low, other) < 0 { other } else { low });
    let high =
        others.into_iter().fold(corner, |high, other| if cross(high, other) > 0 { other } else { high });
    let start = first_place(offsets, |offset| by_direction(offset, low).is_gt());
    let end = first_place(offsets, |offset| by_direction(offset, high).is_ge());
    let is_behind = |&place: &usize| steps(offsets[place]) > steps((x, y));
    if by_direction(low, high).is_lt() {
        (start..end).filter(is_behind).collect()
    } else {
        // The direction to the right, where the order begins, is between them.
        (1..end).chain(start..offsets.len()).filter(is_behind).collect()
    }
}

/// The places of the cells hidden by a closed corner, given in halves of a cell: exactly in its
/// direction, and behind it.
fn behind_corner(offsets: &[Offset], corner: Offset) -> Vec<usize> {
    let start = first_place(offsets, |offset| by_direction(offset, corner).is_ge());
    let end = first_place(offsets, |offset| by_direction(offset, corner).is_gt());
    (start..end).filter(|&place| 2 * steps(offsets[place]) > steps(corner)).collect()
}

/// The place of the first cell for which `is_reached` holds, as for all after it; the robot's own
/// has no direction and is left out.
fn first_place(offsets: &[Offset], is_reached: impl Fn(Offset) -> bool) -> usize {
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

/// A set of places below `length`.
fn set(length: usize, places: impl IntoIterator<Item = usize>) -> Vec<u64> {
    let mut words = vec![0; length.div_ceil(64)];
    for place in places {
        words[place / 64] |= 1 << (place % 64);
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
