//! Scans that sweep, against single rays: one per beam, from where the robot was, at what stood there then.

use super::*;
use interfaces::{heading_rad, pose, rotation, wrap_rad};
use nalgebra::{Isometry2, Vector2};

/// The poses and the corners of the robots, and the corners of the obstacles, at one time.
struct Moment {
    robots: Vec<Isometry2<f64>>,
    bodies: Vec<Vec<Point2<f64>>>,
    obstacles: Vec<[Point2<f64>; 4]>,
}

impl Moment {
    fn of(fleet: &Fleet) -> Self {
        let robots = fleet.robots().map(|robot| robot.pose).collect();
        let corners = |robot: RobotView<'_>| robot.corners.iter().map(|corner| robot.pose * corner).collect();
        let bodies = fleet.robots().map(corners).collect();
        Self { robots, bodies, obstacles: fleet.obstacles().map(|obstacle| obstacle.corners).collect() }
    }

    /// Between two moments everything moves straight and turns evenly; corners move straight.
    fn between(&self, next: &Self, share: f64) -> Self {
        let point = |(a, b): (&Point2<f64>, &Point2<f64>)| a + (b - a) * share;
        let robots = self.robots.iter().zip(&next.robots).map(|(a, b)| {
            let at = point((&a.translation.vector.into(), &b.translation.vector.into()));
            let turn_rad = wrap_rad(heading_rad(b) - heading_rad(a));
            pose(at.x, at.y, heading_rad(a) + share * turn_rad)
        });
        let obstacles = self.obstacles.iter().zip(&next.obstacles);
        let obstacles = obstacles.map(|(a, b)| [0, 1, 2, 3].map(|i| point((&a[i], &b[i]))));
        let bodies = self.bodies.iter().zip(&next.bodies);
        let bodies = bodies.map(|(a, b)| a.iter().zip(b).map(point).collect());
        Self { robots: robots.collect(), bodies: bodies.collect(), obstacles: obstacles.collect() }
    }

    /// The range of a single ray of a robot, m.
    fn range_m(&self, spec: &FleetSpec, own: usize, from: &Point2<f64>, along: &Vector2<f64>) -> f64 {
        let (mut range_m, mut discs_m) = (walls_m(spec, from, along), f64::INFINITY);
        let mut side = |a: &Point2<f64>, b: &Point2<f64>| {
            let (to, side) = (a - from, b - a);
            let (hit_m, place) = (to.perp(&side) / along.perp(&side), to.perp(along) / along.perp(&side));
            if hit_m > 0.0 && (0.0..=1.0).contains(&place) {
                range_m = range_m.min(hit_m);
            }
        };
        for corners in &self.obstacles {
            (0..4).for_each(|i| side(&corners[i], &corners[(i + 1) % 4]));
        }
        let others = spec.robots.iter().zip(&self.robots).enumerate().filter(|(index, _)| *index != own);
        for (index, (robot, pose)) in others {
            let at = &self.bodies[index];
            (0..at.len()).for_each(|i| side(&at[i], &at[(i + 1) % at.len()]));
            if at.is_empty() {
                let to = pose.translation.vector - from.coords;
                let (ahead_m, aside_m) = (to.dot(along), to.perp(along));
                if ahead_m > 0.0 && aside_m.abs() <= robot.radius_m {
                    discs_m = discs_m.min(ahead_m - (robot.radius_m.powi(2) - aside_m.powi(2)).sqrt());
                }
            }
        }
        range_m.min(discs_m)
    }
}

/// The distance along a ray to the first wall, m.
fn walls_m(spec: &FleetSpec, from: &Point2<f64>, along: &Vector2<f64>) -> f64 {
    spec.walls.iter().filter_map(|wall| wall.ray_m(from, along)).fold(f64::INFINITY, f64::min)
}

/// Compares every scan of every robot of a fleet in some steps. Returns the number of beams that agreed, and of those
/// that did not since a slightly turned ray meets something else.
fn compare(spec: &FleetSpec, steps: usize) -> [usize; 2] {
    let mut fleet = Fleet::new(spec, 5);
    let (mut moments, mut tally) = (vec![Moment::of(&fleet)], [0; 2]);
    for step in 0..steps {
        // Scans are taken before the motion of a step.
        fleet.step(&mut reckless);
        for robot in fleet.robots() {
            let laser = &spec.robots[robot.index].laser;
            let Some(reading) = robot.reading().filter(|_| (step as u64).is_multiple_of(laser.period_steps))
            else {
                continue;
            };
            assert!((reading.time_s - step as f64 * spec.step_s).abs() < 1e-9);
            assert_eq!(reading.scan.sweep_s, laser.sweep_s);
            for (beam, range_m) in reading.scan.ranges_m.iter().enumerate() {
                let at_steps = (step as f64 - reading.scan.age_s(beam) / spec.step_s).max(0.0);
                let first = (at_steps as usize).min(step.saturating_sub(1));
                let next = (first + 1).min(step);
                let moment = moments[first].between(&moments[next], at_steps - first as f64);
                let at = moment.robots[robot.index] * laser.mount;
                let ray_m = |turn_rad: f64| {
                    let along =
                        at.rotation * rotation(reading.scan.angle_rad(beam) + turn_rad) * Vector2::x();
                    let range_m = moment.range_m(spec, robot.index, &at.translation.vector.into(), &along);
                    if range_m > laser.range_max_m { 1e3 } else { range_m }
                };
                let [low_m, wanted_m, high_m] = [-1e-5, 0.0, 1e-5].map(ray_m);
                let is_off = |wanted_m: f64| (f64::from(*range_m).min(1e3) - wanted_m).abs() > 1e-3;
                if is_off(wanted_m) {
                    let is_grazing = (low_m - high_m).abs() > 1e-3 && !(is_off(low_m) && is_off(high_m));
                    assert!(
                        is_grazing,
                        "robot {}, step {step}, beam {beam}: {range_m} m, not {wanted_m} m",
                        robot.index
                    );
                }
                tally[usize::from(is_off(wanted_m))] += 1;
            }
        }
        moments.push(Moment::of(&fleet));
    }
    tally
}

/// Robots that ignore their sensors and drive in wild curves.
fn reckless(robot: &RobotView<'_>, reading: &LaserReading) -> Twist {
    let phase = reading.time_s * (0.3 + 0.1 * robot.index as f64);
    Twist { linear_mps: 0.5 * libm::cos(phase * 0.7), angular_radps: 2.0 * libm::sin(phase) }
}

/// The busy rooms with lasers that sweep for so long, over so much, mounted off the middle.
fn sweeping(sweep_s: f64, fov_rad: f64, beams: usize) -> FleetSpec {
    let mut spec = super::specs::busy();
    for robot in &mut spec.robots {
        let laser = &mut robot.laser;
        (laser.sweep_s, laser.noise_std_m, laser.fov_rad, laser.beams) = (sweep_s, 0.0, fov_rad, beams);
        laser.mount = pose(0.1, 0.05, 0.5);
    }
    spec
}

#[test]
fn each_beam_measures_at_its_own_time() {
    for (sweep_s, fov_deg, beams) in [
        // A whole period; less than a physics step.
        (0.1, 360.0, 90),
        (0.03, 360.0, 90),
        // Not a whole number of steps, few beams far apart; a narrow view; a gap; many steps.
        (0.08, 360.0, 3),
        (0.1, 40.0, 40),
        (0.07, 270.0, 50),
        (0.5, 360.0, 180),
    ] {
        let mut spec = sweeping(sweep_s, f64::to_radians(fov_deg), beams);
        if sweep_s > 0.1 {
            spec.robots
                .iter_mut()
                .for_each(|robot| (robot.laser.rate_hz, robot.laser.period_steps) = (2.0, 10));
        }
        let [agreed, grazing] = compare(&spec, 200);
        assert!(grazing * 2000 < agreed, "{grazing} of {agreed} graze something");
        // The robots do move: a scan that is taken at once is another one.
        let instant = sweeping(0.0, f64::to_radians(fov_deg), beams);
        let ranges_m = |spec: &FleetSpec| {
            let mut fleet = Fleet::new(spec, 5);
            fleet.run_until(3.0, &mut reckless);
            fleet.robots().next().unwrap().reading().unwrap().scan.ranges_m.clone()
        };
        assert_ne!(ranges_m(&spec), ranges_m(&instant));
    }
}

/// Beams before a robot was carried away see the old place, and the others the new one.
#[test]
fn a_scan_during_which_the_robot_is_put_elsewhere_begins_at_the_old_place() {
    let mut spec = super::four_rooms().fleet().clone();
    spec.robots.truncate(1);
    let robot = &mut spec.robots[0];
    (robot.laser.sweep_s, robot.laser.beams) = (0.1, 200);
    let often = DisplacementSpec { every_s: 1.0, distance_m: 3.0, turn_rad: 0.0 };
    robot.odometry.carried = Some(often);
    let mut fleet = Fleet::new(&spec, 1);
    let (mut poses, mut checked) = (Vec::new(), 0);
    for step in 0..400 {
        poses.push(fleet.robots().next().unwrap().pose);
        fleet.step(&mut ());
        let reading = fleet.robots().next().unwrap().reading().unwrap().clone();
        // In the middle of a scan.
        let is_carried = step >= 2
            && step % 2 == 0
            && poses[step - 2] != poses[step - 1]
            && poses[step - 1] == poses[step];
        if !is_carried {
            continue;
        }
        for (beam, range_m) in reading.scan.ranges_m.iter().enumerate() {
            let is_before = reading.scan.age_s(beam) > spec.step_s;
            let at = &poses[if is_before { step - 2 } else { step - 1 }];
            let along = at.rotation * rotation(reading.scan.angle_rad(beam)) * Vector2::x();
            let wanted_m = walls_m(&spec, &at.translation.vector.into(), &along);
            let is_same =
                (f64::from(*range_m) - wanted_m).abs() < 1e-4 || wanted_m > spec.robots[0].laser.range_max_m;
            checked += usize::from(is_same);
            assert!(is_same || beam == 0, "beam {beam}: {range_m} m, not {wanted_m} m");
        }
    }
    assert!(checked > 1000, "{checked}");
}
