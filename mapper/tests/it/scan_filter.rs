//! The scan filter: thin things and walls stay, veils go.

use interfaces::{GridFrame, LaserReading, Scan};
use mapper::{Mapper, MapperSettings, NoReturn, ScanFilter, ScanFilterSettings};
use nalgebra::{Isometry2, Point2};

fn reading(ranges_m: Vec<f32>) -> LaserReading {
    let mut reading = crate::house::scan(0.0, Isometry2::identity(), 0.0, ranges_m);
    reading.scan.angle_increment_rad = 1.0_f64.to_radians();
    reading
}

/// A round room of 4 m with these ranges from beam 10 on.
fn room(of: &[f32]) -> Vec<f32> {
    let mut ranges_m = vec![4.0; 300];
    ranges_m[10..10 + of.len()].copy_from_slice(of);
    ranges_m
}

fn filter(edge_m: f64) -> ScanFilter {
    ScanFilter::new(&ScanFilterSettings { edge_m, no_return: NoReturn::Free, ..Default::default() }).unwrap()
}

/// A filter that has seen a scanner with veils.
fn with_veils(edge_m: f64) -> ScanFilter {
    let mut filter = filter(edge_m);
    for _ in 0..400 {
        filter.filter(reading(room(&[2.0, 2.0, 2.0, 3.0])));
        filter.filter(reading(room(&[2.0, 2.0])));
    }
    filter
}

/// The beams that the filter removes, counted from the first one that is not of the room. They stay free up to a thing.
fn removed(filter: &mut ScanFilter, of: &[f32]) -> Vec<usize> {
    let filtered = filter.filter(reading(room(of))).scan.ranges_m;
    let is_near = |beam: &usize| (1.8..=3.0).contains(&Scan::free_m(filtered[*beam]));
    assert!((0..300).all(|beam| !filtered[beam].is_nan() || is_near(&beam)));
    (0..300).filter(is_near).map(|beam| beam.wrapping_sub(10)).collect()
}

#[test]
fn veils_go_and_both_surfaces_stay() {
    let mut filter = with_veils(0.0);
    let near = [2.0; 4];
    for (veils, gone) in
        [(&[3.0][..], vec![4]), (&[2.3, 3.4], vec![4, 5]), (&[2.5, 3.0, 3.5], vec![4, 5, 6]), (&[], vec![])]
    {
        assert_eq!(removed(&mut filter, &[&near, veils].concat()), gone);
        let mirrored: Vec<f32> = veils.iter().rev().chain(&near).copied().collect();
        assert_eq!(removed(&mut filter, &mirrored), gone.iter().map(|beam| beam - 4).collect::<Vec<_>>());
    }
}

#[test]
fn things_of_one_and_two_beams_stay() {
    for filter in [&mut with_veils(0.0), &mut filter(0.0)] {
        for leg in
            [&[2.0][..], &[2.0, 2.0], &[2.02, 2.0], &[2.0, 2.05], &[2.0, 4.0, 2.5], &[2.0, 4.0, 3.0, 3.02]]
        {
            assert_eq!(removed(filter, leg), Vec::<usize>::new(), "{leg:?}");
        }
    }
}

#[test]
fn beside_an_edge_the_far_side_goes_but_not_a_second_thing() {
    let mut filter = filter(0.1);
    // Two beams are 0.07 m apart at 2 m, three 0.105 m.
    let sides = [usize::MAX - 1, usize::MAX];
    assert_eq!(removed(&mut filter, &[2.0; 5]), [&sides[..], &[5, 6]].concat());
    assert_eq!(removed(&mut filter, &[2.0]), [&sides[..], &[1, 2]].concat());
    // The second leg stays; of the wall behind, what is beside it goes.
    assert_eq!(removed(&mut filter, &[2.0, 4.0, 2.5, 2.5]), [&sides[..], &[1, 4, 5]].concat());
}

#[test]
fn a_wall_at_any_angle_stays() {
    // 0.3 m beside a straight wall: down to 2° between beam and wall.
    let wall = (2..178).map(|beam| (0.3 / f64::from(beam).to_radians().sin()) as f32).collect::<Vec<_>>();
    let ranges_m = [&[f32::INFINITY; 2][..], &wall, &[f32::INFINITY; 2]].concat();
    let filtered = with_veils(0.0).filter(reading(ranges_m.clone())).scan.ranges_m;
    assert_eq!(filtered, ranges_m);
}

#[test]
fn a_scanner_without_veils_keeps_its_slivers() {
    let mut filter = filter(0.0);
    for _ in 0..300 {
        filter.filter(reading(room(&[2.0, 2.0, 2.0])));
    }
    assert_eq!(removed(&mut filter, &[2.0, 2.0, 2.0, 3.0]), Vec::<usize>::new());
    assert_eq!(removed(&mut with_veils(0.0), &[2.0, 2.0, 2.0, 3.0]), [3]);
}

#[test]
fn nothing_is_removed_beside_beams_without_a_hit_and_without_an_angle() {
    let open = [2.0, f32::INFINITY, 3.0, f32::INFINITY, 4.0, f32::NEG_INFINITY];
    let filtered = with_veils(0.1).filter(reading(open.to_vec())).scan.ranges_m;
    assert_eq!(filtered, open);
    let settings = ScanFilterSettings { min_shadow_angle_rad: 0.0, edge_m: 0.1, ..Default::default() };
    let kept = ScanFilter::new(&settings).unwrap().filter(reading(room(&[2.0, 3.0])));
    assert_eq!(kept.scan.ranges_m, room(&[2.0, 3.0]));
}

#[test]
fn a_filter_goes_on_from_what_was_saved() {
    let saved = interfaces::snapshot(with_veils(0.0).values());
    let mut restored = filter(0.0);
    interfaces::restore(restored.values(), &saved).unwrap();
    assert_eq!(removed(&mut restored, &[2.0, 2.0, 2.0, 3.0]), [3]);
}

/// A leg that is there for 15 s and away for 15 s: as many changes as without a filter.
#[test]
fn a_leg_before_a_wall_changes_the_map() {
    let frame = GridFrame::new(Point2::new(-5.0, -5.0), 0.05, 200, 200).unwrap();
    let changes = |leg: &[f32], mut filter: Option<ScanFilter>| {
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let mut changes = 0;
        for scan in 0..1200 {
            let ranges_m = room(if scan % 300 < 150 { &[] } else { leg });
            let reading = LaserReading { time_s: f64::from(scan) / 10.0, ..reading(ranges_m) };
            let reading = filter.as_mut().map_or(reading.clone(), |filter| filter.filter(reading));
            mapper.update(&reading).unwrap();
            changes += mapper.transitions().iter().filter(|change| change.event().is_some()).count();
        }
        changes
    };
    for leg in [&[2.0][..], &[2.0, 2.0]] {
        let unfiltered = changes(leg, None);
        assert!(unfiltered > 0);
        for edge_m in [0.0, 0.12] {
            assert_eq!(changes(leg, Some(with_veils(edge_m))), unfiltered, "{leg:?}, {edge_m}");
        }
    }
}

#[test]
fn a_scan_without_beams_stays_as_it_is() {
    // No beam, and an angle between beams for which that is about a turn.
    let mut empty = reading(Vec::new());
    empty.scan.angle_increment_rad = 1e10;
    assert_eq!(with_veils(0.1).filter(empty.clone()).scan.ranges_m, empty.scan.ranges_m);
}
