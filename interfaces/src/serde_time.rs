//! Times, and other numbers that are near to multiples of a thousandth, in serde structs, bit for bit and short:
//! `#[serde(with = "interfaces::serde_time")]`. Such a number is the nearest number of thousandths, and how many floating-point
//! numbers it is away from it: mostly none or a few, from rounding.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de::DeserializeOwned};

/// Thousandths, and the distance from them in floating-point numbers.
type Coded = (i64, i64);

/// Numbers that have a short form.
pub trait Times {
    /// The short form.
    type Short: Serialize + DeserializeOwned;

    /// The short form of these numbers.
    fn short(&self) -> Self::Short;

    /// The numbers with a short form.
    fn of(short: Self::Short) -> Self;
}

/// The number for thousandths, as close as it can be.
fn near(thousandths: i64) -> u64 {
    (thousandths as f64 / 1000.0).to_bits()
}

impl Times for f64 {
    type Short = Coded;

    fn short(&self) -> Coded {
        let thousandths = (self * 1000.0).round() as i64; // 0 for NaN; any number will do
        (thousandths, self.to_bits().wrapping_sub(near(thousandths)) as i64)
    }

    fn of((thousandths, off): Coded) -> Self {
        Self::from_bits(near(thousandths).wrapping_add(off as u64))
    }
}

impl Times for [f64; 2] {
    type Short = [Coded; 2];

    fn short(&self) -> Self::Short {
        self.map(|time| time.short())
    }

    fn of(short: Self::Short) -> Self {
        short.map(f64::of)
    }
}

/// Writes times.
///
/// # Errors
///
/// The errors of the serializer.
pub fn serialize<T: Times, S: Serializer>(times: &T, serializer: S) -> Result<S::Ok, S::Error> {
    times.short().serialize(serializer)
}

/// Reads times.
///
/// # Errors
///
/// The errors of the deserializer.
pub fn deserialize<'de, T: Times, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Short::deserialize(deserializer).map(T::of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_comes_back_and_times_are_short() {
        let sum = [0.1; 7].iter().sum::<f64>();
        for number in [0.0, -0.0, 0.1, sum, 1e300, -7.25, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-310]
        {
            assert_eq!(f64::of(number.short()).to_bits(), number.to_bits(), "{number}");
        }
        let length = |number: f64| postcard::to_stdvec(&number.short()).unwrap().len();
        assert_eq!([0.0, 0.3, sum, 612.4].map(length), [2, 3, 3, 4]);
    }
}
