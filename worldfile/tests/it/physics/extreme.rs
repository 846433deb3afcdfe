//! Random worlds with extreme masses, speeds and walls: nobody passes through a wall.

use super::random::{Chance, Deepest, number, of_what_fits, passes, runs};
use super::*;

/// What a run of all tests can wait for; SIM_EXTREME_WORLDS=20000 asks for more.
const WORLDS: u64 = 300;
const SECONDS: f64 = 10.0;
const SIZE_M: [f64; 2] = [5.0, 4.0];

impl Chance {
    /// A value whose logarithm is uniform.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.between(0.0, 1.0))
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.between(0.0, choices.len() as f64) as usize]
    }

    fn at(&mut self) -> [f64; 2] {
        SIZE_M.map(|size_m| self.between(0.1, size_m - 0.1))
    }
}

fn wall(from: [f64; 2], to: [f64; 2], thickness_m: f64) -> String {
    format!("[[wall]]\nfrom_m = {from:?}\nto_m = {to:?}\nthickness_m = {thickness_m:?}\n")
}

fn robot(name: usize, step_s: f64, chance: &mut Chance) -> String {
    let radius_m = chance.scale(0.02, 0.3);
    let outline = match chance.pick(&[0, 0, 1]) {
        0 => format!("radius_m = {radius_m:?}"),
        _ => {
            let [a, b, c] = [1.5, 1.0, 2.0].map(|factor| factor * radius_m);
            format!("footprint_m = [[-{a:?}, -{b:?}], [{c:?}, 0.0], [-{a:?}, {b:?}]]")
        }
    };
    // A robot may go half of its inner radius in a step and sideways as fast.
    let fastest_mps = (chance.between(0.3, 0.55) * radius_m / step_s).min(5.0);
    let omni = format!("kind = \"omni\"\nmax_left_mps = {fastest_mps:?}");
    let drive = chance.pick(&["kind = \"diff\"", omni.as_str()]);
    format!(
        "[[robot]]\nname = \"{name}\"\n{outline}\nmass_kg = {:?}\npose_m = {:?}\nheading_deg = {:?}\n\
         [robot.drive]\n{drive}\nmax_linear_mps = {fastest_mps:?}\nmax_angular_degps = {:?}\n\
         max_linear_acceleration_mps2 = 100.0\nmax_angular_acceleration_degps2 = 5000.0\n\
         [robot.laser]\nbeams = 2\nrange_max_m = 5.0\nrate_hz = 10.0\n[robot.behavior]\nkind = \"driven\"\n",
        chance.scale(0.001, 1e5),
        chance.at(),
        chance.between(0.0, 360.0),
        chance.between(10.0, 400.0),
    )
}

fn pushed(name: usize, chance: &mut Chance) -> String {
    format!(
        "[[obstacle]]\nname = \"{name}\"\nkind = \"box\"\ncenter_m = {:?}\nsize_m = {:?}\nheading_deg = {:?}\n\
         mass_kg = {:?}\nfriction = {:?}\n",
        chance.at(),
        [chance.scale(0.02, 0.5), chance.scale(0.02, 0.5)],
        chance.between(0.0, 90.0),
        chance.scale(0.001, 1e4),
        chance.between(-0.2, 0.5).max(0.0),
    )
}

/// A closed room with walls, robots and boxes; what does not fit is left out.
fn world(seed: u64) -> FleetSpec {
    let mut chance = Chance::new(seed);
    let step_s = chance.pick(&[0.02, 0.05, 0.1]);
    let [right, top] = SIZE_M;
    let corners = [[0.06, 0.06], [right - 0.06, 0.06], [right - 0.06, top - 0.06], [0.06, top - 0.06]];
    let mut text = format!(
        "name = \"extreme\"\n[map]\nsize_m = {SIZE_M:?}\ncell_m = 0.1\n[physics]\nstep_s = {step_s:?}\n"
    );
    let thickness_m = chance.scale(0.001, 0.1);
    (0..4).for_each(|side| text += &wall(corners[side], corners[(side + 1) % 4], thickness_m));
    let parts = (0..24).map(|thing| match thing {
        0..4 => wall(chance.at(), chance.at(), chance.scale(0.001, 0.1)),
        4..14 => robot(thing, step_s, &mut chance),
        _ => pushed(thing, &mut chance),
    });
    of_what_fits(text, parts)
}

#[test]
fn with_extreme_masses_speeds_and_walls_nobody_passes_a_wall() {
    let worlds = number("SIM_EXTREME_WORLDS", WORLDS);
    let (mut robots, mut boxes, mut contacts) = (0, 0, 0);
    let mut deepest = Deepest::default();
    let mut passed = Vec::new();
    for (model, seed) in runs(worlds) {
        let spec = FleetSpec { contacts: model, ..world(seed) };
        robots += spec.robots.len();
        boxes += spec.obstacles.len();
        let mut fleet = Fleet::new(&spec, seed);
        let mut chance = Chance::new(!seed);
        let mut wanted = vec![Twist::STOP; spec.robots.len()];
        let centers = |fleet: &Fleet| -> Vec<Point2<f64>> {
            let boxes = fleet.obstacles().map(|thing| nalgebra::center(&thing.corners[0], &thing.corners[2]));
            fleet.robots().map(|robot| robot.pose.translation.vector.into()).chain(boxes).collect()
        };
        let mut from = centers(&fleet);
        while fleet.time_s() < SECONDS {
            fleet.step(&mut |robot: &RobotView<'_>, _: &LaserReading| {
                let drive = &spec.robots[robot.index].drive;
                if wanted[robot.index] == Twist::STOP || chance.between(0.0, 1.0) < 0.05 {
                    // Full speed ahead, seldom back.
                    let linear_mps = drive.max_linear_mps * chance.pick(&[1.0, 1.0, 1.0, -1.0]);
                    let angular_radps = chance.pick(&[0.0, 0.3, -0.3, drive.max_angular_radps]);
                    wanted[robot.index] = Twist { linear_mps, angular_radps };
                }
                wanted[robot.index]
            });
            contacts += fleet.contacts().len();
            let to = centers(&fleet);
            for (index, (from, to)) in from.iter().zip(&to).enumerate() {
                let place = || format!("{index} of world {seed} at {:.2} s: {from} to {to}", fleet.time_s());
                assert!(to.coords.iter().all(|value| value.is_finite()), "{}", place());
                if passes(&fleet, from, to) {
                    passed.push(place());
                }
            }
            from = to;
            deepest.note(&fleet, seed);
        }
    }
    assert!(passed.is_empty(), "{} passed a wall: {}", passed.len(), passed.join("\n"));
    deepest.check();
    assert!(robots > 4 * worlds as usize, "too few robots fitted in: {robots}");
    assert!(boxes > 4 * worlds as usize, "too few boxes fitted in: {boxes}");
    assert!(contacts > 5 * robots, "few contacts: {contacts}");
}

/// The smallest case that was found: a heavy robot presses a light one against a thin wall.
#[test]
fn a_light_robot_stays_on_its_side_of_a_thin_wall() {
    let text = format!(
        "name = \"thin\"\n[map]\nsize_m = [5.0, 4.0]\ncell_m = 0.1\n{}{}{}",
        super::wall([4.0, 0.0], [4.02, 4.0]),
        jams::robot("a", "radius_m = 0.2", 10.0, [1.0, 2.0]),
        jams::robot("b", "radius_m = 0.02", 0.1, [3.5, 2.0])
            .replace("_linear_mps = 1.0", "_linear_mps = 0.3"),
    );
    let mut fleet = Fleet::new(&parse_fleet(&text), 0);
    fleet.run_until(10.0, &mut |robot: &RobotView<'_>, _: &LaserReading| Twist {
        linear_mps: if robot.index == 0 { 0.8 } else { 0.0 },
        angular_radps: 0.0,
    });
    let x: Vec<f64> = fleet.robots().map(|robot| robot.pose.translation.x).collect();
    assert!(x[1] < 4.0 - 0.015 && x[0] > 3.7, "{x:?}");
}
