//! `layers.npy`: all that was learned about the cells, as one array of numbers for `numpy.load`; `layers.json`: what its
//! layers are.

use crate::intervals::Intervals;
use files::{OutputError, write_file};
use interfaces::{CellState, Grid};
use mapper::Mapper;
use serde_json::json;
use std::path::Path;

/// The version of the layout of both files; count up when a layer is renamed, removed, moved or changes its meaning.
const SCHEMA: u32 = 1;
/// A layer: the name, with the unit, and the value of a cell, by its index and the credible interval of its rate.
type Layer = (&'static str, fn(&Mapper, usize, (f64, f64)) -> f64);

/// The layers, in the order of the array.
const LAYERS: [Layer; 8] = [
    ("blocked", |of, index, _| f64::from(u8::from(of.states().cells()[index] == CellState::Blocked))),
    ("rate_hz", |of, index, _| of.rate(index)),
    ("rate_low_hz", |_, _, (low, _)| low),
    ("rate_high_hz", |_, _, (_, high)| high),
    ("blocked_probability", |of, index, _| of.blocked_probability(index)),
    ("change_probability", |of, index, _| of.change_probability(index)),
    ("recency_s", |of, index, _| of.recency(index)),
    ("observed_s", |of, index, _| of.statistics(index).observed()),
];

/// The layers before these in a list of cells.
const PLACES: [Layer; 2] = [
    ("column", |of, index, _| f64::from(of.frame().cell(index).x)),
    ("row", |of, index, _| f64::from(of.frame().cell(index).y)),
];

/// The maximum number of cells of an array of rows and columns, which then has half a gibibyte: a square of 200 m with cells of
/// 0.05 m.
const MAX_CELLS: usize = 1 << 24;

/// Writes an array of 32-bit numbers with the shape (layers, rows, columns); row 0 has the lowest y. The layers are
/// the map (0 free, 1 blocked), the rate and its 90 % credible interval in cycles per second, the probability
/// of being blocked now, the probability of a change since last seen, the time since last seen and the time in view, s.
/// Cells that were never seen are NaN in all layers. A file beside it with the ending `.json` names the layers, and where the
/// array lies in the map.
///
/// Of a map with more than 2²⁴ cells, the array lists the cells that were seen: its shape is (layers, cells), and two more layers
/// before the others are the column and the row of each cell.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper, intervals: &Intervals) -> Result<(), OutputError> {
    write_up_to(MAX_CELLS, path, mapper, intervals)
}

/// [`write`], with lists for maps of more than this number of cells.
fn write_up_to(most: usize, path: &Path, mapper: &Mapper, intervals: &Intervals) -> Result<(), OutputError> {
    let frame = mapper.frame();
    let is_list = frame.len() > most;
    let layers: Vec<Layer> = if is_list { [&PLACES[..], &LAYERS].concat() } else { LAYERS.to_vec() };
    let mut about = json!({
        "schema": SCHEMA,
        "layers": layers.iter().map(|(name, _)| name).collect::<Vec<_>>(),
        "resolution_m": frame.resolution_m(),
        "origin_m": [frame.origin().x, frame.origin().y],
    });
    let shape = if is_list {
        about["columns_and_rows"] = json!([frame.width(), frame.height()]);
        vec![layers.len(), intervals.len()]
    } else {
        vec![layers.len(), frame.height(), frame.width()]
    };
    write_file(&path.with_extension("json"), |file| writeln!(file, "{about:#}"))?;
    write_file(path, |file| {
        file.write_all(&npy_header(&shape))?;
        let mut write = |value: f64| file.write_all(&(value as f32).to_le_bytes());
        for (_, value) in layers {
            let mut next = 0;
            for (index, interval) in intervals.of_cells(mapper) {
                (next..if is_list { next } else { index }).try_for_each(|_| write(f64::NAN))?;
                write(value(mapper, index, interval))?;
                next = index + 1;
            }
            (next..if is_list { next } else { frame.len() }).try_for_each(|_| write(f64::NAN))?;
        }
        Ok(())
    })
}

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
    use mapper::MapperSettings;
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
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("layers.npy");
        write(&path, &mapper, &Intervals::of(&mapper)).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let (text, data) = split(&bytes);
        assert_eq!(text, "{'descr': '<f4', 'fortran_order': False, 'shape': (8, 2, 3), }");
        let mut numbers = data.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()));
        assert!(numbers.len() == 48 && numbers.all(f32::is_nan));
        let about = std::fs::read_to_string(folder.path().join("layers.json")).unwrap();
        // Another order or another name is another schema.
        insta::assert_snapshot!(about.replace(char::is_whitespace, ""), @r#"{"layers":["blocked","rate_hz","rate_low_hz","rate_high_hz","blocked_probability","change_probability","recency_s","observed_s"],"origin_m":[0.0,0.0],"resolution_m":1.0,"schema":1}"#);
        // A cell that was seen, in a list.
        let mut mapper = mapper;
        let cells = vec![(interfaces::Cell::new(2, 1), true), (interfaces::Cell::new(0, 0), false)];
        let pose = interfaces::pose(0.5, 0.5, 0.0);
        mapper.update(&interfaces::CellReading { time: 1.0, pose, cells }).unwrap();
        write_up_to(5, &path, &mapper, &Intervals::of(&mapper)).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let (text, data) = split(&bytes);
        assert_eq!(text, "{'descr': '<f4', 'fortran_order': False, 'shape': (10, 2), }");
        let numbers: Vec<f32> =
            data.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
        assert_eq!(numbers[..6], [0.0, 2.0, 0.0, 1.0, 0.0, 1.0]);
        let about = std::fs::read_to_string(folder.path().join("layers.json")).unwrap();
        insta::assert_snapshot!(about.replace(char::is_whitespace, ""), @r#"{"columns_and_rows":[3,2],"layers":["column","row","blocked","rate_hz","rate_low_hz","rate_high_hz","blocked_probability","change_probability","recency_s","observed_s"],"origin_m":[0.0,0.0],"resolution_m":1.0,"schema":1}"#);
        for shape in [[8, 1, 1], [8, 600, 12_345], [8, 1_000_000, 1]] {
            let header = npy_header(&shape);
            assert!(header.len().is_multiple_of(64) && header.ends_with(b"\n"), "{shape:?}");
            assert!(split(&header).0.contains(&format!("{shape:?}").replace(['[', ']'], "")), "{shape:?}");
        }
    }
}
