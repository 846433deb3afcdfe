//! What a run leaves behind.

use crate::Ended;
use crate::args::{Args, DriveChoice};
use crate::parts::Settings;
use curious::pictures::{self, Pictures};
use curious::show::PhysicsShow;
use evaluation::cell_statistics;
use evaluation::map_hash::map_hash;
use evaluation::metrics;
use evaluation::observer::Observer;
use evaluation::output::write_file;
use evaluation::summary::{Liveliest, Summary};
use interfaces::Twist;
use mapper::Mapper;
use robot::Pilot;
use sim::physics::PhysicsWorld;
use std::path::Path;
use worldfile::ros_map;

/// Writes everything but the recording, which is written while the run goes on.
pub(crate) fn write(
    folder: &Path,
    world: &PhysicsWorld,
    mapper: &Mapper,
    show: &PhysicsShow,
    observer: &Observer,
    summary: &Summary,
) -> anyhow::Result<()> {
    let (trails, goals) = (show.trails(), observer.goals());
    let scene = &PhysicsShow::scene(world);
    pictures::write_all(folder, &Pictures { scene, mapper, trails, goals })?;
    let map = mapper.states();
    write_file(&folder.join("map.pgm"), |file| file.write_all(&ros_map::pgm(map)))?;
    write_file(&folder.join("map.yaml"), |file| write!(file, "{}", ros_map::yaml(map.frame(), "map.pgm")))?;
    cell_statistics::write(&folder.join("cell_statistics.csv"), mapper)?;
    let text = serde_json::to_string_pretty(summary)?;
    write_file(&folder.join("summary.json"), |file| writeln!(file, "{text}"))?;
    Ok(())
}

#[allow(clippy::too_many_arguments)] // everything that a run was made of
pub(crate) fn summary(
    args: &Args,
    settings: &Settings,
    world: &PhysicsWorld,
    mapper: &Mapper,
    pilot: &impl Pilot<Command = Twist>,
    observer: &Observer,
    ended: Ended,
    wall_s: f64,
) -> Summary {
    let scores = metrics::map_scores(mapper, world.truth());
    let findings = observer.findings();
    let moving = world.contacts().iter().filter(|contact| contact.moving).count();
    let is_agent = args.drive == DriveChoice::Agent;
    Summary {
        version: env!("CARGO_PKG_VERSION"),
        arguments: std::env::args().skip(1).collect(),
        settings: serde_json::to_value(settings).unwrap_or_default(),
        world: world.spec().name.to_owned(),
        seed: args.seed,
        drive: match args.drive {
            DriveChoice::Agent => "agent",
            DriveChoice::Keyboard => "keyboard",
            DriveChoice::Tour => "tour",
        },
        strategy: is_agent.then(|| args.strategy.name()),
        estimator: args.estimator.name(),
        occupancy: args.occupancy.name(),
        ended_by: match ended {
            Ended::Duration => "duration",
            Ended::Pilot if args.drive == DriveChoice::Tour => "tour",
            Ended::Pilot => "person",
            Ended::Interrupted => "interrupted",
        },
        simulated_s: mapper.time(),
        wall_s,
        real_time_factor: mapper.time() / wall_s.max(f64::MIN_POSITIVE),
        coverage: scores.coverage,
        map_quality: scores.map_quality,
        map_quality_changing: findings.map_quality_changing.in_view,
        map_quality_changing_out_of_view: findings.map_quality_changing.out_of_view,
        rates: metrics::rate_scores(mapper, world.truth()),
        age: metrics::age(mapper, world.truth()),
        block_latency: findings.block_latency,
        free_latency: findings.free_latency,
        collisions: moving,
        contacts_while_standing: world.contacts().len() - moving,
        goals: pilot.goals(),
        strategy_share: pilot
            .strategies(Default::default())
            .iter()
            .map(|s| (s.name.clone(), s.share))
            .collect(),
        things: findings.things,
        curve: findings.curve,
        map_hash: map_hash(mapper),
        liveliest: Liveliest::of(mapper),
    }
}
