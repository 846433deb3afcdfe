use interfaces::{GridFrame, SettingsCheck, SettingsError};
use mapper::{Mapper, MapperSettings, NoReturn, NoReturns, ScanFilter, ScanFilterSettings};
use nalgebra::Point2;

/// How the poses of a log are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PoseMode {
    /// The poses of the log are exact, or the laser stands.
    Exact,
    /// The poses of the odometry, as they drift.
    Odometry,
    /// The trajectory is found from scans and odometry.
    Localized,
}

impl PoseMode {
    /// The name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Odometry => "odometry",
            Self::Localized => "localized",
        }
    }
}

/// Settings of a survey.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurveySettings {
    /// How the poses of the log are used.
    pub pose: PoseMode,
    /// The side of a cell, m.
    pub resolution_m: f64,
    /// What is removed from scans.
    pub filter: ScanFilterSettings,
    /// The settings of the mapper. The noise of ranges stands for the errors of ranges and poses together.
    pub mapper: MapperSettings,
}

/// The time for which something that passes can hide a cell without an interruption of its observation, s.
const HIDING_S: f64 = 8.0;
/// The errors of ranges and poses together before they are learned, m: of exact poses, and of others.
const EXACT_NOISE_M: f64 = 0.03;
const FOUND_NOISE_M: f64 = 0.06;

impl SurveySettings {
    /// The default settings for a use of poses. Poses that were found from scans have errors of some centimetres.
    pub fn of(pose: PoseMode) -> Self {
        let mut mapper = MapperSettings { max_gap: HIDING_S, ..MapperSettings::default() };
        mapper.steady.range_noise_std_m = EXACT_NOISE_M;
        let mut settings = Self { pose, resolution_m: 0.05, filter: ScanFilterSettings::default(), mapper };
        if pose != PoseMode::Exact {
            settings.set_noise(FOUND_NOISE_M);
        }
        settings
    }

    /// Sets the errors of ranges and poses together, m.
    pub fn set_noise(&mut self, noise_m: f64) {
        self.mapper.steady.range_noise_std_m = noise_m;
        if self.pose != PoseMode::Exact {
            self.filter = self.filter.clone().for_noise(noise_m);
        }
    }

    /// The filter of scans, in which beams without a return are free.
    pub fn scan_filter(&self) -> ScanFilter {
        ScanFilter::judged(&self.filter, NoReturns::new(NoReturn::Free))
    }

    /// Checks all settings.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "survey" };
        check.within("resolution_m", self.resolution_m, 0.005..=10.0, "from 0.005 to 10")?;
        self.filter.check()?;
        // A mapper checks its settings when it is built: one cell is enough.
        let cell = GridFrame::new(Point2::origin(), self.resolution_m, 1, 1);
        cell.map_or(Ok(()), |frame| Mapper::new(&self.mapper, frame).map(drop))
    }
}

impl Default for SurveySettings {
    fn default() -> Self {
        Self::of(PoseMode::Localized)
    }
}
