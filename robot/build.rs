//! Hashes the sources of all that decides on the bits of a result: our algorithms, and the versions of all packages.

use std::path::{Path, PathBuf};
use std::{env, fs, io};
use xxhash_rust::xxh3::Xxh3;

/// The crates with algorithms. What only writes, draws or talks does not change a result.
const ALGORITHMS: [&str; 13] = [
    "agent",
    "calendar",
    "controller",
    "evaluation",
    "interfaces",
    "localizer",
    "logs",
    "mapper",
    "robot",
    "sim",
    "stage",
    "survey",
    "worldfile",
];

/// The crates whose types are in a state: what was learned of a place. The rest of a run is read by the same build only.
const LEARNED: [&str; 5] = ["interfaces/", "localizer/", "mapper/", "robot/", "survey/"];

fn main() -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("..");
    let mut files = vec![root.join("Cargo.lock")];
    if files[0].exists() {
        for name in ALGORITHMS {
            add_sources(&root.join(name).join("src"), &mut files)?;
        }
    } else {
        files.clear(); // a package of crates.io: its version names its sources
    }
    files.sort();
    let (mut hash, mut layouts) = (Xxh3::new(), Xxh3::new());
    hash.update(env!("CARGO_PKG_VERSION").as_bytes());
    for path in &files {
        println!("cargo::rerun-if-changed={}", path.display());
        let name = path.strip_prefix(&root).unwrap_or(path).to_string_lossy().replace('\\', "/");
        // Windows can check text out with other ends of lines.
        let text = fs::read_to_string(path)?.replace("\r\n", "\n");
        hash.update(format!("{name} {}\n", text.len()).as_bytes());
        hash.update(text.as_bytes());
        let is_learned = LEARNED.iter().any(|folder| name.starts_with(folder));
        if is_learned && !name.ends_with("settings.rs") {
            layout(&text).for_each(|line| layouts.update(line.as_bytes()));
        }
    }
    println!("cargo::rustc-env=CURIOUS_LAYOUT={:016x}", layouts.digest());
    println!("cargo::rustc-env=CURIOUS_BUILD={:016x}", hash.digest());
    Ok(())
}

/// The paragraphs of a source text that decide what is saved: types that serde reads, and lists of values. Settings are saved by
/// name.
fn layout(text: &str) -> impl Iterator<Item = &str> {
    let is_saved =
        |text: &&str| text.contains("derive(") && text.contains("Deserialize") || text.contains("fn values(");
    text.split("\n\n")
        .filter(is_saved)
        .flat_map(str::lines)
        .map(str::trim)
        .filter(|line| !line.starts_with("//"))
}

/// Adds the sources in a folder, without tests.
fn add_sources(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    println!("cargo::rerun-if-changed={}", folder.display()); // new files
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        match path.file_stem().and_then(|stem| stem.to_str()) {
            Some("tests") => {}
            _ if path.is_dir() => add_sources(&path, files)?,
            _ if path.extension().is_some_and(|ending| ending == "rs") => files.push(path),
            _ => {}
        }
    }
    Ok(())
}
