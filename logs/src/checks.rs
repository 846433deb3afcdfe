//! What cannot be true of a log, and what should be known of it: each check sees scans, poses or times as they come, and says
//! at the end why the log is impossible, or what to note.

mod codes;
mod doubts;
mod holes;
mod jumps;
mod looks;
mod pace;
mod standing;
pub(crate) mod times;

pub(crate) use doubts::{Doubts, OdometryTimes, typical};
pub(crate) use holes::{Holes, LONGEST_GAP_S};
pub(crate) use jumps::{Jumps, Speeds};
pub(crate) use looks::{Looks, TimedLooks};
pub(crate) use pace::Pace;
pub(crate) use standing::{MIN_MOTION_M, MIN_MOTION_RAD, Standing};
