//! The time to read floor plans: `cargo bench -p curious-evaluation --bench floor_plan`.

use divan::{Bencher, black_box};
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use sim::physics::Fleet;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::PathBuf;
use worldfile::floor_plan::Bitmap;

const KINDS: [&str; 4] = ["office", "rooms", "cave", "ragged"];

fn main() {
    divan::main();
}

/// A picture of 1000 × 1000 pixels: a shipped picture, repeated (rooms of 20 × 20 pixels with doors), and walls
/// with a rough surface at every pixel.
fn picture(kind: &str) -> Vec<u8> {
    let shipped = |bytes: &[u8]| Bitmap::decode_dark(bytes, 0.5).unwrap_or_else(|error| panic!("{error}"));
    let is_dark: Box<dyn Fn(u32, u32) -> bool> = match kind {
        "office" => {
            let plan = shipped(include_bytes!("../../worlds/office.png"));
            Box::new(move |x, y| plan.is_blocked(x % plan.width(), y % plan.height()))
        }
        "cave" => {
            let plan = shipped(include_bytes!("../../worlds/cave.png"));
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

/// From the bytes of a picture to its rectangles.
#[divan::bench(args = KINDS)]
fn plan_of_1000_by_1000(bencher: Bencher<'_, '_>, kind: &str) {
    let bytes = picture(kind);
    let bitmap = Bitmap::decode_dark(&bytes, 0.5).unwrap_or_else(|error| panic!("{error}"));
    eprintln!("{kind}: {} rectangles", bitmap.rectangles().len());
    bencher.bench_local(|| {
        let bitmap = Bitmap::decode_dark(black_box(&bytes), 0.5).unwrap_or_else(|error| panic!("{error}"));
        bitmap.rectangles()
    });
}

/// From a world file with such a picture, in pixels of 5 cm, to a fleet of one robot whose laser has a range of 10
/// m, with its potentially visible set.
#[divan::bench(args = ["office", "rooms", "cave"], sample_count = 3)]
fn fleet_of_1000_by_1000(bencher: Bencher<'_, '_>, kind: &str) {
    let bytes = picture(kind);
    let bitmap = Bitmap::decode_dark(&bytes, 0.5).unwrap_or_else(|error| panic!("{error}"));
    let is_free = |x: u32, y: u32| (x..x + 12).all(|x| (y..y + 12).all(|y| !bitmap.is_blocked(x, y)));
    let free = (400..600).flat_map(|y| (400..600).map(move |x| (x, y))).find(|(x, y)| is_free(*x, *y));
    let at = free.map(|(x, y)| [f64::from(x + 6) * 0.05, f64::from(y + 6) * 0.05]);
    let text = format!(
        "name = \"plan\"\n[map]\nsize_m = [50.0, 50.0]\ncell_m = 0.05\n\
         [[floor_plan]]\nimage = \"plan.png\"\npixel_m = 0.05\n\
         [[robot]]\nname = \"a\"\nradius_m = 0.2\npose_m = {:?}\n\
         [robot.drive]\nmax_linear_mps = 0.5\nmax_angular_degps = 90.0\n\
         max_linear_acceleration_mps2 = 1.0\nmax_angular_acceleration_degps2 = 90.0\n\
         [robot.laser]\nbeams = 360\nrange_max_m = 10.0\nrate_hz = 10.0\n\
         [robot.behavior]\nkind = \"driven\"\n",
        at.unwrap_or_default()
    );
    let files = BTreeMap::from([(PathBuf::from("plan.png"), bytes)]);
    bencher.bench_local(|| {
        let spec = worldfile::physics::parse_fleet_with("plan.toml", black_box(&text), &files);
        Fleet::new(&spec.unwrap_or_else(|error| panic!("{error}")), 0)
    });
}
