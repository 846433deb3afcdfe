use interfaces::{GridFrame, LaserReading, SettingsCheck, SettingsError};
use mapper::{Mapper, MapperSettings, NoReturn};
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
    /// Ranges beyond this one are not used, m: there the error of the heading is larger than a cell.
    pub max_range_m: f64,
    /// The smallest angle between a beam and the line to the next hit, rad. Below it, the hit is taken as a point
    /// between two surfaces, see [`remove_shadows`](crate::remove_shadows). 0 keeps every hit.
    pub min_shadow_angle_rad: f64,
    /// What beams without a return mean. What was learned from earlier logs does not depend on it: it is no part of what a
    /// state is compared by.
    #[serde(skip)]
    pub no_return: NoReturn,
    /// The settings of the mapper. The noise of ranges stands for the errors of ranges and poses together.
    pub mapper: MapperSettings,
}

/// The time for which something that passes can hide a cell without an interruption of its observation, s.
const HIDING_S: f64 = 8.0;

impl SurveySettings {
    /// The default settings for a use of poses. A real laser has points between surfaces; poses that were found from
    /// scans have errors of some centimetres.
    pub fn of(pose: PoseMode) -> Self {
        let mut mapper = MapperSettings { max_gap: HIDING_S, ..MapperSettings::default() };
        mapper.steady.range_noise_std_m = match pose {
            PoseMode::Exact => 0.03,
            PoseMode::Odometry | PoseMode::Localized => 0.06,
        };
        Self {
            pose,
            resolution_m: 0.05,
            max_range_m: 20.0,
            min_shadow_angle_rad: 10_f64.to_radians(),
            no_return: NoReturn::default(),
            mapper,
        }
    }

    /// Checks all settings.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "survey" };
        check.within("resolution_m", self.resolution_m, 0.005..=10.0, "from 0.005 to 10")?;
        check.within("max_range_m", self.max_range_m, 0.1..=1000.0, "from 0.1 to 1000")?;
        let angle = self.min_shadow_angle_rad;
        check.within("min_shadow_angle_rad", angle, 0.0..=1.5, "from 0 to 1.5")?;
        // A mapper checks its settings when it is built: one cell is enough.
        let cell = GridFrame::new(Point2::origin(), self.resolution_m, 1, 1);
        cell.map_or(Ok(()), |frame| Mapper::new(&self.mapper, frame).map(drop))
    }

    /// A reading without what must not enter a map: ranges that are too long, and points between surfaces.
    pub fn filtered(&self, mut reading: LaserReading) -> LaserReading {
        crate::remove_shadows(&mut reading.scan, self.min_shadow_angle_rad);
        let scan = &mut reading.scan;
        if scan.range_max_m > self.max_range_m {
            scan.range_max_m = self.max_range_m;
            let far = scan.ranges_m.iter_mut().filter(|range_m| f64::from(**range_m) > self.max_range_m);
            far.for_each(|range_m| *range_m = f32::INFINITY);
        }
        reading
    }
}

impl Default for SurveySettings {
    fn default() -> Self {
        Self::of(PoseMode::Localized)
    }
}
