//! Every picture of the project: the canvas, its font and colors; the scene of a world, the layers of a map; pictures of a run,
//! and a moving picture. It must not know the simulator, its metrics, command lines, or how a run is made.
//!
//! It reads the state of a run and changes nothing: no result depends on it.

pub mod canvas;
#[cfg(test)]
#[path = "tests/fake_run.rs"]
mod fake_run;
mod film;
pub mod layers;
pub mod legend;
pub mod outline;
pub mod palette;
mod panel;
pub mod pen;
pub mod pictures;
mod plan;
pub mod scene;
mod trajectory;
pub mod view;

#[cfg(test)]
extern crate self as draw;

pub use film::Film;
