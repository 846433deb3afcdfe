//! A font, a canvas, and PNG files.

use crate::palette::{self, Rgb};
use files::{OutputError, write_file};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use std::path::Path;

/// The error for a picture that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The drawing failed.
    #[error("cannot draw {name}: {why}")]
    Draw {
        /// The picture.
        name: String,
        /// The message of the plotting library.
        why: String,
    },
}

/// A part of a picture that can be drawn on.
pub type Area<'a> = DrawingArea<BitMapBackend<'a>, Shift>;

/// Pictures are drawn larger by this factor and reduced at the end, so that slanted lines and letters have smooth
/// edges.
const OVERSAMPLING: u32 = 2;

/// Converts a length in pixels of the finished picture to pixels of the larger drawing.
pub const fn px(length: u32) -> i32 {
    (length * OVERSAMPLING) as i32
}

/// The color of text and axes.
pub const INK: RGBColor = ink(palette::INK);
/// The name of the font.
pub const FONT: &str = "sans-serif";

/// Converts a color to the type of the plotting library.
pub const fn ink([red, green, blue]: Rgb) -> RGBColor {
    RGBColor(red, green, blue)
}

/// What was drawn, or why it could not be.
pub type Drawn<T = ()> = Result<T, String>;

/// Converts an error of the plotting library to a sentence.
pub fn why(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Registers a font, so that text can be drawn on machines without any fonts.
///
/// # Errors
///
/// When the font cannot be read.
pub fn register_fonts() -> Drawn {
    let registered = register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT);
    registered.map_err(|_| "the font cannot be read".into())
}

/// A finished picture.
pub struct Canvas {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The rows from the top; red, green and blue of every pixel.
    pub pixels: Vec<u8>,
}

impl Canvas {
    /// A white picture of `size` (width and height in pixels) on which `draw` has drawn.
    ///
    /// # Errors
    ///
    /// When the drawing fails.
    pub fn draw(size: [u32; 2], draw: impl FnOnce(&Area) -> Drawn) -> Drawn<Self> {
        register_fonts()?;
        let [width, height] = size.map(|length| length * OVERSAMPLING);
        let mut pixels = vec![255; width as usize * height as usize * 3];
        let area = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        draw(&area)?;
        area.present().map_err(why)?;
        drop(area);
        Ok(Self { size, pixels: shrink(&pixels, width as usize) })
    }

    /// Pictures of the same height side by side, from the left.
    pub fn beside(pictures: &[&Self]) -> Self {
        let height = pictures.iter().map(|picture| picture.size[1]).min().unwrap_or(0);
        let width = pictures.iter().map(|picture| picture.size[0]).sum();
        let row = |picture: &Self, y: usize| {
            let stride = 3 * picture.size[0] as usize;
            y * stride..(y + 1) * stride
        };
        let rows = (0..height as usize).flat_map(|y| pictures.iter().map(move |picture| (picture, y)));
        Self {
            size: [width, height],
            pixels: rows.flat_map(|(of, y)| of.pixels[row(of, y)].iter().copied()).collect(),
        }
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let [width, height] = self.size;
        write_file(path, |file| {
            let mut encoder = png::Encoder::new(file, width, height);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_compression(png::Compression::Fast);
            encoder.set_filter(png::Filter::Adaptive);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(&self.pixels)?;
            Ok(writer.finish()?)
        })
    }
}

/// A PNG file with a palette, and an index in it for every pixel.
pub fn png_of_palette([width, height]: [u32; 2], colors: &[Rgb], pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette(colors.concat());
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_filter(png::Filter::NoFilter);
    // Into memory, with as many pixels as the header says: nothing can fail.
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
    debug_assert!(written.is_ok(), "{written:?}");
    file
}

/// Reduces the picture: every square of pixels becomes its mean.
fn shrink(pixels: &[u8], width: usize) -> Vec<u8> {
    let by = OVERSAMPLING as usize;
    let stride = 3 * width;
    let mut small = Vec::with_capacity(pixels.len() / (by * by));
    let mut sums = vec![0; stride / by];
    for rows in pixels.chunks_exact(by * stride) {
        sums.fill(0);
        for row in rows.chunks_exact(stride) {
            for (pixels, sum) in row.chunks_exact(3 * by).zip(sums.chunks_exact_mut(3)) {
                for pixel in pixels.chunks_exact(3) {
                    sum.iter_mut().zip(pixel).for_each(|(sum, &value)| *sum += usize::from(value));
                }
            }
        }
        small.extend(sums.iter().map(|sum| (sum / (by * by)) as u8));
    }
    small
}
