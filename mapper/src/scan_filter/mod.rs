//! The scan filter: what must not enter a map is removed from a scan, before a pose is searched for it.

mod no_return;
mod veils;

pub use no_return::{NoReturn, NoReturnDistrust, NoReturnEvidence, NoReturns};

use interfaces::{LaserReading, Scan, SettingsCheck, SettingsError, Values, value};
use nalgebra::Isometry2;
use veils::Jumps;

/// A hit that far beside an edge, in units of the errors of ranges and poses together, is not used.
const EDGE_NOISES: f64 = 2.0;
/// Minimum share of veils among the jumps of a scanner that makes veils. Rays without width have hits between two surfaces
/// as well, on slivers: up to 0.154 of the jumps in the shipped worlds (yard). Real beams: at least 0.174 (freiburg-079, intel).
const MIN_VEILS: f64 = 0.16;
/// Veils of a scanner that makes veils, above that share: in a single view, slivers can be a quarter of the jumps. The shipped
/// worlds have at most 27 (cave); real beams reach 60 after 10 to 100 scans.
const MIN_EXCESS: f64 = 60.0;

/// Settings of a [`ScanFilter`].
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanFilterSettings {
    /// A beam with a longer range shows free space up to this range, m, and nothing behind: there the error of the heading is larger
    /// than a cell.
    pub max_range_m: f64,
    /// The range jumps between two hits whose line has a smaller angle to the beam than this, rad; the customary angle
    /// is that of the shadow filter of the ROS package `laser_filters`. 0: no jumps, every hit is kept.
    pub min_shadow_angle_rad: f64,
    /// Hits on the far side of a jump say nothing within this distance of the near edge across the beams, m: there an
    /// error of the pose decides which surface a beam meets, and a miss would clear the edge. 0 where poses are exact.
    pub edge_m: f64,
    /// What beams without a return mean. What was learned from earlier readings does not depend on it: it is no part of
    /// what a state is compared by.
    #[serde(skip)]
    pub no_return: NoReturn,
}

impl Default for ScanFilterSettings {
    fn default() -> Self {
        let (min_shadow_angle_rad, no_return) = (10_f64.to_radians(), NoReturn::default());
        Self { max_range_m: 20.0, min_shadow_angle_rad, edge_m: 0.0, no_return }
    }
}

impl ScanFilterSettings {
    /// The same for poses with errors: `noise_m` are those of ranges and poses together.
    #[must_use]
    pub fn for_noise(self, noise_m: f64) -> Self {
        Self { edge_m: EDGE_NOISES * noise_m, ..self }
    }

    /// Checks all settings.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "scan filter" };
        check.within("max_range_m", self.max_range_m, 0.1..=1000.0, "from 0.1 to 1000")?;
        check.within("edge_m", self.edge_m, 0.0..=1.0, "from 0 to 1")?;
        check.within("min_shadow_angle_rad", self.min_shadow_angle_rad, 0.0..=1.5, "from 0 to 1.5")
    }
}

/// Removes from the readings of a robot what must not enter a map: veils between two surfaces, hits beside edges, ranges
/// that are too long, and beams without a return of scanners that are not trusted.
#[derive(Clone, Debug)]
pub struct ScanFilter {
    settings: ScanFilterSettings,
    no_returns: NoReturns,
    learns: bool,
    /// The last reading as it was, until its pose is known.
    last: Option<LaserReading>,
    /// The number of veils and of jumps so far.
    veils: [u64; 2],
}

impl ScanFilter {
    /// A filter that knows nothing about any scanner.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &ScanFilterSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        let filter = Self::judged(settings, NoReturns::new(settings.no_return));
        Ok(Self { learns: settings.no_return == NoReturn::Learn, ..filter })
    }

    /// A filter that learns nothing more about beams without a return, with settings that were checked before.
    pub fn judged(settings: &ScanFilterSettings, no_returns: NoReturns) -> Self {
        Self { settings: settings.clone(), no_returns, learns: false, last: None, veils: [0; 2] }
    }

    /// What was learned about beams without a return.
    pub fn no_returns(&self) -> &NoReturns {
        &self.no_returns
    }

    /// The next reading, without what must not enter a map.
    pub fn filter(&mut self, mut reading: LaserReading) -> LaserReading {
        self.apply(&mut reading);
        reading
    }

    /// Removes from the next reading what must not enter a map.
    pub fn apply(&mut self, reading: &mut LaserReading) {
        let invalid = reading.scan.ranges_m.iter_mut().filter(|range_m| range_m.is_nan());
        invalid.for_each(|range_m| *range_m = f32::NAN); // a sensor does not say how far such a beam is free
        self.last = self.learns.then(|| reading.clone());
        self.no_returns.apply(reading); // before ranges that are too long become free ones
        if self.settings.min_shadow_angle_rad > 0.0 {
            self.remove_jumps(&mut reading.scan);
        }
        let (scan, max_range_m) = (&mut reading.scan, self.settings.max_range_m);
        if scan.range_max_m > max_range_m {
            scan.range_max_m = max_range_m;
            let far = scan.ranges_m.iter_mut().filter(|range_m| f64::from(**range_m) > max_range_m);
            far.for_each(|range_m| *range_m = f32::INFINITY);
        }
    }

    /// Removes veils and hits beside edges: of such a beam stays the free part up to the near surface.
    fn remove_jumps(&mut self, scan: &mut Scan) {
        let jumps = Jumps::new(scan, self.settings.min_shadow_angle_rad);
        let (mut removed, count) = jumps.veils();
        for (sum, count) in self.veils.iter_mut().zip([removed.len(), count]) {
            *sum = sum.saturating_add(count as u64);
        }
        if !self.makes_veils() {
            removed.clear();
        }
        if self.settings.edge_m > 0.0 {
            removed.extend(jumps.beside_edges(self.settings.edge_m));
        }
        // A pose can be wrong along the beam as well as across.
        let before_m = 2.0 * self.settings.edge_m;
        // Beside two edges, the nearer one counts.
        removed.sort_unstable_by(|a, b| b.1.total_cmp(&a.1));
        removed
            .into_iter()
            .for_each(|(beam, clear_m)| scan.ranges_m[beam] = Scan::free_to(clear_m - before_m));
    }

    /// Removes from a reading whose pose in the map is certain the beams without a return that pass a known surface.
    pub fn protect(&self, reading: &mut LaserReading) {
        self.no_returns.protect(reading);
    }

    /// Learns about beams without a return from the last reading, whose pose in the map is certain.
    pub fn learn(&mut self, pose: &Isometry2<f64>) {
        if let Some(reading) = self.last.take() {
            self.no_returns.learn(&LaserReading { pose: *pose, ..reading });
        }
    }

    /// Whether the scanner has made veils so far.
    fn makes_veils(&self) -> bool {
        let [veils, all] = self.veils;
        veils as f64 > MIN_VEILS * all as f64 + MIN_EXCESS
    }

    /// What readings have changed: what a state file holds of the filter.
    pub fn values(&mut self) -> Values<'_> {
        let mut values = self.no_returns.values();
        values.push(value(&mut self.veils));
        values
    }
}
