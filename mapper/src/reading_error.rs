use interfaces::{ScanError, is_valid_pose};
use nalgebra::Isometry2;

/// The error for a reading that the mapper refuses. The maps stay as they were.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadingError {
    /// The parameters of the scan are invalid.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// The time is NaN, or before the time of the last reading.
    #[error("a reading at {time} follows one at {last}: time must not go backwards")]
    Time {
        /// The time of the refused reading.
        time: f64,
        /// The time of the last accepted reading.
        last: f64,
    },
    /// A pose contains a number that is not finite, or its position is farther away than a million meters.
    #[error("the pose of the reading at {time} is not a place on the map's plane")]
    Pose {
        /// The time of the refused reading.
        time: f64,
    },
}

/// Refuses an invalid pose.
pub(crate) fn check_pose(pose: &Isometry2<f64>, time: f64) -> Result<(), ReadingError> {
    if is_valid_pose(pose) { Ok(()) } else { Err(ReadingError::Pose { time }) }
}
