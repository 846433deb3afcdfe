//! Warnings about a world, a tour and a map that do not fit together: the run is possible, but not what a user
//! expects.

use interfaces::{Cell, CellState, Grid, GroundTruth, TrueState};
use nalgebra::Point2;
use sim::physics::{OdometryError, PhysicsWorld, WorldSpec};

/// A map with a smaller share of walls that stand in the world is probably of another place.
const MIN_AGREEMENT: f64 = 0.5;

/// What the odometry of the driven robot does to the map.
pub(crate) fn odometry(spec: &WorldSpec) -> Option<String> {
    let robot = spec.driven();
    (robot.odometry != OdometryError::default()).then(|| {
        format!(
            "warning: the odometry of `{}` drifts, and poses are taken as exact: this map will be wrong\n  = help: \
             without `[robot.odometry]` the poses are exact",
            robot.name
        )
    })
}

/// Which waypoints the robot cannot reach.
pub(crate) fn waypoints(spec: &WorldSpec, waypoints: &[Point2<f64>]) -> Option<String> {
    let world = PhysicsWorld::new(spec, 0);
    let truth = world.truth();
    let is_free = |at: &&Point2<f64>| {
        truth
            .frame()
            .index(truth.frame().cell_at(at))
            .is_some_and(|cell| truth.state(cell) == TrueState::Free)
    };
    let blocked = waypoints.iter().filter(|at| !is_free(at)).count();
    (blocked > 0).then(|| {
        let first = waypoints.iter().position(|at| !is_free(&at)).unwrap_or(0);
        format!(
            "warning: {blocked} of the {} waypoints of the tour are in walls or outside of the map of `{}`, the first \
             at {:?}\n  = help: the robot stops at the nearest point that it can reach",
            waypoints.len(),
            spec.name,
            <[f64; 2]>::from(waypoints[first].coords),
        )
    })
}

/// The difference between a known map and the world; an error if the map shows nothing of the world.
pub(crate) fn map(spec: &WorldSpec, map: &Grid<CellState>) -> Result<Option<String>, String> {
    let world = PhysicsWorld::new(spec, 0);
    let truth = world.truth();
    let frame = map.frame();
    // A wall may be drawn one cell beside its place.
    let stands_near = |index: usize| {
        let cell = frame.cell(index);
        let mut near = (-1..=1).flat_map(|x| (-1..=1).map(move |y| Cell::new(cell.x + x, cell.y + y)));
        near.any(|near| frame.index(near).is_some_and(|at| truth.state(at) != TrueState::Free))
    };
    let walls = (0..frame.len()).filter(|&index| map.cells()[index] == CellState::Blocked);
    let (walls, standing) = walls
        .fold((0, 0), |(walls, standing), index| (walls + 1, standing + usize::from(stands_near(index))));
    if map.cells().iter().all(|state| *state == CellState::Unknown) {
        return Err(format!(
            "the map shows nothing of the world `{}`: check `origin` and `resolution`",
            spec.name
        ));
    }
    let agreement = standing as f64 / f64::from(walls.max(1));
    Ok((walls > 0 && agreement < MIN_AGREEMENT).then(|| {
        format!(
            "warning: only {:.0} % of the walls of the map stand in the world `{}`: it looks like a map of another \
             place\n  = help: the robot takes the map as its knowledge, and unlearns it cell by cell",
            100.0 * agreement,
            spec.name
        )
    }))
}
