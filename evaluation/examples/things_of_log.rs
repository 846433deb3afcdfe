//! The doors and the furniture that the map of a log has: `cargo run -p curious-evaluation --example things_of_log -- LOG..`

use interfaces::PoseMode;
use logs::{Log, TopicChoice};
use mapper::{Thing, ThingKind};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use survey::{LogEntry, Survey, SurveySettings};

fn main() -> Result<(), Box<dyn Error>> {
    for file in std::env::args().skip(1) {
        let log = Log::open(Path::new(&file), &TopicChoice::default())?;
        let pose = if log.summary().stands { PoseMode::Exact } else { PoseMode::Localized };
        let mut survey = Survey::new(SurveySettings::of(pose), true);
        let entry = LogEntry::of(file.clone(), &log, &TopicChoice::default())?;
        survey.first_pass(&log, entry, true, |_| ControlFlow::Continue(()))?;
        let mut replay = survey.replay(0, &log)?.ok_or("the log has no reading")?;
        while survey.turn(&mut replay)?.is_some() {}
        let mapper = survey.mapper().ok_or("the log has no reading")?;
        let (readings, changed) = (mapper.readings(), mapper.changed().count());
        println!(
            "{file}: {readings} readings, {:.0} s, {changed} cells that changed, {} things",
            mapper.time(),
            mapper.things().len()
        );
        mapper.things().iter().for_each(|thing| println!("  {}", text(thing)));
    }
    Ok(())
}

fn text(thing: &Thing) -> String {
    match &thing.kind {
        ThingKind::Door(door) => {
            let [a, b] = door.closed.ends;
            let found_s = thing.found_s;
            format!("door {a:.2} to {b:.2}, {:?}, found at {found_s:.0} s, {:?}", door.leaf, door.statistics)
        }
        ThingKind::Furniture(furniture) => {
            let places = [&furniture.from, &furniture.to].map(|place| {
                let place = place.as_ref();
                place.map_or("–".to_owned(), |place| {
                    format!("{:.2} at {:.0?} s", place.center, place.between_s)
                })
            });
            format!("furniture from {} to {}", places[0], places[1])
        }
    }
}
