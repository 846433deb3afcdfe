use super::*;
use crate::trials::{Experiment, GridRobot, TrialStrategy};
use interfaces::{Cell, Step, World};
use mapper::{EstimatorChoice, MapperSettings};
use nalgebra::Isometry2;
use sim::grid::{GenerateSettings, GridWorld};

/// Two rooms; a block moves in the right one.
const ROOMS: &str = r##"
name = "rooms"
sensor_radius = 4
map = """
#############
#R....#.....#
#.....#.....#
#...........#
#############
"""

[[block]]
name = "guard"
dwell = 3
course = "back-and-forth"
path = [[8, 3], [11, 3]]
"##;

/// The Manhattan distance in cells, through walls.
struct Straight;

impl Travel for Straight {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        let frame = mapper.frame();
        let from = frame.cell_at(&pose.translation.vector.into());
        let steps = |cell: Cell| (cell.x - from.x).abs() + (cell.y - from.y).abs();
        times.clear();
        times.extend((0..frame.len()).map(|index| f64::from(steps(frame.cell(index)))));
    }
}

/// The world, the mapper and the oracle after a number of steps of a robot that stays in its cell.
fn after(steps: usize) -> (GridWorld, Mapper, Oracle) {
    let spec = worldfile::grid::parse("rooms.toml", ROOMS).unwrap();
    let mut mapper = Mapper::new(&MapperSettings::default(), *spec.frame()).unwrap();
    let (mut world, mut oracle) = (GridWorld::new(&spec, 0), Oracle::in_grid(&spec));
    for _ in 0..steps {
        mapper.update(&world.sense()).unwrap();
        oracle.learn(world.truth());
        world.act(&Step::Stay);
    }
    (world, mapper, oracle)
}

fn next_goal(world: &mut GridWorld, mapper: &Mapper, oracle: &mut Oracle) -> (usize, Stay) {
    let pose = world.sense().pose;
    let visit = oracle.next_goal(&pose, mapper, &mut Straight).unwrap();
    let frame = mapper.frame();
    (frame.index(frame.cell_at(&visit.position)).unwrap(), visit.stay)
}

#[test]
fn it_goes_to_a_cell_with_changing_cells_in_view() {
    let (mut world, mapper, mut oracle) = after(60);
    assert!(mapper.changed().next().is_none(), "nothing of it is seen from the start");
    let (goal, stay) = next_goal(&mut world, &mapper, &mut oracle);
    let in_view = oracle.patches.in_view[goal].iter().filter(|&&cell| world.truth().is_swept(cell)).count();
    assert!(in_view >= 3, "{:?} {in_view}", mapper.frame().cell(goal));
    assert!(matches!(stay, Stay::Watch(steps) if steps > 1.0));
    assert!(oracle.reason().starts_with("oracle: "));
}

#[test]
fn it_waits_before_anything_has_moved() {
    let (mut world, mapper, mut oracle) = after(1);
    let start = mapper.frame().index(world.robot()).unwrap();
    assert_eq!(next_goal(&mut world, &mapper, &mut oracle), (start, Stay::Watch(1.0)));
    assert_eq!(oracle.reason(), "oracle: nothing expected");
}

#[test]
fn a_far_cell_is_worth_less() {
    let (_, mapper, oracle) = after(60);
    let mut times = vec![1.0; mapper.frame().len()];
    let first = oracle.best(&mapper, &times).unwrap();
    times[first.patch] = 1000.0;
    let second = oracle.best(&mapper, &times).unwrap();
    assert_ne!(first.patch, second.patch);
    times.fill(f64::INFINITY);
    assert!(oracle.best(&mapper, &times).is_none());
    times[first.patch] = 1000.0;
    let far = oracle.best(&mapper, &times).unwrap();
    assert!(far.patch == first.patch && far.stay >= first.stay, "a long journey is for a long stay");
}

#[test]
fn a_cell_where_nothing_is_learned_is_left() {
    let (mut world, mapper, mut oracle) = after(60);
    // The map stays the same after every goal.
    let mut goals: Vec<usize> = (0..30).map(|_| next_goal(&mut world, &mapper, &mut oracle).0).collect();
    goals.sort_unstable();
    goals.dedup();
    assert!(goals.len() >= 5, "{goals:?}");
}

#[test]
fn it_learns_faster_than_strategies_without_the_truth() {
    for seed in [1, 2] {
        let policy = |name: &str| TrialStrategy::Agent(name.parse().unwrap());
        let experiment = Experiment {
            worlds: vec![GridSpec::generate(&GenerateSettings::default(), seed)],
            estimators: vec![EstimatorChoice::default()],
            strategies: vec![TrialStrategy::Oracle, policy("recency"), policy("curious")],
            trials: 1,
            seed,
            length: 4000,
            robot: GridRobot::default(),
        };
        let trials = experiment.run(experiment.jobs(), &false.into(), |_| ()).unwrap();
        let errors = trials.iter().map(|trial| {
            trial.samples.iter().map(|sample| sample.log_error).filter(|error| error.is_finite()).sum::<f64>()
        });
        let errors: Vec<f64> = errors.collect();
        assert!(errors[0] < errors[1] && errors[0] < errors[2], "seed {seed}: {errors:?}");
    }
}

#[test]
fn in_a_physics_world_walls_hide_patches() {
    let text = include_str!("../../../worlds/four_rooms.toml");
    let spec = worldfile::physics::parse_world("four_rooms.toml", text).unwrap();
    let patches = patches::Patches::of_physics(&spec);
    assert_eq!((0..patches.len()).map(|patch| patches.cells[patch].len()).sum::<usize>(), spec.frame.len());
    let at = |x_m: f64, y_m: f64| {
        let cell = spec.frame.index(spec.frame.cell_at(&Point2::new(x_m, y_m))).unwrap();
        (0..patches.len()).find(|&patch| patches.cells[patch].contains(&cell)).unwrap()
    };
    // In the lower left room, and from there to the upper right one.
    let (from, same_room, far_room) = (at(2.0, 2.0), at(4.0, 4.0), at(10.0, 10.0));
    assert!(patches.in_view[from].contains(&same_room));
    assert!(!patches.in_view[from].contains(&far_room));
    let middle = spec.frame.cell(patches.middles[from]);
    assert!((spec.frame.center(middle) - Point2::new(2.0, 2.0)).norm() < 0.25);
}
