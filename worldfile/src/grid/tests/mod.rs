mod messages;

use super::*;
use crate::reader::tests::mutations;
use interfaces::Cell;
use proptest::prelude::*;
use sim::grid::{Course, GridCalendar};

/// A small world in which every line can be made wrong.
const GOOD: &str = r#"name = "yard"
description = "A yard with two blocks."
sensor_radius = 4
map = """
#########
#.......#
#.......#
#..###..#
#...R...#
#.......#
#########
"""

[transitions]
block_chance = 0.5
robot_chance = 1.0

[[block]]
name = "high"
dwell = 7
stood = 2
course = "back-and-forth"
path = [[1, 5], [6, 5], [6, 4]]

[[block]]
name = "low"
dwell = 2
course = "loop"
path = [[1, 1], [3, 1], [3, 2], [1, 2]]
"#;

fn cells(cells: &[(i32, i32)]) -> Vec<Cell> {
    cells.iter().map(|&(x, y)| Cell::new(x, y)).collect()
}

#[test]
fn the_good_world_says_what_it_says() {
    let spec = crate::grid::parse("yard.toml", GOOD).unwrap();
    assert_eq!((spec.name.as_str(), spec.description.as_str()), ("yard", "A yard with two blocks."));
    assert_eq!((spec.frame().width(), spec.frame().height()), (9, 7));
    assert_eq!((spec.frame().origin(), spec.frame().resolution_m()), (nalgebra::Point2::origin(), 1.0));
    assert_eq!(spec.walls.cells().iter().filter(|wall| **wall).count(), 2 * 9 + 2 * 5 + 3);
    assert_eq!(spec.walls.get(Cell::new(3, 3)), Some(&true));
    assert_eq!((spec.start, spec.sensor_radius), (Cell::new(4, 2), 4));
    assert_eq!((spec.block_probability, spec.robot_probability), (0.5, 1.0));
    assert_eq!(spec.warnings(), [] as [String; 0]);
    let [high, low] = &spec.blocks[..] else { panic!("{:?}", spec.blocks) };
    assert_eq!(
        (high.name.as_str(), high.dwell, high.stood, high.course),
        ("high", 7, 2, Course::BackAndForth)
    );
    assert_eq!(high.path, cells(&[(1, 5), (2, 5), (3, 5), (4, 5), (5, 5), (6, 5), (6, 4)]));
    assert_eq!((low.name.as_str(), low.dwell, low.stood, low.course), ("low", 2, 0, Course::Loop));
    assert_eq!(low.path, cells(&[(1, 1), (2, 1), (3, 1), (3, 2), (2, 2), (1, 2)]));
}

#[test]
fn chances_and_blocks_may_be_left_out() {
    let spec = crate::grid::parse("yard.toml", &GOOD[..GOOD.find("[transitions]").unwrap()]).unwrap();
    assert_eq!((spec.block_probability, spec.robot_probability, spec.blocks.len()), (1.0, 1.0, 0));
}

#[test]
fn what_is_written_reads_as_the_same_world() {
    // Names that need care, chances of many digits, a path that comes back over itself.
    let odd = GOOD.replace("name = \"yard\"", r#"name = "a \"yard\" \\ # 庭""#).replace("0.5", "1e-7");
    let odd = odd.replace("[[1, 5], [6, 5], [6, 4]]", "[[1, 5], [6, 5], [3, 5], [7, 5]]");
    let spec = crate::grid::parse("yard.toml", &odd).unwrap();
    assert_eq!(crate::grid::parse("again.toml", &to_toml(&spec)).unwrap(), spec);
}

#[test]
fn lines_may_end_as_on_windows() {
    let spec = crate::grid::parse("yard.toml", &GOOD.replace('\n', "\r\n")).unwrap();
    assert_eq!(spec, crate::grid::parse("yard.toml", GOOD).unwrap());
}

#[test]
fn changed_worlds_keep_to_the_bounds() {
    let spec = || crate::grid::parse("yard.toml", GOOD).unwrap();
    let radius = |radius| spec().with_sensor_radius(radius).sensor_radius;
    assert_eq!([0, 1, 7, 100, u32::MAX].map(radius), [1, 1, 7, 100, 100]);
    let chances = |block, robot| {
        let spec = spec().with_probabilities(block, robot);
        (spec.block_probability, spec.robot_probability)
    };
    assert_eq!(chances(0.25, 1.0), (0.25, 1.0));
    assert_eq!(chances(7.0, f64::NAN), (1.0, f64::MIN_POSITIVE));
    assert_eq!(chances(0.0, -1.0), (f64::MIN_POSITIVE, f64::MIN_POSITIVE));
}

#[test]
fn parts_that_cannot_be_reached_are_a_warning() {
    let warnings = |map: &str| {
        let text =
            format!("name = \"parts\"\nsensor_radius = 4\nmap = \"\"\"\n{}\n\"\"\"", map.replace(' ', "\n"));
        crate::grid::parse("parts.toml", &text).unwrap().warnings().join("\n")
    };
    // Corners do not connect.
    insta::assert_snapshot!(warnings("##### #.#.# ##R## #.#.. #####"), @r"
    the robot cannot reach the cell [1, 1]
    the robot cannot reach the 2 cells around [3, 1]
    the robot cannot reach the cell [1, 3]
    the robot cannot reach the cell [3, 3]
    ");
    insta::assert_snapshot!(warnings("...#... ...#... ...#..R"), @"the robot cannot reach the 9 cells around [0, 0]");
    insta::assert_snapshot!(warnings(".#.#.#.#.#R ########### .#.#.#.#..."), @r"
    the robot cannot reach the cell [0, 0]
    the robot cannot reach the cell [2, 0]
    the robot cannot reach the cell [4, 0]
    the robot cannot reach the cell [6, 0]
    the robot cannot reach the 3 cells around [8, 0]
    the robot cannot reach 5 more parts of 5 cells in all
    ");
}

proptest! {
    /// Whatever the text, there is an error with a place or a world that runs, and never a panic.
    #[test]
    fn no_text_makes_it_panic(changed in mutations::changed(GOOD)) {
        match crate::grid::parse("yard.toml", &changed) {
            Err(error) => prop_assert!(error.to_string().contains("yard.toml:"), "{error}"),
            Ok(spec) => run(&spec),
        }
    }

    /// The same with numbers of every size in every place.
    #[test]
    fn no_number_makes_it_panic(
        changed in mutations::renumbered(GOOD, (any::<i64>(), 0..64_u32).prop_map(|(number, shift)| (number >> shift).to_string()))
    ) {
        if let Ok(spec) = crate::grid::parse("yard.toml", &changed) {
            run(&spec);
        }
    }
}

/// Lets a few steps pass.
fn run(spec: &GridSpec) {
    let mut world = sim::grid::GridWorld::new(spec, 0);
    for step in interfaces::Step::ALL {
        interfaces::World::act(&mut world, &step);
        interfaces::World::sense(&mut world);
    }
}

#[test]
fn a_block_with_a_schedule_is_read_and_written() {
    let of_steps = "dwell = 7\nstood = 2\ncourse = \"back-and-forth\"\n";
    let schedule = "[6, 4]]\n[block.schedule]\nhours = [\"Mon-Fri 8:00-18:00\"]\nfree_s = 100.0\nblocked_s = [50.0, 900.0, 0.25]\n";
    let text = GOOD.replacen(of_steps, "", 1).replacen("[6, 4]]\n", schedule, 1);
    let spec = crate::grid::parse("yard.toml", &format!("starts = \"Tue 6:30\"\n{text}")).unwrap();
    assert_eq!(spec.calendar, Some(GridCalendar { starts_s: 30.5 * 3600.0, step_s: 10.0 }));
    assert!(spec.blocks[0].schedule.is_some() && spec.blocks[1].schedule.is_none());
    assert_eq!(crate::grid::parse("again.toml", &to_toml(&spec)).unwrap(), spec);
}
