//! The geometry and the range of the laser.

use super::*;
use nalgebra::Isometry2;

/// 60 scans of a laser of two beams, the second of which has this range.
fn ranging(head: &str, far: impl Fn(u32) -> String) -> String {
    (0..60).fold(head.to_owned(), |text, step| {
        text + &format!("FLASER 2 1 {} 0 0 0 0 0 0 {step} h {step}\n", far(step))
    })
}

/// The same in ROBOTLASER1 lines.
fn ranging_as_robotlaser(max_m: &str, far: impl Fn(u32) -> String) -> String {
    let line = |step: u32| {
        format!("ROBOTLASER1 0 -1 1 1 {max_m} 0.01 0 2 1 {} 0 {}{step} h 0\n", far(step), "0 ".repeat(11))
    };
    (0..60).map(line).collect()
}

fn far_m(text: &str) -> f32 {
    readings(text)[7].scan.ranges_m[1]
}

#[test]
fn a_range_at_the_maximum_is_no_measurement() {
    // The nearest f32 is below most of these.
    for max in ["5.6", "3.6", "4.095", "4.2", "5.2", "8.183", "8.191", "29.9", "10", "80.99"] {
        let logs = |far: &str| {
            let head = format!("PARAM robot_front_laser_max {max} h 0\n");
            [ranging(&head, |_| far.to_owned()), ranging_as_robotlaser(max, |_| far.to_owned())]
        };
        assert!(logs(max).iter().all(|text| far_m(text).is_nan()), "{max}");
        assert!(logs("3.5").iter().all(|text| far_m(text) == 3.5), "{max}");
    }
}

#[test]
fn numbers_for_failures_are_no_measurements_whatever_maximum_is_stated() {
    let head = "PARAM robot_front_laser_max 81.9 h 0\n";
    let code = |step: u32| ["81.83", "81.87", "81.89", "2"][step as usize % 4].to_owned();
    let far = |step: u32| format!("{:.2}", 80.0 + 0.03 * f64::from(step));
    for (text, measured) in [
        (ranging(head, code), false),
        (ranging_as_robotlaser("81.9", code), false),
        (ranging(head, far), true),
        (ranging_as_robotlaser("81.9", far), true),
    ] {
        let readings = readings(&text);
        let values = readings.iter().map(|reading| reading.scan.ranges_m[1]);
        assert_eq!(values.clone().any(|range_m| range_m >= 80.0), measured);
        let max_m = if measured { 81.9 } else { 80.0 };
        assert!(readings.iter().all(|reading| reading.scan.range_max_m == max_m));
        let note = "the number of different ranges from there on is only 3: they are numbers for failures";
        assert_eq!(notes(&text).join("; ").contains(note), !measured);
    }
}

#[test]
fn the_field_of_view_is_the_stated_one_if_it_agrees_with_the_resolution() {
    let fov = |value: &str| format!("PARAM laser_front_laser_fov {value} h 0\n");
    let resolution = |value: &str| format!("PARAM laser_front_laser_resolution {value} h 0\n");
    let none = String::new();
    for (params, count, fov_deg, increment_deg) in [
        (none.clone(), 180, 180.0, 1.0),
        (none.clone(), 181, 180.0, 1.0),
        (none.clone(), 360, 180.0, 0.5),
        (none.clone(), 361, 180.0, 0.5),
        (none.clone(), 401, 100.0, 0.25),
        (none.clone(), 400, 100.0, 0.25),
        (fov("100"), 401, 100.0, 0.25),
        (fov("3.14159"), 361, 180.0, 0.5),
        (fov("90") + &resolution("0.5"), 181, 90.0, 0.5),
        (fov("270"), 1081, 270.0, 0.25),
        (resolution("0.25"), 1081, 270.0, 0.25),
        // Of another setting.
        (resolution("0.5"), 181, 180.0, 1.0),
        (fov("180") + &resolution("1.0"), 401, 100.0, 0.25),
    ] {
        let text = format!("{params}FLASER {count} {} 0 0 0 0 0 0 1 h 1\n", "2 ".repeat(count));
        let scan = &readings(&text)[0].scan;
        let found = [scan.angle_min_rad, scan.angle_increment_rad].map(f64::to_degrees);
        assert!((found[0] + fov_deg / 2.0).abs() < 1e-9, "{params}{count} {found:?}");
        assert!((found[1] - increment_deg).abs() < 1e-9, "{params}{count} {found:?}");
        assert!(!notes(&text).iter().any(|note| note.contains("180°")));
    }
    let text = format!("FLASER 682 {} 0 0 0 0 0 0 1 h 1\n", "2 ".repeat(682));
    insta::assert_snapshot!(notes(&text)[0], @"FLASER lines with 682 readings do not say their field of view: 180° is assumed; a line `PARAM laser_front_laser_fov DEGREES` before them states it");
}

fn mount(text: &str) -> [f64; 3] {
    let mount = readings(text)[0].mount;
    [mount.translation.x, mount.translation.y, heading_rad(&mount)]
}

fn is_near(found: [f64; 3], expected: [f64; 3]) -> bool {
    found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-5)
}

#[test]
fn the_laser_can_be_beside_the_center_and_turned() {
    let text = "PARAM robot_frontlaser_offset 0.1 h 0\nPARAM robot_frontlaser_side_offset 0.3 h 0\nPARAM \
                robot_frontlaser_angular_offset -1.5 h 0\n"
        .to_owned()
        + &flaser(1.0, "0 0 0");
    assert!(is_near(mount(&text), [0.1, 0.3, -1.5]));
}

#[test]
fn robotlaser_lines_state_the_pose_of_the_laser_on_the_robot() {
    // A robot that drives in a circle, with its laser where `laser` says.
    let log = |param: &str, laser: &dyn Fn(f64, Isometry2<f64>) -> Isometry2<f64>| {
        (0..30).fold(param.to_owned(), |text, step| {
            let time_s = f64::from(step);
            let robot = interfaces::pose((0.3 * time_s).sin(), (0.3 * time_s).cos(), -0.3 * time_s);
            let [laser, robot] = [laser(time_s, robot), robot].map(|pose| {
                format!("{:.6} {:.6} {:.6}", pose.translation.x, pose.translation.y, heading_rad(&pose))
            });
            text + &format!(
                "ROBOTLASER1 0 -1 1 1 80 0.01 0 2 1 2 0 {laser} {robot} 0 0 0 0 0 {time_s} h {time_s}\n"
            )
        })
    };
    let ahead = "PARAM robot_frontlaser_offset 0.2 h 0\n";
    let fixed = |pose: [f64; 3]| move |_: f64, robot| robot * interfaces::pose(pose[0], pose[1], pose[2]);
    for pose in [[0.3, 0.0, 0.0], [-0.2, 0.1, 3.0], [0.0, 0.0, 0.2]] {
        assert!(is_near(mount(&log(ahead, &fixed(pose))), pose), "{pose:?}");
    }
    // Poses that are the same, that another SLAM has corrected, or that are invalid: the parameter counts.
    let corrected = |time_s: f64, robot| interfaces::pose(0.01 * time_s, 0.0, 0.002 * time_s) * robot;
    let text = log(ahead, &fixed([0.0; 3]));
    for text in [text.clone(), log(ahead, &corrected), text.replace(" 2 1 2 0 ", " 2 1 2 0 x")] {
        assert!(is_near(mount(&text), [0.2, 0.0, 0.0]));
    }
}
