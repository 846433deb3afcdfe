//! Random worlds: no body leaves its place, whatever its surroundings.

use super::*;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::collections::BTreeMap;
use std::fmt::Write;

/// The number of worlds, small enough for a run of all tests; SIM_RANDOM_WORLDS=1000 sets another number.
const WORLDS: u64 = 100;
const SECONDS: f64 = 60.0;
const SIDE_M: f64 = 6.0;

pub(super) struct Chance(ChaCha8Rng);

impl Chance {
    pub(super) fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    fn point(&mut self) -> [f64; 2] {
        [(); 2].map(|()| self.between(0.3, SIDE_M - 0.3))
    }
}

/// A closed room with walls at all angles, and robots of all sizes with every kind of drive. Parts that do not fit
/// are left out.
pub(super) fn world(seed: u64) -> FleetSpec {
    let mut chance = Chance::new(seed);
    let mut text = format!("name = \"random\"\n[map]\nsize_m = [{SIDE_M:?}, {SIDE_M:?}]\ncell_m = 0.1\n");
    let corners = [[0.0, 0.0], [SIDE_M, 0.0], [SIDE_M, SIDE_M], [0.0, SIDE_M]];
    for side in 0..4 {
        // Thin walls, within the map.
        let [a, b] = [corners[side], corners[(side + 1) % 4]]
            .map(|corner| corner.map(|c| c.clamp(0.03, SIDE_M - 0.03)));
        let _ = write!(text, "[[wall]]\nfrom_m = {a:?}\nto_m = {b:?}\nthickness_m = 0.05\n");
    }
    text += &format!("[physics]\nstep_s = {:?}\n", [0.02, 0.05, 0.1][seed as usize % 3]);
    let part = |thing: usize| {
        let at = chance.point();
        if thing < 5 {
            let to = chance.point();
            format!(
                "[[wall]]\nfrom_m = {at:?}\nto_m = {to:?}\nthickness_m = {:?}\n",
                chance.between(0.01, 0.2)
            )
        } else if thing >= 14 {
            self::thing(thing, at, &mut chance)
        } else {
            let radius_m = chance.between(0.05, 0.3);
            let kinds = ["driven\"", "wander\"\nspeed_mps = 0.3", "standing\""];
            // At most the speed that is allowed at the longest step, for a circle within a footprint.
            let fastest_mps = chance.between(0.2, (radius_m / 0.2).clamp(0.25, 2.0));
            // Every drive, and every third robot is not round.
            let drive =
                ["diff\"", "omni\"\nmax_left_mps = 0.4", "car\"\nwheelbase_m = 0.3"][seed as usize % 3];
            let drive = if thing % 3 == 1 { "diff\"" } else { drive };
            let [a, b, c] = [1.5, 1.0, 2.0].map(|factor| factor * radius_m);
            let outline = match thing % 3 {
                2 => format!("footprint_m = [[-{a:?}, -{b:?}], [{c:?}, 0.0], [-{a:?}, {b:?}]]"),
                _ => format!("radius_m = {radius_m:?}"),
            };
            format!(
                "[[robot]]\nname = \"{thing}\"\n{outline}\nmass_kg = {:?}\npose_m = {at:?}\nheading_deg = {:?}\n\
                 [robot.drive]\nkind = \"{drive}\nmax_linear_mps = {fastest_mps:?}\nmax_angular_degps = {:?}\n\
                 max_linear_acceleration_mps2 = {:?}\nmax_angular_acceleration_degps2 = {:?}\n\
                 [robot.laser]\nbeams = 24\nrange_max_m = 5.0\nrate_hz = 10.0\n[robot.behavior]\nkind = \"{}\n",
                chance.between(0.1, 20.0),
                chance.between(0.0, 360.0),
                chance.between(10.0, 400.0),
                chance.between(0.5, 50.0),
                chance.between(90.0, 5000.0),
                kinds[thing % 3],
            )
        }
    };
    of_what_fits(text, (0..26).map(part))
}

/// A world with those of further parts that fit.
pub(super) fn of_what_fits(mut text: String, parts: impl IntoIterator<Item = String>) -> FleetSpec {
    let mut spec = parse_fleet(&text);
    for part in parts {
        if let Ok(fits) = worldfile::physics::parse_fleet("test.toml", &format!("{text}{part}")) {
            (spec, text) = (fits, text + &part);
        }
    }
    spec
}

/// An obstacle that moves.
fn thing(thing: usize, at: [f64; 2], chance: &mut Chance) -> String {
    let name = format!("[[obstacle]]\nname = \"{thing}\"\n");
    let to = chance.point();
    let size = [(); 2].map(|()| chance.between(0.1, 0.6));
    match thing % 4 {
        0 | 1 => format!(
            "{name}kind = \"box\"\ncenter_m = {at:?}\nsize_m = {size:?}\nheading_deg = {:?}\nmass_kg = {:?}\nfriction = {:?}\n",
            chance.between(0.0, 90.0),
            chance.between(0.02, 2.0),
            chance.between(-0.2, 0.5).max(0.0),
        ),
        2 => format!(
            "{name}kind = \"block\"\nsize_m = {size:?}\npath_m = [{at:?}, {to:?}]\nspeed_mps = {:?}\ndwell_s = {:?}\n",
            chance.between(0.1, 1.0),
            chance.between(0.0, 3.0),
        ),
        _ => format!(
            "{name}kind = \"{}\"\nfrom_m = {at:?}\nto_m = [{:?}, {:?}]\nthickness_m = 0.04\nopening = \"random\"\nclosed_s = 2.0\nopen_s = 2.0\nmove_s = 1.6\n",
            if thing == 15 { "hinged_door" } else { "sliding_door" },
            at[0] + chance.between(0.1, 0.6),
            at[1] + chance.between(0.1, 0.6),
        ),
    }
}

/// A number that the environment can set.
pub(super) fn number<T: std::str::FromStr>(variable: &str, default: T) -> T {
    std::env::var(variable).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// The seeds of worlds, with each model of contacts.
pub(super) fn runs(worlds: u64) -> impl Iterator<Item = (ContactModel, u64)> {
    let rigid = (0..worlds).map(|seed| (ContactModel::RigidBodies, seed));
    rigid.chain((0..worlds / 2).map(|seed| (ContactModel::Sliding, seed)))
}

/// How deep a segment of a robot's way lies in a wall: it passed through if its middle did.
pub(super) fn passes(fleet: &Fleet, from: &Point2<f64>, to: &Point2<f64>) -> bool {
    fleet.spec().walls.iter().any(|wall| wall.segment_distance_m(from, to) <= 0.0)
}

/// The maximum depth by which the bodies of two kinds penetrated each other, m, and where.
#[derive(Debug, Default)]
pub(super) struct Deepest(BTreeMap<(&'static str, &'static str), (f64, String)>);

impl Deepest {
    pub(super) fn note(&mut self, fleet: &Fleet, seed: u64) {
        let mut note = |a: &'static str, b: &'static str, gap_m: f64| {
            let entry = self.0.entry((a, b)).or_default();
            if -gap_m > entry.0 {
                *entry = (-gap_m, format!("world {seed} at {:.2} s", fleet.time_s()));
            }
        };
        let walls: Vec<[Point2<f64>; 4]> = fleet.spec().walls.iter().map(Rectangle::corners).collect();
        let kind = |obstacle: &ObstacleView<'_>| match fleet.spec().obstacles[obstacle.index].motion {
            Motion::Pushed(_) => "box",
            _ => "mover",
        };
        let robots = fleet.robots().zip(&fleet.spec().robots);
        let robots: Vec<(&str, Form)> = robots
            .map(|(robot, spec)| {
                let name = if robot.corners.is_empty() { "round" } else { "pointed" };
                (name, spec.form(&robot.pose))
            })
            .collect();
        for (index, (name, form)) in robots.iter().enumerate() {
            walls.iter().for_each(|wall| note(name, "wall", form.gap_m(wall)));
            fleet.obstacles().for_each(|thing| note(name, kind(&thing), form.gap_m(&thing.corners)));
            robots[..index].iter().for_each(|(_, other)| note(name, "robot", form.apart_m(other)));
        }
        for pushed in fleet.obstacles().filter(|thing| kind(thing) == "box") {
            walls.iter().for_each(|wall| note("box", "wall", convex::gap_m(&pushed.corners, wall)));
            let others = fleet.obstacles().filter(|other| other.index != pushed.index);
            others
                .for_each(|other| note("box", kind(&other), convex::gap_m(&pushed.corners, &other.corners)));
        }
    }

    /// Half a centimeter, and what rounding adds, whatever meets whatever at whatever speed.
    pub(super) fn check(&self) {
        for ((a, b), (depth_m, place)) in &self.0 {
            assert!(*depth_m < 0.0051, "{a} is {depth_m} m deep in {b}: {place}");
        }
    }
}

/// No obstacle left the world, and nothing that can be pushed passed a wall. Returns the number of those that moved since `stood`.
fn check_obstacles(
    spec: &FleetSpec,
    fleet: &Fleet,
    seed: u64,
    stood: Vec<(usize, [Point2<f64>; 4])>,
) -> usize {
    let mut things = 0;
    let now = fleet.obstacles().map(|obstacle| (obstacle.index, obstacle.corners));
    for ((index, before), (_, after)) in stood.into_iter().zip(now).filter(|(before, now)| before != now) {
        let spec = &spec.obstacles[index];
        let place = || format!("obstacle {} of world {seed} at {:.2} s", spec.name, fleet.time_s());
        let [from, to] = [before, after].map(|corners| nalgebra::center(&corners[0], &corners[2]));
        assert!(to.coords.iter().all(|value| value.is_finite()), "{}", place());
        if let Motion::Pushed(_) = spec.motion {
            assert!(to.coords.min() > 0.0 && to.coords.max() < SIDE_M, "{} left: {to}", place());
            assert!(!passes(fleet, &from, &to), "{} passed a wall: {from} to {to}", place());
        }
        things += 1;
    }
    things
}

/// No robot left the world, passed a wall, or broke the limits of its drive. `before`: the velocities in the last step.
fn check_robots(spec: &FleetSpec, fleet: &Fleet, seed: u64, from: &[Point2<f64>], before: &mut [Twist]) {
    for (index, (robot, from)) in fleet.robots().zip(from).enumerate() {
        let place = || format!("robot {index} of world {seed} at {:.2} s", fleet.time_s());
        let at = Point2::from(robot.pose.translation.vector);
        assert!(at.coords.iter().all(|value| value.is_finite()), "{}", place());
        assert!(at.coords.min() > 0.0 && at.coords.max() < SIDE_M, "{} left: {at}", place());
        assert!(!passes(fleet, from, &at), "{} passed a wall: {from} to {at}", place());
        // The limits hold, and the acceleration is limited where nothing pushes the robot.
        let (limits, now) = (spec.robots[index].drive, robot.twist);
        assert!(now.linear_mps.abs() <= limits.max_linear_mps + 1e-3, "{}: {now:?}", place());
        assert!(now.angular_radps.abs() <= limits.max_angular_radps + 1e-3, "{}: {now:?}", place());
        let gain_mps = limits.max_linear_acceleration_mps2 * spec.step_s;
        let faster_mps = now.linear_mps.abs() - before[index].linear_mps.abs();
        assert!(robot.is_stalled || faster_mps <= gain_mps + 1e-3, "{}: {faster_mps} m/s faster", place());
        before[index] = now;
    }
}

#[test]
fn in_random_worlds_nobody_leaves_enters_or_passes_a_wall() {
    let worlds = number("SIM_RANDOM_WORLDS", WORLDS);
    let (mut robots, mut contacts, mut things) = (0, 0, 0);
    let mut deepest = Deepest::default();
    for (model, seed) in runs(worlds) {
        let mut spec = FleetSpec { contacts: model, ..world(seed) };
        if model == ContactModel::Sliding && seed % 2 == 0 {
            // A box that glides keeps rapier at work.
            spec.obstacles.retain(|obstacle| !matches!(obstacle.motion, Motion::Pushed(_)));
        }
        let mut fleet = Fleet::new(&spec, seed);
        robots += spec.robots.len();
        let mut chance = Chance::new(!seed);
        // Commands without regard to obstacles: full speed in any direction, sometimes another direction.
        let mut wanted = vec![Twist::STOP; spec.robots.len()];
        let mut before: Vec<Twist> = wanted.clone();
        while fleet.time_s() < SECONDS {
            let from: Vec<Point2<f64>> =
                fleet.robots().map(|robot| robot.pose.translation.vector.into()).collect();
            let stood: Vec<(usize, [Point2<f64>; 4])> =
                fleet.obstacles().map(|obstacle| (obstacle.index, obstacle.corners)).collect();
            fleet.step(&mut |robot: &RobotView<'_>, _: &LaserReading| {
                if chance.between(0.0, 1.0) < 0.1 {
                    let [linear_mps, angular_radps] = [5.0, 8.0].map(|most| chance.between(-most, most));
                    wanted[robot.index] = Twist { linear_mps, angular_radps };
                }
                wanted[robot.index]
            });
            contacts += fleet.contacts().len();
            things += check_obstacles(&spec, &fleet, seed, stood);
            check_robots(&spec, &fleet, seed, &from, &mut before);
            deepest.note(&fleet, seed);
        }
    }
    deepest.check();
    assert!(robots > 4 * worlds as usize, "too few robots fitted in: {robots}");
    assert!(things > 1000 * worlds as usize, "too few things moved: {things}");
    assert!(contacts > robots, "too few contacts: {contacts}");
}
