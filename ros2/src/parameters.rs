//! The parameters of the mapping node, named as those of `slam_toolbox` and Nav2 where these have them.

mod choices;
mod given;

pub use choices::{Mode, Navigator};

use crate::value::Value;
use choices::Choice;
use interfaces::{PoseMode, SettingsCheck, SettingsError};
use mapper::NoReturn;

/// The error for a parameter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// There is no such parameter.
    #[error("there is no parameter `{name}`; there are {known}")]
    Unknown {
        /// The name as given.
        name: String,
        /// The names of all parameters.
        known: String,
    },
    /// The value has another type, or is not one of those that are possible.
    #[error("the parameter `{name}` must be {expected}, not `{found}`")]
    Value {
        /// The name.
        name: String,
        /// The valid values.
        expected: &'static str,
        /// The value as given.
        found: Value,
    },
    /// There is a list, or nothing, where a value must be.
    #[error("the parameter `{name}` must be one value, not a list or nothing")]
    NoValue {
        /// The name.
        name: String,
    },
    /// A parameter in a file.
    #[error("{place}: {error}")]
    InFile {
        /// The file and the line.
        place: String,
        /// What is wrong.
        error: Box<ParameterError>,
    },
    /// The value is out of range.
    #[error(transparent)]
    Range(#[from] SettingsError),
}

impl ParameterError {
    fn unknown(name: &str) -> Self {
        let known = Parameters::default().slots().map(|(name, _)| name).join(", ");
        Self::Unknown { name: name.to_owned(), known }
    }
}

/// All parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// `mode`.
    pub mode: Mode,
    /// `navigator`.
    pub navigator: Navigator,
    /// `pose`.
    pub pose: PoseMode,
    /// `map_frame`, `odom_frame` and `base_frame`: the frames of REP-105.
    pub map_frame: String,
    /// See [`Parameters::map_frame`].
    pub odom_frame: String,
    /// See [`Parameters::map_frame`].
    pub base_frame: String,
    /// `scan_topic`.
    pub scan_topic: String,
    /// `odom_topic`: for a robot whose odometry is not in tf.
    pub odom_topic: String,
    /// `resolution`: the side of a cell, m.
    pub resolution_m: f64,
    /// `map_size`: the sides of the map, whose center is where the robot starts, m.
    pub map_size_m: f64,
    /// `max_laser_range`: longer ranges are not used, m.
    pub max_laser_range_m: f64,
    /// `no_return`: what beams without a return mean.
    pub no_return: NoReturn,
    /// `range_noise`: the standard deviation of ranges, m.
    pub range_noise_m: f64,
    /// `map_update_interval`: the time between two maps, s.
    pub map_update_interval_s: f64,
    /// `transform_publish_period`: the time between two transforms from map to odometry, s; 0: none.
    pub transform_publish_period_s: f64,
    /// `transform_timeout`: how long a transform holds after the last reading, s.
    pub transform_timeout_s: f64,
    /// `lost_after`: the time without an agreeing scan after which the robot is lost, s.
    pub lost_after_s: f64,
    /// `enable_stamped_cmd_vel`: whether velocities are `TwistStamped`, as Nav2 has it since Kilted, or `Twist`.
    pub enable_stamped_cmd_vel: bool,
    /// `robot_radius`, m.
    pub robot_radius_m: f64,
    /// `max_vel_x`, m/s.
    pub max_vel_x_mps: f64,
    /// `max_vel_theta`, rad/s.
    pub max_vel_theta_radps: f64,
    /// `acc_lim_x`, m/s².
    pub acc_lim_x_mps2: f64,
    /// `acc_lim_theta`, rad/s².
    pub acc_lim_theta_radps2: f64,
    /// `strategy`: how goals are selected.
    pub strategy: String,
    /// `seed` of the random decisions.
    pub seed: i64,
    /// `use_sim_time`: whether the clock is simulated: then a corrected map replaces the old one after a fixed number of
    /// readings, and not when it is ready. All times are those of the messages.
    pub use_sim_time: bool,
    /// `--switch-at`: with which readings corrected maps replace the old one, as an earlier run has printed.
    pub switch_at: Vec<usize>,
    /// `qos_overrides./scan.subscription.reliability`: `best_effort` or `reliable`.
    pub scan_reliability: String,
}

impl Default for Parameters {
    fn default() -> Self {
        let text = str::to_owned;
        Self {
            mode: Mode::default(),
            navigator: Navigator::default(),
            pose: PoseMode::Localized,
            map_frame: text("map"),
            odom_frame: text("odom"),
            base_frame: text("base_footprint"),
            scan_topic: text("/scan"),
            odom_topic: text("odom"),
            resolution_m: 0.05,
            map_size_m: 40.0,
            max_laser_range_m: 20.0,
            no_return: NoReturn::default(),
            range_noise_m: 0.02,
            map_update_interval_s: 5.0,
            transform_publish_period_s: 0.02,
            transform_timeout_s: 0.2,
            lost_after_s: 2.0,
            enable_stamped_cmd_vel: true,
            robot_radius_m: 0.22,
            max_vel_x_mps: 0.26,
            max_vel_theta_radps: 1.0,
            acc_lim_x_mps2: 2.5,
            acc_lim_theta_radps2: 3.2,
            strategy: text("curious"),
            seed: 1,
            use_sim_time: false,
            switch_at: Vec::new(),
            scan_reliability: text("best_effort"),
        }
    }
}

/// Where the value of a parameter is.
enum Slot<'a> {
    Mode(&'a mut Mode),
    Navigator(&'a mut Navigator),
    Pose(&'a mut PoseMode),
    NoReturn(&'a mut NoReturn),
    Text(&'a mut String),
    Float(&'a mut f64),
    Integer(&'a mut i64),
    Bool(&'a mut bool),
}

impl Parameters {
    /// Sets a parameter.
    ///
    /// # Errors
    ///
    /// When there is no such parameter, or when it has no such value. Ranges are checked by [`check`](Self::check).
    pub fn set(&mut self, name: &str, value: &Value) -> Result<(), ParameterError> {
        let Some(slot) = self.slot(name) else {
            return Err(ParameterError::unknown(name));
        };
        let set = match slot {
            Slot::Mode(mode) => choose(mode, value),
            Slot::Navigator(navigator) => choose(navigator, value),
            Slot::Pose(pose) => choose(pose, value),
            Slot::NoReturn(meaning) => choose(meaning, value),
            Slot::Text(to) => match value {
                Value::Text(text) => assign(to, text.clone()),
                _ => Err("a text"),
            },
            Slot::Float(to) => match value {
                Value::Float(number) => assign(to, *number),
                Value::Integer(number) => assign(to, *number as f64),
                _ => Err("a number"),
            },
            Slot::Integer(to) => match value {
                Value::Integer(number) => assign(to, *number),
                _ => Err("a whole number"),
            },
            Slot::Bool(to) => match value {
                Value::Bool(value) => assign(to, *value),
                _ => Err("true or false"),
            },
        };
        set.map_err(|expected| ParameterError::Value {
            name: name.to_owned(),
            expected,
            found: value.clone(),
        })
    }

    /// All parameters with their values.
    pub fn list(&self) -> Vec<(String, Value)> {
        let mut copy = self.clone();
        let value = |slot: Slot| match slot {
            Slot::Mode(mode) => Value::Text(mode.name().to_owned()),
            Slot::Navigator(navigator) => Value::Text(navigator.name().to_owned()),
            Slot::Pose(pose) => Value::Text(pose.name().to_owned()),
            Slot::NoReturn(meaning) => Value::Text(meaning.name().to_owned()),
            Slot::Text(text) => Value::Text(text.clone()),
            Slot::Float(number) => Value::Float(*number),
            Slot::Integer(number) => Value::Integer(*number),
            Slot::Bool(value) => Value::Bool(*value),
        };
        copy.slots().into_iter().map(|(name, slot)| (name.to_owned(), value(slot))).collect()
    }

    /// Checks the ranges.
    ///
    /// # Errors
    ///
    /// When a value is out of range.
    pub fn check(&self) -> Result<(), ParameterError> {
        let check = SettingsCheck { part: "node" };
        check.within("resolution", self.resolution_m, 0.005..=1.0, "from 0.005 to 1")?;
        check.within("map_size", self.map_size_m, 1.0..=1000.0, "from 1 to 1000")?;
        check.within("max_laser_range", self.max_laser_range_m, 0.1..=1000.0, "from 0.1 to 1000")?;
        check.within("range_noise", self.range_noise_m, 0.0..=0.5, "from 0 to 0.5")?;
        check.within("map_update_interval", self.map_update_interval_s, 0.1..=3600.0, "from 0.1 to 3600")?;
        let period = self.transform_publish_period_s;
        let is_period = period == 0.0 || (0.005..=10.0).contains(&period);
        check.valid("transform_publish_period", period, "0, or from 0.005 to 10", is_period)?;
        check.within("transform_timeout", self.transform_timeout_s, 0.0..=10.0, "from 0 to 10")?;
        check.within("lost_after", self.lost_after_s, 0.0..=3600.0, "from 0 to 3600")?;
        for (name, frame) in [
            ("map_frame", &self.map_frame),
            ("odom_frame", &self.odom_frame),
            ("base_frame", &self.base_frame),
        ] {
            if frame.is_empty() {
                let found = Value::Text(String::new());
                return Err(ParameterError::Value {
                    name: name.into(),
                    expected: "the name of a frame",
                    found,
                });
            }
        }
        if !matches!(self.scan_reliability.as_str(), "best_effort" | "reliable") {
            let found = Value::Text(self.scan_reliability.clone());
            let name = "qos_overrides./scan.subscription.reliability".to_owned();
            return Err(ParameterError::Value { name, expected: "best_effort or reliable", found });
        }
        Ok(())
    }

    /// The parameters by name.
    fn slots(&mut self) -> [(&'static str, Slot<'_>); 27] {
        [
            ("mode", Slot::Mode(&mut self.mode)),
            ("navigator", Slot::Navigator(&mut self.navigator)),
            ("pose", Slot::Pose(&mut self.pose)),
            ("map_frame", Slot::Text(&mut self.map_frame)),
            ("odom_frame", Slot::Text(&mut self.odom_frame)),
            ("base_frame", Slot::Text(&mut self.base_frame)),
            ("scan_topic", Slot::Text(&mut self.scan_topic)),
            ("odom_topic", Slot::Text(&mut self.odom_topic)),
            ("resolution", Slot::Float(&mut self.resolution_m)),
            ("map_size", Slot::Float(&mut self.map_size_m)),
            ("max_laser_range", Slot::Float(&mut self.max_laser_range_m)),
            ("no_return", Slot::NoReturn(&mut self.no_return)),
            ("range_noise", Slot::Float(&mut self.range_noise_m)),
            ("map_update_interval", Slot::Float(&mut self.map_update_interval_s)),
            ("transform_publish_period", Slot::Float(&mut self.transform_publish_period_s)),
            ("transform_timeout", Slot::Float(&mut self.transform_timeout_s)),
            ("lost_after", Slot::Float(&mut self.lost_after_s)),
            ("enable_stamped_cmd_vel", Slot::Bool(&mut self.enable_stamped_cmd_vel)),
            ("robot_radius", Slot::Float(&mut self.robot_radius_m)),
            ("max_vel_x", Slot::Float(&mut self.max_vel_x_mps)),
            ("max_vel_theta", Slot::Float(&mut self.max_vel_theta_radps)),
            ("acc_lim_x", Slot::Float(&mut self.acc_lim_x_mps2)),
            ("acc_lim_theta", Slot::Float(&mut self.acc_lim_theta_radps2)),
            ("strategy", Slot::Text(&mut self.strategy)),
            ("seed", Slot::Integer(&mut self.seed)),
            ("use_sim_time", Slot::Bool(&mut self.use_sim_time)),
            ("qos_overrides./scan.subscription.reliability", Slot::Text(&mut self.scan_reliability)),
        ]
    }

    fn slot(&mut self, name: &str) -> Option<Slot<'_>> {
        self.slots().into_iter().find(|(known, _)| *known == name).map(|(_, slot)| slot)
    }
}

/// Takes a value by its name.
///
/// # Errors
///
/// The valid values.
fn choose<C: Choice>(to: &mut C, value: &Value) -> Result<(), &'static str> {
    let Value::Text(name) = value else { return Err(C::EXPECTED) };
    assign(to, C::named(name).ok_or(C::EXPECTED)?)
}

fn assign<T>(to: &mut T, value: T) -> Result<(), &'static str> {
    *to = value;
    Ok(())
}

#[cfg(test)]
mod tests;
