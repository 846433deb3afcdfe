//! A thousand looks at a thing, and as many predictions of it. The work per look does not grow with the number of looks.

use divan::Bencher;
use mapper::{Calendar, Clock, Look};

const LOOKS: u32 = 1000;

fn main() {
    divan::main();
}

/// A clock after four weeks of looks, one per minute, of a thing that changes every ten minutes or so.
fn clock() -> (Clock, f64) {
    let mut clock = Clock::default();
    let looks = 28 * 1440;
    for step in 0..looks {
        clock.observe(look(60.0 * f64::from(step), step), &Calendar::UTC);
    }
    (clock, 60.0 * f64::from(looks))
}

fn look(time_s: f64, step: u32) -> Look {
    Look { time_s, is_blocked: (step / 10 % 7).is_multiple_of(2) }
}

/// Looks at these intervals, s.
#[divan::bench(args = [0.1, 60.0, 3600.0])]
fn looks(bencher: Bencher<'_, '_>, every_s: f64) {
    let (clock, start_s) = clock();
    bencher.with_inputs(|| clock.clone()).bench_local_refs(|clock| {
        for step in 0..LOOKS {
            clock.observe(look(start_s + every_s * f64::from(step), step), &Calendar::UTC);
        }
    });
}

/// Predictions of the next week.
#[divan::bench]
fn predictions(bencher: Bencher<'_, '_>) {
    let (clock, start_s) = clock();
    bencher.bench_local(|| {
        let ahead =
            (0..LOOKS).map(|step| clock.probability(start_s + 600.0 * f64::from(step), &Calendar::UTC));
        ahead.sum::<f64>()
    });
}
