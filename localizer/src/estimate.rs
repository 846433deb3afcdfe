use interfaces::LaserReading;
use nalgebra::{Isometry2, Matrix3};

/// How far a pose can be trusted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PoseState {
    /// The pose is certain: the scan may enter the map.
    Tracking,
    /// The pose may be wrong by more than a map tolerates: the scan must not enter the map.
    #[default]
    Uncertain,
    /// The pose is not known. The reported pose is a guess.
    Lost,
}

/// A pose with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseEstimate {
    /// The pose of the robot in the frame of the map, m and rad.
    pub pose: Isometry2<f64>,
    /// The covariance of x, y (m²) and the heading (rad²), in the frame of the map.
    pub covariance: Matrix3<f64>,
    /// The share of the seen surface, by length, that lies on surfaces of the line map, among all that the map can
    /// confirm or contradict: from 0 to 1. A surface in a region that was never seen counts neither way.
    pub support: f64,
    /// How far the pose can be trusted.
    pub state: PoseState,
}

impl PoseEstimate {
    /// The standard deviation of the position in the direction in which it is largest, m.
    pub fn position_std_m(&self) -> f64 {
        let c = &self.covariance;
        let (half_sum, half_difference) = ((c[(0, 0)] + c[(1, 1)]) / 2.0, (c[(0, 0)] - c[(1, 1)]) / 2.0);
        (half_sum + (half_difference * half_difference + c[(0, 1)] * c[(0, 1)]).sqrt()).max(0.0).sqrt()
    }

    /// The standard deviation of the heading, rad.
    pub fn heading_std_rad(&self) -> f64 {
        self.covariance[(2, 2)].max(0.0).sqrt()
    }
}

/// The result of one reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Localized {
    /// The reading with the estimated pose, and with a scan whose beams all belong to this pose. Only a reading whose
    /// estimate is [`PoseState::Tracking`] may enter a map.
    pub reading: LaserReading,
    /// The pose of `reading`, with its uncertainty.
    pub estimate: PoseEstimate,
}

/// What is known about the pose at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// The pose of the first reading, m and rad. Without a map, it defines the frame of the map.
    At(Isometry2<f64>),
    /// Anywhere in the known map.
    Unknown,
}
