//! A robot that drives around a block: a loop is closed, and the corrected map replaces the old one.

use super::*;
use interfaces::{heading_rad, wrap_rad};

/// The middle of the corridors, m: where they begin, and where they end.
const LOW_M: f64 = 8.3;
const HIGH_M: [f64; 2] = [LOW_M + 22.0, LOW_M + 14.0];
/// The distance from a corner at which the robot turns to the next one, m.
const CORNER_M: f64 = 0.8;
/// A blocked cell farther than this from every wall is wrong, m.
const WRONG_M: f64 = 0.15;

/// A trip around the block, and on along the first side, where the loop is closed.
#[derive(Default)]
struct Trip {
    said: Vec<String>,
    /// What must repeat: the map, and the transforms from the map to the odometry on the way.
    bits: (Vec<u8>, Vec<Option<Isometry2<f64>>>),
    /// The largest error of the position before the loop is closed, and afterwards, m.
    errors_m: [f64; 2],
    /// The share of the blocked cells that are wrong: shortly before the loop is closed, and at the end.
    wrong: [f64; 2],
}

fn trip(parameters: &Parameters, is_live: bool) -> Trip {
    let world = worldfile::physics::parse_world("block.toml", include_str!("block.toml")).unwrap();
    let mut pair = Pair::in_world(&world, parameters, 0, None);
    let corners = [[HIGH_M[0], LOW_M], HIGH_M, [LOW_M, HIGH_M[1]], [LOW_M, LOW_M]];
    let (mut to, mut trip) = (0, Trip::default());
    // The second way along the first side ends the trip.
    while to < 5 {
        let [truth, odometry] = pair.sim.poses().unwrap();
        let is_closed = pair.is_said("a loop was closed");
        if let Some(to_odom) = pair.node.published.map_to_odom {
            let found = world.driven().pose * to_odom * odometry;
            let error_m = (found.translation.vector - truth.translation.vector).norm();
            let largest_m = &mut trip.errors_m[usize::from(is_closed)];
            *largest_m = largest_m.max(error_m);
        }
        if !is_closed && trip.bits.1.len() % 20 == 0 {
            trip.wrong[0] = wrong(&pair, &world);
        }
        let way = Point2::from(corners[to % 4]).coords - truth.translation.vector;
        to += usize::from(way.norm() < CORNER_M);
        pair.steer(wrap_rad(way.y.atan2(way.x) - heading_rad(&truth)));
        pair.run(0.1);
        trip.bits.1.push(pair.node.published.map_to_odom);
        if is_live && !pair.node.robot.is_settled() {
            // About as fast as a robot, while a thread reads the readings again.
            std::thread::sleep(Duration::from_millis(20));
        }
    }
    trip.wrong[1] = wrong(&pair, &world);
    trip.bits.0 = pair.node.robot.mapper.snapshot();
    trip.said = pair.said.lock().unwrap().clone();
    trip
}

impl Pair {
    /// Drives to where the robot must turn by this. The robot rests at the start.
    fn steer(&mut self, off_rad: f64) {
        let x = if self.sim.time_s() > 2.0 { 0.5 * off_rad.cos().max(0.0) } else { 0.0 };
        self.drive(x, off_rad.clamp(-1.0, 1.0));
    }
}

/// The share of the blocked cells that are wrong.
fn wrong(pair: &Pair, world: &WorldSpec) -> f64 {
    let (states, start) = (pair.node.robot.mapper.states(), world.driven().pose);
    let is_wrong = |at: &Point2<f64>| {
        world.fleet().walls.iter().all(|wall| {
            let outside = wall.pose.inverse_transform_point(at).coords.abs() - wall.half_m;
            outside.map(|off_m| off_m.max(0.0)).norm() > WRONG_M
        })
    };
    let blocked = states.cells().iter().enumerate().filter(|(_, state)| **state == CellState::Blocked);
    let (wrong, right): (Vec<_>, Vec<_>) = blocked
        .map(|(index, _)| start * states.frame().center(states.frame().cell(index)))
        .partition(is_wrong);
    wrong.len() as f64 / (wrong.len() + right.len()).max(1) as f64
}

/// A loop is closed: the robot and its map were off before, and agree with the truth afterwards.
fn check(Trip { said, errors_m, wrong, .. }: &Trip) {
    assert!(said.iter().any(|text| text.contains("a loop was closed")), "{said:?}");
    assert!(errors_m[0] > 0.4 && errors_m[1] < 0.15, "{errors_m:?} m");
    assert!(wrong[0] > 0.15 && wrong[1] < 0.1, "{wrong:?}");
}

fn block() -> Parameters {
    Parameters { map_size_m: 50.0, ..parameters(Mode::Map) }
}

#[test]
fn with_a_simulated_clock_a_loop_is_closed_after_a_fixed_number_of_readings() {
    let simulated = Parameters { use_sim_time: true, ..block() };
    let first = trip(&simulated, false);
    check(&first);
    assert!(first.bits == trip(&simulated, true).bits, "the same readings give other bits");
}

#[test]
fn a_live_run_closes_a_loop() {
    check(&trip(&block(), true));
}
