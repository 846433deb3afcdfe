//! Which parameters can be set while the node runs.

use super::Parameters;
use anyhow::bail;

/// When a parameter can be set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    /// At any time.
    Always,
    /// While the node is unconfigured: the map, the localization or the controller depend on it.
    Unconfigured,
    /// Before the node starts: its topics and services depend on it.
    Start,
}

/// Intervals: 0 switches something off, for which there are topics only if it is on at the start.
const SWITCHES: [&str; 2] = ["mask_update_interval", "transform_publish_period"];

impl Parameters {
    /// When a parameter can be set.
    pub(crate) fn when(name: &str) -> When {
        match name {
            "map_update_interval"
            | "change_horizon"
            | "prediction_horizon"
            | "mask_update_interval"
            | "route_update_interval"
            | "transform_publish_period"
            | "transform_timeout" => When::Always,
            "pose" | "laser_frame" | "map_frame" | "odom_frame" | "base_frame" | "resolution"
            | "map_size" | "max_laser_range" | "no_return" | "range_noise" | "lost_after"
            | "robot_radius" | "max_vel_x" | "max_vel_theta" | "acc_lim_x" | "acc_lim_theta" | "strategy"
            | "purpose" | "seed" => When::Unconfigured,
            _ => When::Start,
        }
    }

    /// Checks whether the node can go from other parameters to these.
    ///
    /// # Errors
    ///
    /// When one cannot be set now: one sentence.
    pub(crate) fn check_change(&self, from: &Self, is_unconfigured: bool) -> anyhow::Result<()> {
        let (mut now, before) = (self.clone(), from.list());
        for ((name, old), (_, slot)) in before.iter().zip(now.slots()) {
            let new = slot.get();
            if new == *old {
                continue;
            }
            match Self::when(name) {
                When::Always if SWITCHES.contains(&name.as_str()) && is_zero(&new) != is_zero(old) => {
                    bail!(
                        "the parameter `{name}` is {old}: a value of 0, or another one after 0, is possible when the node starts"
                    );
                }
                When::Always => {}
                When::Unconfigured if is_unconfigured => {}
                When::Unconfigured => {
                    bail!(
                        "the parameter `{name}` can be set while the node is unconfigured: before, deactivate it and clean it up"
                    );
                }
                When::Start => bail!("the parameter `{name}` can be set when the node starts"),
            }
        }
        Ok(())
    }
}

fn is_zero(value: &crate::value::Value) -> bool {
    matches!(value, crate::value::Value::Float(value) if *value == 0.0)
}
