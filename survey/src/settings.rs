use interfaces::{GridFrame, PoseMode, SettingsCheck, SettingsError};
use localizer::PlaceError;
use logs::LogError;
use mapper::{Mapper, MapperSettings, NoReturn, NoReturns, ReadingError, ScanFilter, ScanFilterSettings};
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

/// The error for logs from which no map can be made.
#[derive(Debug, thiserror::Error)]
pub enum SurveyError {
    /// A log cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The mapper refuses a reading.
    #[error(transparent)]
    Reading(#[from] ReadingError),
    /// A later log finds no place in the map of the first one.
    #[error(transparent)]
    Alignment(#[from] PlaceError),
    /// The callback has interrupted the first pass.
    #[error("the first pass was interrupted")]
    Interrupted,
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// No reading has a pose on a map.
    #[error("no reading has a certain pose from which the place has a size")]
    NoPlace,
    /// The outline of the place has too many cells, or more was seen of it than the memory of a map holds.
    #[error(
        "the place is too large for a map: {what}; larger cells (--resolution, at least {enough_m}) or shorter ranges (--max-range) \
         need less"
    )]
    TooLarge {
        /// How large it is, and what that exceeds.
        what: String,
        /// A side of the cells with which it is small enough, m.
        enough_m: f64,
    },
    /// The scans turn against the poses.
    #[error(
        "the beams look mirrored: in {against} turns the scans fit when they turn against the poses of the log, in {with} when \
         they turn with them; check the sign of the angles, whether the laser hangs upside down (tf), or the order of the ranges"
    )]
    Mirrored {
        /// The number of turns in which scans turn against the poses.
        against: usize,
        /// The number of turns in which they turn with the poses.
        with: usize,
    },
    /// The trajectory contains few scans.
    #[error(
        "{left_out} of {scans} scans have no certain pose: neither do they fit to each other, nor to the odometry; no map is \
         made of the rest; check the units (m, rad), the angles of the beams, and whether all is of one robot"
    )]
    MostLeftOut {
        /// The number of scans without a certain pose.
        left_out: usize,
        /// The number of scans.
        scans: usize,
    },
    /// The odometry does not move as the scans do.
    #[error(
        "the odometry moves otherwise than the scans: in {differing} of {steps} steps of 0.5 m or 0.5 rad (the scans move \
         {ratio:.2} times as far and turn {turn_ratio:.2} times as much); check the units (m, rad), and whether both are of one robot; a log without odometry is \
         mapped by its scans alone"
    )]
    OtherOdometry {
        /// The number of motions that differ.
        differing: usize,
        /// The number of motions that were compared.
        steps: usize,
        /// The median length of the motions by scans, per length by odometry.
        ratio: f64,
        /// The median angle of the turns by scans, per angle by odometry.
        turn_ratio: f64,
    },
}
