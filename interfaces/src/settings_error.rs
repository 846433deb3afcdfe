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
