//! Which scans of a log are looks of their own, and which of their ranges are measurements: some drivers and relays publish a scan
//! again, with its time or with a new one, and some write a number for beams without a return.

use super::codes::Codes;
use interfaces::Spread;
use nalgebra::Isometry2;
use xxhash_rust::xxh3::xxh3_64;

/// A robot that moves by more than this sees something else: as much motion as makes a repeated scan a fault for a localizer.
const MOTION: Spread = Spread::of_motion(0.01);
/// A laser whose scans stay equal for longer is frozen, s: its scans count, and their poses are uncertain.
const LONGEST_S: f64 = 1.0;
/// The looks of a log, and the times of the readings that they become, s.
pub(crate) type TimedLooks = (Vec<f64>, Looks);

/// The scans of a log so far. Equal scans of a robot that stands are looks. Those of several lasers are compared where one publishes
/// its scans twice before the next one.
#[derive(Debug, Default)]
pub(crate) struct Looks {
    scans: usize,
    /// The content of the last scans, which are equal, and the pose of the robot at the first one.
    hash: u64,
    pose: Isometry2<f64>,
    /// The times of the first one and of the last one, s.
    times_s: [f64; 2],
    /// The numbers of those with the time of the one before, or after a motion.
    repeats: Vec<usize>,
    /// The numbers of the scans that repeat another one.
    left_out: Vec<usize>,
    codes: Codes,
    /// What to note, at the end.
    pub(crate) notes: Vec<String>,
}

impl Looks {
    /// Adds the next scan, by its time as written and the pose by the odometry.
    pub(crate) fn add(&mut self, time_s: f64, pose: &Isometry2<f64>, ranges_m: &[f32]) {
        self.codes.add(ranges_m);
        let hash = xxh3_64(&ranges_m.iter().flat_map(|range_m| range_m.to_le_bytes()).collect::<Vec<u8>>());
        let [from_s, to_s] = self.times_s;
        if hash == self.hash {
            let has_moved = !MOTION.contains(&self.pose.inv_mul(pose));
            if time_s == to_s && !self.left_out.is_empty() {
                self.left_out.push(self.scans); // times are known to go forward
            } else if time_s == to_s || has_moved && ranges_m.iter().any(|range_m| range_m.is_finite()) {
                self.repeats.push(self.scans);
            }
            self.times_s[1] = time_s;
        } else {
            let is_repeated = time_s > to_s && time_s - from_s <= LONGEST_S;
            self.left_out.extend(self.repeats.drain(..).filter(|_| is_repeated));
            (self.hash, self.pose, self.times_s) = (hash, *pose, [time_s; 2]);
        }
        self.scans += 1;
    }

    /// Ends the log.
    pub(crate) fn finish(&mut self) {
        self.left_out.sort_unstable();
        let again = "scans come again, with one time or after a motion: left out; publish each scan once";
        let left_out = Some(self.left_out.len()).filter(|count| *count > 0);
        self.notes.extend(left_out.map(|count| format!("{count} {again}")));
        self.notes.extend(self.codes.finish());
    }

    /// What is known of each scan, of the looks alone.
    pub(crate) fn of_looks<T>(&self, of_scans: Vec<T>) -> Vec<T> {
        let numbered = of_scans.into_iter().enumerate();
        numbered.filter(|(number, _)| self.is_look(*number)).map(|(_, it)| it).collect()
    }

    /// Whether the scan with this number, from 0, is a look.
    pub(crate) fn is_look(&self, number: usize) -> bool {
        self.left_out.binary_search(&number).is_err()
    }

    /// Turns numbers for beams without a return into no return.
    pub(crate) fn clean(&self, ranges_m: &mut [f32]) {
        let codes = ranges_m.iter_mut().filter(|range_m| self.codes.found.contains(range_m));
        codes.for_each(|range_m| *range_m = f32::INFINITY);
    }
}
