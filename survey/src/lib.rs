//! A survey of a place from the log of a robot: where the place changes, and how often.
//!
//! A log is read twice:
//!
//! ```text
//! first pass:   log ─▶ trajectory and extent of the place           [`FirstPass`] ─▶ [`Route`]
//! second pass:  log ─▶ localization ─▶ mapper ─▶ changes            [`Replay`], [`FoundPoses`], [`ChangeLog`]
//! ```
//!
//! The second pass is the loop of every robot, [`robot::explore`], with a source that ignores commands and a pilot that
//! gives none. From its map follow the [places](places()) where something changes, and the [map](permanent()) of what is
//! permanent.
//!
//! This crate knows logs, trajectories and maps. It must not know files, pictures or programs.

mod change_log;
mod extent;
mod first_pass;
mod masks;
mod permanent;
mod places;
mod replay;
mod settings;
mod shadows;
#[cfg(test)]
mod tests;

pub use change_log::ChangeLog;
pub use first_pass::{FirstPass, Route, SurveyError};
pub use masks::{keepout_mask, speed_mask};
pub use permanent::permanent;
pub use places::{Place, places};
pub use replay::{FoundPoses, Passenger, Replay};
pub use settings::{PoseMode, SurveySettings};
pub use shadows::remove_shadows;
