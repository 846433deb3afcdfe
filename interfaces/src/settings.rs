use std::ops::RangeInclusive;

/// A setting whose value is out of range, or contradicts another setting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{part} setting `{key}` must be {expected}, not {found}")]
pub struct SettingsError {
    /// The part of the robot that the setting belongs to, as in "mapper".
    pub part: &'static str,
    /// The name of the setting, with the name of its table, as in "curious.temperature".
    pub key: &'static str,
    /// The values that are valid, as in "from 1 to 100".
    pub expected: &'static str,
    /// The value that was found.
    pub found: String,
}

/// Checks the settings of a part of the robot. Every method refuses a value that is not finite, or not as described.
#[derive(Clone, Copy, Debug)]
pub struct SettingsCheck {
    /// [`SettingsError::part`].
    pub part: &'static str,
}

impl SettingsCheck {
    /// A value above 0.
    pub fn positive(self, key: &'static str, value: f64) -> Result<(), SettingsError> {
        self.valid(key, value, "a positive number", value > 0.0)
    }

    /// A value of 0 or more.
    pub fn not_negative(self, key: &'static str, value: f64) -> Result<(), SettingsError> {
        self.valid(key, value, "0 or more", value >= 0.0)
    }

    /// A value in `range`, which `expected` describes.
    pub fn within(
        self,
        key: &'static str,
        value: impl Into<f64>,
        range: RangeInclusive<f64>,
        expected: &'static str,
    ) -> Result<(), SettingsError> {
        let value = value.into();
        self.valid(key, value, expected, range.contains(&value))
    }

    /// A value that is `expected`, as `is_valid` states.
    pub fn valid(
        self,
        key: &'static str,
        value: f64,
        expected: &'static str,
        is_valid: bool,
    ) -> Result<(), SettingsError> {
        if is_valid && value.is_finite() {
            return Ok(());
        }
        Err(SettingsError { part: self.part, key, expected, found: value.to_string() })
    }
}
