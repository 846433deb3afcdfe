//! What cannot be true of a log, and what should be known of it: each check sees scans, poses or times as they come, and says
//! at the end why the log is impossible, or what to note.

mod codes;
mod doubts;
mod holes;
mod jumps;
mod pace;
mod repeats;
mod standing;
pub(crate) mod times;

pub(crate) use codes::{Code, Codes};
pub(crate) use doubts::{Doubts, OdometryTimes, typical};
pub(crate) use holes::{Holes, LONGEST_GAP_S};
pub(crate) use jumps::{Jumps, Speeds};
pub(crate) use pace::Pace;
pub(crate) use repeats::{Repeats, without};
pub(crate) use standing::{MIN_MOTION_M, MIN_MOTION_RAD, Standing};
