//! The files of a run.

use crate::Ended;
use crate::args::{Args, DriveChoice};
use build_id::BUILD;
use curious::program::arguments;
use evaluation::physics_trial::{PhysicsSettings, PhysicsTrial};
use evaluation::summary::{SCHEMA, Summary};
use interfaces::Twist;
use mapper::Mapper;
use results::cell_statistics;
use results::output::{RunFolder, write_file};
use results::ros_map;
use results::thinned::Goals;
use robot::Pilot;
use viewer::layers::Layer;
use viewer::show::Show;

/// The file that ends a run.
const SUMMARY: &str = "summary.json";

/// Writes everything except the recording and the moving picture: no result is lost for them.
pub(crate) fn write(
    folder: &RunFolder,
    mapper: &Mapper,
    show: &Show,
    goals: &Goals,
    summary: &mut Summary,
) -> anyhow::Result<()> {
    let to = folder.unfinished();
    show.write_pictures(to, mapper, goals, &Layer::ALL)?;
    let map = mapper.states();
    write_file(&to.join("map.pgm"), |file| file.write_all(&ros_map::pgm(map)))?;
    write_file(&to.join("map.yaml"), |file| write!(file, "{}", ros_map::yaml(map.frame(), "map.pgm")))?;
    cell_statistics::write(&to.join("cell_statistics.csv"), mapper)?;
    summary.files = folder.results()?;
    let text = serde_json::to_string_pretty(summary)?;
    write_file(&to.join(SUMMARY), |file| writeln!(file, "{text}"))?;
    Ok(())
}

pub(crate) fn summary(
    args: &Args,
    settings: &PhysicsSettings,
    trial: &PhysicsTrial<impl Pilot<Command = Twist>>,
    ended: Ended,
    began_s: f64,
    wall_s: f64,
) -> Summary {
    let simulated_s = trial.mapper.time();
    Summary {
        schema: SCHEMA,
        build: BUILD,
        version: env!("CARGO_PKG_VERSION"),
        arguments: arguments(),
        settings: serde_json::to_value(settings).unwrap_or_default(),
        world: trial.world.spec().name.clone(),
        seed: args.seed,
        drive: args.drive.name(),
        strategy: (args.drive == DriveChoice::Agent).then(|| args.strategy().name()),
        estimator: args.estimator.name(),
        occupancy: args.occupancy.name(),
        ended_by: match ended {
            Ended::Duration => "duration",
            Ended::Pilot if args.drive == DriveChoice::Tour => "tour",
            Ended::Pilot => "person",
            Ended::Interrupted => "interrupted",
        },
        simulated_s,
        wall_s,
        real_time_factor: (simulated_s - began_s) / wall_s.max(f64::MIN_POSITIVE),
        files: Vec::new(),
        results: trial.results(),
    }
}
