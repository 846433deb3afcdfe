//! The parameters of the mapping node, named as those of `slam_toolbox` and Nav2 where these have them.

mod choices;

pub(crate) use choices::{Mode, Navigator, When};

use crate::value::{Given, Value};
use agent::Policy;
use anyhow::{anyhow, bail};
use choices::Slot;
use interfaces::{PoseMode, SettingsCheck};
use mapper::NoReturn;

/// What is said of a value that a parameter cannot have.
fn invalid(name: &str, expected: &str, found: &Value) -> anyhow::Error {
    anyhow!("the parameter `{name}` must be {expected}, not `{found}`")
}

fn unknown(name: &str, known: String, found: &str) -> anyhow::Error {
    anyhow!("the parameter `{name}` must be one of {known}, not `{found}`")
}

fn is_zero(value: &Value) -> bool {
    matches!(value, Value::Float(value) if *value == 0.0)
}

/// Defines the parameters in one table: documentation, name, when it can be set, field, type and default.
macro_rules! parameters {
    ($($(#[doc = $doc:literal])* $when:ident $name:literal, $field:ident: $kind:ty = $default:expr;)*) => {
        /// All parameters.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Parameters {
            $($(#[doc = $doc])* pub $field: $kind,)*
        }

        impl Default for Parameters {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl Parameters {
            /// What a parameter means; empty if there is no such parameter.
            pub fn about(name: &str) -> &'static str {
                match name {
                    $($name => concat!($($doc),*).trim_ascii_start(),)*
                    _ => "",
                }
            }

            /// When a parameter can be set.
            pub(crate) fn when(name: &str) -> When {
                match name {
                    $($name => When::$when,)*
                    _ => When::Start,
                }
            }

            /// The parameters by name.
            fn slots(&mut self) -> Vec<(&'static str, &mut dyn Slot)> {
                vec![$(($name, &mut self.$field),)*]
            }
        }
    };
}

parameters! {
    /// What the node does.
    Start "mode", mode: Mode = Mode::Map;
    /// What drives the robot to goals.
    Start "navigator", navigator: Navigator = Navigator::CmdVel;
    /// How the pose is known.
    Unconfigured "pose", pose: PoseMode = PoseMode::Localized;
    /// The frame of the map.
    Unconfigured "map_frame", map_frame: String = "map".to_owned();
    /// The frame of the odometry.
    Unconfigured "odom_frame", odom_frame: String = "odom".to_owned();
    /// The frame of the robot.
    Unconfigured "base_frame", base_frame: String = "base_footprint".to_owned();
    /// The frame of the laser in use, where more than one sends; empty: the first one.
    Unconfigured "laser_frame", laser_frame: String = String::new();
    /// The topic of the scans.
    Start "scan_topic", scan_topic: String = "/scan".to_owned();
    /// For a robot whose odometry is not in tf.
    Start "odom_topic", odom_topic: String = "odom".to_owned();
    /// The folder in and below which the services `save_map` and `serialize_map` write.
    Start "map_folder", map_folder: String = ".".to_owned();
    /// The side of a cell, m.
    Unconfigured "resolution", resolution_m: f64 = 0.05;
    /// The sides of the map, whose center is where the robot starts, m.
    Unconfigured "map_size", map_size_m: f64 = 40.0;
    /// Longer ranges are not used, m.
    Unconfigured "max_laser_range", max_laser_range_m: f64 = 20.0;
    /// What beams without a return mean.
    Unconfigured "no_return", no_return: NoReturn = NoReturn::default();
    /// The standard deviation of ranges, m.
    Unconfigured "range_noise", range_noise_m: f64 = 0.02;
    /// The time between two maps, s.
    Always "map_update_interval", map_update_interval_s: f64 = 5.0;
    /// How far ahead the map of changes looks, s.
    Always "change_horizon", change_horizon_s: f64 = 60.0;
    /// How far ahead the predicted map and the keepout mask look, s; 0: now.
    Always "prediction_horizon", prediction_horizon_s: f64 = 0.0;
    /// The time between two masks for Nav2, s; 0: none.
    Always "mask_update_interval", mask_update_interval_s: f64 = 30.0;
    /// A graph of routes in the GeoJSON of `nav2_route`, whose edges are adjusted; empty: none.
    Start "route_graph", route_graph: String = String::new();
    /// The service of `nav2_route` that adjusts edges: its node, its scorer, `adjust_edges`.
    Start "route_edges_service", route_edges_service: String = "route_server/DynamicEdgesScorer/adjust_edges".to_owned();
    /// The time between two requests with all edges, s.
    Always "route_update_interval", route_update_interval_s: f64 = 10.0;
    /// The time between two transforms from map to odometry, s; 0: none.
    Always "transform_publish_period", transform_publish_period_s: f64 = 0.02;
    /// How long a transform holds after the last reading, s.
    Always "transform_timeout", transform_timeout_s: f64 = 0.2;
    /// The time without an agreeing scan after which the robot is lost, s.
    Unconfigured "lost_after", lost_after_s: f64 = 2.0;
    /// Whether velocities are `TwistStamped`, as Nav2 has it since Kilted, or `Twist`.
    Start "enable_stamped_cmd_vel", enable_stamped_cmd_vel: bool = true;
    /// Radius of the robot, m.
    Unconfigured "robot_radius", robot_radius_m: f64 = 0.22;
    /// Maximum velocity, m/s.
    Unconfigured "max_vel_x", max_vel_x_mps: f64 = 0.26;
    /// Maximum angular velocity, rad/s.
    Unconfigured "max_vel_theta", max_vel_theta_radps: f64 = 1.0;
    /// Maximum acceleration, m/s².
    Unconfigured "acc_lim_x", acc_lim_x_mps2: f64 = 2.5;
    /// Maximum angular acceleration, rad/s².
    Unconfigured "acc_lim_theta", acc_lim_theta_radps2: f64 = 3.2;
    /// How goals are selected, by the name of a strategy; empty: `curious`.
    Unconfigured "strategy", strategy: String = String::new();
    /// Whether the node begins to work when it starts; otherwise it waits for a lifecycle manager, unconfigured.
    Start "autostart", autostart: bool = true;
    /// The seed of the random decisions.
    Unconfigured "seed", seed: i64 = 1;
    /// Whether the clock is simulated: then a corrected map replaces the old one after a fixed number of readings, and not
    /// when it is ready. All times are those of the messages.
    Start "use_sim_time", use_sim_time: bool = false;
    /// The memory of the program at which it ends, MiB: the network can ask the library for any amount.
    Start "memory_limit", memory_limit_mib: f64 = 1024.0;
    /// `best_effort` or `reliable`.
    Start "qos_overrides./scan.subscription.reliability", scan_reliability: String = "best_effort".to_owned();
}

/// Intervals: 0 switches something off, for which there are topics only if it is on at the start.
const SWITCHES: [&str; 2] = ["mask_update_interval", "transform_publish_period"];
/// The longest name of a frame, bytes.
const MAX_FRAME: usize = 255;
/// The longest horizon, s.
const DAY_S: f64 = 86400.0;

impl Parameters {
    /// Sets a parameter.
    ///
    /// # Errors
    ///
    /// When there is no such parameter, or when it has no such value. Ranges are checked by [`check`](Self::check).
    pub fn set(&mut self, name: &str, value: &Value) -> anyhow::Result<()> {
        let set = self.slot(name)?.set(value);
        set.map_err(|expected| invalid(name, expected, value))
    }

    /// All parameters with their values.
    pub fn list(&self) -> Vec<(String, Value)> {
        let mut copy = self.clone();
        copy.slots().into_iter().map(|(name, slot)| (name.to_owned(), slot.get())).collect()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    ///
    /// When a value is out of range.
    pub fn check(&self) -> anyhow::Result<()> {
        let check = SettingsCheck { part: "node" };
        check.within("resolution", self.resolution_m, 0.005..=1.0, "from 0.005 to 1")?;
        check.within("map_size", self.map_size_m, 1.0..=1000.0, "from 1 to 1000")?;
        check.within("max_laser_range", self.max_laser_range_m, 0.1..=1000.0, "from 0.1 to 1000")?;
        check.within("range_noise", self.range_noise_m, 0.0..=0.5, "from 0 to 0.5")?;
        check.within("map_update_interval", self.map_update_interval_s, 0.1..=3600.0, "from 0.1 to 3600")?;
        check.within("change_horizon", self.change_horizon_s, 0.1..=DAY_S, "from 0.1 to 86400")?;
        check.within("prediction_horizon", self.prediction_horizon_s, 0.0..=DAY_S, "from 0 to 86400")?;
        let interval = self.mask_update_interval_s;
        let is_interval = interval == 0.0 || (1.0..=3600.0).contains(&interval);
        check.valid("mask_update_interval", interval, "0, or from 1 to 3600", is_interval)?;
        check.within(
            "route_update_interval",
            self.route_update_interval_s,
            1.0..=3600.0,
            "from 1 to 3600",
        )?;
        let period = self.transform_publish_period_s;
        let is_period = period == 0.0 || (0.005..=10.0).contains(&period);
        check.valid("transform_publish_period", period, "0, or from 0.005 to 10", is_period)?;
        check.within("transform_timeout", self.transform_timeout_s, 0.0..=10.0, "from 0 to 10")?;
        check.within("lost_after", self.lost_after_s, 0.0..=3600.0, "from 0 to 3600")?;
        check.within("memory_limit", self.memory_limit_mib, 64.0..=1048576.0, "from 64 to 1048576")?;
        let frames = [
            ("map_frame", &self.map_frame),
            ("odom_frame", &self.odom_frame),
            ("base_frame", &self.base_frame),
        ];
        for (number, (name, frame)) in frames.into_iter().enumerate() {
            // tf has no slash before a name, and source::bare removes it.
            let bare = |frame: &str| frame.trim_start_matches('/').to_owned();
            let found = || Value::Text(frame.clone());
            if bare(frame).is_empty() || frame.len() > MAX_FRAME {
                return Err(invalid(name, "the name of a frame", &found()));
            }
            if let Some((other, _)) = frames[..number].iter().find(|(_, other)| bare(other) == bare(frame)) {
                return Err(invalid(name, &format!("another frame than `{other}`"), &found()));
            }
        }
        if !PoseMode::LIVE.contains(&self.pose) {
            let found = Value::Text(self.pose.name().to_owned());
            return Err(invalid("pose", "exact, odometry or localized", &found));
        }
        if !matches!(self.scan_reliability.as_str(), "best_effort" | "reliable") {
            let name = "qos_overrides./scan.subscription.reliability";
            let found = Value::Text(self.scan_reliability.clone());
            return Err(invalid(name, "best_effort or reliable", &found));
        }
        self.policy().map(drop)
    }

    /// Sets what is given, in its order. What a file gives to many nodes, and this node does not know, is not an error.
    ///
    /// # Errors
    ///
    /// As [`set`](Self::set), with the file.
    pub fn set_all<'a>(&mut self, all: impl IntoIterator<Item = &'a Given>) -> anyhow::Result<()> {
        for given in all {
            let slot = self.slot(&given.name);
            if slot.is_err() && given.is_for_others_too() {
                continue;
            }
            let set = slot.and_then(|slot| match &given.value {
                Some(value) => slot.set(value).map_err(|expected| invalid(&given.name, expected, value)),
                None => {
                    Err(anyhow!("the parameter `{}` must be one value, not a list or nothing", given.name))
                }
            });
            set.map_err(|error| match &given.place {
                Some(place) => anyhow!("{place}: {error}"),
                None => error,
            })?;
        }
        Ok(())
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

    /// The strategy.
    ///
    /// # Errors
    ///
    /// When there is no such strategy.
    pub(crate) fn policy(&self) -> anyhow::Result<Policy> {
        if self.strategy.is_empty() {
            return Ok(Policy::default());
        }
        let known = || Policy::built_in().iter().map(Policy::name).collect::<Vec<_>>().join(", ");
        self.strategy.parse().map_err(|_| unknown("strategy", known(), &self.strategy))
    }

    fn slot(&mut self, name: &str) -> anyhow::Result<&mut dyn Slot> {
        let names = Self::default().slots().into_iter().map(|(name, _)| name).collect::<Vec<_>>().join(", ");
        let slot = self.slots().into_iter().find(|(known, _)| *known == name).map(|(_, slot)| slot);
        slot.ok_or_else(|| anyhow!("there is no parameter `{name}`; there are {names}"))
    }
}

#[cfg(test)]
mod tests;
