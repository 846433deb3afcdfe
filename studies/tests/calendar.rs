//! What things do: the same in large and in small steps, with the shares that their model predicts.

use interfaces::{Purpose, RandomStream};
use proptest::prelude::*;
use studies::calendar::{DAY_S, HOUR_S, Habit, Hours, Stays, Timeline, WEEK_S};
use studies::{Belief, Building, Kind, Model, STEP_S};

fn habit() -> Habit {
    let stays = |short_s, long_s| Stays { short_s, long_s, long_share: 0.3 };
    Habit {
        hours: Hours::daily(&[0, 1, 2, 3, 4], 8.0, 18.0),
        active: [stays(120.0, 5000.0), stays(300.0, 9000.0)],
        quiet: [Stays::of_mean(1200.0), Stays::of_mean(2.0 * DAY_S)],
    }
}

fn timeline(seed: u64) -> Timeline {
    let habit = habit();
    Timeline::of_habit(&habit, Model::of(&habit).start(), 0.0, RandomStream::new(seed, Purpose::Thing(0)))
}

fn changes(timeline: &mut Timeline, times_s: impl IntoIterator<Item = f64>) -> Vec<(f64, bool)> {
    let mut changes = Vec::new();
    times_s
        .into_iter()
        .for_each(|time_s| timeline.advance(time_s, |at_s, state| changes.push((at_s, state))));
    changes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn large_steps_are_many_small_ones(seed in any::<u64>(), step_s in 1.0_f64..1e5) {
        let large = changes(&mut timeline(seed), [WEEK_S]);
        let steps = (WEEK_S / step_s).floor() as usize;
        let small = changes(&mut timeline(seed), (0..=steps).map(|step| step as f64 * step_s).chain([WEEK_S]));
        prop_assert_eq!(&large, &small);
        prop_assert!(large.windows(2).all(|two| two[0].0 <= two[1].0 && two[0].1 != two[1].1));
        // From event to event.
        let mut events = timeline(seed);
        let mut jumped = Vec::new();
        while events.next_event_s() <= WEEK_S {
            let at_s = events.next_event_s();
            events.advance(at_s, |at_s, state| jumped.push((at_s, state)));
        }
        prop_assert_eq!(large, jumped);
    }
}

/// The share of 4000 things that are blocked, at hours of the week, is that of the belief without looks.
#[test]
fn things_are_blocked_as_often_as_the_model_says() {
    let model = Model::of(&habit());
    let mut belief = Belief::new(&model);
    let mut timelines: Vec<Timeline> = (0..4000).map(timeline).collect();
    let mut step = 0;
    for hour in [0.0, 7.9, 8.5, 12.0, 17.9, 19.0, 36.0, 108.0, 140.0, 167.0] {
        let at = (hour * HOUR_S / STEP_S) as usize;
        (step..at).for_each(|step| belief.advance(&model, step));
        step = at;
        timelines.iter_mut().for_each(|timeline| timeline.advance(hour * HOUR_S, |_, _| ()));
        let share = timelines.iter().filter(|timeline| timeline.is_blocked()).count() as f64 / 4000.0;
        let p = belief.probability();
        let error = (p * (1.0 - p) / 4000.0).sqrt();
        assert!((share - p).abs() < 4.0 * error + 1e-3, "hour {hour}: {share} against {p}");
    }
}

#[test]
fn an_office_sleeps_at_night() {
    let (mut day, mut night) = (0, 0);
    for seed in 0..20 {
        let building = Building::generate(Kind::Office, seed);
        for (index, thing) in building.things.iter().enumerate() {
            let rng = RandomStream::new(seed, Purpose::Thing(index));
            let mut timeline = Timeline::of_habit(&thing.habit, Model::of(&thing.habit).start(), 0.0, rng);
            let mut count = |at_s: f64, _| match (at_s % DAY_S) / HOUR_S {
                hour if (9.0..17.0).contains(&hour) => day += 1,
                hour if !(7.0..20.0).contains(&hour) => night += 1,
                _ => (),
            };
            timeline.advance(5.0 * DAY_S, &mut count);
        }
    }
    assert!(day > 20 * night, "{day} changes in 40 hours, {night} in 55 hours of the night");
}
