//! What it costs to read floor plans and worlds of Stage: `cargo bench -p sim --bench floor_plan`.

use divan::{Bencher, black_box};
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use sim::floor_plan::Bitmap;
use sim::physics::{Fleet, FleetSpec};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

const KINDS: [&str; 4] = ["office", "rooms", "cave", "ragged"];

fn main() {
    divan::main();
}

/// A picture of 1000 × 1000 pixels: the shipped ones repeated, rooms of 20 × 20 pixels with doors,
/// and walls of which every pixel of the surface is rough.
fn picture(kind: &str) -> Vec<u8> {
    let shipped = |bytes: &[u8]| Bitmap::decode_dark(bytes, 0.5).unwrap_or_else(|error| panic!("{error}"));
    let is_dark: Box<dyn Fn(u32, u32) -> bool> = match kind {
        "office" => {
            let plan = shipped(include_bytes!("../worlds/office.png"));
            Box::new(move |x, y| plan.is_blocked(x % plan.width(), y % plan.height()))
        }
        "cave" => {
            let plan = shipped(include_bytes!("../worlds/cave.png"));
            Box::new(move |x, y| plan.is_blocked(x % plan.width(), y % plan.height()))
        }
        "rooms" => Box::new(|x, y| (x % 20 < 2 || y % 20 < 2) && (x % 20) / 4 != 2 && (y % 20) / 4 != 2),
        _ => Box::new(|x, y| (x % 40 < 10) != ((x ^ y) % 3 == 0 && x % 10 < 2)),
    };
    let grey = |x, y| Luma([if is_dark(x, y) { 0 } else { 254 }]);
    let mut bytes = Cursor::new(Vec::new());
    let picture = DynamicImage::ImageLuma8(GrayImage::from_fn(1000, 1000, grey));
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap_or_else(|error| panic!("{error}"));
    bytes.into_inner()
}

/// From the bytes of a picture to its outline and its rectangles.
#[divan::bench(args = KINDS)]
fn plan_of_1000_by_1000(bencher: Bencher<'_, '_>, kind: &str) {
    let bytes = picture(kind);
    let bitmap = Bitmap::decode_dark(&bytes, 0.5).unwrap_or_else(|error| panic!("{error}"));
    let (segments, sides) = (bitmap.outline().len(), bitmap.boundary_sides());
    let rectangles = bitmap.rectangles().len();
    eprintln!("{kind}: {segments} segments of {sides} boundary pixels, {rectangles} rectangles");
    bencher.bench_local(|| {
        let bitmap = Bitmap::decode_dark(black_box(&bytes), 0.5).unwrap_or_else(|error| panic!("{error}"));
        (bitmap.outline(), bitmap.rectangles())
    });
}

/// The shipped Stage world, from its files to a fleet.
#[divan::bench]
fn stage_lab(bencher: Bencher<'_, '_>) {
    let files: [(&str, &[u8]); 4] = [
        ("lab.world", include_bytes!("../worlds/stage/lab.world")),
        ("rover.inc", include_bytes!("../worlds/stage/rover.inc")),
        ("scanner.inc", include_bytes!("../worlds/stage/scanner.inc")),
        ("lab.png", include_bytes!("../worlds/stage/lab.png")),
    ];
    let files: BTreeMap<PathBuf, Vec<u8>> =
        files.map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).into();
    bencher.bench_local(|| {
        let (spec, findings) = sim::stage::load(Path::new("lab.world"), black_box(&files));
        let spec: FleetSpec = spec.unwrap_or_else(|| panic!("{findings}"));
        Fleet::new(&spec, 0)
    });
}
