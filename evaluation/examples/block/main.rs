//! A robot that maps corridors around a block, drives by its own estimate, and closes the loop while it drives.
//!
//! The robot starts from nothing, its odometry drifts hard, and the agent selects the goals. Printed: the errors of its
//! certain positions before and after the map was learned again; and the map at the end, compared with the truth and with
//! the map of a robot with exact poses.
//!
//! ```text
//! cargo run -p curious-evaluation --example block -- LENGTH DEPTH [SEED [TRIALS [MINUTES [BEAMS [VIEW_DEG [SWEEP_S]]]]]]
//! ```

mod world;

use agent::Policy;
use evaluation::metrics::{map_scores, quantile};
use evaluation::physics_trial::{self, PhysicsTrial};
use interfaces::{CellState, GroundTruth, LaserReading, PoseMode, TrueState};
use localizer::{Localized, Localizer, PoseState};
use mapper::Mapper;
use robot::{Belief, Localization, Permission, Robot};
use sim::physics::WorldSpec;
use std::error::Error;
use std::time::Instant;

/// A blocked cell farther than this from everything blocked is a wall that is not there, cells.
const REACH: i32 = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let numbers = std::env::args().skip(1).map(|text| text.parse::<f64>());
    let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
    let number = |index: usize, default: f64| numbers.get(index).copied().unwrap_or(default);
    let sides_m = [number(0, 30.0), number(1, 22.0)];
    let seed = number(2, 100.0) as u64;
    for seed in seed..seed + number(3, 1.0) as u64 {
        let laser = world::Laser {
            beams: number(5, 360.0) as usize,
            view_rad: number(6, 360.0).to_radians(),
            sweep_s: number(7, 0.0),
        };
        let spec = world::block(sides_m, laser, seed).ok_or("no such world")?;
        for (name, pose, is_closing) in [
            ("exact poses", PoseMode::Exact, false),
            ("localized, no loops", PoseMode::Localized, false),
            ("localized", PoseMode::Localized, true),
        ] {
            print!("{}, {name}: ", spec.name);
            run(&spec, seed, pose, is_closing, number(4, 10.0) * 60.0)?;
        }
    }
    Ok(())
}

fn run(
    spec: &WorldSpec,
    seed: u64,
    pose: PoseMode,
    is_closing: bool,
    end_s: f64,
) -> Result<(), Box<dyn Error>> {
    let mut settings = physics_trial::settings(spec)?;
    settings.pose = pose;
    let pilot = settings.pilot(settings.agent(&Policy::default(), seed)?, seed)?;
    let mut trial = PhysicsTrial::new(spec, seed, &settings, None, pilot)?;
    if pose == PoseMode::Localized && !is_closing {
        let start = *trial.world.true_pose();
        let localizer = Localizer::from_nothing(&settings.localizer, &spec.frame, start)?;
        let Robot { mapper, pilot, .. } = trial.robot;
        trial.robot = Robot::new(Box::new(WithoutLoops(localizer)), mapper, pilot);
    }
    let (mut errors_m, mut uncertain) = ([Vec::new(), Vec::new()], 0);
    let mut corrections = Vec::new();
    let (begin, mut last, mut slowest_s) = (Instant::now(), Instant::now(), 0.0_f64);
    while trial.robot.mapper.time() < end_s {
        let turn = trial.turn()?;
        slowest_s = slowest_s.max(last.elapsed().as_secs_f64());
        corrections.extend(
            turn.belief.correction.map(|correction| (turn.reading.time_s, correction, last.elapsed())),
        );
        last = Instant::now();
        if turn.belief.is_certain() {
            let off = turn.belief.pose.translation.vector - trial.world.true_pose().translation.vector;
            errors_m[usize::from(!corrections.is_empty())].push(off.norm());
        } else {
            uncertain += 1;
        }
    }
    let elapsed_s = begin.elapsed().as_secs_f64();
    let scores = map_scores(&trial.robot.mapper, trial.world.truth());
    let [before, after] = errors_m.map(|errors_m| quantiles(&errors_m));
    println!(
        "before {before}; after {after}; {uncertain} scans not certain; seen {:.1} %, right {:.1} %, walls that are not \
         there {:.2} %; {:.0} x real time, a scan at most {:.0} ms",
        scores.coverage * 100.0,
        scores.map_quality * 100.0,
        wrong_walls(&trial) * 100.0,
        end_s / elapsed_s,
        slowest_s * 1e3
    );
    for (time_s, correction, elapsed) in corrections {
        println!("    at {time_s:.1} s: {correction}; {:.0} ms", elapsed.as_secs_f64() * 1e3);
    }
    Ok(())
}

/// The share of the blocked cells of the map with nothing blocked around them.
fn wrong_walls<P>(trial: &PhysicsTrial<P>) -> f64 {
    let (states, truth) = (trial.robot.mapper.states(), trial.world.truth());
    let frame = *states.frame();
    let is_wrong = |index: &&usize| {
        let cell = frame.cell(**index);
        let mut around = (-REACH..=REACH)
            .flat_map(|x| (-REACH..=REACH).map(move |y| interfaces::Cell::new(cell.x + x, cell.y + y)));
        around.all(|cell| frame.index(cell).is_none_or(|index| truth.state(index) == TrueState::Free))
    };
    let blocked: Vec<usize> =
        (0..frame.len()).filter(|index| states.cells()[*index] == CellState::Blocked).collect();
    blocked.iter().filter(is_wrong).count() as f64 / blocked.len().max(1) as f64
}

/// The median, the value that 95 % do not exceed, and the largest, in cm.
fn quantiles(errors_m: &[f64]) -> String {
    let at = |share: f64| quantile(errors_m, share).map_or(f64::NAN, |m| m * 100.0);
    format!("{:.1} / {:.1} / {:.1} cm", at(0.5), at(0.95), at(1.0))
}

/// A localizer that closes no loops.
struct WithoutLoops(Localizer);

impl Localization<LaserReading> for WithoutLoops {
    fn localize(&mut self, reading: LaserReading, mapper: &mut Mapper) -> (LaserReading, Belief) {
        let Localized { reading, estimate } = self.0.localize(&reading, mapper);
        let permission = match estimate.state {
            _ if self.0.wants_rest() => Permission::Rest,
            PoseState::Lost => Permission::LookAround,
            PoseState::Tracking | PoseState::Uncertain => Permission::Drive,
        };
        let belief = Belief { estimate: Some(estimate), permission, ..Belief::exact(reading.pose) };
        (reading, belief)
    }
}
