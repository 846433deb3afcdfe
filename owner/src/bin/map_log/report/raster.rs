//! The cells of a map as a picture inside the page.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use draw::palette::Rgb;
use interfaces::Grid;
use nalgebra::Point2;

/// The largest number of samples of a pixel along one side.
const MAX_SAMPLES: usize = 6;

/// A class for every cell of a map, the color of each class, and which class is shown where several meet in one pixel.
pub(super) struct Cells {
    pub(super) classes: Grid<u8>,
    pub(super) colors: Vec<Rgb>,
    /// The class with the highest rank is shown.
    pub(super) rank: fn(u8) -> u8,
    /// The class of what is outside.
    pub(super) outside: u8,
}

impl Cells {
    /// The picture with this number of pixels, as a PNG file in a `data:` address. `at` gives the point of the map, m, at a
    /// position in pixels from the upper left; `pixel_m`: the side of a pixel.
    pub(super) fn address(
        &self,
        [width, height]: [u32; 2],
        pixel_m: f64,
        at: impl Fn(f64, f64) -> Point2<f64>,
    ) -> String {
        let samples = (1.5 * pixel_m / self.classes.frame().resolution_m()).ceil().max(1.0) as usize;
        let samples = samples.min(MAX_SAMPLES);
        let offsets: Vec<f64> = (0..samples).map(|sample| (sample as f64 + 0.5) / samples as f64).collect();
        let class_at = |x: f64, y: f64| {
            self.classes.get(self.classes.frame().cell_at(&at(x, y))).copied().unwrap_or(self.outside)
        };
        let pixel = |x: u32, y: u32| {
            let samples = offsets.iter().flat_map(|dy| offsets.iter().map(move |dx| (dx, dy)));
            let classes = samples.map(|(dx, dy)| class_at(f64::from(x) + dx, f64::from(y) + dy));
            classes.max_by_key(|class| (self.rank)(*class)).unwrap_or(self.outside)
        };
        let pixels: Vec<u8> =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
        format!("data:image/png;base64,{}", STANDARD.encode(self.png([width, height], &pixels)))
    }

    /// A PNG file with a palette.
    fn png(&self, [width, height]: [u32; 2], pixels: &[u8]) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_palette(self.colors.concat());
        encoder.set_compression(png::Compression::Balanced);
        encoder.set_filter(png::Filter::NoFilter);
        // Into memory, with as many pixels as the header says: nothing can fail.
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
        debug_assert!(written.is_ok(), "{written:?}");
        file
    }
}
