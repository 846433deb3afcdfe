//! The changing values of a part, as bytes, so that the part can go on later where it stopped.
//!
//! Every part lists its changing values once, as [`Values`]; serde and postcard write them and read them in the same
//! order. Settings, and what follows from settings and other values, are not in the list: the part that reads the
//! values was made with the same settings.

use serde::{Serialize, de::DeserializeOwned};

/// The error for bytes that are not the values of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("these bytes are not the values of this part")]
pub struct ValueError;

/// A changing value of a part.
pub trait Value {
    /// Appends the value to `bytes`.
    ///
    /// # Errors
    ///
    /// When the value has no form as bytes.
    fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError>;

    /// Reads the value from the front of `bytes`.
    ///
    /// # Errors
    ///
    /// When the bytes are no such value.
    fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError>;
}

impl<T: Serialize + DeserializeOwned> Value for &mut T {
    fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&**self, bytes)
    }

    fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
        **self = read_value(bytes)?;
        Ok(())
    }
}

/// Appends one value to `bytes`.
///
/// # Errors
///
/// When the value has no form as bytes.
pub fn write_value<T: Serialize + ?Sized>(value: &T, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
    postcard::to_io(value, bytes).map(|_| ()).map_err(|_| ValueError)
}

/// Reads one value from the front of `bytes`.
///
/// # Errors
///
/// When the bytes are no such value.
pub fn read_value<T: DeserializeOwned>(bytes: &mut &[u8]) -> Result<T, ValueError> {
    let value;
    (value, *bytes) = postcard::take_from_bytes(bytes).map_err(|_| ValueError)?;
    Ok(value)
}

/// The changing values of a part.
pub type Values<'a> = Vec<Box<dyn Value + 'a>>;

/// A value of any type that serde can write and read.
pub fn value<'a, T: Serialize + DeserializeOwned>(value: &'a mut T) -> Box<dyn Value + 'a> {
    Box::new(value)
}

/// A value at the end of a snapshot: the default one if the snapshot ends before it, in an older format.
pub fn last_value<'a, T: Default + Serialize + DeserializeOwned>(value: &'a mut T) -> Box<dyn Value + 'a> {
    struct Last<'a, T>(&'a mut T);

    impl<T: Default + Serialize + DeserializeOwned> Value for Last<'_, T> {
        fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
            write_value(&*self.0, bytes)
        }

        fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
            *self.0 = if bytes.is_empty() { T::default() } else { read_value(bytes)? };
            Ok(())
        }
    }

    Box::new(Last(value))
}

/// A part that is saved in another form, which `save` makes of it; `load` brings the part into the state of that form.
pub fn converted<'a, P: ?Sized, T: Serialize + DeserializeOwned + 'a>(
    part: &'a mut P,
    save: fn(&P) -> T,
    load: fn(&mut P, T) -> Result<(), ValueError>,
) -> Box<dyn Value + 'a> {
    struct Converted<'a, P: ?Sized, T>(&'a mut P, fn(&P) -> T, fn(&mut P, T) -> Result<(), ValueError>);

    impl<P: ?Sized, T: Serialize + DeserializeOwned> Value for Converted<'_, P, T> {
        fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
            write_value(&self.1(self.0), bytes)
        }

        fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
            self.2(self.0, read_value(bytes)?)
        }
    }

    Box::new(Converted(part, save, load))
}

/// A value at the end of a snapshot: it stays as it is if the snapshot ends before it, in an older format.
pub fn if_present<'a>(value: Box<dyn Value + 'a>) -> Box<dyn Value + 'a> {
    struct IfPresent<'a>(Box<dyn Value + 'a>);

    impl Value for IfPresent<'_> {
        fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
            self.0.write(bytes)
        }

        fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
            if bytes.is_empty() { Ok(()) } else { self.0.read(bytes) }
        }
    }

    Box::new(IfPresent(value))
}

/// The [`Values`] of fields, and after a semicolon those of parts that list their own.
#[macro_export]
macro_rules! values {
    ($($field:expr),* $(; $($part:expr),+)?) => {{
        #[allow(unused_mut)]
        let mut values: $crate::Values<'_> = vec![$($crate::value(&mut $field)),*];
        $($(values.extend($part.values());)+)?
        values
    }};
}

/// Appends values to `bytes`.
///
/// # Errors
///
/// When a value has no form as bytes.
pub fn write_values(values: Values<'_>, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
    values.into_iter().try_for_each(|value| value.write(bytes))
}

/// Reads values from the front of `bytes`.
///
/// # Errors
///
/// When the bytes are not these values.
pub fn read_values(bytes: &mut &[u8], values: Values<'_>) -> Result<(), ValueError> {
    values.into_iter().try_for_each(|mut value| value.read(bytes))
}

/// The snapshot of a part: its changing values.
pub fn snapshot(values: Values<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    // All our values can be written. If one could not, the snapshot would be refused when it is restored.
    if write_values(values, &mut bytes).is_err() {
        bytes.clear();
    }
    bytes
}

/// One value as bytes, for [`from_bytes`]; none if it has no form as bytes.
pub fn to_bytes(value: &impl Serialize) -> Vec<u8> {
    postcard::to_stdvec(value).unwrap_or_default()
}

/// One value from all of its bytes.
///
/// # Errors
///
/// When the bytes are no such value.
pub fn from_bytes<T: DeserializeOwned>(mut bytes: &[u8]) -> Result<T, ValueError> {
    let value = read_value(&mut bytes)?;
    if bytes.is_empty() { Ok(value) } else { Err(ValueError) }
}

/// Reads the values of a part from its snapshot.
///
/// # Errors
///
/// When the bytes are not the snapshot of such a part; some values are read then.
pub fn restore(values: Values<'_>, mut snapshot: &[u8]) -> Result<(), ValueError> {
    read_values(&mut snapshot, values)?;
    if snapshot.is_empty() { Ok(()) } else { Err(ValueError) }
}

/// One value per cell of a grid, of which many that follow each other are equal: each is written once, with the number of
/// cells that have it. Reading needs a list of the same length.
pub fn runs<'a, T: Clone + Serialize + DeserializeOwned>(list: &'a mut [T]) -> Box<dyn Value + 'a> {
    struct Runs<'a, T>(&'a mut [T]);

    impl<T: Clone + Serialize + DeserializeOwned> Value for Runs<'_, T> {
        fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
            // Compared by their bytes: 0 and -0 are equal numbers, and differ.
            let (mut run, mut next, mut length) = (Vec::new(), Vec::new(), 0usize);
            let end = |run: &[u8], length: usize, bytes: &mut Vec<u8>| {
                write_value(&length, bytes)?;
                bytes.extend_from_slice(run);
                Ok(())
            };
            for item in &*self.0 {
                next.clear();
                write_value(item, &mut next)?;
                if length > 0 && run != next {
                    end(&run, std::mem::take(&mut length), bytes)?;
                }
                length += 1;
                std::mem::swap(&mut run, &mut next);
            }
            if length > 0 { end(&run, length, bytes) } else { Ok(()) }
        }

        fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
            let mut rest = &mut *self.0;
            while !rest.is_empty() {
                let (length, value): (usize, T) = read_value(bytes)?;
                let is_run = (1..=rest.len()).contains(&length);
                let (run, others) = rest.split_at_mut(if is_run { length } else { return Err(ValueError) });
                run.fill(value);
                rest = others;
            }
            Ok(())
        }
    }

    Box::new(Runs(list))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_runs_come_back() {
        let (mut number, mut list) = (7u64, vec![0.5, 0.5, 0.5, -1.0, 2.0, 2.0]);
        let mut bytes = Vec::new();
        write_values(vec![value(&mut number), runs(&mut list)], &mut bytes).unwrap();
        assert_eq!(bytes.len(), 1 + 3 * 9);
        let (mut again, mut same) = (0u64, vec![0.0; 6]);
        let mut front = &bytes[..];
        read_values(&mut front, vec![value(&mut again), runs(&mut same)]).unwrap();
        assert!((again, &same) == (number, &list) && front.is_empty());
        // A shorter and a longer list, and too few bytes.
        for (cells, length) in [(5, bytes.len()), (7, bytes.len()), (6, bytes.len() - 1)] {
            let mut other = vec![0.0; cells];
            assert_eq!(read_values(&mut &bytes[1..length], vec![runs(&mut other)]), Err(ValueError));
        }
    }
}
