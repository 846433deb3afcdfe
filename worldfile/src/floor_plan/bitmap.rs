use super::picture::{self, Pixel};
use super::{MAX_CORNERS, PlanError};

/// The blocked pixels of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    width: u32,
    height: u32,
    /// Row by row from the bottom: y points upwards, as in the world.
    blocked: Vec<bool>,
}

impl Bitmap {
    /// Decodes a PNG, PBM, PGM or PPM picture. `is_blocked` decides for each pixel.
    ///
    /// # Errors
    ///
    /// When the picture has another format, is too large by its header, is damaged or empty, or contains only
    /// noise.
    pub fn decode(bytes: &[u8], is_blocked: impl Fn(Pixel) -> bool) -> Result<Self, PlanError> {
        let image = picture::decode(bytes)?;
        let (width, height) = (image.width(), image.height());
        let rows = (0..height).rev();
        let blocked = rows.flat_map(|y| picture::row(&image, y)).map(is_blocked).collect();
        drop(image);
        Self::new(width, height, blocked)
    }

    /// Decodes a picture by brightness: pixels darker than `blocked_below` (0 black, 1 white) are blocked.
    /// Transparent pixels are seen on a white background.
    ///
    /// # Errors
    ///
    /// The errors of [`Bitmap::decode`].
    pub fn decode_dark(bytes: &[u8], blocked_below: f64) -> Result<Self, PlanError> {
        Self::decode(bytes, |pixel| pixel.on_white() < blocked_below)
    }

    /// The bitmap of `width` × `height` pixels, row by row from the bottom.
    ///
    /// # Errors
    ///
    /// When the bitmap is empty or has too many corners.
    pub fn new(width: u32, height: u32, blocked: Vec<bool>) -> Result<Self, PlanError> {
        if width == 0 || height == 0 || blocked.len() != width as usize * height as usize {
            return Err(PlanError::Empty);
        }
        let bitmap = Self { width, height, blocked };
        let corners = bitmap.corners();
        if corners > MAX_CORNERS { Err(PlanError::TooManyCorners { corners }) } else { Ok(bitmap) }
    }

    /// The number of pixels per row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The number of rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the pixel in column `x` and row `y`, counted from the lower left pixel, is blocked; pixels outside
    /// of the picture are free.
    pub fn is_blocked(&self, x: u32, y: u32) -> bool {
        x < self.width && y < self.height && self.row(y)[x as usize]
    }

    /// The smallest box of pixels that contains all blocked pixels: its lower left and upper right corner; `None`
    /// if no pixel is blocked.
    pub fn blocked_bounds(&self) -> Option<([u32; 2], [u32; 2])> {
        let rows = (0..self.height).filter_map(|y| {
            let first = self.row(y).iter().position(|blocked| *blocked)?;
            let last = self.row(y).iter().rposition(|blocked| *blocked)?;
            Some(([first as u32, y], [last as u32 + 1, y + 1]))
        });
        rows.reduce(|(low, high), (first, last)| {
            ([low[0].min(first[0]), low[1]], [high[0].max(last[0]), last[1]])
        })
    }

    /// One row of pixels.
    pub(super) fn row(&self, y: u32) -> &[bool] {
        let start = y as usize * self.width as usize;
        &self.blocked[start..start + self.width as usize]
    }

    /// Visits every border between rows, from the bottom of the lowest row to the top of the
    /// highest: its y, the row below and the row above.
    pub(super) fn for_row_pairs(&self, mut visit: impl FnMut(u32, &[bool], &[bool])) {
        let outside = vec![false; self.width as usize];
        for y in 0..=self.height {
            let below = if y == 0 { &outside } else { self.row(y - 1) };
            let above = if y == self.height { &outside } else { self.row(y) };
            visit(y, below, above);
        }
    }

    /// The corners of the blocked area. Where two blocked pixels touch in a point only, there are two.
    fn corners(&self) -> usize {
        let mut corners = 0;
        self.for_row_pairs(|_, below, above| {
            let (mut left_below, mut left_above) = (false, false);
            let outside = std::iter::once((&false, &false));
            for (&right_below, &right_above) in below.iter().zip(above).chain(outside) {
                let turns = (left_below != left_above) != (right_below != right_above);
                let meets_in_a_point =
                    left_below == right_above && left_above == right_below && left_below != left_above;
                corners += usize::from(turns) + 2 * usize::from(meets_in_a_point);
                (left_below, left_above) = (right_below, right_above);
            }
        });
        corners
    }
}
