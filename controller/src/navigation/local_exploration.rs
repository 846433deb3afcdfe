use crate::drives::Body;
use crate::planner::Costmap;
use interfaces::RandomStream;
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use std::f64::consts::TAU;

/// The maximum number of consecutive random steps: in the paper fewer than 2.
const MAX_RANDOM_STEPS: u32 = 1;

/// Local exploration (paper, section 2): each step goes toward the centroid of the last change, or in a random
/// direction if nothing changed. Counts the steps.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct LocalExploration {
    steps: u32,
    random_steps_in_a_row: u32,
}

impl LocalExploration {
    /// The target of the next step; `None` after `max_steps` steps. `change` is the centroid of the last
    /// change, `random` the target of a random step.
    pub(crate) fn next(
        &mut self,
        max_steps: u32,
        change: Option<Point2<f64>>,
        random: impl FnOnce() -> Point2<f64>,
    ) -> Option<Point2<f64>> {
        if self.steps >= max_steps {
            return None;
        }
        let target = match change {
            Some(change) => {
                self.random_steps_in_a_row = 0;
                change
            }
            None if self.random_steps_in_a_row >= MAX_RANDOM_STEPS => return None,
            None => {
                self.random_steps_in_a_row += 1;
                random()
            }
        };
        self.steps += 1;
        Some(target)
    }
}

/// The point one step away in a random traversable direction; `here` if there is none. Always draws one random
/// number.
pub(crate) fn random_step(
    body: &Body,
    costmap: &Costmap,
    here: &Point2<f64>,
    rng: &mut RandomStream,
) -> Point2<f64> {
    let cell = |point: &Point2<f64>| costmap.frame().cell_at(point);
    let step = |direction: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(direction) / f64::from(body.directions));
        here + Vector2::new(cos, sin) * body.step_m
    };
    let is_traversable = |target: &Point2<f64>| costmap.line_cost(cell(here), cell(target)).is_some();
    let targets: Vec<_> = (0..body.directions).map(step).filter(is_traversable).collect();
    let draw: u32 = rng.random_range(0..body.directions.max(1));
    // The first traversable direction from a random one on would favor those after a gap.
    let index = u64::from(draw) * targets.len() as u64 / u64::from(body.directions.max(1));
    targets.get(index as usize).copied().unwrap_or(*here)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{costmap, find};
    use crate::{CellDrive, Drive};
    use interfaces::Purpose;

    const HERE: Point2<f64> = Point2::new(1.0, 1.0);
    const CHANGE: Option<Point2<f64>> = Some(Point2::new(5.0, 5.0));

    #[test]
    fn it_makes_fewer_than_two_random_steps_in_a_row() {
        let mut exploration = LocalExploration::default();
        assert_eq!(exploration.next(42, None, || HERE), Some(HERE));
        assert_eq!(exploration.next(42, CHANGE, || HERE), CHANGE);
        assert_eq!(exploration.next(42, None, || HERE), Some(HERE));
        assert_eq!(exploration.next(42, None, || HERE), None);
    }

    #[test]
    fn random_steps_lead_to_every_open_side_and_no_other() {
        let rows = ["....", "#R..", ".#.."];
        let map = costmap(&rows);
        let body = CellDrive.body();
        let robot = find(&rows, 'R');
        let here = map.frame().center(robot);
        let mut rng = RandomStream::new(1, Purpose::Controller);
        let mut steps: Vec<_> =
            (0..100).map(|_| map.frame().cell_at(&random_step(&body, &map, &here, &mut rng))).collect();
        steps.sort();
        steps.dedup();
        let [right, up, ..] = robot.neighbours4();
        assert_eq!(steps, [up, right]);
        let walls = costmap(&["###", "#R#", "###"]);
        let inside = Point2::new(1.5, 1.5);
        assert_eq!(random_step(&body, &walls, &inside, &mut rng), inside);
    }
}
