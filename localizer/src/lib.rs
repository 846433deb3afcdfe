//! Odometry + scan + line map → pose, with its uncertainty: the part between the source of readings and the mapper.
//! It reads the states and the rates of a map; it must not know worlds, simulators, goals, drives, recordings or files.
//!
//! ```text
//! reading ─▶ motion prior ─▶ deskew ─▶ match with the line map ─▶ pose ─▶ calibrate, deskew again ─▶ insert in the line map
//!                                             └─ low support: search, hypotheses ─┘
//! ```
//!
//! [`Localizer::localize`] (`localizer.rs`) does this for a reading; the common part is `LocalTrajectoryBuilder::add`. The table of
//! its states is in `localizer/state.rs`. A chosen number stands beside its formula, or, with several users, in `constants.rs`. The localizer never mistakes its own error
//! for a change of the place, because a scan enters a map only while the state of the estimate is [`PoseState::Tracking`];
//! all other time counts as not observed.
//!
//! - Scans are matched with a map of short straight surfaces (surfels), which are frozen after a fixed number of hits, by
//!   point-to-line Gauss-Newton with a prior from odometry: Censi (2008), Segal, Haehnel & Thrun (2009).
//! - Each point is weighted by the length of surface that it represents, and by its range noise normal to the surface: beams
//!   that graze a wall fix the heading best.
//! - Motion distortion: a scan that is measured while the robot moves is deskewed with the velocities of the odometry. Scan
//!   matching then estimates its start pose and its end pose together, and interpolates the beams in between
//!   (as Dellenbach et al. 2022, "CT-ICP", but with the start tied to the last estimate by its covariance).
//! - Where the scan does not support the pose, it is searched for: correlative matching in a window (Olson 2009) and
//!   in the whole map are one branch and bound over a pyramid of maxima (Hess, Kohler, Rapp & Andor 2016). Several
//!   poses that fit about as well are kept as hypotheses, and driving on decides.
//! - In a map that the robot makes itself, the true place may be missing, and something in the map always looks a little
//!   like it: a found pose is certain once enough scans from enough viewpoints agree with it.
//! - If much of the view shifts at once, two rigid motions are separated, and the odometry selects the one of the robot.
//!   Surfaces that moved are down-weighted from then on.
//! - Learned rates of change ([`ChangingMap`]) lower the weight of surfaces in a search; not in tracking.
//!
//! [`TrajectoryFinder`] finds the trajectory of a whole log: with submaps that move along with the robot, loops, and a pose
//! graph. [`RouteSearch`] finds the place of such a trajectory among the surfaces of another one ([`KnownPlace`]). [`LoopClosingLocalizer`] closes loops while the robot maps a place for the first time.

mod beams;
mod calibration;
mod changing_map;
mod coherent_motion;
mod constants;
mod deskew;
mod estimate;
mod faults;
mod first_map;
mod hypotheses;
mod local_trajectory_builder;
mod localizer;
mod loop_closing;
mod match_scene;
mod matcher;
mod motion;
mod placement;
mod scan_path;
mod scan_points;
mod score_grid;
mod search;
mod settings;
mod support;
mod surfel_map;
mod tracking;
mod trajectory;
mod verification;
mod work;

pub use changing_map::ChangingMap;
pub use deskew::GivenPoses;
pub use estimate::{Localized, PoseEstimate, PoseState, Start};
pub use localizer::Localizer;
pub use loop_closing::{Correction, LoopClosed, LoopClosingLocalizer, Switch};
pub use settings::LocalizerSettings;
pub use trajectory::{
    DistanceScale, KnownPlace, PlaceError, RouteSearch, Trajectory, TrajectoryFinder, TrajectoryPose,
};
