//! The legends of the pictures.

use crate::palette::{self, Rgb};
use crate::scene::Scene;
use crate::view::View;

/// How an entry of a legend is drawn.
#[derive(Clone, Copy)]
pub enum Mark {
    /// A filled square.
    Area(Rgb),
    /// A line.
    Line(Rgb),
    /// A cross.
    Cross(Rgb),
    /// A filled circle with a white rim.
    Dot(Rgb),
}

/// The entries of a legend.
pub type Legend = Vec<(Mark, String)>;

/// The entries whose condition holds.
pub fn entries<const N: usize>(entries: [(bool, Mark, &str); N]) -> Legend {
    entries.into_iter().filter(|entry| entry.0).map(|(_, mark, text)| (mark, text.to_owned())).collect()
}

/// The entries for what the map of the occupancy shows of the run.
pub fn of_run(scene: &Scene, view: &View) -> Legend {
    let has_plan = !view.strategies.is_empty() || view.goal.is_some();
    entries([
        (true, Mark::Dot(palette::CURIOUS), "curious robot"),
        (view.belief.is_some(), Mark::Line(palette::ESTIMATE), "where it believes to be"),
        (scene.has_robot(false), Mark::Dot(palette::OTHER_ROBOT), "other robot"),
        (scene.has_obstacle(false), Mark::Area(palette::MOVING), "what moves"),
        (has_plan, Mark::Dot(palette::GOAL), "goal"),
        (has_plan, Mark::Line(palette::PATH), "planned path"),
        (view.sight().is_some(), Mark::Area(palette::SENSOR_AREA), "field of view"),
        (true, Mark::Area(palette::FREE), "free"),
        (true, Mark::Area(palette::BLOCKED), "blocked"),
        (true, Mark::Area(palette::UNKNOWN), "never seen"),
    ])
}
