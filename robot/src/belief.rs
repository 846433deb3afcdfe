use localizer::{Correction, PoseEstimate, PoseState};
use nalgebra::Isometry2;

/// What the robot believes about its pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Belief {
    /// The pose that the robot uses, in the frame of the map, m and rad.
    pub pose: Isometry2<f64>,
    /// The estimate with its uncertainty; `None` if the source says that its poses are exact.
    pub estimate: Option<PoseEstimate>,
    /// What the robot may do with this pose.
    pub permission: Permission,
    /// If a loop was closed with this reading: the map was learned again with better poses, and has other cells than its
    /// [transitions](mapper::Mapper::transitions) say.
    pub correction: Option<Correction>,
}

impl Belief {
    /// The belief of a robot whose source says that its poses are exact.
    pub fn exact(pose: Isometry2<f64>) -> Self {
        Self { pose, estimate: None, permission: Permission::Drive, correction: None }
    }

    /// How far the pose can be trusted.
    pub fn state(&self) -> PoseState {
        self.estimate.as_ref().map_or(PoseState::Tracking, |estimate| estimate.state)
    }

    /// Whether the reading may enter the map.
    pub fn is_certain(&self) -> bool {
        self.state() == PoseState::Tracking
    }
}

/// What a robot may do, as far as its pose is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Permission {
    /// Drive to goals.
    #[default]
    Drive,
    /// Stand: the first scans at a start without a map should all be made from one pose.
    Rest,
    /// Look around, first in place, then from elsewhere: the robot is lost.
    LookAround,
}
