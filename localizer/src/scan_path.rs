//! The path of a robot while a scan was measured, from odometry.

use interfaces::{LaserReading, Spread, Twist, VelocitySample, heading_rad};
use nalgebra::{Complex, Isometry2, Translation2, UnitComplex, Vector2, Vector3};

/// Rotation equivalent to 1 m of a path within a scan, rad.
const RAD_PER_M: f64 = 3.0;
/// Largest difference between the motion and the sum of the velocities within a scan. Beyond it, the odometry has jumped.
const MAX_MISMATCH: Spread = Spread { m: 0.1, rad: 0.15 };
/// No robot is faster than this, m/s.
const MAX_MPS: f64 = 50.0;
/// Largest turn of which the chord approximates the arc, rad: wrong by less than 1e-5 rad.
const MAX_CHORD_RAD: f64 = 0.1;

/// The path of a robot up to the end of a scan.
pub(crate) struct ScanPath {
    /// The earliest last.
    nodes: Vec<Node>,
}

/// A place on a path.
#[derive(Clone, Copy)]
struct Node {
    /// The time before the end of the scan, s.
    age_s: f64,
    /// The pose in the frame of the robot at the end of the scan: x, y (m) and heading (rad).
    at: Vector3<f64>,
    /// The rotation by this heading.
    rotation: Complex<f64>,
    /// The length of the path from here to the end: meters, and turns as meters.
    length: f64,
}

impl ScanPath {
    /// The path of a robot that moved by `motion` in the time `elapsed_s` up to the end of a scan. The velocities of the
    /// reading give its shape; what they miss of the motion is spread along the path, as the errors of wheels are.
    fn new(reading: &LaserReading, motion: &Isometry2<f64>, elapsed_s: f64) -> Self {
        let mut path = Self::along(reading, elapsed_s);
        path.end_at(motion);
        path
    }

    /// The path of this time up to the end of a scan by the velocities alone.
    fn along(reading: &LaserReading, elapsed_s: f64) -> Self {
        let mut nodes =
            vec![Node { age_s: 0.0, at: Vector3::zeros(), rotation: Complex::new(1.0, 0.0), length: 0.0 }];
        let only = [VelocitySample { time_s: reading.time_s, twist: reading.twist }];
        let samples = if reading.velocities.is_empty() { &only[..] } else { &reading.velocities };
        for (index, sample) in samples.iter().enumerate().rev() {
            let last = nodes[nodes.len() - 1];
            let begin_s = if index > 0 { reading.time_s - samples[index - 1].time_s } else { elapsed_s };
            // Times out of order, or not finite, are no part of the path.
            if begin_s > last.age_s && begin_s <= elapsed_s {
                nodes.push(last.before(&sample.twist, begin_s));
            }
        }
        let last = nodes[nodes.len() - 1];
        if last.age_s < elapsed_s {
            nodes.push(last.before(&samples[0].twist, elapsed_s));
        }
        Self { nodes }
    }

    /// Bends the path so that it has `motion` from its first to its last pose.
    fn end_at(&mut self, motion: &Isometry2<f64>) {
        let whole = *self.whole();
        let missing = pose(&whole.at).inv_mul(&motion.inverse());
        let (shift_m, turn_rad) = (missing.translation.vector, heading_rad(&missing));
        let is_jump = shift_m.norm() > MAX_MISMATCH.m || turn_rad.abs() > MAX_MISMATCH.rad;
        let (shift_m, turn_rad) = if is_jump { (Vector2::zeros(), 0.0) } else { (shift_m, turn_rad) };
        for node in &mut self.nodes {
            let share =
                if whole.length > 0.0 { node.length / whole.length } else { node.age_s / whole.age_s };
            let bent =
                pose(&node.at) * interfaces::pose(shift_m.x * share, shift_m.y * share, turn_rad * share);
            let turned_rad = node.at.z + turn_rad * share;
            node.at = Vector3::new(bent.translation.x, bent.translation.y, turned_rad);
            node.rotation = *interfaces::rotation(turned_rad);
        }
    }

    /// The path of a robot during a scan that sweeps; `None` if all beams were measured at once.
    pub(crate) fn of_sweep(reading: &LaserReading, motion: &Isometry2<f64>, elapsed_s: f64) -> Option<Self> {
        let sweeps = reading.scan.sweep_s > 0.0 && elapsed_s > 0.0;
        sweeps.then(|| Self::new(reading, motion, elapsed_s))
    }

    /// The motion during a scan that sweeps by the velocities alone, and its time, s: of a first reading, before which no pose
    /// is known. If they say that the robot stood, or nothing, the time is 0.
    pub(crate) fn by_velocities(reading: &LaserReading) -> (Isometry2<f64>, f64) {
        let nothing = (Isometry2::identity(), 0.0);
        let sweep_s = reading.scan.sweep_s;
        let is_moving = |twist: &Twist| twist.linear_mps != 0.0 || twist.angular_radps != 0.0;
        let moves =
            is_moving(&reading.twist) || reading.velocities.iter().any(|sample| is_moving(&sample.twist));
        if !moves || !sweep_s.is_finite() || sweep_s <= 0.0 {
            return nothing;
        }
        let begin = Self::along(reading, sweep_s).whole().at;
        let motion = pose(&begin).inverse();
        if motion.translation.vector.norm() < MAX_MPS * sweep_s { (motion, sweep_s) } else { nothing }
    }

    /// The share of the path that the robot had gone at a time before the end of the scan.
    pub(crate) fn passed(&self, age_s: f64) -> f64 {
        let (from, to, share) = self.piece(age_s);
        let (length, whole) = (from.length + (to.length - from.length) * share, self.whole());
        let left = if whole.length > 0.0 { length / whole.length } else { age_s / whole.age_s };
        (1.0 - left).clamp(0.0, 1.0)
    }

    /// The begin of the path.
    fn whole(&self) -> &Node {
        &self.nodes[self.nodes.len() - 1]
    }

    /// The pose at a time before the end of the scan, in the frame of the robot at the end.
    pub(crate) fn at(&self, age_s: f64) -> Isometry2<f64> {
        let (from, to, share) = self.piece(age_s);
        let at = from.at.lerp(&to.at, share);
        if (to.at.z - from.at.z).abs() > MAX_CHORD_RAD {
            return pose(&at);
        }
        // The chord instead of the arc, for speed: wrong by less than 1e-5 rad.
        let rotation = UnitComplex::new_normalize(from.rotation * (1.0 - share) + to.rotation * share);
        Isometry2::from_parts(Translation2::new(at.x, at.y), rotation)
    }

    /// The nodes around a time before the end of the scan, and where it lies between them.
    fn piece(&self, age_s: f64) -> (&Node, &Node, f64) {
        let last = self.nodes.len() - 1;
        let next = (1..last).find(|&node| self.nodes[node].age_s >= age_s).unwrap_or(last);
        let (from, to) = (&self.nodes[next - 1], &self.nodes[next]);
        (from, to, (age_s - from.age_s) / (to.age_s - from.age_s))
    }
}

impl Node {
    /// The node at a time before this one, where the robot moved at a velocity.
    fn before(&self, twist: &Twist, age_s: f64) -> Self {
        let elapsed_s = age_s - self.age_s;
        let (way_m, turn_rad) = (twist.linear_mps * elapsed_s, twist.angular_radps * elapsed_s);
        if !way_m.is_finite() || !turn_rad.is_finite() {
            return Self { age_s, ..*self };
        }
        let heading_rad = self.at.z - turn_rad / 2.0;
        let way = interfaces::rotation(heading_rad) * Vector2::x() * way_m;
        Self {
            age_s,
            at: self.at - Vector3::new(way.x, way.y, turn_rad),
            rotation: self.rotation,
            length: self.length + way_m.abs() + turn_rad.abs() / RAD_PER_M,
        }
    }
}

fn pose(at: &Vector3<f64>) -> Isometry2<f64> {
    interfaces::pose(at.x, at.y, at.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Scan, pose};

    #[test]
    fn the_motion_within_a_first_scan_follows_from_its_velocities() {
        let reading = |linear_mps: f64, angular_radps: f64| LaserReading {
            time_s: 1.0,
            twist: Twist { linear_mps, angular_radps },
            scan: Scan { sweep_s: 0.1, ..Scan::default() },
            ..LaserReading::default()
        };
        let (motion, elapsed_s) = ScanPath::by_velocities(&reading(0.5, 1.0));
        assert_eq!(elapsed_s, 0.1);
        assert!((motion.translation.x - 0.05).abs() < 1e-3, "{motion}");
        assert!((heading_rad(&motion) - 0.1).abs() < 1e-9, "{motion}");
        for (linear_mps, angular_radps) in
            [(0.0, 0.0), (f64::NAN, f64::NAN), (f64::INFINITY, 0.0), (1e9, 0.0)]
        {
            let (motion, elapsed_s) = ScanPath::by_velocities(&reading(linear_mps, angular_radps));
            assert!(motion == Isometry2::identity() || elapsed_s == 0.0, "{linear_mps}: {motion}");
        }
    }

    #[test]
    fn velocities_that_cannot_be_true_are_no_part_of_the_path() {
        let sample = |time_s, linear_mps| VelocitySample {
            time_s,
            twist: Twist { linear_mps, angular_radps: f64::NAN },
        };
        for velocities in [vec![], vec![sample(0.95, 0.3), sample(0.92, 0.3), sample(f64::NAN, 1.0)]] {
            let reading = LaserReading {
                time_s: 1.0,
                twist: Twist { linear_mps: f64::INFINITY, angular_radps: 0.0 },
                velocities,
                ..LaserReading::default()
            };
            let path = ScanPath::new(&reading, &pose(0.04, 0.0, 0.1), 0.1);
            let [first, middle] = [0.1, 0.05].map(|age_s| path.at(age_s));
            assert!((pose(0.04, 0.0, 0.1) * first).translation.vector.norm() < 1e-12);
            assert!(((-heading_rad(&middle)) - 0.05).abs() < 0.03, "{middle}");
        }
    }
}
