//! A survey of a place from the logs of a robot: where the place changes, and how often.
//!
//! A log is read twice:
//!
//! ```text
//! first pass:   log ─▶ trajectory and reach                  [`FirstPass`] ─▶ [`Route`]
//!               later log ─▶ its place in the first one      [`KnownPlace`], [`Search`]
//! second pass:  log ─▶ found poses ─▶ mapper ─▶ changes      [`Replay`], [`FoundPoses`], [`ChangeLog`]
//! ```
//!
//! [`Survey`] does both, log after log; it can be saved, and go on with another log later. [`routes()`] is the first pass over
//! all logs alone, and [`learn()`] the second pass over one. The second pass is the loop of every robot, [`robot::explore`],
//! with a source that ignores commands and a pilot that gives none. From its map follow the [places](places()) where
//! something changes, and the [map](permanent()) of what is permanent.
//!
//! This crate knows logs, trajectories and maps. It must not know files, pictures or programs.

mod change_log;
mod error;
mod extent;
mod known_place;
mod masks;
mod median;
mod noise;
mod odometry_check;
mod passes;
mod permanent;
mod places;
mod range_noise;
mod repeated;
mod replay;
mod route;
mod search;
mod settings;
mod shadows;
mod survey;
mod surveyed_log;
#[cfg(test)]
mod tests;
mod turns;

pub use change_log::ChangeLog;
pub use error::SurveyError;
pub use known_place::KnownPlace;
pub use masks::{CHANGE_HORIZON_S, keepout_mask, speed_mask};
pub use passes::{PassError, RoutePass, RouteProgress, Stage, learn, routes};
pub use permanent::permanent;
pub use places::{Place, PlaceRates, places};
pub use replay::{FoundPoses, NoPilot, Replay};
pub use route::{FirstPass, Route, frame, length_m, uncertain};
pub use search::Search;
pub use settings::{PoseMode, SurveySettings};
pub use shadows::remove_shadows;
pub use survey::{SavedLogs, Survey};
pub use surveyed_log::{LogEntry, SurveyedLog, Travelled};
