use interfaces::SettingsError;
use localizer::PlaceError;
use logs::LogError;
use mapper::ReadingError;

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
         {ratio:.2} times as far); check the units (m, rad), and whether both are of one robot; a log without odometry is \
         mapped by its scans alone"
    )]
    OtherOdometry {
        /// The number of motions that differ.
        differing: usize,
        /// The number of motions that were compared.
        steps: usize,
        /// The median length of the motions by scans, per length by odometry.
        ratio: f64,
    },
}
