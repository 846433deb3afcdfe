//! How well a robot knows things that come and go while it is elsewhere (`evaluation::known_things`). A line per world with the seed 1,
//! and one for all things: the Brier score now, 1 and 10 minutes ahead, divided by that of the nominal chains and by the floor; in
//! parentheses that of the state last seen, divided by that of the nominal chains. Then log error and share inside of the 90 % interval,
//! of the map and of the floor.
//!
//! ```text
//! cargo run -p curious-evaluation --example behind_back -- MINUTES WORLD..
//! cargo run -p curious-evaluation --example behind_back -- 120 rooms-1 rooms-2
//! ```

use agent::Policy;
use evaluation::known_things::{KnownThing, KnownThingsScores, ThingBrier};
use evaluation::physics_trial::{self, PhysicsTrial};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [minutes, worlds @ ..] = &arguments[..] else {
        return Err("usage: behind_back MINUTES WORLD..".into());
    };
    let end_s = 60.0 * minutes.parse::<f64>()?;
    let mut all = Vec::new();
    for world in worlds {
        let spec = worldfile::shipped::load(world)?;
        let settings = physics_trial::settings(&spec)?;
        let pilot = settings.pilot(settings.agent(&Policy::default(), 1)?, 1)?;
        let mut trial = PhysicsTrial::new(&spec, 1, &settings, None, pilot)?;
        trial.run(end_s)?;
        let rows = trial.observer.known_things.rows(&trial.world, &trial.robot.mapper);
        report(world, &rows);
        all.extend(rows);
    }
    report("all", &all);
    Ok(())
}

fn report(name: &str, rows: &[KnownThing]) {
    let Some(KnownThingsScores { things, objects, all, log_error, inside_90, .. }) =
        KnownThingsScores::of(rows)
    else {
        return println!("{name}: nothing was seen");
    };
    let horizon = |scores: Option<ThingBrier>| {
        scores.map_or_else(String::new, |ThingBrier { brier, by_nominal, by_floor, last_seen_by_nominal }| {
            format!("{brier:.4} ÷ nominal {by_nominal:.3} ÷ floor {by_floor:.3} ({last_seen_by_nominal:.3})")
        })
    };
    let [now, in_1min, in_10min] = [all.now, all.in_1min, all.in_10min].map(horizon);
    let numbers = |of: [Option<f64>; 2]| {
        of.map(|number| number.map_or("–".into(), |number| format!("{number:.3}"))).join(", ")
    };
    println!(
        "{name}: {things} things, {objects} objects; now {now}; 60 s {in_1min}; 600 s {in_10min}; log error {}; inside {}",
        numbers(log_error),
        numbers(inside_90)
    );
}
