//! The field of view of a laser, as a polygon of few corners.

use interfaces::LaserReading;
use mapper::Segment;
use nalgebra::Point2;

/// The maximum distance between the drawn and the measured outline, m.
const TOLERANCE_M: f64 = 0.04;

/// The field of view of a scan in the frame of the map, m: a line through the end of every beam, and through the
/// laser unless the beams cover a full turn. Closed: the last point equals the first.
pub fn field_of_view(reading: &LaserReading) -> Vec<Point2<f64>> {
    let scan = &reading.scan;
    let laser = reading.pose * reading.mount;
    let mut corners: Vec<Point2<f64>> = Vec::with_capacity(scan.ranges_m.len() + 2);
    if !scan.is_full_turn() {
        corners.push(Point2::from(laser.translation.vector));
    }
    for (beam, &range_m) in scan.ranges_m.iter().enumerate() {
        let range_m = f64::from(range_m);
        // REP-117: NaN is no measurement, +∞ is free space up to the limit.
        if range_m >= scan.range_min_m {
            let (sin, cos) = libm::sincos(scan.angle_rad(beam));
            corners.push(laser * (Point2::new(cos, sin) * range_m.min(scan.range_max_m)));
        }
    }
    if let Some(&first) = corners.first() {
        corners.push(first);
    }
    simplify(&corners, TOLERANCE_M)
}

/// The fewest points of a line within `tolerance_m` of all its points (Ramer, Douglas and Peucker).
fn simplify(line: &[Point2<f64>], tolerance_m: f64) -> Vec<Point2<f64>> {
    let Some(end) = line.len().checked_sub(1) else { return Vec::new() };
    let mut keep = vec![false; line.len()];
    let mut open = vec![(0, end)];
    while let Some((from, to)) = open.pop() {
        (keep[from], keep[to]) = (true, true);
        let side = Segment { ends: [line[from], line[to]] };
        let farthest = (from + 1..to)
            .map(|index| (index, side.distance_m(&line[index])))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((index, distance_m)) = farthest
            && distance_m > tolerance_m
        {
            open.extend([(from, index), (index, to)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(point, _)| *point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Scan, Twist, pose};
    use std::f64::consts::TAU;

    fn reading(sweep_rad: f64, ranges_m: Vec<f32>) -> LaserReading {
        LaserReading {
            time_s: 0.0,
            pose: pose(1.0, 2.0, 0.5),
            twist: Twist::STOP,
            velocities: Vec::new(),
            mount: pose(0.1, 0.0, 0.0),
            scan: Scan {
                angle_min_rad: -0.5 * sweep_rad,
                angle_increment_rad: sweep_rad / ranges_m.len() as f64,
                range_min_m: 0.05,
                range_max_m: 10.0,
                sweep_s: 0.0,
                ranges_m,
            },
        }
    }

    /// Ranges from the middle of a square room with sides of 2 × `half_m`.
    fn square_room(beams: usize, half_m: f64) -> Vec<f32> {
        let range = |beam| {
            let angle = (beam as f64 / beams as f64 - 0.5) * TAU;
            half_m / libm::cos(angle).abs().max(libm::sin(angle).abs())
        };
        (0..beams).map(|beam| range(beam) as f32).collect()
    }

    #[test]
    fn a_square_room_has_few_corners_and_they_are_its_own() {
        let reading = reading(TAU, square_room(720, 3.0));
        let outline = field_of_view(&reading);
        assert!(outline.len() <= 8, "{outline:?}");
        assert_eq!(outline.first(), outline.last());
        let laser = reading.pose * reading.mount;
        for corner in &outline {
            let local = laser.inverse_transform_point(corner);
            assert!((local.x.abs().max(local.y.abs()) - 3.0).abs() < 1e-4, "{local}");
        }
    }

    #[test]
    fn no_beam_end_is_farther_than_the_tolerance() {
        let wavy = (0..720).map(|beam| 4.0 + (beam as f32 * 0.07).sin()).collect();
        let reading = reading(TAU, wavy);
        let outline = field_of_view(&reading);
        assert!(outline.len() < 200);
        let laser = reading.pose * reading.mount;
        for (beam, &range) in reading.scan.ranges_m.iter().enumerate() {
            let (sin, cos) = reading.scan.angle_rad(beam).sin_cos();
            let end = laser * (Point2::new(cos, sin) * f64::from(range));
            let nearest =
                outline.windows(2).map(|side| Segment { ends: [side[0], side[1]] }.distance_m(&end));
            assert!(nearest.fold(f64::INFINITY, f64::min) <= TOLERANCE_M + 1e-9);
        }
    }

    #[test]
    fn values_that_are_no_measurements_leave_no_corner() {
        let odd = vec![f32::NAN, f32::NEG_INFINITY, 0.0, f32::INFINITY];
        let outline = field_of_view(&reading(1.0, odd));
        assert_eq!(outline.len(), 3, "{outline:?}"); // laser, limit, laser
        assert!(((outline[1] - outline[0]).norm() - 10.0).abs() < 1e-9);
        assert!(field_of_view(&reading(TAU, vec![f32::NAN; 4])).is_empty());
    }
}
