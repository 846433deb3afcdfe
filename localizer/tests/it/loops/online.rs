//! Loops that are closed while the robot drives.

use super::world::{Corridor, Plan};
use super::{SPEED_MPS, ahead};
use crate::robot::{Odometry, PERIOD_S, furnished, mapper};
use interfaces::{CellState, LaserReading};
use localizer::{
    Correction, Localizer, LocalizerSettings, LoopClosed, LoopClosingLocalizer, PoseState, Switch,
};
use mapper::Mapper;
use nalgebra::Isometry2;
use std::time::Instant;

/// The number of scans at rest before the robot drives.
const RESTING: usize = 20;

/// The way on known ground within which a loop is closed, m.
const CLOSING_M: f64 = 12.0;

/// A robot that drives around a corridor.
struct Run {
    corridor: Corridor,
    odometry: Odometry,
    localizer: LoopClosingLocalizer,
    map: Mapper,
    step: usize,
}

impl Run {
    fn new(corridor: Corridor, seed: u64) -> Self {
        let (start, frame) = (corridor.at(0.0), corridor.frame(0.05));
        let localizer = LoopClosingLocalizer::from_nothing(&LocalizerSettings::default(), &frame, start);
        let odometry = Odometry::new(start, seed);
        Self { corridor, odometry, localizer: localizer.unwrap(), map: mapper(frame), step: 0 }
    }

    /// The number of scans of a number of rounds.
    fn scans(&self, rounds: f64) -> usize {
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

    fn step(&mut self) -> LoopClosed {
        let (reading, _) = self.reading();
        let closed = self.localizer.localize(&reading, &mut self.map);
        self.learn(&closed);
        closed
    }

    /// The run in another program, from what this one has saved.
    fn resumed(self) -> Self {
        let Self { corridor, odometry, mut localizer, mut map, step } = self;
        let mut again = Self { odometry, step, ..Self::new(corridor, 0) };
        again.localizer.restore(&localizer.snapshot()).unwrap();
        again.map.restore(&map.snapshot()).unwrap();
        again
    }
}

/// What a trip has measured.
#[derive(Default)]
struct Trip {
    /// The errors of the certain positions on the first round, and from the second one on, m. The first [`CLOSING_M`] of the
    /// second round belong to the first one.
    errors_m: [Vec<f64>; 2],
    /// After which way, m; and the computing time, ms.
    corrections: Vec<(f64, Correction, f64)>,
    /// The numbers of scans without a certain pose, on the same ways.
    not_certain: [usize; 2],
    /// The way after which the map stands, m.
    stands_m: Option<f64>,
    per_scan_ms: f64,
    /// The distances of the blocked cells from the walls, m.
    walls_m: Vec<f64>,
}

/// A trip around a corridor. `plain`: loops are not closed.
fn trip(corridor: Corridor, rounds: f64, seed: u64, plain: bool) -> Trip {
    let mut alone =
        Localizer::from_nothing(&LocalizerSettings::default(), &corridor.frame(0.05), corridor.at(0.0))
            .unwrap();
    let mut run = Run::new(corridor, seed);
    let mut trip = Trip::default();
    let scans = run.scans(rounds);
    for _ in 0..scans {
        let way_m = run.way_m();
        let (reading, truth) = run.reading();
        let begin = Instant::now();
        let closed = match plain {
            true => LoopClosed { localized: alone.localize(&reading, &run.map), correction: None },
            false => run.localizer.localize(&reading, &mut run.map),
        };
        let elapsed_ms = begin.elapsed().as_secs_f64() * 1e3;
        trip.per_scan_ms += elapsed_ms / scans as f64;
        run.learn(&closed);
        trip.corrections.extend(closed.correction.map(|correction| (way_m, correction, elapsed_ms)));
        let after = usize::from(way_m > run.corridor.round_m() + CLOSING_M);
        let estimate = &closed.localized.estimate;
        match estimate.state {
            PoseState::Tracking => {
                let error = estimate.pose.translation.vector - truth.translation.vector;
                trip.errors_m[after].push(error.norm());
            }
            _ => trip.not_certain[after] += 1,
        }
        if run.localizer.is_frozen() {
            trip.stands_m.get_or_insert(way_m);
        }
    }
    trip.walls_m = walls_m(&run.map, &run.corridor);
    trip
}

fn walls_m(map: &Mapper, corridor: &Corridor) -> Vec<f64> {
    let states = map.states();
    let blocked = states.cells().iter().enumerate().filter(|(_, state)| **state == CellState::Blocked);
    blocked
        .map(|(index, _)| corridor.distance_m(&states.frame().center(states.frame().cell(index))))
        .collect()
}

/// The value that this share does not exceed.
fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((share * values.len().saturating_sub(1) as f64).round() as usize).copied().unwrap_or(f64::NAN)
}

impl Trip {
    fn report(&self, name: &str) {
        let cm = |values: &[f64]| {
            let [median, most, largest] = [0.5, 0.95, 1.0].map(|share| quantile(values, share) * 100.0);
            format!("{median:.1} / {most:.1} / {largest:.1} cm")
        };
        println!(
            "{name}: first round {}, {} not certain; then {}, {} not certain; walls off by {}, {:.2} % not there; {:.2} ms \
             per scan; stands after {:.0?} m",
            cm(&self.errors_m[0]),
            self.not_certain[0],
            cm(&self.errors_m[1]),
            self.not_certain[1],
            cm(&self.walls_m),
            self.wrong_walls() * 100.0,
            self.per_scan_ms,
            self.stands_m,
        );
        for (way_m, correction, elapsed_ms) in &self.corrections {
            println!("    after {way_m:.1} m: {correction}; {elapsed_ms:.0} ms");
        }
    }

    /// The share of the blocked cells that are more than 10 cm from every wall.
    fn wrong_walls(&self) -> f64 {
        self.walls_m.iter().filter(|off_m| **off_m > 0.1).count() as f64 / self.walls_m.len().max(1) as f64
    }
}

/// A short loop, and a laser that sees little of it.
fn narrow(seed: u64) -> Corridor {
    Corridor::new([15.0, 11.0], Plan::Varied, seed).with_laser(61, 90_f64.to_radians())
}

#[test]
fn a_loop_is_closed_while_the_robot_drives() {
    let trip = trip(narrow(101), 1.5, 101, false);
    trip.report("50 m");
    let [first, second] = [0, 1].map(|round| quantile(&trip.errors_m[round], 0.95));
    assert!(first > 0.12 && second < 0.08, "{first} {second}");
    assert_eq!(trip.corrections.len(), 1);
    assert!(trip.wrong_walls() < 0.01);
}

/// A loop of 100 m, three sides of which have smooth walls.
fn mostly_smooth(seed: u64) -> Corridor {
    Corridor::new([30.0, 20.0], Plan::OneSide, seed).with_laser(61, 90_f64.to_radians())
}

#[test]
#[ignore = "prints how a robot fares on eight loops with smooth walls (docs/limits.md)"]
fn robots_beside_smooth_walls() {
    (100..108).for_each(|seed| trip(mostly_smooth(seed), 1.5, seed, false).report(&format!("seed {seed}")));
}

#[test]
fn a_robot_that_was_lost_gets_the_map_of_the_corrected_trajectory() {
    let trip = trip(mostly_smooth(105), 1.5, 105, false);
    trip.report("100 m, mostly smooth");
    // Of the few poses that were certain before, none has moved by what otherwise makes a new map worth it.
    assert!(trip.corrections[0].1.largest_m < 0.05, "{:?}", trip.corrections);
    assert!(quantile(&trip.errors_m[1], 1.0) < 0.5 && trip.not_certain[1] < 500);
}

/// A round of 50 m of the localizer alone, and of one with a guide: the scans without a certain pose, and the error of the
/// position that 95 % do not exceed, m.
fn alone_and_guided(corridor: impl Fn() -> Corridor) -> [(usize, f64); 2] {
    [true, false].map(|plain| {
        let trip = trip(corridor(), 1.0, 102, plain);
        trip.report(if plain { "50 m, the localizer alone" } else { "50 m" });
        (trip.not_certain[0], quantile(&trip.errors_m[0], 0.95))
    })
}

#[test]
fn a_robot_with_a_guide_is_not_lost() {
    let [alone, guided] = alone_and_guided(|| ahead(Corridor::new([15.0, 11.0], Plan::Varied, 102)));
    assert!(alone.0 > 4 * guided.0 && guided.1 < 0.1, "{alone:?} {guided:?}");
}

#[test]
fn a_guide_helps_where_scans_sweep() {
    let corridor = || ahead(Corridor::new([15.0, 11.0], Plan::Varied, 102)).sweeping();
    let [alone, guided] = alone_and_guided(corridor);
    assert!(alone.1 > 0.3 && guided.1 < 0.1, "{alone:?} {guided:?}");
}

#[test]
fn a_run_that_goes_on_equals_one_that_was_not_interrupted() {
    let (mut whole, mut parts) = (Run::new(narrow(101), 101), Run::new(narrow(101), 101));
    let mut corrections = 0;
    for step in 0..whole.scans(1.3) {
        // While the robot rests before a correction, and at some other times.
        if step % 199 == 198 || parts.localizer.wants_rest() && step > 2 * RESTING {
            parts = parts.resumed();
        }
        let (expected, found) = (whole.step(), parts.step());
        assert_eq!(found, expected, "step {step}");
        corrections += usize::from(found.correction.is_some());
    }
    assert!(corrections > 0);
    assert!(parts.map.snapshot() == whole.map.snapshot());
}

/// The states and poses of all readings; the numbers of readings with which the robot changed its map, and those that were read
/// again; the largest error on the second round, m, and the longest time for a reading, ms.
type Switched = (Vec<(PoseState, Isometry2<f64>)>, Vec<(usize, usize)>, f64, f64);

/// A trip of 1.5 rounds of a robot that changes to a new map as given.
fn switched(switch: Switch) -> Switched {
    switched_in(narrow(101), switch, 0.1)
}

/// The same in another corridor; `most_m`: the largest error of 99 % of its walls, m.
fn switched_in(corridor: Corridor, switch: Switch, most_m: f64) -> Switched {
    let mut run = Run::new(corridor, 101);
    run.localizer = run.localizer.switching(switch.clone());
    let (mut poses, mut changes, mut worst_m, mut longest_ms) = (Vec::new(), Vec::new(), 0.0_f64, 0.0_f64);
    for _ in 0..run.scans(1.5) {
        let is_second = run.way_m() > run.corridor.round_m() + CLOSING_M + 3.0;
        let (reading, truth) = run.reading();
        let begin = Instant::now();
        let closed = run.localizer.localize(&reading, &mut run.map);
        longest_ms = longest_ms.max(begin.elapsed().as_secs_f64() * 1e3);
        run.learn(&closed);
        let estimate = &closed.localized.estimate;
        poses.push((estimate.state, estimate.pose));
        changes.extend(closed.correction.map(|correction| (run.step, correction.readings)));
        if is_second && estimate.state == PoseState::Tracking {
            worst_m = worst_m.max((estimate.pose.translation.vector - truth.translation.vector).norm());
        }
        if switch == Switch::WhenReady && !run.localizer.is_settled() {
            // As fast as a robot.
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
    }
    let walls_m = walls_m(&run.map, &run.corridor);
    assert!(quantile(&walls_m, 0.99) < most_m, "{switch:?}: walls off by {} m", quantile(&walls_m, 0.99));
    (poses, changes, worst_m, longest_ms)
}

#[test]
fn a_loop_is_closed_beside_the_robot() {
    let at_once = switched(Switch::AtOnce);
    for switch in [Switch::After(30), Switch::WhenReady] {
        let (poses, changes, worst_m, longest_ms) = switched(switch.clone());
        println!(
            "{switch:?}: {changes:?}, {worst_m:.2} m, {longest_ms:.0} ms; at once: {:?}, {:.0} ms",
            at_once.1, at_once.3
        );
        let [(reading, read_again)] = changes[..] else { panic!("{switch:?}: {changes:?}") };
        // Until it changes the map, the robot goes on in the old one.
        let (begun, _) = at_once.1[0];
        assert!(reading > begun && poses[..begun - 1] == at_once.0[..begun - 1]);
        assert_eq!(reading, read_again, "the number of the reading is recorded");
        assert!(worst_m < at_once.2 + 0.05, "{worst_m} m, {} m at once", at_once.2);
        if switch == Switch::After(30) {
            assert_eq!(reading, begun + 30);
        }
        // The reading that was recorded repeats the run.
        assert!(switched(Switch::At(vec![reading])).0 == poses, "{reading}: other bits");
    }
}

#[test]
fn what_is_learned_again_can_be_awaited() {
    let mut run = Run::new(narrow(101), 101);
    run.localizer = run.localizer.switching(Switch::After(10_000));
    while run.localizer.is_settled() {
        run.step();
    }
    (0..25).for_each(|_| drop(run.step()));
    let before = walls_m(&run.map, &run.corridor);
    run.localizer.settle(&mut run.map);
    assert!(run.localizer.is_settled());
    let after = walls_m(&run.map, &run.corridor);
    assert!(quantile(&after, 0.99) < 0.1 && quantile(&after, 0.99) < quantile(&before, 0.99));
    let mut resumed = run.resumed();
    assert_ne!(resumed.step().localized.estimate.state, PoseState::Lost);
}

#[test]
fn nothing_changes_where_the_map_is_whole() {
    let mut house = furnished(180, 100);
    let start = house.tour(0.0);
    let settings = LocalizerSettings::default();
    let mut closing = LoopClosingLocalizer::from_nothing(&settings, &house.frame, start).unwrap();
    let mut alone = Localizer::from_nothing(&settings, &house.frame, start).unwrap();
    let (mut odometry, mut map) = (Odometry::new(start, 100), mapper(house.frame));
    for step in 0..1200 {
        let time_s = step as f64 * PERIOD_S;
        let pose = house.tour((time_s - 2.0).max(0.0));
        let mut reading = house.reading(time_s, pose, &[]);
        reading.pose = odometry.moved_to(&pose);
        let expected = alone.localize(&reading, &map);
        let LoopClosed { localized, correction } = closing.localize(&reading, &mut map);
        assert!(localized == expected && correction.is_none(), "{step}");
        map.update(&localized.reading).unwrap();
    }
}

#[test]
fn a_session_ends_the_first_map() {
    let mut run =
        Run::new(Corridor::new([8.0, 5.0], Plan::Varied, 102).with_laser(90, std::f64::consts::TAU), 102);
    run.localizer.begin_session();
    assert!(!run.localizer.is_frozen(), "nothing is known yet");
    run.step();
    run.localizer.begin_session();
    assert!(run.localizer.is_frozen());
    let snapshot = run.localizer.snapshot();
    for length in 0..snapshot.len().min(2000) {
        assert!(run.localizer.restore(&snapshot[..length]).is_err(), "{length}");
    }
}

/// ```text
/// cargo test -p curious-localizer --test it loops::online::long -- --ignored --nocapture
/// ```
#[test]
#[ignore = "takes minutes"]
fn long_loops_are_closed() {
    // The largest errors after the loop: of 181 beams that sweep, and of all others, m.
    let mut worst_m: [f64; 2] = [0.0; 2];
    for (sides_m, rounds) in [([15.0, 11.0], 1.5), ([30.0, 23.0], 1.4), ([62.0, 41.0], 1.3)] {
        let lasers = [(false, false), (true, false), (false, true), (true, true)];
        for ((looks_ahead, sweeps), seed) in
            lasers.into_iter().flat_map(|laser| (100..103).map(move |seed| (laser, seed)))
        {
            for plain in [true, false] {
                let corridor = Corridor::new(sides_m, Plan::Varied, seed);
                let corridor = if looks_ahead { ahead(corridor) } else { corridor };
                let corridor = if sweeps { corridor.sweeping() } else { corridor };
                let laser = if looks_ahead { "181 beams ahead" } else { "360 beams" };
                let laser = format!("{laser}{}", if sweeps { " that sweep" } else { "" });
                let loops = if plain { ", loops are not closed" } else { "" };
                let name = format!("{:.0} m, seed {seed}, {laser}{loops}", corridor.round_m());
                let trip = trip(corridor, rounds, seed, plain);
                trip.report(&name);
                if !plain {
                    let worst_m = &mut worst_m[usize::from(!(looks_ahead && sweeps))];
                    *worst_m = worst_m.max(quantile(&trip.errors_m[1], 0.95));
                }
            }
        }
    }
    assert!(worst_m[0] < 0.5 && worst_m[1] < 0.2, "{worst_m:?} m");
}

/// The longest time for a reading where thousands are read again, in a thread and at once. On a machine without other work:
///
/// ```text
/// cargo test -p curious-localizer --test it loops::online::thousands -- --ignored --nocapture
/// ```
#[test]
#[ignore = "takes minutes"]
fn thousands_of_readings_are_read_again_beside_the_robot() {
    for switch in [Switch::WhenReady, Switch::AtOnce] {
        let (_, changes, worst_m, longest_ms) =
            switched_in(ahead(Corridor::new([62.0, 41.0], Plan::Varied, 101)), switch.clone(), 0.5);
        println!("{switch:?}: {changes:?}, {worst_m:.2} m, at most {longest_ms:.0} ms for a reading");
    }
}
