use super::{Body, Drive, DriveScene};
use crate::planner::{InflationSettings, Moves, Path};
use interfaces::Step;

/// The drive of a grid world: the robot is as large as its cell, and at each step it stays or moves to one of the
/// four cells that share a side. Cells are 1 m wide, and a step lasts 1 s.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellDrive;

impl Drive for CellDrive {
    type Command = Step;

    fn body(&self) -> Body {
        Body {
            radius_m: 0.0,
            inflation: InflationSettings { footprint_padding_m: 0.0, inflation_m: 0.0, inflation_cost: 1 },
            moves: Moves::Four,
            speed_mps: 1.0,
            tolerance_m: 0.4,
            step_m: 1.0,
            directions: 4,
            step_s: 1.0,
            step_limit_s: 1.0,
            goal_timeout_s: 1e5, // no path needs it
        }
    }

    fn follow(&mut self, scene: &DriveScene, path: &Path) -> Step {
        let frame = scene.costmap.frame();
        let here = frame.cell_at(&scene.input.position());
        let next = path.ahead().first().map(|next| frame.cell_at(next));
        // The robot waits for a cell that became blocked, until there is another path.
        let free = next.filter(|next| scene.costmap.is_traversable(*next));
        free.and_then(|next| Step::between(here, next)).unwrap_or(Step::Stay)
    }

    fn rest(&mut self, _: &DriveScene) -> Step {
        Step::Stay
    }

    fn recover(&mut self, _: &DriveScene, _: f64) -> Option<Step> {
        None
    }
}
