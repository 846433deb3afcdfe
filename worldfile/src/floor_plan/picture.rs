//! Pictures as gray values, decoded only if the size in their header is acceptable.

use super::PlanError;
use image::codecs::png::PngDecoder;
use image::codecs::pnm::PnmDecoder;
use image::{ColorType, ImageDecoder, Limits};
use std::io::Cursor;

/// The maximum size of a file, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 28;
/// The maximum number of pixels: 400 m × 400 m in pixels of 5 cm.
pub const MAX_PIXELS: u64 = 1 << 26;
/// The maximum memory of the pixels, bytes.
pub const MAX_DECODED_BYTES: u64 = 1 << 28;

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

/// A decoded picture.
pub(crate) struct Raster {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Colors, and perhaps opacity, of a pixel.
    channels: usize,
    /// Whether a value takes two bytes.
    is_wide: bool,
    bytes: Vec<u8>,
}

impl Raster {
    pub(crate) fn decode(bytes: &[u8]) -> Result<Self, PlanError> {
        let damaged = |_| PlanError::DamagedHeader;
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => {
                // Without the first chunk, its place holds no size.
                if bytes.get(12..16) != Some(b"IHDR") {
                    return Err(PlanError::DamagedHeader);
                }
                // The decoder's own limits would hide how large the picture claims to be.
                if let Some([a, b, c, d, e, f, g, h]) = bytes.get(16..24) {
                    let (width, height) = ([*a, *b, *c, *d], [*e, *f, *g, *h]);
                    check(u32::from_be_bytes(width), u32::from_be_bytes(height))?;
                }
                let mut limits = Limits::no_limits();
                limits.max_alloc = Some(2 * MAX_DECODED_BYTES);
                Self::from_decoder(PngDecoder::with_limits(Cursor::new(bytes), limits).map_err(damaged)?)
            }
            [b'P', b'1'..=b'7', ..] => {
                Self::from_decoder(PnmDecoder::new(Cursor::new(bytes)).map_err(damaged)?)
            }
            _ => Err(PlanError::Format),
        }
    }

    fn from_decoder(decoder: impl ImageDecoder) -> Result<Self, PlanError> {
        let (width, height) = decoder.dimensions();
        check(width, height)?;
        let size = decoder.total_bytes();
        if size > MAX_DECODED_BYTES {
            return Err(PlanError::TooManyBytes { bytes: size });
        }
        let (channels, is_wide) = match decoder.color_type() {
            ColorType::L8 => (1, false),
            ColorType::La8 => (2, false),
            ColorType::Rgb8 => (3, false),
            ColorType::Rgba8 => (4, false),
            ColorType::L16 => (1, true),
            ColorType::La16 => (2, true),
            ColorType::Rgb16 => (3, true),
            ColorType::Rgba16 => (4, true),
            _ => return Err(PlanError::Format),
        };
        let mut bytes = vec![0; size as usize];
        decoder.read_image(&mut bytes).map_err(|_| PlanError::DamagedPixels)?;
        Ok(Self { width, height, channels, is_wide, bytes })
    }

    /// The pixels of row `y`, counted from the top.
    pub(crate) fn row(&self, y: u32) -> impl Iterator<Item = Pixel> {
        let pixel_bytes = self.channels * if self.is_wide { 2 } else { 1 };
        let row_bytes = self.width as usize * pixel_bytes;
        let row = &self.bytes[y as usize * row_bytes..][..row_bytes];
        row.chunks_exact(pixel_bytes).map(|pixel| self.pixel(pixel))
    }

    fn pixel(&self, bytes: &[u8]) -> Pixel {
        let value = |channel: usize| {
            if self.is_wide {
                f64::from(u16::from_ne_bytes([bytes[2 * channel], bytes[2 * channel + 1]])) / 65535.0
            } else {
                f64::from(bytes[channel]) / 255.0
            }
        };
        let alpha = if self.channels.is_multiple_of(2) { value(self.channels - 1) } else { 1.0 };
        let (red, green, blue) = match self.channels {
            1 | 2 => (value(0), value(0), value(0)),
            _ => (value(0), value(1), value(2)),
        };
        Pixel { red, green, blue, alpha }
    }
}

/// Refuses what is too large to decode, or nothing.
fn check(width: u32, height: u32) -> Result<(), PlanError> {
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(PlanError::TooManyPixels { width, height });
    }
    if width == 0 || height == 0 { Err(PlanError::Empty) } else { Ok(()) }
}
