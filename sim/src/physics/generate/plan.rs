use super::draw::CELLS_PER_M;
use super::layout::Area;
use crate::physics::shape::Rectangle;
use nalgebra::{Point2, Vector2};

/// From the cells of a layout to positions in the world.
pub(super) struct Plan {
    /// Whether the corridor runs along y instead of x.
    pub(super) is_upright: bool,
}

impl Plan {
    /// A position, m.
    pub(super) fn point(&self, [along, across]: [f64; 2]) -> Point2<f64> {
        let [x, y] = if self.is_upright { [across, along] } else { [along, across] };
        // A quotient is the nearest number to the decimal fraction, as in a world file; a product is not.
        Point2::new(x / CELLS_PER_M, y / CELLS_PER_M)
    }

    /// The upright rectangle of an area, m.
    pub(super) fn rectangle(&self, area: &Area) -> Rectangle {
        let [low, high] = [area.low, area.high].map(|corner| self.point(corner.map(f64::from)));
        Rectangle::between(low, high)
    }

    /// A square in the center of an area, turned by an angle, m and rad.
    pub(super) fn turned(&self, area: &Area, side: i32, heading_rad: f64) -> Rectangle {
        let center = [0, 1].map(|axis| f64::from(area.low[axis] + area.high[axis]) / 2.0);
        let side_m = f64::from(side) / CELLS_PER_M;
        Rectangle::around(self.point(center), Vector2::new(side_m, side_m), heading_rad)
    }
}
