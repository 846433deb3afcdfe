//! From blocked pixels to solid rectangles.
//!
//! First the blocked pixels are divided into rectangles: equal runs in consecutive rows form one rectangle. A run
//! is as long as possible, so that each rectangle can only grow upward and downward; it then grows over its
//! neighbors as far as all its columns are blocked. Rectangles that have become equal are merged. The time is
//! proportional to the number of pixels (times a logarithm), the memory to the length of the outline.

use super::picture::{self, Pixel};

/// The maximum number of rectangles before they grow: more come from pictures of noise.
const MAX_PARTS: usize = 1 << 20;

/// The blocked pixels of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    width: u32,
    height: u32,
    rectangles: Vec<PixelRectangle>,
}

/// A rectangle of pixels. Rows are counted from the bottom: y points upwards, as in the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PixelRectangle {
    /// The lower left corner: column and row.
    pub min: [u32; 2],
    /// The upper right corner: column and row.
    pub max: [u32; 2],
}

impl Bitmap {
    /// Decodes a PNG, PBM, PGM or PPM picture. `is_blocked` decides for each pixel.
    ///
    /// # Errors
    ///
    /// When the picture has another format, is too large by its header, is damaged or empty, or contains only
    /// noise.
    pub fn decode(bytes: &[u8], is_blocked: impl Fn(Pixel) -> bool) -> Result<Self, String> {
        let image = picture::decode(bytes)?;
        let (width, height) = (image.width(), image.height());
        let rows = (0..height).rev();
        let blocked: Vec<bool> = rows.flat_map(|y| picture::row(&image, y)).map(is_blocked).collect();
        drop(image);
        Self::new(width, height, &blocked)
    }

    /// Decodes a picture by brightness: pixels darker than `blocked_below` (0 black, 1 white) are blocked.
    /// Transparent pixels are seen on a white background.
    ///
    /// # Errors
    ///
    /// The errors of [`Bitmap::decode`].
    pub fn decode_dark(bytes: &[u8], blocked_below: f64) -> Result<Self, String> {
        Self::decode(bytes, |pixel| pixel.on_white() < blocked_below)
    }

    /// The bitmap of `width` × `height` pixels, row by row from the bottom.
    ///
    /// # Errors
    ///
    /// When the bitmap is empty or contains only noise.
    pub fn new(width: u32, height: u32, blocked: &[bool]) -> Result<Self, String> {
        if width == 0 || height == 0 || blocked.len() != width as usize * height as usize {
            return Err(picture::EMPTY.to_owned());
        }
        let rows: Vec<&[bool]> = blocked.chunks(width as usize).collect();
        let mut rectangles = parts(&rows).ok_or_else(|| {
            format!("its blocked pixels are more than {MAX_PARTS} rectangles, which are too many")
        })?;
        let columns = columns(&rows);
        for rectangle in &mut rectangles {
            let row = rectangle.min[1];
            // The run of blocked pixels of each column that holds the row.
            let run = |x: u32| {
                let changes = &columns[x as usize];
                let above = changes.partition_point(|change| *change <= row);
                (changes[above - 1], changes[above])
            };
            let runs = (rectangle.min[0]..rectangle.max[0]).map(run);
            let (low, high) = runs.fold((0, u32::MAX), |(low, high), run| (low.max(run.0), high.min(run.1)));
            (rectangle.min[1], rectangle.max[1]) = (low, high);
        }
        rectangles.sort_unstable();
        rectangles.dedup();
        Ok(Self { width, height, rectangles })
    }

    /// The number of pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Rectangles whose union is what is blocked. None of them could be larger; they overlap.
    /// Sorted by their lower left corners.
    pub fn rectangles(&self) -> &[PixelRectangle] {
        &self.rectangles
    }

    /// Whether the pixel in column `x` and row `y`, counted from the lower left pixel, is blocked.
    #[cfg(test)]
    pub(crate) fn is_blocked(&self, x: u32, y: u32) -> bool {
        self.rectangles
            .iter()
            .any(|PixelRectangle { min, max }| (min[0]..max[0]).contains(&x) && (min[1]..max[1]).contains(&y))
    }

    /// The smallest box of pixels that contains all blocked pixels; `None` if no pixel is blocked.
    pub fn blocked_bounds(&self) -> Option<PixelRectangle> {
        self.rectangles.iter().copied().reduce(|all, next| PixelRectangle {
            min: [0, 1].map(|axis| all.min[axis].min(next.min[axis])),
            max: [0, 1].map(|axis| all.max[axis].max(next.max[axis])),
        })
    }
}

/// Rectangles that part what is blocked: none overlap. `None` if they are too many.
fn parts(rows: &[&[bool]]) -> Option<Vec<PixelRectangle>> {
    let mut parts = Vec::new();
    // Those that reach up to the row below, from left to right.
    let mut open: Vec<PixelRectangle> = Vec::new();
    for (y, row) in (0..).zip(rows) {
        let mut grown = Vec::new();
        let mut old = open.into_iter().peekable();
        for [start, end] in runs(row) {
            while let Some(ended) = old.next_if(|old| old.min[0] < start) {
                parts.push(ended);
            }
            let same = old.next_if(|old| (old.min[0], old.max[0]) == (start, end));
            let bottom = same.map_or(y, |old| old.min[1]);
            grown.push(PixelRectangle { min: [start, bottom], max: [end, y + 1] });
        }
        parts.extend(old);
        if parts.len() > MAX_PARTS {
            return None;
        }
        open = grown;
    }
    parts.extend(open);
    Some(parts)
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
fn columns(rows: &[&[bool]]) -> Vec<Vec<u32>> {
    let mut columns = vec![Vec::new(); rows[0].len()];
    let outside = vec![false; columns.len()];
    let mut below = &*outside;
    for (y, above) in (0..).zip(rows.iter().copied().chain([&*outside])) {
        for (column, (below, above)) in columns.iter_mut().zip(below.iter().zip(above)) {
            if below != above {
                column.push(y);
            }
        }
        below = above;
    }
    columns
}
