//! The parameters as the settings of the parts of a robot.

use crate::parameters::{Parameters, PoseSource};
use anyhow::Context;
use interfaces::GridFrame;
use nalgebra::Point2;
use survey::{PoseMode, SurveySettings};

/// The settings of the mapper, and what is left out of scans.
pub(super) fn settings(parameters: &Parameters) -> SurveySettings {
    let mode = match parameters.pose {
        PoseSource::Exact => PoseMode::Exact,
        PoseSource::Odometry => PoseMode::Odometry,
        PoseSource::Localized => PoseMode::Localized,
    };
    let mut settings = SurveySettings { resolution_m: parameters.resolution_m, ..SurveySettings::of(mode) };
    settings.filter.max_range_m = parameters.max_laser_range_m;
    settings.filter.no_return = parameters.no_return;
    settings.set_noise(parameters.range_noise_m);
    settings
}

/// The cells of the map. Its center is where the robot starts, or where the odometry is 0.
pub(super) fn frame(parameters: &Parameters) -> anyhow::Result<GridFrame> {
    let Parameters { map_size_m: size_m, resolution_m, .. } = *parameters;
    let half_cells = (size_m / 2.0 / resolution_m).ceil();
    let origin = Point2::new(-half_cells * resolution_m, -half_cells * resolution_m);
    let cells = 2 * half_cells as usize;
    let frame = GridFrame::new(origin, resolution_m, cells, cells);
    frame.with_context(|| format!("a map of {cells} × {cells} cells is too large: reduce `map_size`"))
}
