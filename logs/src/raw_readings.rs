use crate::error::LogError;
use interfaces::LaserReading;

/// Readings with their times as written.
pub(crate) trait RawReadings {
    /// The next reading, `None` at the end.
    fn next_reading(&mut self) -> Result<Option<LaserReading>, LogError>;
}
