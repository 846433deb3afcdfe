//! The files of a survey.

use crate::passes::Learned;
use crate::report;
use crate::summary::Summary;
use anyhow::Context;
use draw::layers::Layer;
use files::{RunFolder, write_file};
use results::thinned::Thinned;
use results::{cell_statistics, ros_map, things};
use survey::{MASKS, Survey, masks, permanent};

/// The page for people.
pub(crate) const PAGE: &str = "report.html";
/// The file that ends a run.
const SUMMARY: &str = "summary.json";

/// Writes everything except the recording and the trajectory.
pub(crate) fn write(
    folder: &RunFolder,
    survey: &Survey,
    learned: &Learned,
    summary: &mut Summary,
) -> anyhow::Result<()> {
    let mapper = survey.mapper().context("nothing was learned")?;
    let to = folder.unfinished();
    let has_rates = summary.rates_withheld.is_none();
    let layers: &[Layer] = if has_rates { &Layer::ALL } else { &[Layer::Occupancy] };
    learned.show.write_pictures(to, mapper, &Thinned::default(), layers)?;
    for (name, map) in [("map", mapper.states()), ("permanent", &permanent(mapper))] {
        ros_map::write(to, name, map)?;
    }
    if has_rates {
        for (name, mask) in MASKS.iter().zip(masks(mapper)) {
            ros_map::write_mask(to, name, &mask)?;
        }
        cell_statistics::write(&to.join("cell_statistics.csv"), mapper)?;
        things::write(&to.join("things.json"), mapper)?;
    }
    let page = report::page(summary, mapper);
    write_file(&to.join(PAGE), |file| file.write_all(page.as_bytes()))?;
    summary.files = folder.results()?;
    let text = serde_json::to_string_pretty(summary)?;
    write_file(&to.join(SUMMARY), |file| writeln!(file, "{text}"))?;
    Ok(())
}
