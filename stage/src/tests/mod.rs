mod bad;
mod bytes;
mod lab;
mod meaning;

use super::{StageWorld, read};
use image::{DynamicImage, GrayImage, ImageFormat, Luma};
use sim::physics::FleetSpec;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use worldfile::Findings;

type Table = BTreeMap<PathBuf, Vec<u8>>;

/// The shipped example and all included files.
fn lab_files() -> Table {
    let files: [(&str, &[u8]); 4] = [
        ("lab.world", include_bytes!("../../../worlds/stage/lab.world")),
        ("rover.inc", include_bytes!("../../../worlds/stage/rover.inc")),
        ("scanner.inc", include_bytes!("../../../worlds/stage/scanner.inc")),
        ("lab.png", include_bytes!("../../../worlds/stage/lab.png")),
    ];
    table(&files)
}

fn table(files: &[(&str, &[u8])]) -> Table {
    files.iter().map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).collect()
}

/// A picture of 6 × 4 pixels, of which 4 × 2 in the middle are dark but for one.
fn picture() -> Vec<u8> {
    let grey = |x: u32, y: u32| {
        if (1..5).contains(&x) && (1..3).contains(&y) && (x, y) != (1, 1) { 127 } else { 128 }
    };
    let picture = DynamicImage::ImageLuma8(GrayImage::from_fn(6, 4, |x, y| Luma([grey(x, y)])));
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Reads one text, beside which there is a picture.
fn one(text: &str) -> (Option<StageWorld>, Findings) {
    let files = table(&[("x.world", text.as_bytes()), ("p.png", &picture())]);
    let (world, findings) = read(Path::new("x.world"), &files);
    assert_eq!(world.is_none(), findings.errors() > 0, "{findings}");
    (world, findings)
}

/// Reads one text and makes a fleet of it.
fn load_one(text: &str) -> (Option<FleetSpec>, Findings) {
    let files = table(&[("x.world", text.as_bytes()), ("p.png", &picture())]);
    let (spec, findings) = super::load(Path::new("x.world"), &files);
    assert_eq!(spec.is_none(), findings.errors() > 0);
    (spec, findings)
}

/// The same where there must be a fleet.
fn fleet(text: &str) -> (FleetSpec, Findings) {
    let (spec, findings) = load_one(text);
    (spec.unwrap_or_else(|| panic!("{findings}")), findings)
}

/// The same where there must be a world.
fn good(text: &str) -> StageWorld {
    let (world, findings) = one(text);
    world.unwrap_or_else(|| panic!("{findings}"))
}
