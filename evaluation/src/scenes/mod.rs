//! How the simulated worlds are displayed.

mod grid;
mod physics;

pub use physics::view;

use draw::scene::Scene;

/// The description of a world that can be displayed.
pub trait Displayed {
    /// The world at its start.
    fn scene(&self) -> Scene;
}
