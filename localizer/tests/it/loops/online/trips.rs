//! Trips of a robot around a corridor, and what they measure.

use super::super::SPEED_MPS;
use super::super::world::{Corridor, Plan};
use crate::robot::{Odometry, PERIOD_S, error_m, localizer, mapper};
use interfaces::{CellState, LaserReading};
use localizer::{Correction, LocalizerSettings, LoopClosed, LoopClosingLocalizer, PoseState, Switch};
use mapper::Mapper;
use nalgebra::Isometry2;

/// The number of scans at rest before the robot drives.
pub(super) const RESTING: usize = 20;

/// The way on known ground within which a loop is closed, m.
const CLOSING_M: f64 = 12.0;

/// A robot that drives around a corridor.
pub(super) struct Run {
    pub(super) corridor: Corridor,
    odometry: Odometry,
    pub(super) localizer: LoopClosingLocalizer,
    pub(super) map: Mapper,
    step: usize,
}

impl Run {
    pub(super) fn new(corridor: Corridor, seed: u64) -> Self {
        let (start, frame) = (corridor.at(0.0), corridor.frame(0.05));
        let localizer = LoopClosingLocalizer::from_nothing(&LocalizerSettings::default(), &frame, start);
        let odometry = Odometry::new(start, seed);
        Self { corridor, odometry, localizer: localizer.unwrap(), map: mapper(frame), step: 0 }
    }

    /// The number of scans of a number of rounds.
    pub(super) fn scans(&self, rounds: f64) -> usize {
        RESTING + (rounds * self.corridor.round_m() / (SPEED_MPS * PERIOD_S)) as usize
    }

    /// The way so far, m.
    fn way_m(&self) -> f64 {
        self.step.saturating_sub(RESTING) as f64 * SPEED_MPS * PERIOD_S
    }

    /// The next reading, and its true pose.
    fn reading(&mut self) -> (LaserReading, Isometry2<f64>) {
        let pose = self.corridor.at(self.way_m());
        let mut reading = self.corridor.reading(self.step as f64 * PERIOD_S, pose);
        reading.pose = self.odometry.moved_to(&pose);
        self.step += 1;
        (reading, pose)
    }

    /// The map learns from the reading.
    fn learn(&mut self, closed: &LoopClosed) {
        match closed.localized.estimate.state {
            PoseState::Tracking => self.map.update(&closed.localized.reading).unwrap(),
            _ => self.map.skip(&closed.localized.reading),
        }
    }

    pub(super) fn step(&mut self) -> LoopClosed {
        let (reading, _) = self.reading();
        let closed = self.localizer.localize(&reading, &mut self.map);
        self.learn(&closed);
        closed
    }

    /// The run in another program, from what this one has saved.
    pub(super) fn resumed(self) -> Self {
        let Self { corridor, odometry, mut localizer, mut map, step } = self;
        let mut again = Self { odometry, step, ..Self::new(corridor, 0) };
        again.localizer.restore(&localizer.snapshot()).unwrap();
        again.map.restore(&map.snapshot()).unwrap();
        again
    }
}

/// What a trip has measured.
#[derive(Default)]
pub(super) struct Trip {
    /// The errors of the certain positions on the first round, and from the second one on, m. The first [`CLOSING_M`] of the
    /// second round belong to the first one.
    pub(super) errors_m: [Vec<f64>; 2],
    /// After which way, m.
    pub(super) corrections: Vec<(f64, Correction)>,
    /// The numbers of scans without a certain pose, on the same ways.
    pub(super) not_certain: [usize; 2],
    /// The way after which the map stands, m.
    stands_m: Option<f64>,
    /// The distances of the blocked cells from the walls, m.
    walls_m: Vec<f64>,
}

/// A trip around a corridor. `plain`: loops are not closed.
pub(super) fn trip(corridor: Corridor, rounds: f64, seed: u64, plain: bool) -> Trip {
    let mut alone = localizer(&corridor.frame(0.05), corridor.at(0.0));
    let mut run = Run::new(corridor, seed);
    let mut trip = Trip::default();
    for _ in 0..run.scans(rounds) {
        let way_m = run.way_m();
        let (reading, truth) = run.reading();
        let closed = match plain {
            true => LoopClosed { localized: alone.localize(&reading, &run.map), correction: None },
            false => run.localizer.localize(&reading, &mut run.map),
        };
        run.learn(&closed);
        trip.corrections.extend(closed.correction.map(|correction| (way_m, correction)));
        let after = usize::from(way_m > run.corridor.round_m() + CLOSING_M);
        let estimate = &closed.localized.estimate;
        match estimate.state {
            PoseState::Tracking => trip.errors_m[after].push(error_m(&closed.localized, &truth)),
            _ => trip.not_certain[after] += 1,
        }
        if run.localizer.is_frozen() {
            trip.stands_m.get_or_insert(way_m);
        }
    }
    trip.walls_m = walls_m(&run.map, &run.corridor);
    trip
}

pub(super) fn walls_m(map: &Mapper, corridor: &Corridor) -> Vec<f64> {
    let states = map.states();
    let blocked = states.cells().iter().enumerate().filter(|(_, state)| **state == CellState::Blocked);
    blocked
        .map(|(index, _)| corridor.distance_m(&states.frame().center(states.frame().cell(index))))
        .collect()
}

/// The value that this share does not exceed.
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((share * values.len().saturating_sub(1) as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

impl Trip {
    pub(super) fn report(&self, name: &str) {
        let cm = |values: &[f64]| {
            let [median, most, largest] = [0.5, 0.95, 1.0].map(|share| quantile(values, share) * 100.0);
            format!("{median:.1} / {most:.1} / {largest:.1} cm")
        };
        println!(
            "{name}: first round {}, {} not certain; then {}, {} not certain; walls off by {}, {:.2} % not there; stands \
             after {:.0?} m",
            cm(&self.errors_m[0]),
            self.not_certain[0],
            cm(&self.errors_m[1]),
            self.not_certain[1],
            cm(&self.walls_m),
            self.wrong_walls() * 100.0,
            self.stands_m,
        );
        self.corrections
            .iter()
            .for_each(|(way_m, correction)| println!("    after {way_m:.1} m: {correction}"));
    }

    /// The share of the blocked cells that are more than 10 cm from every wall.
    pub(super) fn wrong_walls(&self) -> f64 {
        self.walls_m.iter().filter(|off_m| **off_m > 0.1).count() as f64 / self.walls_m.len().max(1) as f64
    }
}

/// A short loop, and a laser that sees little of it.
pub(super) fn narrow(seed: u64) -> Corridor {
    Corridor::new([15.0, 11.0], Plan::Varied, seed).with_laser(61, 90_f64.to_radians())
}

/// The states and poses of all readings; the numbers of readings with which the robot changed its map, and those that were read
/// again; the largest error on the second round, m.
pub(super) type Switched = (Vec<(PoseState, Isometry2<f64>)>, Vec<(usize, usize)>, f64);

/// A trip of 1.5 rounds of a robot that changes to a new map as given.
pub(super) fn switched(switch: Switch) -> Switched {
    let mut run = Run::new(narrow(101), 101);
    run.localizer = run.localizer.switching(switch);
    let (mut poses, mut changes, mut worst_m) = (Vec::new(), Vec::new(), 0.0_f64);
    for _ in 0..run.scans(1.5) {
        let is_second = run.way_m() > run.corridor.round_m() + CLOSING_M + 3.0;
        let (reading, truth) = run.reading();
        let closed = run.localizer.localize(&reading, &mut run.map);
        run.learn(&closed);
        let estimate = &closed.localized.estimate;
        poses.push((estimate.state, estimate.pose));
        changes.extend(closed.correction.map(|correction| (run.step, correction.readings)));
        if is_second && estimate.state == PoseState::Tracking {
            worst_m = worst_m.max(error_m(&closed.localized, &truth));
        }
        if switch == Switch::WhenReady && !run.localizer.is_settled() {
            // As fast as a robot.
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
    }
    let walls_m = walls_m(&run.map, &run.corridor);
    assert!(quantile(&walls_m, 0.99) < 0.1, "{switch:?}: walls off by {} m", quantile(&walls_m, 0.99));
    (poses, changes, worst_m)
}
