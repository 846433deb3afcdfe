//! What every figure and picture has in common: a font, a canvas, PNG files, and one color for one meaning.

mod canvas;
pub mod palette;

pub use canvas::{Area, Canvas, FONT, INK, PictureError, ink, px, register_fonts, text, why};
