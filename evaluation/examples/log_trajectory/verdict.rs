//! The verdict on the map along a trajectory.

use interfaces::{LaserReading, PoseMode};
use nalgebra::Isometry2;
use std::error::Error;
use survey::{FirstPass, SurveySettings};

/// Prints the verdict on the map of these scans, each with its pose; scans without a pose are left out.
pub(crate) fn print(
    name: &str,
    readings: &[LaserReading],
    poses: impl IntoIterator<Item = Option<Isometry2<f64>>>,
) -> Result<(), Box<dyn Error>> {
    let mut pass = FirstPass::new(&SurveySettings::of(PoseMode::Exact))?;
    for (reading, pose) in readings.iter().zip(poses) {
        if let Some(pose) = pose {
            pass.add(LaserReading { pose, ..reading.clone() });
        }
    }
    let quality = pass.finish().quality;
    println!(
        "map along {name}: {} ({:.3} of {} scans contradict, {:.3} of the worst stretch, {} weak links, {:.2} seen once)",
        quality.verdict().name(),
        quality.contradicting,
        quality.scans,
        quality.worst_stretch,
        quality.weak_links,
        quality.seen_once
    );
    Ok(())
}
