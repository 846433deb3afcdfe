/// The payload of a NaN: bits that carry no meaning in arithmetic.
const NAN_BITS: u32 = 0x003f_ffff;

/// One scan of a planar laser, as ROS `sensor_msgs/LaserScan`, with the meaning of REP-117.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Scan {
    /// The direction of the first beam in the laser's frame, rad.
    pub angle_min_rad: f64,
    /// The angle between consecutive beams, rad; the direction of beam `i` is `angle_min_rad + i *
    /// angle_increment_rad`.
    pub angle_increment_rad: f64,
    /// The minimum range, m: smaller ranges are not measurements.
    pub range_min_m: f64,
    /// The maximum range of the laser, m.
    pub range_max_m: f64,
    /// The time from the measurement of the first beam to that of the last beam, s. 0: all beams were measured at once.
    /// The beams are measured in order and at equal intervals; the time of the reading is that of the last beam.
    pub sweep_s: f64,
    /// One range per beam, m: +∞ no return, −∞ too close, NaN invalid measurement; [`Self::free_to`] says how far such a beam is
    /// free.
    pub ranges_m: Vec<f32>,
}

impl Scan {
    /// The direction of beam `index` in the laser's frame, rad.
    pub fn angle_rad(&self, index: usize) -> f64 {
        self.angle_min_rad + index as f64 * self.angle_increment_rad
    }

    /// The time from the measurement of beam `index` to that of the last beam, which is the time of the reading, s.
    pub fn age_s(&self, index: usize) -> f64 {
        let last = self.ranges_m.len().saturating_sub(1);
        self.sweep_s * (last.saturating_sub(index) as f64 / last.max(1) as f64)
    }

    /// The range of a beam that is free up to `clear_m`, m, and whose hit is not used: a NaN with this distance, mm, as its
    /// payload. Code that does not ask [`Self::free_m`] sees an invalid measurement.
    pub fn free_to(clear_m: f64) -> f32 {
        f32::from_bits(f32::NAN.to_bits() | (clear_m * 1e3).clamp(0.0, f64::from(NAN_BITS)) as u32)
    }

    /// How far a beam with an invalid range is free, m: 0 but for [`Self::free_to`].
    pub fn free_m(invalid: f32) -> f64 {
        if invalid.is_nan() { f64::from(invalid.to_bits() & NAN_BITS) / 1e3 } else { 0.0 }
    }

    /// Whether the beams cover a full turn, so that the last beam is a neighbor of the first. The tolerance is a
    /// thousandth of the angle between beams, more than the accumulated rounding of an angle in 32 bits.
    pub fn is_full_turn(&self) -> bool {
        let sweep_rad = self.angle_increment_rad.abs() * self.ranges_m.len() as f64;
        !self.ranges_m.is_empty()
            && (sweep_rad - std::f64::consts::TAU).abs() < 1e-3 * self.angle_increment_rad.abs()
    }

    /// Checks the parameters of the scan: the angles, the number of beams, the range limits and the duration. Single ranges are
    /// never an error: REP-117 defines the meaning of each value.
    ///
    /// # Errors
    ///
    /// When an angle is not finite, when the beams cover more than one turn, or when the range limits do not
    /// satisfy `0 <= range_min_m < range_max_m` or are not finite, or when the duration is negative or not finite.
    pub fn check(&self) -> Result<(), ScanError> {
        let Self { angle_min_rad, angle_increment_rad, range_min_m, range_max_m, sweep_s, ref ranges_m } =
            *self;
        if !angle_min_rad.is_finite() || !angle_increment_rad.is_finite() {
            return Err(ScanError::Angle { angle_min_rad, angle_increment_rad });
        }
        let sweep_rad = angle_increment_rad.abs() * ranges_m.len().saturating_sub(1) as f64;
        if angle_increment_rad == 0.0 && ranges_m.len() > 1 || sweep_rad > std::f64::consts::TAU + 1e-3 {
            return Err(ScanError::Sweep { beams: ranges_m.len(), angle_increment_rad });
        }
        if !(range_min_m >= 0.0 && range_min_m < range_max_m && range_max_m.is_finite()) {
            return Err(ScanError::Limits { range_min_m, range_max_m });
        }
        if !(sweep_s >= 0.0 && sweep_s.is_finite()) {
            return Err(ScanError::Duration { sweep_s });
        }
        Ok(())
    }
}

/// The error for a scan that is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// An angle is NaN or infinite.
    #[error("scan angles must be finite: angle_min {angle_min_rad}, angle_increment {angle_increment_rad}")]
    Angle {
        /// The direction of the first beam, rad.
        angle_min_rad: f64,
        /// The angle between consecutive beams, rad.
        angle_increment_rad: f64,
    },
    /// All beams have the same direction, or the beams cover more than one turn.
    #[error("{beams} beams {angle_increment_rad} rad apart do not make a sweep of at most one turn")]
    Sweep {
        /// The number of ranges.
        beams: usize,
        /// The angle between consecutive beams, rad.
        angle_increment_rad: f64,
    },
    /// The range limits do not satisfy `0 <= min < max`, or are not finite.
    #[error("range limits must hold 0 <= range_min < range_max, finite: {range_min_m} m, {range_max_m} m")]
    Limits {
        /// The minimum range of the scan, m.
        range_min_m: f64,
        /// The maximum range of the scan, m.
        range_max_m: f64,
    },
    /// The duration of the scan is negative, NaN or infinite.
    #[error("the duration of a scan must be 0 or more, finite: {sweep_s} s")]
    Duration {
        /// The time from the measurement of the first beam to that of the last beam, s.
        sweep_s: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn scan(beams: usize, angle_increment_rad: f64) -> Scan {
        Scan { angle_increment_rad, range_max_m: 10.0, ranges_m: vec![1.0; beams], ..Scan::default() }
    }

    #[test]
    fn a_full_turn_is_recognized() {
        assert!(scan(720, TAU / 720.0).is_full_turn());
        assert!(!scan(181, TAU / 360.0).is_full_turn());
    }

    #[test]
    fn bad_figures_are_refused() {
        assert_eq!(scan(720, TAU / 720.0).check(), Ok(()));
        assert!(matches!(scan(2, 0.0).check(), Err(ScanError::Sweep { .. })));
        assert!(matches!(scan(3, TAU).check(), Err(ScanError::Sweep { .. })));
        assert!(matches!(scan(2, f64::NAN).check(), Err(ScanError::Angle { .. })));
        let limits = Scan { range_min_m: 11.0, ..scan(2, 0.1) };
        assert!(matches!(limits.check(), Err(ScanError::Limits { .. })));
        for sweep_s in [-0.1, f64::NAN, f64::INFINITY] {
            let sweeping = Scan { sweep_s, ..scan(2, 0.1) };
            assert!(matches!(sweeping.check(), Err(ScanError::Duration { .. })));
        }
    }

    #[test]
    fn beams_are_measured_at_equal_intervals() {
        let sweeping = Scan { sweep_s: 0.1, ..scan(5, 0.1) };
        assert_eq!([0, 1, 3, 4].map(|beam| sweeping.age_s(beam)), [0.1, 0.1 * 0.75, 0.1 * 0.25, 0.0]);
        assert_eq!(scan(5, 0.1).age_s(0), 0.0);
        // A single beam is the last one.
        assert_eq!(Scan { sweep_s: 0.1, ..scan(1, 0.1) }.age_s(0), 0.0);
    }
}
