//! The parameters as the settings of the parts of a robot.

use crate::parameters::Parameters;
use anyhow::Context;
use interfaces::GridFrame;
use localizer::Switch;
use nalgebra::Point2;
use survey::SurveySettings;

/// With a simulated clock, the map that a closed loop has corrected replaces the old one after this number of readings.
const SWITCH_READINGS: usize = 50;

/// When a corrected map replaces the old one.
pub(super) fn switch(parameters: &Parameters) -> Switch {
    match &parameters.switch_at {
        readings if !readings.is_empty() => Switch::At(readings.clone()),
        _ if parameters.use_sim_time => Switch::After(SWITCH_READINGS),
        _ => Switch::WhenReady,
    }
}

/// The settings of the mapper, and what is left out of scans.
pub(super) fn settings(parameters: &Parameters) -> SurveySettings {
    let mut settings = SurveySettings {
        resolution_m: parameters.resolution_m,
        max_range_m: parameters.max_laser_range_m,
        ..SurveySettings::of(parameters.pose)
    };
    settings.mapper.steady.range_noise_std_m = parameters.range_noise_m;
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
