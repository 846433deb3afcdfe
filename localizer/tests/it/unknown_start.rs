use crate::house::House;
use crate::robot::{Odometry, furnished};
use interfaces::{CellState, Grid, pose};
use localizer::{Localizer, LocalizerSettings, PoseEstimate, PoseState, Start};
use nalgebra::{Isometry2, Point2};

/// The true map of a house.
fn map_of(house: &House) -> Grid<CellState> {
    let mut map = Grid::filled(house.frame, CellState::Free);
    for index in (0..house.frame.len()).filter(|index| house.truth(*index, 0.0) != CellState::Free) {
        map.cells_mut()[index] = CellState::Blocked;
    }
    map
}

fn in_map(map: &Grid<CellState>, start: Start) -> Localizer {
    Localizer::in_map(&LocalizerSettings::default(), map, start).unwrap()
}

/// The estimate after some scans at rest at an unknown pose.
fn found(house: &mut House, map: &Grid<CellState>, at: Isometry2<f64>, scans: u32) -> PoseEstimate {
    let mut localizer = in_map(map, Start::Unknown);
    let estimates = (0..scans).map(|scan| {
        let mut reading = house.reading(0.1 * f64::from(scan), at, &[]);
        reading.pose = pose(100.0, -3.0, 1.0); // the odometry knows nothing of the map
        localizer.localize(&reading, map).estimate
    });
    estimates.last().unwrap()
}

fn is_right(estimate: &PoseEstimate, true_pose: &Isometry2<f64>) -> bool {
    let off = true_pose.inv_mul(&estimate.pose);
    off.translation.vector.norm() < 0.05 && interfaces::heading_rad(&off).abs() < 0.02
}

#[test]
fn a_robot_finds_itself_in_a_known_house() {
    let mut house = furnished(360, 130);
    let map = map_of(&house);
    for (x, y, heading) in
        [(3.0, 3.0, 0.0), (9.0, 2.5, 1.0), (8.7, 9.0, -2.0), (2.0, 9.5, 3.0), (3.0, 6.0, 0.7)]
    {
        let at = house.turned(Point2::new(x, y));
        let at = pose(at.x, at.y, heading);
        let estimate = found(&mut house, &map, at, 6);
        assert_eq!(estimate.state, PoseState::Tracking, "at {x}, {y}");
        assert!(is_right(&estimate, &at), "at {x}, {y}: {}", estimate.pose);
    }
}

#[test]
fn four_equal_rooms_are_ambiguous_until_the_robot_drives_on() {
    // Only one room has a thing in it. The robot cannot see it from the start.
    let mut house = House::new(0.1, 0.0, 0.01, 360, 131);
    house.add(crate::house::Thing::always(crate::house::rectangle(9.0, 9.6, 11.0, 11.9)));
    let map = map_of(&house);
    let mut localizer = in_map(&map, Start::Unknown);
    let start = pose(1.5, 4.3, 0.2);
    let mut odometry = Odometry::new(start, 131);
    let mut step = |time_s: f64, at: Isometry2<f64>| {
        let mut reading = house.reading(time_s, at, &[]);
        reading.pose = odometry.moved_to(&at);
        localizer.localize(&reading, &map).estimate
    };
    for scan in 0..20 {
        let estimate = step(0.1 * f64::from(scan), start);
        assert_ne!(estimate.state, PoseState::Tracking, "three rooms look the same");
        assert!(estimate.position_std_m() > 1.0, "{}", estimate.position_std_m());
    }
    // Through the door to the room on the left above, from where the doors lead to the room with the thing.
    let mut last = None;
    for number in 0..260 {
        let share = f64::from(number) / 259.0;
        let ways = [(1.5, 4.3), (3.0, 5.0), (3.0, 7.5), (5.0, 9.0), (8.0, 9.0)];
        let leg = (share * 4.0).min(3.999);
        let (a, b) = (ways[leg as usize], ways[leg as usize + 1]);
        let part = leg.fract();
        let at = pose(a.0 + (b.0 - a.0) * part, a.1 + (b.1 - a.1) * part, 0.2 + 1.2 * share);
        let estimate = step(2.0 + 0.1 * f64::from(number), at);
        if estimate.state == PoseState::Tracking {
            assert!(is_right(&estimate, &at), "confidently wrong at step {number}: {}", estimate.pose);
        }
        last = Some((estimate, at));
    }
    let (estimate, at) = last.unwrap();
    assert_eq!(estimate.state, PoseState::Tracking);
    assert!(is_right(&estimate, &at));
}

#[test]
fn a_known_pose_in_a_known_map_needs_no_search() {
    let mut house = furnished(360, 132);
    let map = map_of(&house);
    let at = house.turned(Point2::new(3.0, 3.0));
    let (at, guess) = (pose(at.x, at.y, 0.4), pose(at.x + 0.04, at.y - 0.03, 0.41));
    let mut localizer = in_map(&map, Start::At(guess));
    let estimate = localizer.localize(&house.reading(0.0, at, &[]), &map).estimate;
    assert_eq!(estimate.state, PoseState::Tracking);
    assert!(is_right(&estimate, &at), "{}", estimate.pose);
}
