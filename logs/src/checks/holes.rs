//! Where the odometry of a log is missing while there are scans.

use super::times::LONGEST_PAUSE_S;

/// The odometry is not missing for a shorter time than this, s.
pub(crate) const LONGEST_GAP_S: f64 = 2.0;
/// A gap this many times as long as the step before it is a hole: some logs have a pose every few seconds.
const HOLE: f64 = 10.0;
/// In a pause of the recording there are no scans either, at least for this share of the gap: nothing else shows the motion in it.
const MAX_SCANLESS: f64 = 0.5;

/// Finds the holes of an odometry, as poses and scans come.
#[derive(Debug, Default)]
pub(crate) struct Holes {
    count: usize,
    /// The time of the last pose, or of the first scan before all poses, s.
    since_s: Option<f64>,
    /// The time of the last scan since then, and the longest time without a scan until then, s.
    scan_s: Option<f64>,
    scanless_s: f64,
    last_pose_s: Option<f64>,
    /// The time between the last two poses, s.
    step_s: Option<f64>,
    /// The time without poses at the begin, s, until a step shows whether it is a hole.
    begin_s: Option<f64>,
}

impl Holes {
    /// Adds the time of a scan, s.
    pub(crate) fn add_scan(&mut self, time_s: f64) {
        let last_s = self.scan_s.unwrap_or(*self.since_s.get_or_insert(time_s));
        if time_s > last_s {
            self.scanless_s = self.scanless_s.max(time_s - last_s);
            self.scan_s = Some(time_s);
        }
    }

    /// Adds the time of a pose, s. Whether there is a hole between two poses and this one.
    pub(crate) fn add_pose(&mut self, time_s: f64) -> bool {
        let missing_s = self.missing_s(time_s);
        let is_hole = self.is_longer(missing_s);
        match self.last_pose_s {
            Some(last_s) => {
                let step_s = time_s - last_s;
                let begins_late = self.begin_s.take().is_some_and(|begin_s| begin_s > HOLE * step_s);
                self.count += usize::from(is_hole) + usize::from(begins_late);
                self.step_s = Some(step_s);
            }
            None => self.begin_s = missing_s,
        }
        (self.since_s, self.last_pose_s) = (Some(time_s), Some(time_s));
        (self.scan_s, self.scanless_s) = (None, 0.0);
        is_hole
    }

    /// The time without poses until a time, s, if it is long and there were scans.
    fn missing_s(&self, time_s: f64) -> Option<f64> {
        let (since_s, scan_s) = self.since_s.zip(self.scan_s)?;
        let (gap_s, scanless_s) = (time_s - since_s, self.scanless_s.max(time_s - scan_s));
        let is_missing =
            gap_s > LONGEST_GAP_S && gap_s <= LONGEST_PAUSE_S && scanless_s <= MAX_SCANLESS * gap_s;
        is_missing.then_some(gap_s)
    }

    fn is_longer(&self, missing_s: Option<f64>) -> bool {
        missing_s.zip(self.step_s).is_some_and(|(missing_s, step_s)| missing_s > HOLE * step_s)
    }

    /// A note if the odometry is missing at times. A log without any pose has none.
    pub(crate) fn note(&self) -> Option<String> {
        let at_end = self.scan_s.is_some_and(|scan_s| self.is_longer(self.missing_s(scan_s)));
        let count = self.count + usize::from(at_end);
        let places = if count == 1 { "place" } else { "places" };
        (count > 0).then(|| {
            format!(
                "the odometry is missing for more than {LONGEST_GAP_S} s while there are scans, in {count} {places}: the way \
                 there is that of the scans alone"
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::Range;

    /// The number of holes, and the note, of 60 s with a pose every 0.1 s and a scan every 0.2 s, but none in these times, s.
    fn holes(without_pose: &[Range<f64>], without_scan: &[Range<f64>]) -> (usize, Option<String>) {
        let (mut holes, mut found) = (Holes::default(), 0);
        for tenth in 0..600 {
            let time_s = 0.1 * f64::from(tenth);
            let misses = |ranges: &[Range<f64>]| ranges.iter().any(|range| range.contains(&time_s));
            if tenth % 2 == 0 && !misses(without_scan) {
                holes.add_scan(time_s);
            }
            if !misses(without_pose) {
                found += usize::from(holes.add_pose(time_s));
            }
        }
        (found, holes.note())
    }

    #[test]
    fn a_hole_has_scans() {
        assert_eq!(holes(&[], &[]), (0, None));
        assert_eq!(holes(&[20.05..21.5], &[]), (0, None));
        let (found, note) = holes(&[20.05..30.0], &[]);
        let expected = "the odometry is missing for more than 2 s while there are scans, in 1 place: the way there is that of the \
                        scans alone";
        assert_eq!((found, note.as_deref()), (1, Some(expected)));
        // A pause of the recording, after which scans come first.
        for pose_s in [29.95, 30.15, 31.0] {
            assert_eq!(holes(&[20.05..pose_s], &[20.05..29.95]), (0, None), "{pose_s}");
        }
    }

    #[test]
    fn the_odometry_can_be_missing_at_the_begin_and_at_the_end() {
        let places = |without: &[Range<f64>]| {
            let (found, note) = holes(without, &[]);
            (found, note.map(|note| note.split_once("in ").unwrap().1.split_once(':').unwrap().0.to_owned()))
        };
        assert_eq!(places(&[0.0..10.0]), (0, Some("1 place".to_owned())));
        assert_eq!(places(&[50.0..60.0]), (0, Some("1 place".to_owned())));
        assert_eq!(places(&[0.0..10.0, 20.0..30.0, 50.0..60.0]), (1, Some("3 places".to_owned())));
        assert_eq!(places(&[0.0..1.9, 58.5..60.0]), (0, None));
        // No pose at all is another note.
        assert_eq!(places(&[0.0..60.0]), (0, None));
    }

    #[test]
    fn a_pose_every_few_seconds_is_no_hole() {
        let mut holes = Holes::default();
        for second in 0..60 {
            holes.add_scan(f64::from(second));
            if second % 5 == 4 {
                assert!(!holes.add_pose(f64::from(second)));
            }
        }
        assert_eq!(holes.note(), None);
    }
}
