//! Masks for the costmap filters of Nav2: a picture whose grey values are a number from 0 to 100 per cell.

use interfaces::{Grid, GridFrame};

/// The picture of a mask (PGM, binary) with values from 0 to 100; a larger value counts as 100.
///
/// In the mode `scale` with the thresholds 0 and 1, the map server takes a pixel p as the value
/// round(100 · (255 − p) / 255): every value comes back as it was.
pub fn mask_pgm(mask: &Grid<u8>) -> Vec<u8> {
    let frame = mask.frame();
    let mut bytes = format!("P5\n{} {}\n255\n", frame.width(), frame.height()).into_bytes();
    let pixel = |value: &u8| 255 - ((u32::from((*value).min(100)) * 255 + 50) / 100) as u8;
    bytes.extend(mask.cells().chunks(frame.width()).rev().flatten().map(pixel));
    bytes
}

/// The YAML file of a mask with this frame, whose picture is called `image`.
pub fn mask_yaml(frame: &GridFrame, image: &str) -> String {
    let (origin, resolution_m) = (frame.origin(), frame.resolution_m());
    format!(
        "image: {image}\nmode: scale\nresolution: {resolution_m:?}\norigin: [{:?}, {:?}, 0.0]\nnegate: 0\n\
         occupied_thresh: 1.0\nfree_thresh: 0.0\n",
        origin.x, origin.y
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point2;

    /// The value that the map server of Nav2 gives a pixel, in the mode `scale` (nav2_map_server, map_io.cpp).
    fn served(pixel: u8, occupied_threshold: f64, free_threshold: f64) -> u8 {
        let occupied = f64::from(255 - pixel) / 255.0;
        match () {
            () if occupied > occupied_threshold => 100,
            () if occupied < free_threshold => 0,
            () => ((occupied - free_threshold) / (occupied_threshold - free_threshold) * 100.0).round() as u8,
        }
    }

    #[test]
    fn every_value_is_served_as_it_was() {
        let values: Vec<u8> = (0..=100).collect();
        let frame = GridFrame::new(Point2::new(-1.0, 2.0), 0.5, values.len(), 1).unwrap();
        let mask = Grid::from_cells(frame, values.clone()).unwrap();
        let picture = mask_pgm(&mask);
        let pixels = &picture[picture.len() - values.len()..];
        let back: Vec<u8> = pixels.iter().map(|pixel| served(*pixel, 1.0, 0.0)).collect();
        assert_eq!(back, values);
        let expected = "image: m.pgm\nmode: scale\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n\
                        occupied_thresh: 1.0\nfree_thresh: 0.0\n";
        assert_eq!(mask_yaml(&frame, "m.pgm"), expected);
    }
}
