//! Parts of the robot that its own laser sees: posts, cables, a shelf. Their ranges stay the same while the robot turns and drives.

use crate::checks::{MIN_MOTION_M, MIN_MOTION_RAD};
use interfaces::{LaserReading, heading_rad, rotation, wrap_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::TAU;

/// A part is at most this far from the laser, m, plus the distance of the laser from the robot's origin: the size of the body is unknown.
const NEAR_M: f64 = 0.6;
/// Ranges of one part differ by less than this from their mean, m: three standard deviations of a laser at short range.
const SAME_M: f32 = 0.03;
/// Ranges up to this far behind a part are those of the part, m: at its edge, a beam meets the part and what is behind it.
const BEHIND_M: f32 = 0.1;
/// Beams are counted by their direction, in steps of 0.25°: some lasers have another number of beams in each scan.
const DIRECTIONS: usize = 1440;
/// A part hides this number of directions on both sides of it: at an edge, a beam meets the part only in some scans.
const BESIDE: usize = 8;
/// Headings of the robot, 45° each. A wall beside the robot keeps its range along straight routes only. So a part must show in
/// each heading, and in enough headings for half a turn.
const HEADINGS: usize = 8;
const MIN_HEADINGS: usize = 5;
/// A heading with fewer scans than this does not count.
const MIN_SCANS: u32 = 5;
/// The share of the scans that must show a part, as the mean of the headings.
const MIN_SHARE: f64 = 0.95;
/// The distance that the robot must have driven, m.
const MIN_DRIVEN_M: f64 = 5.0;
/// The box that is proposed for a filter is larger than the parts by this, m.
const BOX_MARGIN_M: f64 = 0.05;

/// The ranges in one direction.
#[derive(Clone, Copy, Debug, Default)]
struct Direction {
    /// The range of what is probably a part, m, and by how many scans it leads (majority vote, Boyer & Moore 1981).
    range_m: f32,
    lead: u32,
    /// For each heading of the robot, the scans with this range and all valid ones.
    scans: [[u32; 2]; HEADINGS],
}

impl Direction {
    fn add(&mut self, heading: usize, range_m: f32, max_m: f32) {
        if self.lead == 0 && range_m <= max_m {
            self.range_m = range_m;
            self.scans.iter_mut().for_each(|[same, _]| *same = 0);
        }
        let is_same = (range_m - self.range_m).abs() <= SAME_M;
        self.lead = if is_same { self.lead + 1 } else { self.lead.saturating_sub(1) };
        if is_same {
            self.range_m += (range_m - self.range_m) / self.lead as f32;
        }
        let [same, all] = &mut self.scans[heading];
        (*same, *all) = (*same + u32::from(is_same), *all + 1);
    }

    fn is_part(&self) -> bool {
        let known = self.scans.iter().filter(|[_, all]| *all >= MIN_SCANS);
        let (headings, shares) = known.fold((0, 0.0), |(headings, shares), [same, all]| {
            (headings + 1, shares + f64::from(*same) / f64::from(*all))
        });
        headings >= MIN_HEADINGS && shares >= MIN_SHARE * headings as f64
    }
}

/// Finds the parts of a robot in the scans of one laser, by the poses of the odometry: a part is near, and its range is the same
/// in 95 % of the scans while the robot drives 5 m or more and turns by 180° or more.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnParts {
    mount: Isometry2<f64>,
    directions: Vec<Direction>,
    /// The pose of the robot in the last scan that counted, and the distance driven until then, m.
    last: Isometry2<f64>,
    driven_m: f64,
    /// The directions of the parts, and their ranges, m.
    parts: Vec<(usize, f32)>,
    /// The largest range that is left out in each direction, m: NaN without a part.
    left_out_m: Vec<f32>,
}

impl OwnParts {
    /// Learns from the next reading, as it was measured.
    pub(crate) fn add(&mut self, reading: &LaserReading) {
        let LaserReading { pose, scan, .. } = reading;
        self.mount = reading.mount;
        let step = self.last.inv_mul(pose);
        let step_m = step.translation.vector.norm();
        if step_m < MIN_MOTION_M && heading_rad(&step).abs() < MIN_MOTION_RAD {
            return; // at rest, everything stays the same
        }
        (self.last, self.driven_m) = (*pose, self.driven_m + step_m);
        self.directions.resize_with(DIRECTIONS, Direction::default);
        let heading = cyclic(heading_rad(pose), HEADINGS);
        let max_m = (NEAR_M + self.mount.translation.vector.norm()) as f32;
        for (beam, range_m) in scan.ranges_m.iter().enumerate() {
            if f64::from(*range_m) >= scan.range_min_m && *range_m > 0.0 {
                self.directions[cyclic(scan.angle_rad(beam), DIRECTIONS)].add(heading, *range_m, max_m);
            }
        }
    }

    /// Decides by the scans so far what [`remove`](Self::remove) leaves out. Returns a note if parts are known now and were not before.
    pub(crate) fn judge(&mut self) -> Option<String> {
        let is_new = self.parts.is_empty();
        let seen = self.directions.iter().enumerate().filter(|_| self.driven_m >= MIN_DRIVEN_M);
        let parts = seen.filter(|(_, direction)| direction.is_part());
        self.parts = parts.map(|(index, direction)| (index, direction.range_m)).collect();
        self.left_out_m = vec![f32::NAN; DIRECTIONS];
        for (index, part_m) in &self.parts {
            for shift in 0..=2 * BESIDE {
                let left_out_m = &mut self.left_out_m[(index + DIRECTIONS + shift - BESIDE) % DIRECTIONS];
                *left_out_m = left_out_m.max(part_m + BEHIND_M);
            }
        }
        self.note().filter(|_| is_new)
    }

    /// Makes the ranges up to a part of the robot invalid, and beams without a return beside it: a part hides what is behind it.
    pub(crate) fn remove(&self, reading: &mut LaserReading) {
        if self.parts.is_empty() {
            return;
        }
        for beam in 0..reading.scan.ranges_m.len() {
            let left_out_m = self.left_out_m[cyclic(reading.scan.angle_rad(beam), DIRECTIONS)];
            let range_m = &mut reading.scan.ranges_m[beam];
            if *range_m <= left_out_m || *range_m == f32::INFINITY && !left_out_m.is_nan() {
                *range_m = f32::NAN;
            }
        }
    }

    /// What was found, in a sentence.
    fn note(&self) -> Option<String> {
        let far_m = self.parts.iter().map(|(_, part_m)| *part_m).reduce(f32::max)?;
        let degrees =
            |(index, _): (usize, f32)| wrap_rad(angle_rad(index) + heading_rad(&self.mount)).to_degrees();
        let sides = self.parts.chunk_by(|one, next| next.0 - one.0 <= BESIDE);
        let sides =
            sides.map(|side| format!("{:.0}° to {:.0}°", degrees(side[0]), degrees(side[side.len() - 1])));
        let points = self.parts.iter().map(|(index, part_m)| {
            self.mount * Point2::from(rotation(angle_rad(*index)) * Vector2::new(f64::from(*part_m), 0.0))
        });
        let none = [Point2::from([f64::MAX; 2]), Point2::from([f64::MIN; 2])];
        let [min, max] = points.fold(none, |[min, max], at| [min.inf(&at), max.sup(&at)]);
        Some(format!(
            "the laser sees parts of the robot itself, up to {far_m:.2} m away, in the directions {} from the front of the robot: these ranges are \
             left out, and what is behind them is not observed; laser_filters/LaserScanBoxFilter does the same in ROS, with the frame of \
             the robot as box_frame and min_x: {:.2}, max_x: {:.2}, min_y: {:.2}, max_y: {:.2}, min_z: -1.0, max_z: 1.0",
            sides.collect::<Vec<_>>().join(", "),
            min.x - BOX_MARGIN_M,
            max.x + BOX_MARGIN_M,
            min.y - BOX_MARGIN_M,
            max.y + BOX_MARGIN_M
        ))
    }
}

/// The number of the nearest of `count` equal parts of a turn, from -180° on.
fn cyclic(angle_rad: f64, count: usize) -> usize {
    ((angle_rad / TAU + 0.5) * count as f64).round().rem_euclid(count as f64) as usize
}

/// The angle of a direction, rad.
fn angle_rad(direction: usize) -> f64 {
    (direction as f64 / DIRECTIONS as f64 - 0.5) * TAU
}

#[cfg(test)]
mod tests;
