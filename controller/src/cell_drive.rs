use crate::{Body, Drive, InflationSettings, Moves, Path, PatienceSettings, Scene, Settings};
use interfaces::Step;

/// The robot of a grid world: as large as its cell, and each step it stays or moves to one of the
/// four cells that share a side. The cells are 1 m wide, and a step of time lasts 1 s.
#[derive(Clone, Copy, Debug, Default)]
pub struct CellDrive;

impl CellDrive {
    /// The settings for a controller of this drive: no inflation, and no goal given up for being far.
    pub fn settings() -> Settings {
        Settings {
            inflation: InflationSettings { margin_m: 0.0, comfort_m: 0.0, comfort_price: 1 },
            patience: PatienceSettings { goal_limit_s: 1e5, ..PatienceSettings::default() },
            ..Settings::default()
        }
    }
}

impl Drive for CellDrive {
    type Command = Step;

    fn body(&self) -> Body {
        Body {
            radius_m: 0.0,
            moves: Moves::Four,
            speed_mps: 1.0,
            tolerance_m: 0.4,
            stride_m: 1.0,
            directions: 4,
            step_s: 1.0,
            step_limit_s: 1.0,
        }
    }

    fn follow(&mut self, scene: &Scene, path: &Path) -> Step {
        let frame = scene.costmap.frame();
        let here = frame.cell_at(&scene.situation.position());
        let next = path.ahead().first().map(|next| frame.cell_at(next));
        // A cell that has just closed is waited for, until there is another path.
        let open = next.filter(|next| scene.costmap.is_open(*next));
        open.and_then(|next| Step::between(here, next)).unwrap_or(Step::Stay)
    }

    fn rest(&mut self, _: &Scene) -> Step {
        Step::Stay
    }

    fn recover(&mut self, _: &Scene, _: f64) -> Option<Step> {
        None
    }
}
