//! Values of cells as an array of numbers for `numpy.load`.

use files::{OutputError, write_file};
use interfaces::Grid;
use std::path::Path;

/// Writes the values of all cells as an array of 32-bit numbers with the shape (rows, columns); row 0 has the lowest y.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write_values(path: &Path, values: &Grid<f64>) -> Result<(), OutputError> {
    let frame = values.frame();
    write_file(path, |file| {
        file.write_all(&npy_header(&[frame.height(), frame.width()]))?;
        values.cells().iter().try_for_each(|value| file.write_all(&(*value as f32).to_le_bytes()))
    })
}

/// What stands before the numbers in a file of NumPy: a magic number, the version 1.0, and a dictionary in the syntax of
/// Python, filled with spaces to a multiple of 64 bytes (`numpy.lib.format`). The numbers are little-endian and have 32
/// bits; the last index varies fastest.
fn npy_header(shape: &[usize]) -> Vec<u8> {
    const BEFORE: usize = 10;
    let shape = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
    // The longest text has 128 bytes: three numbers of 20 digits.
    let length = (BEFORE + text.len() + 1).next_multiple_of(64) - BEFORE;
    text += &" ".repeat(length - 1 - text.len());
    text.push('\n');
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(text.into_bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::GridFrame;
    use nalgebra::Point2;

    /// The description and the data of a file of format 1.0.
    fn split(bytes: &[u8]) -> (&str, &[u8]) {
        let (begin, rest) = bytes.split_at(10);
        assert_eq!(begin[..8], *b"\x93NUMPY\x01\x00");
        let (text, data) = rest.split_at(u16::from_le_bytes([begin[8], begin[9]]).into());
        (std::str::from_utf8(text).unwrap().trim_end(), data)
    }

    #[test]
    fn the_file_is_as_numpy_describes_it() {
        let frame = GridFrame::new(Point2::origin(), 1.0, 3, 2).unwrap();
        let values = Grid::from_cells(frame, vec![0.0, 1.0, 2.0, f64::NAN, 4.0, 5.5]).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("values.npy");
        write_values(&path, &values).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let (text, data) = split(&bytes);
        assert_eq!(text, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }");
        let numbers: Vec<f32> =
            data.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert!(numbers[3].is_nan());
        assert_eq!([&numbers[..3], &numbers[4..]].concat(), [0.0, 1.0, 2.0, 4.0, 5.5]);
        for shape in [[8, 1, 1], [8, 600, 12_345], [8, 1_000_000, 1]] {
            let header = npy_header(&shape);
            assert!(header.len().is_multiple_of(64) && header.ends_with(b"\n"), "{shape:?}");
            assert!(split(&header).0.contains(&format!("{shape:?}").replace(['[', ']'], "")), "{shape:?}");
        }
    }
}
