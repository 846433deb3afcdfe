//! The difference to poses of an earlier estimation, and which of both trajectories makes the sharper map.

use crate::alignment::alignment;
use evaluation::metrics::quantile;
use interfaces::{LaserReading, heading_rad, wrap_rad};
use localizer::Trajectory;
use logs::{Log, LogError};
use nalgebra::Isometry2;
use std::collections::BTreeSet;

/// A pose of ours and that of the earlier estimation.
type Pair = (Isometry2<f64>, Isometry2<f64>);

/// The side of the cells in which points are counted, m, and the largest range of these points, m.
const CELL_M: f64 = 0.03;
const FARTHEST_M: f64 = 15.0;

/// Prints the differences of position and heading after a rigid alignment, if the log has poses of the laser.
pub(crate) fn print(log: &Log, trajectory: &Trajectory, readings: &[LaserReading]) -> Result<(), LogError> {
    let Some(reference) = log.reference_poses()? else { return Ok(()) };
    let pairs: Vec<Pair> = trajectory
        .poses
        .iter()
        .zip(readings)
        .zip(reference)
        .filter_map(|((found, reading), reference)| Some((found.pose * reading.mount, reference?)))
        .collect();
    if pairs.is_empty() {
        return Ok(());
    }
    let position = |at: &Isometry2<f64>| at.translation.vector;
    let positions: Vec<_> =
        pairs.iter().map(|(found, reference)| (position(found), position(reference))).collect();
    let align = alignment(&positions);
    let errors = pairs.iter().map(|(found, reference)| {
        let found = align * found;
        let turn_rad = wrap_rad(heading_rad(&found) - heading_rad(reference));
        ((found.translation.vector - reference.translation.vector).norm(), turn_rad.abs().to_degrees())
    });
    let (positions_m, headings_deg): (Vec<f64>, Vec<f64>) = errors.unzip();
    let quantiles =
        |errors: &[f64]| [0.5, 0.95, 1.0].map(|share| quantile(errors, share).expect("there is a pair"));
    let ([median_m, p95_m, max_m], [median_deg, p95_deg, max_deg]) =
        (quantiles(&positions_m), quantiles(&headings_deg));
    println!(
        "against the poses in the FLASER lines, median / 95 % / max: {:.1} / {:.1} / {:.1} cm, {median_deg:.2} / {p95_deg:.2} / \
         {max_deg:.2}°",
        median_m * 100.0,
        p95_m * 100.0,
        max_m * 100.0
    );
    if pairs.len() == readings.len() {
        let ours = cells(pairs.iter().map(|pair| pair.0), readings);
        let theirs = cells(pairs.iter().map(|pair| pair.1), readings);
        println!(
            "sharpness: the points lie in {ours} cells of {CELL_M} m, along the poses in the FLASER lines in {theirs}"
        );
    }
    Ok(())
}

/// The number of cells that contain points, from poses of the laser: a blurred map has more.
fn cells(poses: impl Iterator<Item = Isometry2<f64>>, readings: &[LaserReading]) -> usize {
    let mut cells = BTreeSet::new();
    for (pose, reading) in poses.zip(readings) {
        let from_laser = pose * reading.mount.inverse();
        let near = reading.hits().filter(|hit| hit.coords.norm() < FARTHEST_M);
        cells.extend(near.map(|hit| {
            let at = (from_laser * hit) / CELL_M;
            (at.x.floor() as i32, at.y.floor() as i32)
        }));
    }
    cells.len()
}
