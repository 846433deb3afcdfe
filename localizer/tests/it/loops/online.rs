//! Loops that are closed while the robot drives.

mod trips;

use super::ahead;
use super::world::{Corridor, Plan};
use crate::robot::{Odometry, PERIOD_S, furnished, localizer, mapper};
use localizer::{LocalizerSettings, LoopClosed, LoopClosingLocalizer, PoseState, Switch};
use trips::{RESTING, Run, narrow, quantile, switched, trip, walls_m};

#[test]
fn a_loop_is_closed_while_the_robot_drives() {
    let trip = trip(narrow(101), 1.5, 101, false);
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
fn a_robot_that_was_lost_gets_the_map_of_the_corrected_trajectory() {
    let trip = trip(mostly_smooth(105), 1.5, 105, false);
    // Of the few poses that were certain before, none has moved by what otherwise makes a new map worth it.
    assert!(trip.corrections[0].1.largest_m < 0.05, "{:?}", trip.corrections);
    assert!(quantile(&trip.errors_m[1], 1.0) < 0.5 && trip.not_certain[1] < 500);
}

/// A round of 50 m of the localizer alone, and of one with a guide: the scans without a certain pose, and the error of the
/// position that 95 % do not exceed, m.
fn alone_and_guided(corridor: impl Fn() -> Corridor) -> [(usize, f64); 2] {
    [true, false].map(|plain| {
        let trip = trip(corridor(), 1.0, 102, plain);
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

#[test]
fn a_loop_is_closed_beside_the_robot() {
    let at_once = switched(Switch::AtOnce);
    for switch in [Switch::After(30), Switch::WhenReady] {
        let (poses, changes, worst_m) = switched(switch);
        let [(reading, read_again)] = changes[..] else { panic!("{switch:?}: {changes:?}") };
        // Until it changes the map, the robot goes on in the old one.
        let (begun, _) = at_once.1[0];
        assert!(reading > begun && poses[..begun - 1] == at_once.0[..begun - 1]);
        assert_eq!(reading, read_again, "the number of the reading is recorded");
        assert!(worst_m < at_once.2 + 0.05, "{worst_m} m, {} m at once", at_once.2);
        if switch == Switch::After(30) {
            assert_eq!(reading, begun + 30);
        }
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
    let mut alone = localizer(&house.frame, start);
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
