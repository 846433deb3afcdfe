use super::*;

/// The cell of the robot after each step.
fn walk(world: &mut GridWorld, steps: &[Step]) -> Vec<(i32, i32)> {
    let mut cells = Vec::new();
    for step in steps {
        world.act(step);
        cells.push((world.robot().x, world.robot().y));
    }
    cells
}

#[test]
fn it_starts_where_the_map_says_or_in_the_centre() {
    assert_eq!(GridWorld::new(&spec("....\n..R.\n....", ""), 0).robot(), Cell::new(2, 1));
    assert_eq!(GridWorld::new(&spec(".....\n.....\n.....", ""), 0).robot(), Cell::new(2, 1));
    assert_eq!(GridWorld::new(&spec("....\n....\n....\n....", ""), 0).robot(), Cell::new(2, 2));
}

#[test]
fn it_steps_to_the_four_sides() {
    let mut world = GridWorld::new(&spec(".....\n.....\n..R..\n.....\n.....", ""), 0);
    let steps = [Step::Right, Step::Up, Step::Left, Step::Left, Step::Down, Step::Stay];
    assert_eq!(walk(&mut world, &steps), [(3, 2), (3, 3), (2, 3), (1, 3), (1, 2), (1, 2)]);
    assert_eq!(world.time(), 6.0);
}

#[test]
fn walls_and_the_end_of_the_map_stop_it() {
    let mut world = GridWorld::new(&spec("...\nR#.\n...", ""), 0);
    assert_eq!(
        walk(&mut world, &[Step::Right, Step::Left, Step::Down, Step::Down]),
        [(0, 1), (0, 1), (0, 0), (0, 0)]
    );
    let mut world = GridWorld::new(&spec("..R\n...\n...", ""), 0);
    assert_eq!(walk(&mut world, &[Step::Up, Step::Right]), [(2, 2), (2, 2)]);
}

#[test]
fn a_block_stops_it_until_the_step_after_it_left() {
    let spec = spec("R..\n...\n...", &block("b", 2, "back-and-forth", "[[1, 2], [1, 0]]"));
    let mut world = GridWorld::new(&spec, 0);
    // The robot acts before the block leaves in step 2.
    assert_eq!(walk(&mut world, &[Step::Right; 4]), [(0, 2), (0, 2), (1, 2), (2, 2)]);
}

#[test]
fn it_sees_its_own_cell_free_and_knows_where_it_is() {
    let mut world = GridWorld::new(&spec("...\n.R.\n...", ""), 0);
    world.act(&Step::Right);
    let reading = world.sense();
    assert_eq!((reading.time, reading.pose), (1.0, interfaces::pose(2.5, 1.5, 0.0)));
    assert_eq!(reading.cells[0], (Cell::new(2, 1), false));
    assert_eq!(reading.cells.len(), 9);
}
