//! The parameters as the settings of a robot.

use crate::parameters::Parameters;
use anyhow::Context;
use controller::DiffDriveSettings;
use interfaces::GridFrame;
use localizer::Switch;
use nalgebra::Point2;
use robot::{Settings, Source};

/// With a simulated clock, the map that a closed loop has corrected replaces the old one after this number of readings.
const SWITCH_READINGS: usize = 50;

/// The settings of the robot, from what the parameters say of it.
pub(crate) fn settings(parameters: &Parameters) -> Settings {
    let mut settings = Settings::of(&Source {
        pose: parameters.pose,
        cell_m: parameters.resolution_m,
        range_max_m: parameters.max_laser_range_m,
        range_noise_m: Some(parameters.range_noise_m),
        no_return: parameters.no_return,
        drive: DiffDriveSettings {
            radius_m: parameters.robot_radius_m,
            max_linear_mps: parameters.max_vel_x_mps,
            max_angular_radps: parameters.max_vel_theta_radps,
            acceleration_mps2: parameters.acc_lim_x_mps2,
            angular_acceleration_radps2: parameters.acc_lim_theta_radps2,
            ..DiffDriveSettings::default()
        },
        ..Source::default()
    });
    settings.localizer.lost_after_s = parameters.lost_after_s;
    settings.switch = match &parameters.switch_at {
        readings if !readings.is_empty() => Switch::At(readings.clone()),
        _ if parameters.use_sim_time => Switch::After(SWITCH_READINGS),
        _ => Switch::WhenReady,
    };
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
