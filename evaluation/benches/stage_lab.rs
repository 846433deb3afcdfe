//! The time to read a Stage world: `cargo bench -p curious-evaluation --bench stage_lab`.

use divan::{Bencher, black_box};
use sim::physics::{Fleet, FleetSpec};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

fn main() {
    divan::main();
}

/// The shipped Stage world, from its files to a fleet.
#[divan::bench]
fn stage_lab(bencher: Bencher<'_, '_>) {
    let files: [(&str, &[u8]); 4] = [
        ("lab.world", include_bytes!("../../worlds/stage/lab.world")),
        ("rover.inc", include_bytes!("../../worlds/stage/rover.inc")),
        ("scanner.inc", include_bytes!("../../worlds/stage/scanner.inc")),
        ("lab.png", include_bytes!("../../worlds/stage/lab.png")),
    ];
    let files: BTreeMap<PathBuf, Vec<u8>> =
        files.map(|(name, bytes)| (PathBuf::from(name), bytes.to_vec())).into();
    bencher.bench_local(|| {
        let (spec, findings) = stage::load(Path::new("lab.world"), black_box(&files));
        let spec: FleetSpec = spec.unwrap_or_else(|| panic!("{findings}"));
        Fleet::new(&spec, 0)
    });
}
