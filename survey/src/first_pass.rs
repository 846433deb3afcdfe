use crate::extent::{self, Reach};
use crate::settings::{PoseMode, SurveySettings};
use interfaces::{GridFrame, LaserReading, SettingsError};
use localizer::{PoseState, TrajectoryFinder, TrajectoryPose, TrajectorySettings};

/// The error for a log from which no map can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurveyError {
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The log has no reading, or its poses leave every map.
    #[error("no reading of the log has a pose on a map")]
    NoPlace,
}

/// What the first pass has found.
#[derive(Clone, Debug)]
pub struct Route {
    /// The cells of the place.
    pub frame: GridFrame,
    /// One pose per reading, in the frame of the map.
    pub poses: Vec<TrajectoryPose>,
    /// The number of places that were recognised; 0 where no trajectory was searched.
    pub loops: usize,
}

impl Route {
    /// The length of the trajectory, m.
    pub fn length_m(&self) -> f64 {
        let position = |at: &TrajectoryPose| at.pose.translation.vector;
        self.poses.windows(2).map(|pair| (position(&pair[1]) - position(&pair[0])).norm()).sum()
    }

    /// The number of readings whose scan does not support their pose.
    pub fn uncertain(&self) -> usize {
        self.poses.iter().filter(|pose| pose.state != PoseState::Tracking).count()
    }
}

/// The first pass over a log: the trajectory, and the extent of the place.
#[derive(Debug)]
pub struct FirstPass {
    settings: SurveySettings,
    /// Finds the trajectory; `None` where the poses of the log are used.
    finder: Option<TrajectoryFinder>,
    given: Vec<TrajectoryPose>,
    reaches: Vec<Reach>,
}

impl FirstPass {
    /// A pass without a reading.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn new(settings: &SurveySettings) -> Result<Self, SurveyError> {
        settings.check()?;
        let finder = match settings.pose {
            PoseMode::Localized => Some(TrajectoryFinder::new(&TrajectorySettings::default())?),
            PoseMode::Exact | PoseMode::Odometry => None,
        };
        Ok(Self { settings: settings.clone(), finder, given: Vec::new(), reaches: Vec::new() })
    }

    /// Adds the next reading.
    pub fn add(&mut self, reading: LaserReading) {
        self.reaches.push(Reach::of(&self.settings.filtered(reading.clone())));
        match &mut self.finder {
            Some(finder) => finder.add(reading),
            None => self.given.push(TrajectoryPose {
                time_s: reading.time_s,
                pose: reading.pose,
                state: PoseState::Tracking,
            }),
        }
    }

    /// The poses of all readings, and the cells that cover the place.
    ///
    /// # Errors
    ///
    /// When there was no reading.
    pub fn finish(self) -> Result<Route, SurveyError> {
        let (poses, loops) = match self.finder {
            Some(finder) => {
                let trajectory = finder.finish();
                (trajectory.poses, trajectory.loops)
            }
            None => (self.given, 0),
        };
        let used = poses.iter().zip(&self.reaches).filter(|(pose, _)| pose.state == PoseState::Tracking);
        let placed = used.map(|(pose, reach)| (&pose.pose, reach));
        let frame = extent::frame(placed, self.settings.resolution_m).ok_or(SurveyError::NoPlace)?;
        Ok(Route { frame, poses, loops })
    }
}
