use interfaces::{APPROXIMATE_ATAN2_ERROR_RAD, Event, GridFrame, LaserReading, approximate_atan2};
use nalgebra::{Isometry2, Point2, Vector2};

/// A laser scan with the true pose of the laser.
pub(super) struct Beams<'a> {
    reading: &'a LaserReading,
    laser: &'a Isometry2<f64>,
    frame: &'a GridFrame,
    /// The longest range of a beam that ended on a surface, and of any beam, m.
    longest_m: [f64; 2],
    is_full_turn: bool,
}

impl<'a> Beams<'a> {
    pub(super) fn new(reading: &'a LaserReading, laser: &'a Isometry2<f64>, frame: &'a GridFrame) -> Self {
        let longest = |ranges_m: &mut dyn Iterator<Item = f32>| f64::from(ranges_m.fold(0.0, f32::max));
        let ranges_m = || reading.scan.ranges_m.iter().copied();
        let ended_m = longest(&mut ranges_m().filter(|range_m| range_m.is_finite()));
        let longest_m = [ended_m, longest(&mut ranges_m())];
        Self { reading, laser, frame, longest_m, is_full_turn: reading.scan.is_full_turn() }
    }

    /// Whether a beam shows the event in the cell with the center `middle` (m): the beam ends in the cell (block), or
    /// passes through the middle half of the cell and beyond the cell (free).
    pub(super) fn shows(&self, middle: &Point2<f64>, event: Event) -> bool {
        self.may_show(middle, event) && self.does_show(middle, event)
    }

    /// Whether the ranges around the direction of the cell allow that a beam shows the event. Most cells are out of
    /// sight: this comparison takes no sine, and its margins are on the safe side.
    fn may_show(&self, middle: &Point2<f64>, event: Event) -> bool {
        let (scan, side_m) = (&self.reading.scan, self.frame.resolution_m());
        let toward = self.laser.inverse_transform_point(middle);
        let distance2 = toward.coords.norm_squared();
        let longest_m = self.longest_m[usize::from(event == Event::Free)] + side_m + 2e-3;
        if distance2 > longest_m * longest_m {
            return false;
        }
        if !self.is_full_turn || scan.angle_increment_rad <= 0.0 {
            return true;
        }
        let distance_m = distance2.sqrt();
        let half_rad = (side_m / distance_m.max(side_m)).min(1.0) + 2.0 * APPROXIMATE_ATAN2_ERROR_RAD;
        let angle_rad = approximate_atan2(toward.y, toward.x) - scan.angle_min_rad;
        let index = |angle_rad: f64| (angle_rad / scan.angle_increment_rad).floor() as i64;
        let (first, last) = (index(angle_rad - half_rad), index(angle_rad + half_rad) + 1);
        let mut beam = first.rem_euclid(scan.ranges_m.len() as i64) as usize;
        (first..=last).any(|_| {
            let range_m = f64::from(scan.ranges_m[beam]);
            beam = if beam + 1 == scan.ranges_m.len() { 0 } else { beam + 1 };
            match event {
                Event::Block => (range_m - distance_m).abs() < side_m + 2e-3,
                Event::Free => range_m > distance_m + 0.99 * side_m,
            }
        })
    }

    fn does_show(&self, middle: &Point2<f64>, event: Event) -> bool {
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
            let index = if self.is_full_turn {
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

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream, Scan};

    /// No cell that a beam shows is left out by the comparison that comes first.
    #[test]
    fn what_a_beam_shows_may_be_shown() {
        let frame = GridFrame::new(Point2::origin(), 0.05, 40, 40).unwrap();
        let mut random = RandomStream::new(5, Purpose::Agent);
        let (mut shown, mut left_out) = (0, 0);
        for _ in 0..300 {
            let [x, y, heading_rad] = [0.0..2.0, 0.0..2.0, -4.0..4.0].map(|range| random.uniform(range));
            let laser = interfaces::pose(x, y, heading_rad);
            let ranges_m: Vec<f32> = (0..random.uniform(3.0..120.0) as usize)
                .map(|_| match random.uniform(0.0..1.0) {
                    kind if kind < 0.1 => f32::INFINITY,
                    kind if kind < 0.2 => f32::NAN,
                    _ => random.uniform(0.1..3.0) as f32,
                })
                .collect();
            let angle_increment_rad = std::f64::consts::TAU / ranges_m.len() as f64;
            let angle_min_rad = -std::f64::consts::PI;
            let scan =
                Scan { angle_min_rad, angle_increment_rad, range_max_m: 3.0, ranges_m, ..Scan::default() };
            let mount = Isometry2::identity();
            let reading = LaserReading { pose: laser, mount, scan, ..LaserReading::default() };
            let beams = Beams::new(&reading, &laser, &frame);
            for middle in (0..frame.len()).map(|index| frame.center(frame.cell(index))) {
                for event in [Event::Block, Event::Free] {
                    let (may_show, does_show) =
                        (beams.may_show(&middle, event), beams.does_show(&middle, event));
                    assert!(may_show || !does_show, "{middle}");
                    shown += usize::from(does_show);
                    left_out += usize::from(!may_show);
                }
            }
        }
        assert!(shown > 1000 && left_out > 300_000, "{shown} shown, {left_out} left out");
    }
}
