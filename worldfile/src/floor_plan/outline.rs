//! From blocked pixels to the segments around them.
//!
//! All segments lie on borders of pixels, so one pass over the borders finds each of them whole: a
//! segment runs as far as the border keeps a blocked pixel on the same side and a free one on the
//! other.

use super::bitmap::Bitmap;

/// A segment along borders of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PixelSegment {
    /// Where it starts: column and row of a pixel's lower left corner. What is blocked is on the
    /// left on the way from here.
    pub from: [u32; 2],
    /// Where it ends.
    pub to: [u32; 2],
}

/// A segment that goes on: where it began, and whether what is blocked lies on its upper (of a
/// level one) or right side.
#[derive(Clone, Copy, PartialEq)]
struct Open {
    start: u32,
    blocked_after: bool,
}

impl Bitmap {
    /// The outline of what is blocked, each straight piece one segment; beyond the picture all is
    /// free. First the segments that end lower.
    pub fn outline(&self) -> Vec<PixelSegment> {
        let mut segments = Vec::new();
        let mut upright: Vec<Option<Open>> = vec![None; self.width() as usize + 1];
        self.for_row_pairs(|y, below, above| {
            // Level borders below this row: what is blocked lies on the left of the way.
            let mut level: Option<Open> = None;
            for x in 0..=self.width() {
                let (below, above) =
                    below.get(x as usize).zip(above.get(x as usize)).unwrap_or((&false, &false));
                let end = |open: Open, end: u32| match open.blocked_after {
                    true => PixelSegment { from: [open.start, y], to: [end, y] },
                    false => PixelSegment { from: [end, y], to: [open.start, y] },
                };
                segments.extend(advance(&mut level, x, *below, *above).map(|open| end(open, x)));
            }
            // Upright borders of this row.
            for x in 0..=self.width() {
                let left = x > 0 && above[x as usize - 1];
                let right = above.get(x as usize).copied().unwrap_or(false);
                let end = |open: Open| match open.blocked_after {
                    true => PixelSegment { from: [x, y], to: [x, open.start] },
                    false => PixelSegment { from: [x, open.start], to: [x, y] },
                };
                segments.extend(advance(&mut upright[x as usize], y, left, right).map(end));
            }
        });
        segments
    }
}

/// Goes on to the next border, at `place`, between a pixel before and one after it. Returns the
/// segment that does not go on, if there is one.
fn advance(open: &mut Option<Open>, place: u32, before: bool, after: bool) -> Option<Open> {
    let is_border = before != after;
    if open.is_some_and(|open| is_border && open.blocked_after == after) {
        return None;
    }
    let ended = *open;
    *open = is_border.then_some(Open { start: place, blocked_after: after });
    ended
}
