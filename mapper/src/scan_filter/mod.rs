//! The scan filter: what must not enter a map is removed from a scan, before a pose is searched for it.

mod no_return;
mod veils;

pub use no_return::{NoReturn, NoReturnEvidence, NoReturns};

use interfaces::{LaserReading, SettingsCheck, SettingsError, Values};
use nalgebra::Isometry2;

/// Settings of a [`ScanFilter`].
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScanFilterSettings {
    /// Ranges beyond this one are not used, m: there the error of the heading is larger than a cell.
    pub max_range_m: f64,
    /// The range jumps between two hits whose line has a smaller angle to the beam than this, rad. Hits within a jump
    /// are veils, and are removed. 0 keeps every hit.
    pub min_shadow_angle_rad: f64,
    /// What beams without a return mean. What was learned from earlier readings does not depend on it: it is no part of
    /// what a state is compared by.
    #[serde(skip)]
    pub no_return: NoReturn,
}

impl Default for ScanFilterSettings {
    fn default() -> Self {
        Self { max_range_m: 20.0, min_shadow_angle_rad: 10_f64.to_radians(), no_return: NoReturn::default() }
    }
}

impl ScanFilterSettings {
    /// Checks all settings.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "scan filter" };
        check.within("max_range_m", self.max_range_m, 0.1..=1000.0, "from 0.1 to 1000")?;
        check.within("min_shadow_angle_rad", self.min_shadow_angle_rad, 0.0..=1.5, "from 0 to 1.5")
    }

    /// A reading without veils and without ranges that are too long. Beams without a return are kept.
    pub fn filtered(&self, mut reading: LaserReading) -> LaserReading {
        self.apply(&mut reading);
        reading
    }

    fn apply(&self, reading: &mut LaserReading) {
        let scan = &mut reading.scan;
        veils::remove(scan, self.min_shadow_angle_rad);
        if scan.range_max_m > self.max_range_m {
            scan.range_max_m = self.max_range_m;
            let far = scan.ranges_m.iter_mut().filter(|range_m| f64::from(**range_m) > self.max_range_m);
            far.for_each(|range_m| *range_m = f32::INFINITY);
        }
    }
}

/// Removes from the readings of a robot what must not enter a map: veils between two surfaces, ranges that are too long,
/// and beams without a return of scanners that are not trusted.
#[derive(Clone, Debug)]
pub struct ScanFilter {
    settings: ScanFilterSettings,
    no_returns: NoReturns,
    learns: bool,
    /// The last reading as it was, until its pose is known.
    last: Option<LaserReading>,
}

impl ScanFilter {
    /// A filter that knows nothing about any scanner.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &ScanFilterSettings) -> Result<Self, SettingsError> {
        settings.check()?;
        let no_returns = NoReturns::new(settings.no_return);
        Ok(Self { settings: settings.clone(), no_returns, learns: true, last: None })
    }

    /// A filter that learns nothing more about beams without a return, with settings that were checked before.
    pub fn judged(settings: &ScanFilterSettings, no_returns: NoReturns) -> Self {
        Self { settings: settings.clone(), no_returns, learns: false, last: None }
    }

    /// What was learned about beams without a return.
    pub fn no_returns(&self) -> &NoReturns {
        &self.no_returns
    }

    /// Removes from the next reading what must not enter a map.
    pub fn apply(&mut self, reading: &mut LaserReading) {
        self.last = self.learns().then(|| reading.clone());
        self.no_returns.apply(reading); // before ranges that are too long become free ones
        self.settings.apply(reading);
    }

    /// Learns about beams without a return from the last reading, whose pose in the map is certain.
    pub fn learn(&mut self, pose: &Isometry2<f64>) {
        if let Some(reading) = self.last.take() {
            self.no_returns.learn(&LaserReading { pose: *pose, ..reading });
        }
    }

    /// What readings have changed: what a state file holds of the filter. Empty if it learns nothing.
    pub fn values(&mut self) -> Values<'_> {
        if self.learns() { self.no_returns.values() } else { Vec::new() }
    }

    fn learns(&self) -> bool {
        self.learns && self.settings.no_return == NoReturn::Learn
    }
}
