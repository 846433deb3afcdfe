//! The noise of the ranges of a laser that stands, from the ranges themselves.

use interfaces::{LaserReading, Scan, median};
use nalgebra::Isometry2;

/// The number of scans that are kept, at most; at least half of it of a long log, spread over it.
const MAX_SCANS: usize = 512;
/// With fewer scans, nothing is said.
const MIN_SCANS: usize = 20;
/// The standard deviation of normal noise with a median absolute deviation of 1.
const STD_PER_MAD: f64 = 1.4826;
/// The noise is that of all beams but this share, which end on edges, glass or far away.
const NOISY_SHARE: f64 = 0.1;

/// Scans of one laser that stands, a few hundred of a log.
#[derive(Clone, Debug, Default)]
pub(crate) struct RangeNoise {
    /// The pose and the mount of the laser; `None` before the first scan.
    stands: Option<(Isometry2<f64>, Isometry2<f64>)>,
    has_moved: bool,
    scans: Vec<Vec<f32>>,
    /// How often every second scan was left out: one in 2^n scans is kept.
    halvings: u32,
    passed: usize,
}

impl RangeNoise {
    /// Adds the next reading. Scans of a second laser are left out.
    pub(crate) fn add(&mut self, reading: &LaserReading) {
        let (pose, mount) = self.stands.get_or_insert((reading.pose, reading.mount));
        self.has_moved |= reading.pose != *pose;
        let is_other = reading.mount != *mount
            || self.scans.first().is_some_and(|first| first.len() != reading.scan.ranges_m.len());
        if self.has_moved || is_other {
            return;
        }
        if self.passed.is_multiple_of(1 << self.halvings) {
            self.scans.push(valid(&reading.scan));
        }
        self.passed += 1;
        if self.scans.len() > MAX_SCANS {
            let mut is_kept = false;
            self.scans.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.halvings += 1;
        }
    }

    /// The standard deviation of the ranges, m: of each beam by the median absolute deviation, which things that pass do not
    /// change. `None` if the laser has moved, or if too few beams end on something at rest.
    pub(crate) fn std_m(&self) -> Option<f64> {
        let beams = self.scans.first().filter(|_| !self.has_moved)?.len();
        if self.scans.len() < MIN_SCANS {
            return None;
        }
        let mut stds_m: Vec<f64> = (0..beams).filter_map(|beam| self.beam_std_m(beam)).collect();
        stds_m.sort_by(f64::total_cmp);
        stds_m.get((stds_m.len() as f64 * (1.0 - NOISY_SHARE)) as usize).copied()
    }

    fn beam_std_m(&self, beam: usize) -> Option<f64> {
        let ranges =
            self.scans.iter().map(|scan| f64::from(scan[beam])).filter(|range_m| range_m.is_finite());
        let ranges: Vec<f64> = ranges.collect();
        if 2 * ranges.len() < self.scans.len() {
            return None;
        }
        let middle = median(ranges.iter().copied())?;
        Some(STD_PER_MAD * median(ranges.into_iter().map(|range_m| (range_m - middle).abs()))?)
    }
}

/// The ranges of the hits; infinity for the other beams.
fn valid(scan: &Scan) -> Vec<f32> {
    let is_hit =
        |range_m: f32| f64::from(range_m) >= scan.range_min_m && f64::from(range_m) < scan.range_max_m;
    scan.ranges_m.iter().map(|range_m| if is_hit(*range_m) { *range_m } else { f32::INFINITY }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};

    /// A reading of 100 beams at 2 m with noise; something is at 1 m for a ninth of the time.
    fn reading(number: usize, std_m: f64, noise: &mut RandomStream) -> LaserReading {
        let wall_m = if number.is_multiple_of(9) { 1.0 } else { 2.0 };
        let ranges_m = (0..100).map(|_| (wall_m + std_m * noise.normal()) as f32).collect();
        LaserReading {
            time_s: number as f64,
            scan: Scan { range_max_m: 10.0, ranges_m, ..Scan::default() },
            ..LaserReading::default()
        }
    }

    #[test]
    fn the_noise_is_that_of_the_ranges() {
        let mut stream = RandomStream::new(300, Purpose::LaserNoise(0));
        for std_m in [0.0, 0.01, 0.03] {
            let mut noise = RangeNoise::default();
            (0..3000).for_each(|number| noise.add(&reading(number, std_m, &mut stream)));
            assert!((MAX_SCANS / 2..=MAX_SCANS).contains(&noise.scans.len()), "{}", noise.scans.len());
            // The noisier beams of all, and things in front of them, are a little above it.
            let found_m = noise.std_m().unwrap();
            assert!(found_m >= std_m && found_m <= 1.4 * std_m, "{found_m} of {std_m}");
        }
    }

    #[test]
    fn a_laser_that_moves_or_sees_too_little_has_no_noise() {
        let mut stream = RandomStream::new(301, Purpose::LaserNoise(0));
        let mut noise = RangeNoise::default();
        (0..MIN_SCANS - 1).for_each(|number| noise.add(&reading(number, 0.01, &mut stream)));
        assert_eq!(noise.std_m(), None);
        (0..10).for_each(|number| noise.add(&reading(number, 0.01, &mut stream)));
        assert!(noise.std_m().is_some());
        let pose = interfaces::pose(0.1, 0.0, 0.0);
        noise.add(&LaserReading { pose, ..reading(0, 0.01, &mut stream) });
        assert_eq!(noise.std_m(), None);
        let mut open = RangeNoise::default();
        let nothing = reading(0, 0.0, &mut stream);
        let scan = Scan { ranges_m: vec![f32::INFINITY; 100], ..nothing.scan.clone() };
        (0..50).for_each(|_| open.add(&LaserReading { scan: scan.clone(), ..nothing.clone() }));
        assert_eq!(open.std_m(), None);
    }
}
