use interfaces::{SettingsCheck, SettingsError};

/// Settings of an [`Agent`](crate::Agent).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct AgentSettings {
    /// The side of a square patch, in cells. Weights of goals are averaged over a patch.
    pub patch_cells: usize,
    /// The range of the sensor, m. Used by strategies that compute visibility.
    pub sensor_radius_m: f64,
    /// *Unseen first*: whether the robot looks into unseen space that it can reach before it asks its strategies. The paper's robot
    /// does not, nor does any robot where strategies are compared: with it, all of them cover the same place at first.
    pub unseen_first: bool,
    /// The temperature τ of the paper's chooser, in map updates per reading: a strategy whose value is larger by τ is chosen e
    /// times as often.
    pub temperature: f64,
}

impl Default for AgentSettings {
    fn default() -> Self {
        Self { patch_cells: 5, sensor_radius_m: 10.0, unseen_first: false, temperature: 2.0 }
    }
}

impl AgentSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "agent" };
        check.within("patch_cells", self.patch_cells as f64, 1.0..=1e3, "from 1 to 1000")?;
        check.within("sensor_radius_m", self.sensor_radius_m, 1e-3..=1e6, "from 0.001 to 1000000")?;
        check.within("temperature", self.temperature, 1e-9..=1e9, "from 1e-9 to 1e9")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_refused() {
        let settings = AgentSettings::default();
        assert_eq!(settings.check(), Ok(()));
        for (settings, message) in [
            (AgentSettings { patch_cells: 0, ..settings }, "`patch_cells` must be from 1 to 1000, not 0"),
            (AgentSettings { temperature: 0.0, ..settings }, "`temperature` must be from 1e-9 to 1e9, not 0"),
            (
                AgentSettings { temperature: f64::NAN, ..settings },
                "`temperature` must be from 1e-9 to 1e9, not NaN",
            ),
        ] {
            assert_eq!(settings.check().unwrap_err().to_string(), format!("agent setting {message}"));
        }
    }
}
