//! Walls that swallow beams of lasers.

use super::fleet::{nobody, robot};
use super::*;
use nalgebra::Vector2;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..Default::default() })]

    /// The reference casts every beam at every wall.
    #[test]
    fn glass_returns_the_beams_along_its_normal(
        within_deg in prop_oneof![Just(0.0), 1.0f64..89.0], turn_deg in -180.0f64..180.0,
        x in 0.5f64..4.5, y in 0.5f64..3.5, heading_deg in -180.0f64..180.0,
    ) {
        let stands = robot("one", [x, y], heading_deg, "kind = \"standing\"").replace("0.005", "0.0");
        let text = format!(
            "name = \"glass\"\n[map]\nsize_m = [8.0, 4.0]\ncell_m = 0.05\nturn_deg = {turn_deg:?}\n\
             [[wall]]\nmin_m = [0.0, 3.9]\nmax_m = [8.0, 4.0]\n\
             [[wall]]\nfrom_m = [5.5, 0.5]\nto_m = [7.0, 3.5]\nthickness_m = 0.1\nreturns_within_deg = {within_deg:?}\n{stands}"
        );
        let spec = parse_fleet(&text);
        let mut fleet = Fleet::new(&spec, 0);
        fleet.step(&mut nobody);
        let robot = fleet.robots().next().unwrap();
        let (at, scan) = (robot.pose, &robot.reading().unwrap().scan);
        let pane = spec.glass[0].shape;
        for (beam, range_m) in scan.ranges_m.iter().enumerate() {
            let along = at.rotation * interfaces::rotation(scan.angle_rad(beam)) * Vector2::x();
            let origin = Point2::from(at.translation.vector);
            let hit_m = |wall: &Rectangle| wall.ray_m(&origin, &along).unwrap_or(f64::INFINITY);
            let nearest_m = spec.walls.iter().map(hit_m).fold(f64::INFINITY, f64::min);
            // The long sides of the pane have this normal, its ends the other one.
            let local = pane.pose.inverse_transform_vector(&along);
            let end = pane.pose.inverse_transform_point(&(origin + along * nearest_m));
            let is_side = (end.y.abs() - pane.half_m.y).abs() < (end.x.abs() - pane.half_m.x).abs();
            let angle_deg = (if is_side { local.y } else { local.x }).abs().acos().to_degrees();
            prop_assume!((angle_deg - within_deg).abs() > 1e-6);
            let is_swallowed = nearest_m == hit_m(&pane) && (angle_deg > within_deg || within_deg == 0.0);
            let expected_m = if is_swallowed || nearest_m > scan.range_max_m { f64::INFINITY } else { nearest_m };
            let range_m = f64::from(*range_m);
            prop_assert!(range_m == expected_m || (range_m - expected_m).abs() < 1e-5, "{range_m}, not {expected_m}");
        }
    }
}
