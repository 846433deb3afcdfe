//! Pictures of every kind, whole and damaged.

use crate::floor_plan::{Bitmap, MAX_PIXELS};
use image::{DynamicImage, GrayImage, ImageFormat, Luma, Rgba, RgbaImage};
use proptest::prelude::*;
use std::io::Cursor;

fn encode(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

fn dark(bytes: &[u8]) -> Result<String, String> {
    let bitmap = Bitmap::decode_dark(bytes, 0.5)?;
    let row = |y| (0..bitmap.width()).map(|x| if bitmap.is_blocked(x, y) { '#' } else { '.' }).collect();
    let rows: Vec<String> = (0..bitmap.height()).rev().map(row).collect();
    Ok(rows.join("/"))
}

#[test]
fn every_depth_says_the_same() {
    let grey =
        GrayImage::from_fn(3, 2, |x, y| Luma([[[0, 127, 128], [255, 254, 1]][y as usize][x as usize]]));
    let grey = DynamicImage::ImageLuma8(grey);
    let all = [
        grey.clone(),
        DynamicImage::ImageLuma16(grey.to_luma16()),
        DynamicImage::ImageRgb8(grey.to_rgb8()),
        DynamicImage::ImageRgba8(grey.to_rgba8()),
        DynamicImage::ImageRgba16(grey.to_rgba16()),
    ];
    for picture in &all {
        for format in [ImageFormat::Png, ImageFormat::Pnm] {
            assert_eq!(dark(&encode(picture, format)).unwrap(), "##./..#");
        }
    }
}

#[test]
fn text_pictures_bits_and_other_scales() {
    assert_eq!(dark(b"P2\n# by hand\n3 2\n255\n0 127 128\n255 254 1\n").unwrap(), "##./..#");
    // 49 of 100 is dark, 50 is not: the scale is the file's.
    assert_eq!(dark(b"P2 3 1 100 0 49 50").unwrap(), "##.");
    assert_eq!(dark(b"P5 3 1 100 \x00\x31\x32").unwrap(), "##.");
    // A bit that is set is black.
    assert_eq!(dark(b"P1 3 1 1 0 1").unwrap(), "#.#");
    assert_eq!(dark(b"P4 3 1 \xa0").unwrap(), "#.#");
    assert_eq!(dark(b"P5 2 1 65535 \x7f\xff\x80\x00").unwrap(), "#.");
}

#[test]
fn what_is_transparent_is_white() {
    let picture = RgbaImage::from_fn(3, 1, |x, _| Rgba([0, 0, 0, [0, 127, 255][x as usize]]));
    assert_eq!(dark(&encode(&DynamicImage::ImageRgba8(picture), ImageFormat::Png)).unwrap(), "..#");
}

/// A PNG whose header is in order and tells of `width` × `height` pixels, and no pixels.
fn png_header(width: u32, height: u32, depth: u8, colour: u8) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([depth, colour, 0, 0, 0]);
    let crc = chunk.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 },
        )
    });
    let mut bytes = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    bytes.extend(chunk);
    bytes.extend((!crc).to_be_bytes());
    // The start of the pixels, which a decoder looks for before it tells of the header.
    bytes.extend(b"\0\0\0\x0aIDAT\x78\x9c");
    bytes
}

#[test]
fn bombs_and_noise_are_refused() {
    let is_refused = |bytes: &[u8], why: &str| {
        let error = dark(bytes).unwrap_err();
        assert!(error.contains(why), "{error}");
    };
    is_refused(&png_header(100_000, 100_000, 8, 0), "too");
    is_refused(&png_header(0x7fff_ffff, 0x7fff_ffff, 16, 6), "too");
    is_refused(b"P5 4000000000 4000000000 255 \0", "4000000000 × 4000000000 pixels are too many");
    is_refused(b"P4 65536 65536 \0", "65536 × 65536 pixels are too many");
    is_refused(&png_header(8000, 8000, 16, 6), "its pixels take 512000000 bytes");
    // As many pixels as there may be are decoded, so that this is damaged and no bomb.
    assert_eq!(MAX_PIXELS, 8192 * 8192);
    is_refused(&png_header(8192, 8192, 8, 0), "its pixels are damaged");
    let rows = (0..2000).flat_map(|y| [if y % 2 == 0 { 0xaa } else { 0x55 }; 250]);
    let noise: Vec<u8> = b"P4 2000 2000\n".iter().copied().chain(rows).collect();
    is_refused(&noise, "more than 1048576 rectangles");
}

/// The largest picture that is allowed, of the fewest bytes, in at most 1 GiB: run alone as
/// `(ulimit -v 1048576; TEST-PROGRAM largest_picture --ignored)`.
#[test]
#[ignore = "slow; for measuring memory"]
fn largest_picture() {
    let picture = RgbaImage::from_fn(8192, 8192, |x, y| Rgba([(x / 16 + y / 16) as u8 % 2 * 255, 0, 0, 255]));
    let bytes = encode(&DynamicImage::ImageRgba8(picture), ImageFormat::Png);
    let bitmap = Bitmap::decode_dark(&bytes, 0.2).unwrap();
    assert!(bitmap.rectangles().len() > 100_000);
}

fn samples() -> Vec<Vec<u8>> {
    let grey = GrayImage::from_fn(9, 7, |x, y| Luma([(x * y * 31 % 256) as u8]));
    let grey = DynamicImage::ImageLuma8(grey);
    let rgba = DynamicImage::ImageRgba8(grey.to_rgba8());
    vec![
        encode(&grey, ImageFormat::Png),
        encode(&rgba, ImageFormat::Png),
        encode(&grey, ImageFormat::Pnm),
        b"P2 3 2 255 0 127 128 255 254 1 ".to_vec(),
        b"P1 3 1 1 0 1".to_vec(),
    ]
}

proptest! {
    /// Any bytes: a plan or an error, soon, and never a panic.
    #[test]
    fn no_bytes_make_it_panic(head in 0..8_usize, bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let heads: [&[u8]; 8] = [b"", b"\x89PNG\r\n\x1a\n", b"P1", b"P2 ", b"P3 9 9 ", b"P4 9 9 ", b"P5 9 9 255 ", b"P6"];
        let bytes = [heads[head], &bytes].concat();
        let _ = Bitmap::decode_dark(&bytes, 0.5);
    }

    /// The same with pictures that are almost whole.
    #[test]
    fn no_damage_makes_it_panic(
        sample in 0..5_usize,
        places in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in proptest::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = samples().swap_remove(sample);
        for (place, byte) in places {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = Bitmap::decode_dark(&bytes, 0.5);
    }
}
