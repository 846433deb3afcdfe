//! Floor plans: pictures whose dark pixels are walls.
//!
//! A [`Bitmap`] has the blocked pixels of a picture. It is read from a PNG or PGM picture, either alone or through
//! a ROS `map.yaml` ([`crate::ros_map`]). A [`FloorPlan`] adds a size and a place. From these come the walls:
//! [`FloorPlan::rectangles`], solid rectangles whose union is the blocked area, exact on the borders of pixels. They
//! overlap where walls meet, so that no seam lies across a flat surface.
//!
//! Pictures are bounded before they are decoded: see [`MAX_PIXELS`].

mod bitmap;
mod picture;
#[cfg(test)]
mod tests;

pub use bitmap::{Bitmap, PixelRectangle};
pub use picture::{MAX_FILE_BYTES, MAX_PIXELS, Pixel};
pub(crate) use picture::{decode, row};

use nalgebra::{Isometry2, Point2, Vector2};
use sim::physics::Rectangle;
use std::sync::Arc;

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
        self.bitmap.rectangles().iter().map(|rectangle| {
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
