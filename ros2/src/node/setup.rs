//! From the parameters to the parts of the node.

use crate::message::Time;
use crate::node_state_file::NodeStateFile;
use crate::notes::Notes;
use crate::parameters::Parameters;
use crate::pilot::LivePilot;
use crate::source::FrameNames;
use anyhow::Context;
use controller::DiffDriveSettings;
use interfaces::{GridFrame, LaserReading};
use localizer::Switch;
use nalgebra::{Isometry2, Point2};
use robot::state::StateFile;
use robot::{Robot, Settings, Source};

/// With a simulated clock, the map that a closed loop has corrected replaces the old one after this number of readings.
const SWITCH_READINGS: usize = 50;

/// What the parameters say, and what was learned in earlier runs.
pub(super) struct Parts {
    pub(super) robot: Robot<LaserReading, LivePilot>,
    pub(super) state_file: Option<NodeStateFile>,
    /// The time of the last reading of the state that was loaded.
    pub(super) continued: Option<Time>,
}

impl Parts {
    /// The parts; what was learned is loaded from `state`.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, or when the state cannot be used.
    pub(super) fn new(
        parameters: &Parameters,
        state: Option<StateFile>,
        notes: &mut Notes,
    ) -> anyhow::Result<Self> {
        parameters.check()?;
        let (settings, frame) = (settings(parameters), frame(parameters)?);
        let pilot = LivePilot::new(parameters, &settings)?;
        let mut file = state.map(|file| NodeStateFile::new(file, &settings, parameters)).transpose()?;
        let saved = file.as_mut().map(NodeStateFile::load).transpose()?.flatten();
        let map = saved.as_ref().and_then(|state| state.map.as_ref());
        let frame = map.and_then(|map| map.frame.union(&frame)).unwrap_or(frame);
        let mut robot = settings.robot(frame, None, Isometry2::identity(), pilot)?;
        let continued = match (&mut file, saved) {
            (Some(file), Some(state)) => Some(file.restore(state, &mut robot, notes)?),
            _ => None,
        };
        Ok(Self { robot, state_file: file, continued })
    }
}

/// The frames of the robot.
pub(super) fn frames(parameters: &Parameters) -> FrameNames {
    let Parameters { map_frame: map, odom_frame: odom, base_frame: base, laser_frame: laser, .. } =
        parameters.clone();
    FrameNames { map, odom, base, laser, are_connected: parameters.transform_publish_period_s > 0.0 }
}

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
    settings.switch =
        if parameters.use_sim_time { Switch::After(SWITCH_READINGS) } else { Switch::WhenReady };
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
