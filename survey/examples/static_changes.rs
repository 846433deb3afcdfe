//! Changes where nothing can have changed: on cells that the laser hit in the first and in the last third of a log.
//!
//! A thing that came and went between counts as well, and so does a person who stood at the same place twice: the figure
//! is an upper bound of the false changes.
//!
//! ```text
//! cargo run -p survey --example static_changes -- LOG
//! ```

use interfaces::LaserReading;
use logs::{Log, TopicChoice};
use mapper::{Mapper, ReadingError};
use nalgebra::{Point2, Vector2};
use robot::explore;
use std::collections::BTreeSet;
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{FirstPass, FoundPoses, NoPilot, PoseMode, Replay, SurveySettings, frame, learned_noise_m};

fn main() -> Result<(), Box<dyn Error>> {
    let Some(file) = std::env::args().nth(1) else { return Err("usage: static_changes LOG".into()) };
    let log = Log::open(Path::new(&file), &TopicChoice::default())?;
    let mut settings = SurveySettings::of(PoseMode::Localized);
    let mut pass = FirstPass::new(&settings)?;
    for reading in log.readings()? {
        pass.add(reading?);
    }
    let sessions = [pass.finish()];
    if let Some(noise_m) = learned_noise_m(&sessions) {
        settings.mapper.steady.range_noise_std_m = noise_m;
    }
    let mut mapper = Mapper::new(&settings.mapper, frame(&sessions, &settings)?)?;

    let third_s = log.summary().duration_s / 3.0;
    let mut hit = [BTreeSet::new(), BTreeSet::new()];
    // What was hit is judged by the scans as they are: nothing is left out.
    for (reading, found) in log.readings()?.zip(&sessions[0].poses) {
        let reading = reading?;
        let part = match reading.time_s {
            time_s if time_s < third_s => 0,
            time_s if time_s > 2.0 * third_s => 1,
            _ => continue,
        };
        let cells = hits(&reading).filter(|at| at.coords.norm() < settings.max_range_m);
        hit[part]
            .extend(cells.filter_map(|at| mapper.frame().index(mapper.frame().cell_at(&(found.pose * at)))));
    }

    let readings = log.readings()?;
    let mut replay = Replay::new(readings, &settings, 0.0)?.ok_or("the log has no reading")?;
    let [session] = sessions;
    let scans = session.poses.len();
    let mut poses = FoundPoses::new(session.poses);
    explore(&mut replay, &mut poses, &mut mapper, &mut NoPilot, |replay, _, _, _| {
        Ok::<_, ReadingError>(if replay.is_over() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        })
    })?;

    let events = |index: usize| u64::from(mapper.statistics(index).events());
    let static_cells = hit[0].intersection(&hit[1]);
    let changes: u64 = static_cells.clone().map(|index| events(*index)).sum();
    let all: u64 = mapper.changed().map(events).sum();
    println!(
        "noise {:.3} m, {scans} scans, {all} changes of cells",
        settings.mapper.steady.range_noise_std_m
    );
    println!(
        "{changes} changes on {} static cells: {:.1} per 1000 scans",
        static_cells.count(),
        changes as f64 * 1000.0 / scans as f64
    );
    Ok(())
}

/// The points that a reading hit, in the frame of the robot, m.
fn hits(reading: &LaserReading) -> impl Iterator<Item = Point2<f64>> + '_ {
    let scan = &reading.scan;
    scan.ranges_m.iter().enumerate().filter(|(_, range_m)| range_m.is_finite()).map(|(beam, range_m)| {
        let along = interfaces::rotation(scan.angle_rad(beam)) * Vector2::new(f64::from(*range_m), 0.0);
        reading.mount * Point2::from(along)
    })
}
