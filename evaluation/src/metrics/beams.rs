use interfaces::{Event, GridFrame, LaserReading};
use nalgebra::{Isometry2, Point2, Vector2};

/// A laser scan with the true pose of the laser.
pub(super) struct Beams<'a> {
    pub(super) reading: &'a LaserReading,
    pub(super) laser: &'a Isometry2<f64>,
    pub(super) frame: &'a GridFrame,
}

impl Beams<'_> {
    /// Whether a beam shows the event in the cell with the center `middle` (m): the beam ends in the cell (block), or
    /// passes through the middle half of the cell and beyond the cell (free).
    pub(super) fn shows(&self, middle: &Point2<f64>, event: Event) -> bool {
        let cell = self.frame.cell_at(middle);
        let scan = &self.reading.scan;
        let side_m = self.frame.resolution_m();
        let toward = self.laser.inverse_transform_point(middle);
        let distance_m = toward.coords.norm();
        // The beams that can touch the cell lie around the direction to its middle.
        let half_rad = (side_m / distance_m.max(side_m)).min(1.0);
        let direction = interfaces::wrap_rad(libm::atan2(toward.y, toward.x) - scan.angle_min_rad);
        let index_at = |angle_rad: f64| (angle_rad / scan.angle_increment_rad).ceil() as i64;
        (index_at(direction - half_rad)..index_at(direction + half_rad)).any(|beam| {
            let index = if scan.is_full_turn() {
                beam.rem_euclid(scan.ranges_m.len() as i64) as usize
            } else {
                beam as usize
            };
            scan.ranges_m.get(index).is_some_and(|&range_m| {
                let along = self.laser.rotation * interfaces::rotation(scan.angle_rad(index));
                let origin = Point2::from(self.laser.translation.vector);
                match event {
                    Event::Block => {
                        // A millimeter behind the surface: a surface on a border belongs to the solid cell.
                        let end = origin + along * Vector2::new(f64::from(range_m) + 1e-3, 0.0);
                        range_m.is_finite() && self.frame.cell_at(&end) == cell
                    }
                    Event::Free => {
                        let lateral_m = (along.inverse() * (middle - origin)).y.abs();
                        lateral_m < side_m / 4.0 && f64::from(range_m) > distance_m + side_m
                    }
                }
            })
        })
    }
}
