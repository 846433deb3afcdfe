use super::*;
use curious::worlds::{SHIPPED, SHIPPED_GRID};

/// A file of this workspace.
fn file(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_shipped_world_is_right_and_its_walls_lie_in_its_frame() {
    let of_sim = ["house.toml", "office.toml", "warehouse.toml", "cave.toml", "yard.toml", "stage/lab.world"];
    let of_sim = of_sim.map(|name| file(&format!("worlds/{name}")));
    let names = SHIPPED.iter().chain(&SHIPPED_GRID).map(|(name, _)| (*name).to_owned());
    for name in names.chain(of_sim) {
        let inspection = inspect(&name);
        assert_eq!(inspection.errors, Vec::<String>::new());
        let Content { scene, lines, .. } = inspection.content.unwrap();
        assert!(!scene.walls.is_empty() && !scene.robots.is_empty() && lines.len() >= 3, "{name}");
        let (low, cell_m) = (scene.frame.origin(), scene.frame.resolution_m());
        let high =
            low + nalgebra::Vector2::new(scene.frame.width() as f64, scene.frame.height() as f64) * cell_m;
        for corner in scene.walls.iter().flatten() {
            let is_inside = corner.x >= low.x - 1e-6 && corner.y >= low.y - 1e-6;
            assert!(is_inside && corner.x <= high.x + 1e-6 && corner.y <= high.y + 1e-6, "{name}: {corner}");
        }
    }
}

#[test]
fn what_is_in_the_paper_s_worlds() {
    let grid = inspect("two_blocks").content.unwrap();
    assert_eq!((grid.kind, grid.scene.obstacles.len(), grid.scene.robots.len()), ("grid world", 2, 1));
    let physics = inspect("four_rooms").content.unwrap();
    assert_eq!(
        (physics.kind, physics.scene.obstacles.len(), physics.scene.robots.len()),
        ("physics world", 0, 2)
    );
    assert_eq!(physics.lines[0], ("size", "12 × 12 m, 240 × 240 cells of 0.05 m".to_owned()));
}

#[test]
fn a_block_with_a_schedule_has_no_chance() {
    let folder = tempfile::tempdir().unwrap();
    let chance = |blocks: &str| {
        let path = folder.path().join("grid.toml");
        let text = format!(
            "name = \"grid\"\nsensor_radius = 4\nmap = \"\"\"\n......\n......\nR.....\n\"\"\"\n\
             [transitions]\nblock_chance = 0.5\n{blocks}"
        );
        std::fs::write(&path, text).unwrap();
        let content = inspect(path.to_str().unwrap()).content.unwrap();
        content.lines.into_iter().find(|(what, _)| *what == "chance").unwrap().1
    };
    let walker =
        "[[block]]\nname = \"walker\"\ndwell = 5\ncourse = \"back-and-forth\"\npath = [[1, 1], [4, 1]]\n";
    let door = "[[block]]\nname = \"door\"\npath = [[1, 2], [2, 2]]\n\
                [block.schedule]\nfree_s = 600.0\nblocked_s = 600.0\n";
    let robot = "the robot moves with probability 1";
    assert_eq!(chance(walker), format!("a block moves with probability 0.5, {robot}"));
    assert_eq!(chance(door), robot);
    assert_eq!(
        chance(&format!("{walker}{door}")),
        format!("a block without a schedule moves with probability 0.5, {robot}")
    );
}
