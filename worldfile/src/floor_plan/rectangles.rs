//! From blocked pixels to solid rectangles.
//!
//! First the blocked pixels are divided into rectangles: equal runs in consecutive rows form one rectangle. A run
//! is as long as possible, so that each rectangle can only grow upward and downward; it then grows over its
//! neighbors as far as all its columns are blocked. Rectangles that have become equal are merged. The time is
//! proportional to the number of pixels (times a logarithm), the memory to the length of the outline.

use super::bitmap::Bitmap;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PixelRectangle {
    /// The lower left corner: column and row.
    pub min: [u32; 2],
    /// The upper right corner: column and row.
    pub max: [u32; 2],
}

impl Bitmap {
    /// Rectangles whose union is what is blocked. None of them could be larger; they overlap.
    /// Sorted by their lower left corners.
    pub fn rectangles(&self) -> Vec<PixelRectangle> {
        let columns = Columns::new(self);
        let mut rectangles = self.parts();
        for rectangle in &mut rectangles {
            let row = rectangle.min[1];
            let runs = (rectangle.min[0]..rectangle.max[0]).map(|x| columns.run(x, row));
            let (low, high) = runs.fold((0, u32::MAX), |(low, high), run| (low.max(run.0), high.min(run.1)));
            (rectangle.min[1], rectangle.max[1]) = (low, high);
        }
        rectangles.sort_unstable();
        rectangles.dedup();
        rectangles
    }

    /// Rectangles that part what is blocked: none overlap.
    fn parts(&self) -> Vec<PixelRectangle> {
        let mut parts = Vec::new();
        // Those that reach up to the row below, from left to right.
        let mut open: Vec<PixelRectangle> = Vec::new();
        for y in 0..self.height() {
            let mut grown = Vec::new();
            let mut old = open.into_iter().peekable();
            for [start, end] in runs(self.row(y)) {
                while let Some(ended) = old.next_if(|old| old.min[0] < start) {
                    parts.push(ended);
                }
                let same = old.next_if(|old| (old.min[0], old.max[0]) == (start, end));
                let bottom = same.map_or(y, |old| old.min[1]);
                grown.push(PixelRectangle { min: [start, bottom], max: [end, y + 1] });
            }
            parts.extend(old);
            open = grown;
        }
        parts.extend(open);
        parts
    }
}

/// The runs of blocked pixels in a row: the first pixel, and the one after the last.
fn runs(row: &[bool]) -> impl Iterator<Item = [u32; 2]> {
    let mut x = 0;
    std::iter::from_fn(move || {
        let start = x + row[x..].iter().position(|blocked| *blocked)?;
        x = start + row[start..].iter().position(|blocked| !blocked).unwrap_or(row.len() - start);
        Some([start as u32, x as u32])
    })
}

/// The rows at which each column changes between free and blocked, upwards from free.
struct Columns(Vec<Vec<u32>>);

impl Columns {
    fn new(bitmap: &Bitmap) -> Self {
        let mut columns = vec![Vec::new(); bitmap.width() as usize];
        bitmap.for_row_pairs(|y, below, above| {
            for (column, (below, above)) in columns.iter_mut().zip(below.iter().zip(above)) {
                if below != above {
                    column.push(y);
                }
            }
        });
        Self(columns)
    }

    /// The run of blocked pixels in column `x` that holds row `y`, which is blocked.
    fn run(&self, x: u32, y: u32) -> (u32, u32) {
        let changes = &self.0[x as usize];
        let above = changes.partition_point(|change| *change <= y);
        (changes[above - 1], changes[above])
    }
}
