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

/// One value per cell of a grid, as [`cell_runs`] reads and writes them.
pub trait CellList {
    /// The value of a cell.
    type Item: DeserializeOwned;

    /// The number of cells.
    fn len(&self) -> usize;

    /// Whether there is no cell.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends the value of a cell to `bytes`.
    ///
    /// # Errors
    ///
    /// When the value has no form as bytes.
    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError>;

    /// The number of cells from this one on that certainly have equal values.
    fn alike(&self, _index: usize) -> usize {
        1
    }

    /// Sets the value of a cell.
    fn set(&mut self, index: usize, value: &Self::Item);
}

impl<T: Clone + Serialize + DeserializeOwned> CellList for &mut [T] {
    type Item = T;

    fn len(&self) -> usize {
        <[T]>::len(self)
    }

    fn write(&self, index: usize, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
        write_value(&self[index], bytes)
    }

    fn set(&mut self, index: usize, value: &T) {
        self[index] = value.clone();
    }
}

/// One value per cell of a grid, of which many that follow each other are equal: each is written once, with the number of
/// cells that have it. Reading needs a list of the same length.
pub fn runs<'a, T: Clone + Serialize + DeserializeOwned>(list: &'a mut [T]) -> Box<dyn Value + 'a> {
    cell_runs(list, usize::MAX)
}

/// The same for any list. A run ends at each multiple of `longest`.
pub fn cell_runs<'a>(list: impl CellList + 'a, longest: usize) -> Box<dyn Value + 'a> {
    struct Runs<L>(L, usize);

    impl<L: CellList> Runs<L> {
        /// The number of cells from this one on that can be in one run.
        fn rest(&self, index: usize) -> usize {
            (self.1 - index % self.1).min(self.0.len() - index)
        }
    }

    impl<L: CellList> Value for Runs<L> {
        fn write(&self, bytes: &mut Vec<u8>) -> Result<(), ValueError> {
            // Compared by their bytes: 0 and -0 are equal numbers, and differ.
            let (mut run, mut next, mut length, mut index) = (Vec::new(), Vec::new(), 0usize, 0);
            while index < self.0.len() {
                next.clear();
                self.0.write(index, &mut next)?;
                if length > 0 && (run != next || index % self.1 == 0) {
                    write_value(&std::mem::take(&mut length), bytes)?;
                    bytes.extend_from_slice(&run);
                }
                let alike = self.0.alike(index).min(self.rest(index));
                (length, index) = (length + alike, index + alike);
                std::mem::swap(&mut run, &mut next);
            }
            if length > 0 {
                write_value(&length, bytes)?;
                bytes.extend_from_slice(&run);
            }
            Ok(())
        }

        fn read(&mut self, bytes: &mut &[u8]) -> Result<(), ValueError> {
            let mut index = 0;
            while index < self.0.len() {
                let (length, value): (usize, L::Item) = read_value(bytes)?;
                if !(1..=self.rest(index)).contains(&length) {
                    return Err(ValueError);
                }
                (index..index + length).for_each(|index| self.0.set(index, &value));
                index += length;
            }
            Ok(())
        }
    }

    Box::new(Runs(list, longest))
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
