//! Maps as the two files of the ROS `map_server`, a picture (PGM, binary) and a YAML file, and masks for the costmap filters of
//! Nav2. The crate `worldfile` reads maps.

use files::{OutputError, UnfinishedFile};
use interfaces::{CellState, Grid};
use std::path::Path;

/// What a map is saved with. 205 is p = 0.19608: with the customary threshold of 0.25 it would
/// come back as free.
const FREE_THRESHOLD: f64 = 0.196;
const OCCUPIED_THRESHOLD: f64 = 0.65;
const FREE: u8 = 254;
const UNKNOWN: u8 = 205;
const BLOCKED: u8 = 0;

/// Writes a map into a folder: the files `NAME.pgm` and `NAME.yaml`.
///
/// # Errors
///
/// When a file cannot be written.
pub fn write(folder: &Path, name: &str, map: &Grid<CellState>) -> Result<(), OutputError> {
    write_both(folder, name, (map, map_pixel), "trinary", [OCCUPIED_THRESHOLD, FREE_THRESHOLD])
}

/// Writes a mask with values from 0 to 100 into a folder, as [`write()`].
///
/// # Errors
///
/// When a file cannot be written.
pub fn write_mask(folder: &Path, name: &str, mask: &Grid<u8>) -> Result<(), OutputError> {
    write_both(folder, name, (mask, mask_pixel), "scale", [1.0, 0.0])
}

fn map_pixel(state: &CellState) -> u8 {
    match state {
        CellState::Free => FREE,
        CellState::Unknown => UNKNOWN,
        CellState::Blocked => BLOCKED,
    }
}

/// The pixel of a mask; a value above 100 counts as 100.
///
/// In the mode `scale` with the thresholds 0 and 1, the map server takes a pixel p as the value
/// round(100 · (255 − p) / 255): every value comes back as it was.
fn mask_pixel(value: &u8) -> u8 {
    255 - ((u32::from((*value).min(100)) * 255 + 50) / 100) as u8
}

fn write_both<T>(
    folder: &Path,
    name: &str,
    (grid, pixel): (&Grid<T>, fn(&T) -> u8),
    mode: &str,
    [occupied, free]: [f64; 2],
) -> Result<(), OutputError> {
    let frame = grid.frame();
    let file = |ending| UnfinishedFile::create(&folder.join(format!("{name}.{ending}")));
    let (picture, description) = (file("pgm")?, file("yaml")?); // both or none
    // Row by row: the picture of a large place is larger than its map in memory.
    picture.write(|file| {
        write!(file, "P5\n{} {}\n255\n", frame.width(), frame.height())?;
        grid.rows().rev().try_for_each(|row| file.write_all(&row.map(pixel).collect::<Vec<_>>()))
    })?;
    let (origin, resolution_m) = (frame.origin(), frame.resolution_m());
    description.write(|file| {
        write!(
            file,
            "image: {name}.pgm\nmode: {mode}\nresolution: {resolution_m:?}\norigin: [{:?}, {:?}, 0.0]\nnegate: 0\n\
             occupied_thresh: {occupied:?}\nfree_thresh: {free:?}\n",
            origin.x, origin.y
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::GridFrame;
    use nalgebra::Point2;

    /// The value that the map server of Nav2 gives a pixel, in the mode `scale` (nav2_map_server, map_io.cpp).
    fn served(pixel: u8, occupied_threshold: f64, free_threshold: f64) -> u8 {
        let occupied = f64::from(255 - pixel) / 255.0;
        let share = (occupied - free_threshold) / (occupied_threshold - free_threshold);
        (share.clamp(0.0, 1.0) * 100.0).round() as u8
    }

    #[test]
    fn every_value_is_served_as_it_was() {
        let values: Vec<u8> = (0..=100).collect();
        let frame = GridFrame::new(Point2::new(-1.0, 2.0), 0.5, values.len(), 1).unwrap();
        let mask = Grid::from_cells(frame, values.clone()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        write_mask(folder.path(), "m", &mask).unwrap();
        let picture = std::fs::read(folder.path().join("m.pgm")).unwrap();
        let pixels = &picture[picture.len() - values.len()..];
        let back: Vec<u8> = pixels.iter().map(|pixel| served(*pixel, 1.0, 0.0)).collect();
        assert_eq!(back, values);
        let expected = "image: m.pgm\nmode: scale\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                        occupied_thresh: 1.0\nfree_thresh: 0.0\n";
        assert_eq!(std::fs::read_to_string(folder.path().join("m.yaml")).unwrap(), expected);
    }
}
