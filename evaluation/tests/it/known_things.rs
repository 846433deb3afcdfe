//! Things that come and go while the robot is elsewhere: found as objects, also on thin legs, and scored per thing.

use agent::{Agent, Policy};
use controller::{Controller, DiffDrive};
use evaluation::known_things::{KnownThings, KnownThingsScores};
use evaluation::physics_trial::{self, PhysicsTrial};
use evaluation::scheduled_things::object_cell;
use mapper::Mapper;
use robot::Autonomous;
use sim::physics::{PhysicsWorld, WorldSpec};
use std::collections::BTreeMap;

/// Two rooms with an opening between them, a chair with four legs in the left one, a box and an L of two parts in the right one.
fn world() -> WorldSpec {
    let mut text = String::from(
        "name = \"chair and box\"\n[map]\nsize_m = [8.0, 4.0]\ncell_m = 0.05\n[[robot]]\nname = \"curious\"\nradius_m = 0.2\n\
         pose_m = [3.0, 3.0]\n[robot.drive]\nmax_linear_mps = 0.8\nmax_angular_degps = 150.0\nmax_linear_acceleration_mps2 = 1.5\n\
         max_angular_acceleration_degps2 = 600.0\n[robot.behavior]\nkind = \"driven\"\n[robot.laser]\nbeams = 360\nrange_max_m = 6.0\nrate_hz = 10.0\nnoise_std_m = 0.01\n",
    );
    let walls = [
        [0.0, 0.0, 8.0, 0.1],
        [0.0, 3.9, 8.0, 4.0],
        [0.0, 0.0, 0.1, 4.0],
        [7.9, 0.0, 8.0, 4.0],
        [3.9, 0.0, 4.0, 2.5],
    ];
    for [x, y, right, top] in walls {
        text += &format!("[[wall]]\nmin_m = [{x}, {y}]\nmax_m = [{right}, {top}]\n");
    }
    let mut obstacle = |name: &str, [x, y, width, height]: [f64; 4], rest: &str| {
        let [right, top] = [x + width, y + height];
        text += &format!(
            "[[obstacle]]\nname = \"{name}\"\nmin_m = [{x}, {y}]\nmax_m = [{right}, {top}]\n{rest}\n"
        );
    };
    obstacle("chair", [1.5, 1.0, 0.05, 0.05], "schedule = { free_s = 60.0, blocked_s = 90.0 }");
    for (leg, x, y) in [(2, 1.9, 1.0), (3, 1.5, 1.4), (4, 1.9, 1.4)] {
        obstacle(&format!("leg {leg}"), [x, y, 0.05, 0.05], "part_of = \"chair\"");
    }
    obstacle("box", [6.0, 1.0, 0.5, 0.5], "schedule = { free_s = 90.0, blocked_s = 60.0 }");
    obstacle("L", [5.4, 2.0, 1.1, 0.1], "schedule = { free_s = 70.0, blocked_s = 80.0 }");
    obstacle("side of the L", [5.4, 2.1, 0.1, 1.0], "part_of = \"L\"");
    worldfile::physics::parse_world_with("rooms.toml", &text, &BTreeMap::new()).unwrap()
}

type Trial = PhysicsTrial<Autonomous<Agent, Controller<DiffDrive>>>;

fn trial(minutes: f64) -> Trial {
    let spec = world();
    let settings = physics_trial::settings(&spec).unwrap();
    let pilot = settings.pilot(settings.agent(&Policy::default(), 1).unwrap(), 1).unwrap();
    let mut trial = PhysicsTrial::new(&spec, 1, &settings, None, pilot).unwrap();
    trial.run(60.0 * minutes).unwrap();
    trial
}

#[test]
fn a_chair_a_box_and_an_l_are_objects_with_scores() {
    let trial = trial(30.0);
    let mapper = &trial.robot.mapper;
    for thing in trial.world.spec().things() {
        let cells = &thing.places[0];
        let known = object_cell(mapper, cells).unwrap_or_else(|| panic!("the {} is no object", thing.name));
        let object = mapper.objects().find(|object| object.cells.contains(&(known as u32))).unwrap();
        let own = object.cells.iter().filter(|cell| cells.contains(&(**cell as usize))).count();
        assert!(own >= 3, "{own} of the {} cells of the {}", cells.len(), thing.name);
        // One cycle takes 150 s on average.
        assert!((8.0..72.0).contains(&object.cycles_per_hour), "{object:?}");
    }
    let scores = trial.results().known_things.unwrap();
    assert_eq!((scores.things, scores.objects, scores.all), (3, 3, scores.first_hour));
    for scores in [scores.all.now, scores.all.in_1min, scores.all.in_10min].map(Option::unwrap) {
        assert!(scores.last_seen_by_nominal > 1.0 && scores.brier < 0.4, "{scores:?}");
        // The posterior learns the rates, which the nominal chain knows.
        assert!(
            (0.8..1.5).contains(&scores.by_floor) && (0.8..2.0).contains(&scores.by_nominal),
            "{scores:?}"
        );
    }
    assert!(scores.log_error.iter().all(|error| error.unwrap() < 1.0), "{scores:?}");
}

#[test]
fn what_was_never_seen_has_no_scores() {
    let spec = world();
    let mapper = Mapper::new(&physics_trial::settings(&spec).unwrap().mapper, spec.frame).unwrap();
    let (mut world, mut things) = (PhysicsWorld::new(&spec, 1), KnownThings::default());
    world.rest_watched(600.0, 1.0, |world| things.sample(world, &mapper));
    assert_eq!(KnownThingsScores::of(&things.rows(&world, &mapper)), None);
}
