//! The posterior against simulated chains whose rates are known.

use super::{Evidence, Population, Posterior};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::iter::repeat_with;

/// Mean stays away and there, s: the logarithm is uniform.
fn stays_s(rng: &mut ChaCha8Rng) -> [f64; 2] {
    [0, 1].map(|_| libm::exp(rng.random_range(libm::log(15.0)..libm::log(1800.0))))
}

/// The looks at a chain at these times, s: its state.
fn looks(stays_s: [f64; 2], times_s: &[f64], rng: &mut ChaCha8Rng) -> Vec<bool> {
    let (mut is_there, mut until_s) = (false, 0.0);
    let look = |time_s: &f64| {
        while until_s <= *time_s {
            is_there = !is_there;
            until_s -= stays_s[usize::from(is_there)] * libm::log(rng.random_range(f64::MIN_POSITIVE..1.0));
        }
        is_there
    };
    times_s.iter().map(look).collect()
}

/// Looks of 10 s, with this time in between, s.
fn times_s(between_s: f64, end_s: f64) -> Vec<f64> {
    let starts =
        (0..).map(|visit| f64::from(visit) * (10.0 + between_s)).take_while(|start_s| *start_s < end_s);
    starts.flat_map(|start_s| (0..=20).map(move |step| start_s + 0.5 * f64::from(step))).collect()
}

fn evidence(times_s: &[f64], looks: &[bool]) -> Evidence {
    let mut evidence = Evidence::default();
    for (times_s, looks) in times_s.windows(2).zip(looks.windows(2)) {
        evidence.look(looks[0], looks[1], times_s[1] - times_s[0]);
    }
    evidence
}

/// Things with their mean stays, s, and their looks.
fn things(count: usize, times_s: &[f64]) -> Vec<([f64; 2], Vec<bool>)> {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let thing = || {
        let stays_s = stays_s(&mut rng);
        (stays_s, looks(stays_s, times_s, &mut rng))
    };
    repeat_with(thing).take(count).collect()
}

#[test]
fn rates_are_found_and_intervals_hold_them() {
    for (between_s, log_error) in [(0.0, 0.25), (50.0, 0.3), (230.0, 0.55), (890.0, 1.1)] {
        let times_s = times_s(between_s, 7200.0);
        let things = things(60, &times_s);
        let evidence: Vec<Evidence> = things.iter().map(|(_, looks)| evidence(&times_s, looks)).collect();
        let alone: Vec<Posterior> =
            evidence.iter().map(|evidence| Posterior::new(evidence, &Population::default())).collect();
        let population = Population::of(alone.iter());
        let (mut errors, mut inside) = (0.0, 0);
        for ((stays_s, _), evidence) in things.iter().zip(&evidence) {
            let (posterior, rate) = (Posterior::new(evidence, &population), 1.0 / (stays_s[0] + stays_s[1]));
            errors += libm::log(posterior.cycle_rate() / rate).abs() / things.len() as f64;
            let (low, high) = posterior.interval(0.9);
            inside += usize::from((low..=high).contains(&rate));
        }
        assert!(errors < log_error, "{between_s} s between looks: log error {errors}");
        assert!((50..=59).contains(&inside), "{between_s} s between looks: {inside} of 60 intervals");
    }
}

#[test]
fn states_are_predicted_almost_as_well_as_by_the_chain_itself() {
    let times_s = times_s(230.0, 10_800.0);
    let (mut own, mut chain) = (0.0, 0.0);
    for (stays_s, looks) in things(60, &times_s) {
        let known = looks.len() * 2 / 3;
        let posterior = Posterior::new(&evidence(&times_s[..known], &looks[..known]), &Population::default());
        for (now, later) in (known..looks.len()).step_by(21).zip((known + 21..looks.len()).step_by(21)) {
            let (elapsed_s, share) = (times_s[later] - times_s[now], stays_s[1] / (stays_s[0] + stays_s[1]));
            let fades = libm::exp(-elapsed_s * (1.0 / stays_s[0] + 1.0 / stays_s[1]));
            let [was, is] = [now, later].map(|look| f64::from(u8::from(looks[look])));
            own += (posterior.probability(looks[now], elapsed_s) - is).powi(2);
            chain += (share + (was - share) * fades - is).powi(2);
        }
    }
    assert!(own < 1.12 * chain, "{own} against {chain}");
}

#[test]
fn nothing_is_certain_and_the_order_of_gaps_does_not_count() {
    let gaps = [
        (true, false, 70.0),
        (false, false, 4.0),
        (false, true, 3000.0),
        (true, true, 9.0),
        (true, false, 71.0),
    ];
    let add = |gaps: &mut dyn Iterator<Item = &(bool, bool, f64)>| {
        let mut evidence = Evidence::default();
        gaps.for_each(|(before, after, length_s)| evidence.gap(*before, *after, *length_s));
        evidence
    };
    let [forth, back] = [add(&mut gaps.iter()), add(&mut gaps.iter().rev())];
    let [none, some] =
        [Evidence::default(), forth.clone()].map(|seen| Posterior::new(&seen, &Population::default()));
    assert_eq!(
        (forth.changes(), some.cycle_rate()),
        (3, Posterior::new(&back, &Population::default()).cycle_rate())
    );
    for posterior in [none, some] {
        assert_eq!([true, false].map(|was| posterior.probability(was, 0.0).round()), [1.0, 0.0]);
        for elapsed_s in [1.0, 100.0, 1e6, 1e9] {
            let [there, away] = [true, false].map(|was| posterior.probability(was, elapsed_s));
            assert!(0.0 < away && away <= there && there < 1.0, "{away} to {there} after {elapsed_s} s");
        }
        let (low, high) = posterior.interval(0.9);
        assert!(0.0 < low && low < posterior.cycle_rate() && posterior.cycle_rate() < high);
    }
}

#[test]
fn the_kernel_between_known_lengths_is_that_of_the_chains() {
    for length_s in [0.3, 2.6, 47.0, 63.9, 5000.0, 1e6] {
        for (before, after) in [(false, true), (true, false), (true, true)] {
            let mut evidence = Evidence::default();
            evidence.gap(before, after, length_s);
            for (found, [come, go]) in evidence.log_likelihood().into_iter().zip(super::chains()) {
                let (all, leave) = (come + go, if before { go } else { come });
                let changed = leave / all * (1.0 - libm::exp(-all * length_s));
                let expected = if before == after { 1.0 - changed } else { changed };
                assert!((libm::exp(found) - expected).abs() < 0.006, "{length_s} s: {found}");
            }
        }
    }
}

#[test]
fn a_look_fades_at_the_sum_of_the_rates_to_the_share_of_the_time() {
    let mut evidence = Evidence::default();
    for cycle in 0..2000 {
        let is_there = cycle % 2 == 0;
        let looks = if is_there { 15 } else { 45 };
        (0..looks).for_each(|_| evidence.look(is_there, is_there, 2.0));
        evidence.look(is_there, !is_there, 0.0);
    }
    let posterior = Posterior::new(&evidence, &Population::default());
    let (share, fading_hz) = posterior.share_and_fading();
    assert!(
        (share / 0.25 - 1.0).abs() < 0.3 && (fading_hz * 22.5 - 1.0).abs() < 0.3,
        "{share}, {fading_hz} Hz"
    );
    assert!((posterior.probability(true, 1e9) - share).abs() < 1e-6);
}

#[test]
fn a_cell_that_flickers_is_explained_by_its_thing_and_traffic_is_not() {
    // A thing that stays for an hour, twice; a cell of it that is missed for a moment every ten minutes; and people who pass.
    let stays = |stay_s: f64, changes: u32| {
        let mut evidence = Evidence::default();
        for change in 0..changes {
            let is_there = change % 2 == 0;
            let looks = if is_there { (stay_s / 2.0) as u32 } else { 1 };
            (0..looks).for_each(|_| evidence.look(is_there, is_there, 2.0));
            evidence.look(is_there, !is_there, 0.0);
        }
        evidence
    };
    let [thing, flickers, traffic, other] =
        [(3600.0, 4), (600.0, 24), (2.0, 24), (3600.0, 1)].map(|(stay_s, changes)| stays(stay_s, changes));
    assert_eq!(
        [&thing, &flickers, &traffic, &other].map(|cell| thing.explains(cell)),
        [true, true, false, false]
    );
}

/// By looking at what the prediction loses until the next look, with and without a look now.
#[test]
fn a_look_is_worth_what_it_takes_away_from_the_brier_score() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for between_s in [0.0, 50.0, 890.0] {
        let times_s = times_s(between_s, 3600.0);
        let looks = looks(stays_s(&mut rng), &times_s, &mut rng);
        let posterior = Posterior::new(&evidence(&times_s, &looks), &Population::default());
        for (was_there, elapsed_s) in [(false, 30.0), (true, 30.0), (false, 600.0), (true, 7200.0)] {
            let there = posterior.probability(was_there, elapsed_s);
            let (steps, mut fall) = (20_000, 0.0);
            for step in 0..steps {
                let later_s = elapsed_s * (f64::from(step) + 0.5) / f64::from(steps);
                let [seen_there, seen_away] = [true, false].map(|seen| posterior.probability(seen, later_s));
                let variance = |p: f64| p * (1.0 - p);
                let without = variance(there * seen_there + (1.0 - there) * seen_away);
                let with = there * variance(seen_there) + (1.0 - there) * variance(seen_away);
                fall += (without - with) * elapsed_s / f64::from(steps);
            }
            let found = posterior.fading().look_worth(was_there, elapsed_s);
            assert!(
                (found / fall - 1.0).abs() < 0.03,
                "{found} against {fall}, {between_s} s, {elapsed_s} s"
            );
        }
    }
}

#[test]
fn what_is_silent_for_long_changes_rarely() {
    let posterior = Posterior::new(&Evidence::default(), &Population::default());
    let mut before = (1.0, posterior.fading().probability(false, 600.0));
    for silent_s in [0.0, 60.0, 600.0, 3600.0, 86_400.0, 1e6] {
        let (fading, probability) = posterior.fading().after_silence(silent_s);
        let changed = fading.probability(false, 600.0);
        assert!(
            probability <= before.0 && changed <= before.1 + 1e-9,
            "{silent_s} s: {probability} {changed}"
        );
        before = (probability, changed);
    }
    assert!(before.0 < 0.1 && before.1 < 0.01, "{before:?}");
    assert_eq!(posterior.fading().after_silence(1e12).1, 0.0);
}
