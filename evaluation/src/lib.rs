//! The quality of a robot: metrics over the ground truth of a simulated world, trials, and the scenes to draw. It must not know
//! the command line, recordings or screens.

pub mod known_things;
pub mod metrics;
pub mod observer;
pub mod physics_trial;
pub mod scenes;
pub mod scheduled_things;
pub mod summary;
pub mod trial_state;
pub mod trials;
