//! Pictures as gray values, decoded only if the size in their header is acceptable.

use image::codecs::png::PngDecoder;
use image::codecs::pnm::PnmDecoder;
use image::{DynamicImage, ImageDecoder, Limits};
use std::io::Cursor;

/// The maximum size of a file, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 28;
/// The maximum number of pixels: 400 m × 400 m in pixels of 5 cm.
pub const MAX_PIXELS: u64 = 1 << 26;
/// The maximum memory of the pixels, bytes.
const MAX_DECODED_BYTES: u64 = 1 << 28;

/// The errors of pictures that are not floor plans.
pub(super) const EMPTY: &str = "it has no pixels";
const DAMAGED_HEADER: &str = "its header is damaged or incomplete, or that of too large a picture";

/// A pixel. All values are from 0 (dark, transparent) to 1 (bright, opaque); a gray pixel has
/// three equal colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Red.
    pub red: f64,
    /// Green.
    pub green: f64,
    /// Blue.
    pub blue: f64,
    /// Opacity; 1 where the picture knows no transparency.
    pub alpha: f64,
}

impl Pixel {
    /// The mean of the colors, without regard to transparency.
    pub fn brightness(&self) -> f64 {
        (self.red + self.green + self.blue) / 3.0
    }

    /// The brightness on a white ground.
    pub fn on_white(&self) -> f64 {
        1.0 - self.alpha * (1.0 - self.brightness())
    }
}

/// Decodes a picture, unless it is too large by its header.
pub(crate) fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let damaged = |_| DAMAGED_HEADER.to_owned();
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => {
            let mut limits = Limits::no_limits();
            limits.max_alloc = Some(2 * MAX_DECODED_BYTES);
            read(PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?)
        }
        [b'P', b'1'..=b'7', ..] => read(PnmDecoder::new(Cursor::new(bytes)).map_err(damaged)?),
        _ => Err("it is neither a PNG nor a PGM picture".to_owned()),
    }
}

fn read(decoder: impl ImageDecoder) -> Result<DynamicImage, String> {
    let ((width, height), bytes) = (decoder.dimensions(), decoder.total_bytes());
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!("{width} × {height} pixels are too many: at most {MAX_PIXELS}"));
    }
    if width == 0 || height == 0 {
        return Err(EMPTY.to_owned());
    }
    if bytes > MAX_DECODED_BYTES {
        return Err(format!(
            "its pixels take {bytes} bytes, which are too many: at most {MAX_DECODED_BYTES}"
        ));
    }
    DynamicImage::from_decoder(decoder).map_err(|_| "its pixels are damaged or incomplete".to_owned())
}

/// The pixels of row `y`, counted from the top. Not of all rows at once: that would take too much memory.
pub(crate) fn row(image: &DynamicImage, y: u32) -> Vec<Pixel> {
    let color = image.color();
    let [channels, bytes] = [color.channel_count(), color.bytes_per_pixel()].map(usize::from);
    let width = image.width() as usize * bytes;
    let pixel = |pixel: &[u8]| {
        let value = |channel: usize| match pixel[channel * bytes / channels..] {
            [low, high, ..] if bytes > channels => f64::from(u16::from_ne_bytes([low, high])) / 65535.0,
            [value, ..] => f64::from(value) / 255.0,
            [] => 1.0,
        };
        let [red, green, blue] = if channels < 3 { [value(0); 3] } else { [0, 1, 2].map(value) };
        let alpha = if channels.is_multiple_of(2) { value(channels - 1) } else { 1.0 };
        Pixel { red, green, blue, alpha }
    };
    image.as_bytes()[y as usize * width..][..width].chunks_exact(bytes).map(pixel).collect()
}
