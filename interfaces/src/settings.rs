use std::ops::RangeInclusive;

/// The error for a setting whose value is out of range or contradicts another setting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{part} setting `{key}` must be {expected}, not {found}")]
pub struct SettingsError {
    /// The part of the robot that the setting belongs to, for example "mapper".
    pub part: &'static str,
    /// The name of the setting, with the name of its table, for example "curious.temperature".
    pub key: &'static str,
    /// The valid values, for example "from 1 to 100".
    pub expected: &'static str,
    /// The value that was found.
    pub found: String,
}

/// Checks the settings of a part of the robot. Every method returns an error if the value is not finite or does not
/// satisfy the condition.
#[derive(Clone, Copy, Debug)]
pub struct SettingsCheck {
    /// The name of the part in errors, see [`SettingsError::part`].
    pub part: &'static str,
}

impl SettingsCheck {
    /// Accepts a value above 0.
    pub fn positive(self, key: &'static str, value: f64) -> Result<(), SettingsError> {
        self.valid(key, value, "a positive number", value > 0.0)
    }

    /// Accepts a value of 0 or more.
    pub fn not_negative(self, key: &'static str, value: f64) -> Result<(), SettingsError> {
        self.valid(key, value, "0 or more", value >= 0.0)
    }

    /// Accepts a value in `range`; `expected` describes the range.
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

    /// Accepts a value if `is_valid`; `expected` describes the valid values.
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
