use interfaces::{GridFrame, PoseMode, SettingsCheck, SettingsError};
use mapper::{Mapper, MapperSettings, NoReturn, NoReturns, ScanFilter, ScanFilterSettings};
use nalgebra::Point2;
use robot::{Settings, Source};

/// Settings of a survey.
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct SurveySettings {
    /// How the poses of the log are used. `localized`: the trajectory is found from scans and odometry.
    pub pose: PoseMode,
    /// The side of a cell, m.
    pub resolution_m: f64,
    /// What is removed from scans.
    pub filter: ScanFilterSettings,
    /// The settings of the mapper. The noise of ranges stands for the errors of ranges and poses together.
    pub mapper: MapperSettings,
}

impl SurveySettings {
    /// The default settings of a robot whose log says nothing of itself. Hours are those of UTC.
    pub fn of(pose: PoseMode) -> Self {
        let source = Source { pose, ..Source::default() };
        let Settings { filter, mut mapper, .. } = Settings::of(&source);
        (mapper.clocks, mapper.time_zone) = (true, Some("UTC".to_owned()));
        Self { pose, resolution_m: source.cell_m, filter, mapper }
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
