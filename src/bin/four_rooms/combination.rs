//! A world, a tour and a map that do not fit together: warnings where the run is possible, but not what a user
//! expects, and an error where it makes no sense.

use interfaces::{Cell, CellState, GroundTruth, PoseMode, TrueState};
use nalgebra::Point2;
use sim::physics::{PhysicsWorld, WorldSpec};
use worldfile::ros_map::RosMap;

/// A map with a smaller share of walls, or of free space, that is right in the world is probably of another place.
/// Robots that pass leave walls in a map that was learned for a short time.
const MIN_WALLS: f64 = 0.55;
const MIN_FREE: f64 = 0.95;

/// What the odometry of the driven robot does to the map, if nothing corrects it.
pub(crate) fn odometry(spec: &WorldSpec, pose: PoseMode) -> Option<String> {
    let robot = spec.driven();
    (pose == PoseMode::Odometry && !robot.odometry.is_exact()).then(|| {
        format!(
            "warning: the odometry of `{}` drifts, and `--pose odometry` takes its poses as exact: this map will be \
             wrong\n  = help: `--pose localized` corrects them",
            robot.name
        )
    })
}

/// Which waypoints the robot cannot reach.
pub(crate) fn waypoints(spec: &WorldSpec, waypoints: &[Point2<f64>]) -> Option<String> {
    let world = PhysicsWorld::new(spec, 0);
    let truth = world.truth();
    let frame = truth.frame();
    let is_free = |at: &Point2<f64>| {
        frame.index(frame.cell_at(at)).is_some_and(|cell| truth.state(cell) == TrueState::Free)
    };
    let blocked: Vec<&Point2<f64>> = waypoints.iter().filter(|at| !is_free(at)).collect();
    let first = blocked.first()?;
    Some(format!(
        "warning: {} of the {} waypoints of the tour are in walls or outside of the map of `{}`, the first at \
         {:?}\n  = help: the robot stops at the nearest point that it can reach",
        blocked.len(),
        waypoints.len(),
        spec.name,
        [first.x, first.y],
    ))
}

/// The difference between a known map and the world; an error if the map shows nothing of the world.
pub(crate) fn map(spec: &WorldSpec, map: &RosMap) -> Result<Option<String>, String> {
    let world = PhysicsWorld::new(spec, 0);
    let (truth, of_map) = (world.truth(), map.cells.frame());
    let frame = truth.frame();
    // A wall may be anywhere in its pixel, or drawn a cell beside its place.
    let reach = (of_map.resolution_m() / frame.resolution_m() / 2.0).ceil() as i32;
    let is_wall_near = |cell: Cell| {
        let mut near =
            (-reach..=reach).flat_map(|x| (-reach..=reach).map(move |y| Cell::new(cell.x + x, cell.y + y)));
        near.any(|near| frame.index(near).is_some_and(|at| truth.state(at) != TrueState::Free))
    };
    // The number of blocked and of free cells of the map, in the world or not, and how many of them are right.
    let (mut blocked, mut free, mut is_overlapping) = ([0_usize; 2], [0_usize; 2], false);
    for (index, state) in map.cells.cells().iter().enumerate() {
        let cell = frame.cell_at(&(map.origin * of_map.center(of_map.cell(index))));
        let place = frame.index(cell);
        is_overlapping |= place.is_some() && *state != CellState::Unknown;
        let (counts, is_right) = match state {
            CellState::Unknown => continue,
            CellState::Blocked => (&mut blocked, is_wall_near(cell)),
            CellState::Free => (&mut free, place.is_some_and(|at| truth.state(at) != TrueState::Blocked)),
        };
        counts[0] += 1;
        counts[1] += usize::from(is_right);
    }
    if !is_overlapping {
        return Err(format!(
            "the map shows nothing of the world `{}`: check `origin` and `resolution`",
            spec.name
        ));
    }
    let [walls, space] =
        [blocked, free].map(|[all, right]| if all > 0 { right as f64 / all as f64 } else { 1.0 });
    Ok((walls < MIN_WALLS || space < MIN_FREE).then(|| {
        format!(
            "warning: only {:.0} % of the walls and {:.0} % of the free space of the map agree with the world `{}`: it \
             looks like a map of another place\n  = help: the robot takes the map as its knowledge, and unlearns it cell \
             by cell",
            100.0 * walls,
            100.0 * space,
            spec.name
        )
    }))
}
