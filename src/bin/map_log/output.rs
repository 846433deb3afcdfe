//! The files of a survey.

use crate::report;
use crate::second_pass::Learned;
use crate::summary::Summary;
use anyhow::Context;
use nalgebra::{Point2, Vector2};
use results::intervals::Intervals;
use results::output::{RunFolder, write_file};
use results::thinned::Thinned;
use results::{cell_statistics, raster, ros_map, things};
use survey::{MASKS, Survey, Verdict, masks, permanent};
use viewer::layers::Layer;
use viewer::pictures::draw_places;

/// The file that ends a run.
const SUMMARY: &str = "summary.json";

/// The box that marks a place in doubt.
fn around(at: &Point2<f64>) -> [Point2<f64>; 2] {
    [-0.5, 0.5].map(|by_m| at + Vector2::new(by_m, by_m))
}

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
    let corner = |at: &[f64; 2]| Point2::new(at[0], at[1]);
    let numbered: Vec<_> =
        summary.places.iter().map(|place| [corner(&place.low_m), corner(&place.high_m)]).collect();
    draw_places(&to.join("places.png"), "Where it changes", mapper, &numbered)?;
    let doubts = survey.logs().iter().flat_map(|log| &log.quality.doubts);
    let in_doubt: Vec<_> = doubts.map(|doubt| around(&Point2::new(doubt.x_m, doubt.y_m))).collect();
    if summary.verdict != Verdict::Good {
        draw_places(&to.join("doubts.png"), "Where the map is in doubt", mapper, &in_doubt)?;
    }
    for (name, map) in [("map", mapper.states()), ("permanent", &permanent(mapper))] {
        ros_map::write(to, name, map)?;
    }
    if has_rates {
        for (name, mask) in MASKS.iter().zip(masks(mapper)) {
            ros_map::write_mask(to, name, &mask)?;
        }
        let intervals = Intervals::of(mapper);
        cell_statistics::write(&to.join("cell_statistics.csv"), mapper, &intervals)?;
        raster::write(&to.join("layers.npy"), mapper, &intervals)?;
        things::write(&to.join("things.json"), mapper)?;
    }
    let page = report::page(summary, mapper);
    write_file(&to.join("report.html"), |file| file.write_all(page.as_bytes()))?;
    summary.files = folder.results()?;
    let text = serde_json::to_string_pretty(summary)?;
    write_file(&to.join(SUMMARY), |file| writeln!(file, "{text}"))?;
    Ok(())
}
