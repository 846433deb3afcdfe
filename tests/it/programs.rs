//! `docs/programs.md` is what the programs say with `--help`.

use crate::run::{PROGRAMS, Run};
use std::path::Path;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/programs.md");
const HEAD: &str = "# Programs

What every program says with `--help`; `-h` prints a shorter text. They start with `cargo run --bin NAME -- OPTIONS`, or, once
installed, with their names. The live nodes `curious_node` and `sim_node` take ROS arguments: [robots.md](robots.md#live).
";

fn page() -> String {
    let mut page = HEAD.to_owned();
    for name in PROGRAMS {
        let help = Run::of(name).goes_well("--help").stdout;
        let lines: Vec<&str> = help.trim().lines().map(str::trim_end).collect();
        assert!(lines.iter().all(|line| line.chars().count() <= 100), "{name}: {help}");
        page += &format!("\n## {name}\n\n```text\n{}\n```\n", lines.join("\n"));
    }
    page
}

#[test]
fn every_version_is_printed() {
    for name in PROGRAMS {
        let expected = format!("{name} {}\n", env!("CARGO_PKG_VERSION"));
        assert_eq!(Run::of(name).goes_well("--version").stdout, expected);
    }
}

#[test]
fn the_page_is_what_the_programs_say() {
    let written = std::fs::read_to_string(Path::new(PAGE)).unwrap();
    assert!(
        written == page(),
        "the options changed: cargo test --test it -- --ignored write_the_page_of_programs"
    );
}

#[test]
#[ignore = "writes docs/programs.md anew"]
fn write_the_page_of_programs() {
    std::fs::write(PAGE, page()).unwrap();
}
