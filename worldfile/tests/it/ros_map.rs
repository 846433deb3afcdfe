//! ROS maps: read, written, resampled.

use interfaces::{Cell, CellState, Grid, GridFrame};
use nalgebra::Point2;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use worldfile::Findings;
use worldfile::ros_map::{self, RosMap};

/// Reads a map of a picture and a YAML file.
fn read(picture: Vec<u8>, yaml: &str) -> RosMap {
    let files = [("map.pgm", picture), ("map.yaml", yaml.as_bytes().to_vec())];
    let files = BTreeMap::from(files.map(|(name, bytes)| (PathBuf::from(name), bytes)));
    let mut findings = Findings::default();
    let map = ros_map::read(Path::new("map.yaml"), &files, &mut findings);
    map.unwrap_or_else(|| panic!("{findings}"))
}

/// The picture and the YAML file that are written of a map.
fn written(map: &Grid<CellState>) -> (Vec<u8>, String) {
    let folder = tempfile::tempdir().unwrap();
    results::ros_map::write(folder.path(), "map", map).unwrap();
    let picture = std::fs::read(folder.path().join("map.pgm")).unwrap();
    (picture, std::fs::read_to_string(folder.path().join("map.yaml")).unwrap())
}

/// A map drawn with the highest row first: `.` free, `#` blocked, ` ` unknown.
fn drawn(origin: (f64, f64), resolution_m: f64, rows: &[&str]) -> Grid<CellState> {
    let origin = Point2::new(origin.0, origin.1);
    let frame = GridFrame::new(origin, resolution_m, rows[0].len(), rows.len()).unwrap();
    let state = |drawn| match drawn {
        '.' => CellState::Free,
        '#' => CellState::Blocked,
        _ => CellState::Unknown,
    };
    Grid::from_cells(frame, rows.iter().rev().flat_map(|row| row.chars().map(state)).collect()).unwrap()
}

fn draw(map: &Grid<CellState>) -> Vec<String> {
    let symbol = |state: &CellState| match state {
        CellState::Free => '.',
        CellState::Blocked => '#',
        CellState::Unknown => ' ',
    };
    map.rows().rev().map(|row| row.map(symbol).collect()).collect()
}

const YAML: &str = "image: map.pgm\nresolution: 0.5\norigin: [1.0, -2.0, 0.0]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";

/// A map of one row of pixels.
fn row(yaml: &str, pixels: &[u8]) -> RosMap {
    let header = format!("P5\n# a comment\n{} 1\n255\n", pixels.len());
    read([header.as_bytes(), pixels].concat(), yaml)
}

fn states(yaml: &str, pixels: &[u8]) -> String {
    draw(&row(yaml, pixels).cells).concat()
}

#[test]
fn what_is_written_comes_back() {
    let map = drawn((-1.25, 3.0), 0.25, &["#####", "#.. #", "#.###"]);
    let (picture, yaml) = written(&map);
    let read = read(picture, &yaml);
    assert_eq!(read.onto(map.frame()), map);
}

#[test]
fn the_files_are_as_ros_writes_them() {
    let map = drawn((-6.0, 0.5), 0.05, &[".#", " ."]);
    let (picture, yaml) = written(&map);
    assert_eq!(picture, b"P5\n2 2\n255\n\xfe\x00\xcd\xfe");
    assert_eq!(
        yaml,
        "image: map.pgm\nmode: trinary\nresolution: 0.05\norigin: [-6.0, 0.5, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    );
}

#[test]
fn thresholds_are_strict() {
    assert_eq!(states(YAML, &[0, 89, 90, 204, 205, 206, 254, 255]), "##   ...");
    // 153/255 is 0.6 to the last bit: neither more nor less.
    let yaml = YAML.replace("0.65", "0.6").replace("0.196", "0.6");
    assert_eq!(states(&yaml, &[101, 102, 103]), "# .");
    // With the usual threshold, a cell that was saved as unknown would be free.
    assert_eq!(states(&YAML.replace("0.196", "0.25"), &[205]), ".");
}

#[test]
fn negate_turns_bright_into_blocked() {
    for negate in ["1", "true"] {
        let yaml = YAML.replace("negate: 0", &format!("negate: {negate}"));
        assert_eq!(states(&yaml, &[0, 49, 50, 51, 254]), "..  #");
    }
    assert_eq!(states(&YAML.replace("negate: 0\n", ""), &[0, 255]), "#.");
}

#[test]
fn a_colour_picture_counts_by_its_mean() {
    let pixels = [[0, 0, 0], [255, 255, 255], [255, 100, 0], [60, 60, 0]].concat();
    let mut png = Cursor::new(Vec::new());
    image::RgbImage::from_raw(4, 1, pixels).unwrap().write_to(&mut png, image::ImageFormat::Png).unwrap();
    let map = read(png.into_inner(), YAML);
    assert_eq!(draw(&map.cells), ["#. #"]);
}

#[test]
fn resampling_asks_at_the_middle_of_each_cell() {
    let map = row(YAML, &[0, 255, 0]); // x from 1 to 2.5 m, y from −2 to −1.5 m
    let finer = GridFrame::new(Point2::new(0.75, -2.25), 0.25, 9, 4).unwrap();
    assert_eq!(draw(&map.onto(&finer)), ["         ", " ##..##  ", " ##..##  ", "         "]);
    let coarser = GridFrame::new(Point2::new(0.9, -2.1), 0.7, 2, 1).unwrap(); // middles at 1.25 and 1.95
    assert_eq!(draw(&map.onto(&coarser)), ["#."]);
}

#[test]
fn a_turned_map_is_turned_back() {
    // A quarter turn: the picture's columns run upwards from (1, −2).
    let map = row(&YAML.replace("-2.0, 0.0]", "-2.0, 1.5707963267948966]"), &[0, 255, 0]);
    let frame = GridFrame::new(Point2::new(0.0, -2.0), 0.5, 3, 3).unwrap();
    assert_eq!(draw(&map.onto(&frame)), [" # ", " . ", " # "]);
    assert_eq!(map.onto(&frame).get(Cell::new(1, 1)), Some(&CellState::Free));
}
