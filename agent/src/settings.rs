use interfaces::{CellState, SettingsCheck, SettingsError, Transition};

/// The events that count as map updates in the reward of a trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reward {
    /// Changes of a known cell: free to blocked, blocked to free.
    #[default]
    Changes,
    /// First observations as well. A laser has thousands of them in one scan, far more than the temperature.
    ChangesAndDiscoveries,
}

impl Reward {
    /// The number of transitions that count as map updates.
    pub(crate) fn count(self, transitions: &[Transition]) -> usize {
        let counts = |transition: &&Transition| match self {
            Self::Changes => transition.event().is_some(),
            Self::ChangesAndDiscoveries => {
                transition.event().is_some() || transition.before == CellState::Unknown
            }
        };
        transitions.iter().filter(counts).count()
    }
}

/// Settings of an [`Agent`](crate::Agent).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct AgentSettings {
    /// The side of a square patch, in cells. Weights of goals are averaged over a patch.
    pub patch_cells: usize,
    /// The range of the sensor, m. Used by strategies that compute visibility.
    pub sensor_radius_m: f64,
    /// The events that count as map updates.
    pub reward: Reward,
    /// Whether the robot looks into unseen space that it can reach before its strategies decide. The paper's robot
    /// does not: in its worlds everything comes into view soon.
    pub looks_at_unseen: bool,
    /// Settings of the paper's chooser.
    pub curious: CuriousSettings,
}

impl Default for AgentSettings {
    fn default() -> Self {
        Self {
            patch_cells: 5,
            sensor_radius_m: 10.0,
            reward: Reward::default(),
            looks_at_unseen: false,
            curious: CuriousSettings::default(),
        }
    }
}

/// Settings of [`Curious`](crate::Curious), with the paper's values (section 4).
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct CuriousSettings {
    /// The number of tilings.
    pub tilings: usize,
    /// The size of a tile in p, in expected changed cells.
    pub tile_p: f64,
    /// The size of a tile in r, s (steps in a grid world).
    pub tile_r: f64,
    /// λ: the share of a tile's weight that one visit replaces by the reward, from 0 to 1.
    pub learning_rate: f64,
    /// τ, in map updates per reading: a strategy whose value is larger by τ is chosen e times as often.
    pub temperature: f64,
}

impl Default for CuriousSettings {
    fn default() -> Self {
        Self { tilings: 5, tile_p: 0.5, tile_r: 100.0, learning_rate: 0.9, temperature: 2.0 }
    }
}

impl AgentSettings {
    pub(crate) fn check(&self) -> Result<(), SettingsError> {
        let Self { patch_cells, sensor_radius_m, reward: _, looks_at_unseen: _, ref curious } = *self;
        let check = SettingsCheck { part: "agent" };
        check.within("patch_cells", patch_cells as f64, 1.0..=1e3, "from 1 to 1000")?;
        check.within("sensor_radius_m", sensor_radius_m, 1e-3..=1e6, "from 0.001 to 1000000")?;
        check.within("curious.tilings", curious.tilings as f64, 1.0..=1e3, "from 1 to 1000")?;
        check.within("curious.tile_p", curious.tile_p, 1e-9..=1e9, "from 1e-9 to 1e9")?;
        check.within("curious.tile_r", curious.tile_r, 1e-9..=1e9, "from 1e-9 to 1e9")?;
        check.within("curious.temperature", curious.temperature, 1e-9..=1e9, "from 1e-9 to 1e9")?;
        let rate = curious.learning_rate;
        check.valid("curious.learning_rate", rate, "above 0, and at most 1", rate > 0.0 && rate <= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Cell;
    use serde::Deserialize;
    use serde::de::value::{Error, MapDeserializer};

    /// What is invalid in the default settings after a change.
    fn message(change: impl FnOnce(&mut AgentSettings)) -> String {
        let mut settings = AgentSettings::default();
        change(&mut settings);
        settings.check().map_or_else(|error| error.to_string(), |()| "fine".into())
    }

    /// What is wrong with settings that have one key.
    fn unreadable(key: &str, value: &str) -> String {
        let keys = MapDeserializer::<_, Error>::new([(key, value)].into_iter());
        AgentSettings::deserialize(keys).unwrap_err().to_string()
    }

    #[test]
    fn invalid_settings_are_refused() {
        assert_eq!(message(|_| {}), "fine");
        let change = |settings: &mut AgentSettings| {
            (settings.patch_cells, settings.reward) = (10, Reward::ChangesAndDiscoveries);
        };
        assert_eq!(message(change), "fine");
        assert_eq!(
            message(|settings| settings.patch_cells = 0),
            "agent setting `patch_cells` must be from 1 to 1000, not 0"
        );
        assert_eq!(
            message(|settings| settings.curious.tilings = 0),
            "agent setting `curious.tilings` must be from 1 to 1000, not 0"
        );
        type Field = fn(&mut CuriousSettings) -> &mut f64;
        let fields: [(&str, f64, Field); 4] = [
            ("tile_p", -0.5, |curious| &mut curious.tile_p),
            ("tile_r", f64::INFINITY, |curious| &mut curious.tile_r),
            ("temperature", 0.0, |curious| &mut curious.temperature),
            ("tile_r", f64::NAN, |curious| &mut curious.tile_r),
        ];
        for (key, value, field) in fields {
            assert_eq!(
                message(|settings| *field(&mut settings.curious) = value),
                format!("agent setting `curious.{key}` must be from 1e-9 to 1e9, not {value}")
            );
        }
        for value in [0.0, 1.1, f64::NAN] {
            assert_eq!(
                message(|settings| settings.curious.learning_rate = value),
                format!("agent setting `curious.learning_rate` must be above 0, and at most 1, not {value}")
            );
        }
        assert_eq!(
            unreadable("patches", "3"),
            "unknown field `patches`, expected one of `patch_cells`, `sensor_radius_m`, `reward`, \
             `looks_at_unseen`, `curious`"
        );
        assert_eq!(
            unreadable("reward", "joy"),
            "unknown variant `joy`, expected `changes` or `changes-and-discoveries`"
        );
    }

    #[test]
    fn rewards_count_their_transitions() {
        use CellState::{Blocked, Free, Unknown};
        let transitions: Vec<_> = [(Unknown, Free), (Unknown, Blocked), (Free, Blocked), (Blocked, Free)]
            .map(|(before, after)| Transition { cell: Cell::new(0, 0), before, after })
            .into();
        assert_eq!(Reward::Changes.count(&transitions), 2);
        assert_eq!(Reward::ChangesAndDiscoveries.count(&transitions), 4);
        assert_eq!(Reward::Changes.count(&[]), 0);
    }
}
