//! Floor plans: pictures whose dark pixels are walls.
//!
//! A [`Bitmap`] has the blocked pixels of a picture. It is read from a PNG or PGM picture, either alone or through
//! a ROS `map.yaml` ([`crate::ros_map`]). A [`FloorPlan`] adds a size and a place. From these come the walls:
//! [`FloorPlan::rectangles`], solid rectangles whose union is the blocked area, exact on the borders of pixels. They
//! overlap where walls meet, so that no seam lies across a flat surface.
//!
//! Pictures are bounded before they are decoded: see [`PlanError`].

mod bitmap;
mod picture;
mod rectangles;
#[cfg(test)]
mod tests;

pub use bitmap::Bitmap;
pub use picture::{MAX_DECODED_BYTES, MAX_FILE_BYTES, MAX_PIXELS, Pixel};
pub(crate) use picture::{decode, row};
pub use rectangles::PixelRectangle;

use nalgebra::{Isometry2, Point2, Vector2};
use sim::physics::Rectangle;
use std::sync::Arc;

/// The maximum number of corners of a floor plan: a million pieces of wall.
pub const MAX_CORNERS: usize = 1 << 20;

/// The error for a picture that is not a floor plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// Neither PNG nor PBM, PGM, PPM or PAM, by its first bytes.
    #[error("it is neither a PNG nor a PGM picture")]
    Format,
    /// The header has more pixels than are allowed; nothing was decoded.
    #[error("{width} × {height} pixels are too many: at most {MAX_PIXELS}")]
    TooManyPixels {
        /// The number of pixels per row.
        width: u32,
        /// The number of rows.
        height: u32,
    },
    /// The header has more bytes of pixels than are allowed; nothing was decoded.
    #[error("its pixels take {bytes} bytes, which are too many: at most {MAX_DECODED_BYTES}")]
    TooManyBytes {
        /// The number of bytes that the pixels need in memory.
        bytes: u64,
    },
    /// The picture has no pixels.
    #[error("it has no pixels")]
    Empty,
    /// The part before the pixels is damaged.
    #[error("its header is damaged or incomplete")]
    DamagedHeader,
    /// The pixels are damaged.
    #[error("its pixels are damaged or incomplete")]
    DamagedPixels,
    /// The blocked pixels have too many corners, for example in a picture of noise.
    #[error("its blocked pixels have {corners} corners, which are too many: at most {MAX_CORNERS}")]
    TooManyCorners {
        /// The number of corners.
        corners: usize,
    },
}

/// A picture of walls with its size and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct FloorPlan {
    /// The blocked pixels; several plans may share them.
    pub bitmap: Arc<Bitmap>,
    /// The width and the height of a pixel, m.
    pub pixel_m: Vector2<f64>,
    /// The lower left corner of the picture, m, and the direction of its rows, rad.
    pub origin: Isometry2<f64>,
}

impl FloorPlan {
    /// The width and the height of the picture, m.
    pub fn size_m(&self) -> Vector2<f64> {
        Vector2::new(f64::from(self.bitmap.width()), f64::from(self.bitmap.height()))
            .component_mul(&self.pixel_m)
    }

    /// Solid rectangles whose union is the walls.
    pub fn rectangles(&self) -> impl Iterator<Item = Rectangle> {
        self.bitmap.rectangles().into_iter().map(|rectangle| {
            let (low, high) = (self.local(rectangle.min), self.local(rectangle.max));
            let middle = self.origin * nalgebra::center(&low, &high);
            Rectangle {
                pose: Isometry2::from_parts(middle.into(), self.origin.rotation),
                half_m: (high - low) / 2.0,
            }
        })
    }

    /// A corner of a pixel in the picture's own frame, m.
    fn local(&self, [x, y]: [u32; 2]) -> Point2<f64> {
        Point2::new(f64::from(x) * self.pixel_m.x, f64::from(y) * self.pixel_m.y)
    }
}
