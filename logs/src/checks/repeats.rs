//! Scans that a log contains more than once: some drivers and relays publish a scan again, with its time or with a new one.

use interfaces::{Scan, Spread};
use nalgebra::Isometry2;

/// A robot that moves by more than this sees something else: as much motion as makes a repeated scan a fault for a localizer.
const MOTION: Spread = Spread::of_motion(0.01);
/// A laser whose scans stay equal for longer is frozen, s: its scans count, and their poses are uncertain.
const LONGEST_S: f64 = 1.0;
/// Lasers beyond this number are not compared.
const MAX_LASERS: usize = 8;

/// The equal scans of a laser so far.
#[derive(Debug)]
struct Run {
    mount: Option<Isometry2<f64>>,
    ranges_m: Vec<f32>,
    /// The time of the first one, s, and the pose of the robot; whether the scan before it has an earlier time.
    time_s: f64,
    pose: Isometry2<f64>,
    has_time: bool,
    /// The time of the last one, s.
    last_s: f64,
    /// The numbers of the scans with the time of the one before, of which it is not known whether times go forward.
    same_time: Vec<usize>,
    /// The numbers of the scans that are equal though the robot moved.
    moved: Vec<usize>,
}

/// Finds the scans of a log that are no look of their own. Equal scans of a robot that stands are looks.
#[derive(Debug, Default)]
pub(crate) struct Repeats {
    runs: Vec<Run>,
    scans: usize,
    /// The numbers of the scans with the time of an equal scan, and with a new time.
    same_time: Vec<usize>,
    new_time: Vec<usize>,
}

impl Repeats {
    /// Adds the next scan of the laser with this mount, by its time as written and the pose by the odometry.
    pub(crate) fn add(
        &mut self,
        time_s: f64,
        pose: &Isometry2<f64>,
        mount: Option<Isometry2<f64>>,
        scan: &Scan,
    ) {
        let (number, ranges_m) = (self.scans, &scan.ranges_m);
        self.scans += 1;
        let Some(run) = self.runs.iter_mut().find(|run| run.mount == mount) else {
            if self.runs.len() < MAX_LASERS {
                let ranges_m = ranges_m.clone();
                let (pose, last_s, [same_time, moved]) = (*pose, time_s, [Vec::new(), Vec::new()]);
                let run = Run { mount, ranges_m, time_s, pose, has_time: false, last_s, same_time, moved };
                self.runs.push(run);
            }
            return;
        };
        let bits = |ranges_m: &[f32]| ranges_m.iter().map(|range_m| range_m.to_bits()).collect::<Vec<_>>();
        if ranges_m.len() != run.ranges_m.len() || bits(ranges_m) != bits(&run.ranges_m) {
            let is_short = time_s > run.time_s && time_s - run.time_s <= LONGEST_S;
            let same_time = run.same_time.drain(..).filter(|_| time_s > run.last_s);
            self.same_time.extend(same_time);
            self.new_time.extend(run.moved.drain(..).filter(|_| is_short));
            run.has_time = time_s > run.last_s;
            run.ranges_m.clone_from(ranges_m);
            (run.time_s, run.pose) = (time_s, *pose);
        } else if time_s == run.last_s {
            let same_time = if run.has_time { &mut self.same_time } else { &mut run.same_time };
            same_time.push(number);
        } else if !MOTION.contains(&run.pose.inv_mul(pose)) && ranges_m.iter().any(|it| it.is_finite()) {
            run.moved.push(number);
        }
        run.last_s = time_s;
    }

    /// The numbers of the scans to leave out, in order, and what to note.
    pub(crate) fn finish(self) -> (Vec<usize>, Vec<String>) {
        let (same, new) = (self.same_time.len(), self.new_time.len());
        let driver = "the driver or a relay publishes scans again: publish each scan once, with the time of its measurement";
        let same_note = format!("scans come again with the same time, and are left out ({driver})");
        let new_note =
            format!("scans come again with a new time, though the robot moved, and are left out ({driver})");
        let notes = [(same, same_note), (new, new_note)].into_iter().filter(|(count, _)| *count > 0);
        let mut left_out = [self.same_time, self.new_time].concat();
        left_out.sort_unstable();
        (left_out, notes.map(|(count, note)| format!("{count} of {} {note}", self.scans)).collect())
    }
}

/// Removes the elements with these numbers, which are in order.
pub(crate) fn without<T>(all: &mut Vec<T>, left_out: &[usize]) {
    let mut number = 0..;
    all.retain(|_| number.next().is_none_or(|number| left_out.binary_search(&number).is_err()));
}
