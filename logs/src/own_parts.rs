//! Parts of the robot that its own laser sees: posts, cables, a shelf. Their ranges stay the same while the robot turns and drives.

use interfaces::{LaserReading, heading_rad, rotation, wrap_rad};
use nalgebra::{Isometry2, Point2, Vector2};
use std::f64::consts::TAU;

/// A part is at most this far from the laser, m, and from the robot's origin if that is farther away.
const NEAR_M: f64 = 0.6;
/// Ranges of one part differ by less than this from their mean, m: three standard deviations of a laser at short range.
const SAME_M: f32 = 0.03;
/// Ranges up to this far behind a part are those of the part, m: at its edge, a beam meets the part and what is behind it.
const BEHIND_M: f32 = 0.1;
/// The beams are told apart by their directions, in steps of 0.25°: some lasers have another number of beams in each scan.
const DIRECTIONS: usize = 1440;
/// A part hides at least this number of directions beside it, and at least one beam: posts tremble, and beams are wide.
const BESIDE: usize = 4;
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
/// A scan counts if the robot has moved by this since the last one that counted, m or rad: at rest, everything stays the same.
const STEP_M: f64 = 0.02;
const STEP_RAD: f64 = 0.05;
/// Lasers beyond this number are not looked at.
const MAX_LASERS: usize = 8;
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
        self.scans[heading][1] += 1;
        if self.lead == 0 && range_m <= max_m {
            self.range_m = range_m;
            self.scans.iter_mut().for_each(|[same, _]| *same = 0);
        }
        if (range_m - self.range_m).abs() <= SAME_M {
            self.lead += 1;
            self.range_m += (range_m - self.range_m) / self.lead as f32;
            self.scans[heading][0] += 1;
        } else {
            self.lead = self.lead.saturating_sub(1);
        }
    }

    /// The range of a part, m.
    fn part_m(&self) -> Option<f32> {
        let known = self.scans.iter().filter(|[_, all]| *all >= MIN_SCANS);
        let shares = known.map(|[same, all]| f64::from(*same) / f64::from(*all));
        let (sum, count) = shares.fold((0.0, 0), |(sum, count), share| (sum + share, count + 1));
        (count >= MIN_HEADINGS && sum >= MIN_SHARE * count as f64).then_some(self.range_m)
    }
}

/// The beams of one laser.
#[derive(Clone, Debug)]
struct Laser {
    mount: Isometry2<f64>,
    directions: Vec<Direction>,
    /// The number of directions beside a part that it hides.
    beside: usize,
    /// The pose of the robot in the last scan that counted, and the distance driven until then, m.
    last: Option<Isometry2<f64>>,
    driven_m: f64,
    /// The largest range that is left out in each direction, m: NaN without a part; empty without any part.
    left_out_m: Vec<f32>,
}

impl Laser {
    /// Counts the next scan.
    fn add(&mut self, reading: &LaserReading) {
        let LaserReading { pose, scan, .. } = reading;
        if let Some(last) = &self.last {
            let step = last.inv_mul(pose);
            let step_m = step.translation.vector.norm();
            if step_m < STEP_M && heading_rad(&step).abs() < STEP_RAD {
                return;
            }
            self.driven_m += step_m;
        }
        self.last = Some(*pose);
        let heading = cyclic(heading_rad(pose), HEADINGS);
        let max_m = (NEAR_M + self.mount.translation.vector.norm()) as f32;
        for (beam, range_m) in scan.ranges_m.iter().enumerate() {
            if f64::from(*range_m) >= scan.range_min_m && *range_m > 0.0 {
                self.directions[cyclic(scan.angle_rad(beam), DIRECTIONS)].add(heading, *range_m, max_m);
            }
        }
    }

    /// The directions and the ranges of the parts, rad and m.
    fn parts(&self) -> impl Iterator<Item = (usize, f32)> {
        let seen = self.directions.iter().enumerate().filter(|_| self.driven_m >= MIN_DRIVEN_M);
        seen.filter_map(|(index, direction)| Some((index, direction.part_m()?)))
    }

    fn judge(&mut self) {
        let mut left_out_m = Vec::new();
        for (index, part_m) in self.parts() {
            left_out_m.resize(DIRECTIONS, f32::NAN);
            for shift in 0..=2 * self.beside {
                let at = (index + DIRECTIONS + shift - self.beside) % DIRECTIONS;
                left_out_m[at] = left_out_m[at].max(part_m + BEHIND_M);
            }
        }
        self.left_out_m = left_out_m;
    }

    /// What was found, in a sentence.
    fn note(&self) -> Option<String> {
        let is_out = |index: usize| !self.left_out_m[index % DIRECTIONS].is_nan();
        let far_m = self.parts().map(|(_, part_m)| part_m).reduce(f32::max)?;
        let degrees = |index: usize| wrap_rad(index as f64 * TAU / DIRECTIONS as f64).to_degrees();
        // From a begin to the end, also over the last direction.
        let begins = (DIRECTIONS / 2..3 * DIRECTIONS / 2).filter(|index| is_out(*index) && !is_out(index - 1));
        let parts: Vec<String> = begins
            .map(|begin| {
                let beams = (begin..begin + DIRECTIONS).take_while(|index| is_out(*index)).count();
                format!("{:.0} to {:.0}", degrees(begin), degrees(begin + beams - 1))
            })
            .collect();
        let at = if parts.is_empty() { "all around".to_owned() } else { format!("at {}°", parts.join(", ")) };
        let points = self.parts().map(|(index, part_m)| {
            let along = rotation(index as f64 * TAU / DIRECTIONS as f64) * Vector2::x();
            self.mount * Point2::from(along * f64::from(part_m))
        });
        let none = [Point2::from([f64::MAX; 2]), Point2::from([f64::MIN; 2])];
        let [min, max] = points.fold(none, |[min, max], at| [min.inf(&at), max.sup(&at)]);
        let [min, max] = [min.coords.add_scalar(-BOX_MARGIN_M), max.coords.add_scalar(BOX_MARGIN_M)];
        Some(format!(
            "the laser sees parts of the robot itself, {at} of its own frame, up to {far_m:.2} m away: these ranges are left out, and \
             nothing is known behind them; laser_filters/LaserScanBoxFilter does the same in ROS, with the frame of the robot as box_frame \
             and min_x: {:.2}, max_x: {:.2}, min_y: {:.2}, max_y: {:.2}, min_z: -1.0, max_z: 1.0",
            min.x, max.x, min.y, max.y
        ))
    }
}

/// Finds the parts of a robot in the scans of its lasers, by the poses of the odometry: a part is near, and its range is the same
/// in 95 % of the scans while the robot drives 5 m or more and turns by 180° or more.
#[derive(Clone, Debug, Default)]
pub struct OwnParts {
    lasers: Vec<Laser>,
}

impl OwnParts {
    /// Learns from the next reading, as it was measured.
    pub fn add(&mut self, reading: &LaserReading) {
        if let Some(laser) = self.lasers.iter_mut().find(|laser| laser.mount == reading.mount) {
            laser.add(reading);
        } else if self.lasers.len() < MAX_LASERS {
            let step = (reading.scan.angle_increment_rad.abs() / TAU * DIRECTIONS as f64).ceil() as usize;
            let mut laser = Laser {
                mount: reading.mount,
                directions: vec![Direction::default(); DIRECTIONS],
                beside: step.clamp(BESIDE, DIRECTIONS / 8),
                last: None,
                driven_m: 0.0,
                left_out_m: Vec::new(),
            };
            laser.add(reading);
            self.lasers.push(laser);
        }
    }

    /// Decides by the readings so far what [`remove`](Self::remove) leaves out. Returns the notes on lasers for which parts
    /// are known now and were not before.
    pub fn judge(&mut self) -> Vec<String> {
        let newly = |laser: &mut Laser| {
            let was_known = !laser.left_out_m.is_empty();
            laser.judge();
            laser.note().filter(|_| !was_known)
        };
        self.lasers.iter_mut().filter_map(newly).collect()
    }

    /// Makes the ranges up to a part of the robot invalid: a part hides what is behind it.
    pub fn remove(&self, reading: &mut LaserReading) {
        let known = self.lasers.iter().find(|laser| laser.mount == reading.mount);
        let Some(laser) = known.filter(|laser| !laser.left_out_m.is_empty()) else { return };
        for beam in 0..reading.scan.ranges_m.len() {
            let left_out_m = laser.left_out_m[cyclic(reading.scan.angle_rad(beam), DIRECTIONS)];
            let range_m = &mut reading.scan.ranges_m[beam];
            if *range_m <= left_out_m {
                *range_m = f32::NAN;
            }
        }
    }
}

/// The number of the nearest of `count` equal parts of a turn.
fn cyclic(angle_rad: f64, count: usize) -> usize {
    ((angle_rad / TAU * count as f64).round() as i64).rem_euclid(count as i64) as usize
}
