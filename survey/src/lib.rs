//! A survey of a place from the logs of a robot: where the place changes, and how often. It must not know
//! files, pictures or programs.
//!
//! A log is read twice:
//!
//! ```text
//! first pass:   log ─▶ trajectory and reach                  [`FirstPass`] ─▶ [`Route`]
//!               later log ─▶ its pose in the first one       [`localizer::KnownPlace`], [`localizer::RouteSearch`]
//! second pass:  log ─▶ robot at the found poses ─▶ changes    [`Replay`], [`FoundPoses`], [`ChangeLog`]
//! ```
//!
//! [`Survey`] does both, log after log; it can be saved, and go on with another log later. In the second pass, a robot without a
//! pilot reads the log: each reading is one [`robot::Robot::step`]. From its map follow the [places](Survey::places) where something
//! changes, and the [map](permanent()) of what is permanent.

mod change_log;
mod extent;
mod forecast;
mod masks;
mod outlook;
mod passes;
mod places;
mod quality;
mod range_noise;
mod repeated;
mod route;
mod route_graph;
mod settings;
mod survey;
mod surveyed_log;
#[cfg(test)]
mod tests;
mod upright;

pub use change_log::ChangeLog;
pub use forecast::{Forecast, NEAR_M};
pub use masks::{MASKS, masks, masks_ahead, permanent};
pub use outlook::{Obstacle, Outlook, Stop};
pub use passes::{FoundPoses, Replay, Stage};
pub use places::{
    Lasting, Place, PlaceKind, PlaceName, PlaceRates, PlaceSince, Since, StillName, Trend, is_line,
};
pub use quality::{Doubt, DoubtKind, Quality, Verdict};
pub use route::{FirstPass, Route};
pub use route_graph::{EdgeOutlook, RouteGraph, RouteGraphError, Travel};
pub use settings::{SurveyError, SurveySettings};
pub use survey::{Survey, saved_logs, saved_settings};
pub use surveyed_log::{LogEntry, SurveyedLog, Travelled};
pub use upright::upright_rad;
