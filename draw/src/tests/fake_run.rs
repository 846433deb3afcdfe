//! Shared parts of the tests: a simulated run of four rooms, a robot that drives a tour, another that drives back
//! and forth, and scans from a simple geometry. No physics, no agent.

use agent::Features;
use draw::scene::{Obstacle, Outline, RobotState, Scene, SceneRobot};
use draw::view::{Measured, View};
use interfaces::{GridFrame, LaserReading, Scan, Twist, heading_rad, pose, wrap_rad};
use localizer::PoseEstimate;
use mapper::{Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2, Vector2};
use robot::{Belief, Level, Message, StrategyState};
use std::f64::consts::TAU;

const TICK_S: f64 = 0.1;
const RADIUS_M: f64 = 0.2;

/// Drives along waypoints at a constant speed, and back to the first.
struct Driver {
    pose: Isometry2<f64>,
    waypoints: Vec<Point2<f64>>,
    next: usize,
    speed_mps: f64,
}

impl Driver {
    fn step(&mut self) -> bool {
        let goal = self.waypoints[self.next % self.waypoints.len()];
        let way = goal - Point2::from(self.pose.translation.vector);
        let turn_rad = wrap_rad(libm::atan2(way.y, way.x) - heading_rad(&self.pose));
        if turn_rad.abs() > 0.2 {
            self.pose *= pose(0.0, 0.0, turn_rad.clamp(-0.15, 0.15));
        } else {
            self.pose *= pose(self.speed_mps * TICK_S, 0.0, turn_rad);
        }
        let arrived = way.norm() < 2.0 * self.speed_mps * TICK_S;
        self.next += usize::from(arrived);
        arrived
    }
}

/// The state of the run.
pub(crate) struct FakeRun {
    pub(crate) scene: Scene,
    pub(crate) has_agent: bool,
    /// Where the curious robot believes to be; `None` if its poses are exact.
    pub(crate) estimate: Option<PoseEstimate>,
    pub(crate) mapper: Mapper,
    pub(crate) step: u64,
    curious: Driver,
    dummy: Driver,
    reading: LaserReading,
    messages: Vec<Message>,
}

fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Outline {
    [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
        .map(|(dx, dy)| Point2::new(x + dx, y + dy))
        .into()
}

impl FakeRun {
    pub(crate) fn new() -> Self {
        let point = |(x, y)| Point2::new(x, y);
        let walls = vec![
            rectangle(0.0, 0.0, 12.0, 0.1),
            rectangle(0.0, 11.9, 12.0, 0.1),
            rectangle(0.0, 0.1, 0.1, 11.8),
            rectangle(11.9, 0.1, 0.1, 11.8),
            rectangle(5.95, 0.1, 0.1, 2.4),
            rectangle(5.95, 3.5, 0.1, 5.0),
            rectangle(5.95, 9.5, 0.1, 2.4),
            rectangle(0.1, 5.95, 2.4, 0.1),
            rectangle(3.5, 5.95, 5.0, 0.1),
            rectangle(9.5, 5.95, 2.4, 0.1),
        ];
        let tour = [(3.0, 3.0), (9.0, 3.0), (9.0, 9.0), (8.0, 8.0), (9.0, 9.0), (3.0, 9.0)];
        let frame = GridFrame::covering(Point2::origin(), 12.0, 12.0, 0.05).unwrap();
        let driver = |waypoints: &[(f64, f64)], speed_mps| Driver {
            pose: pose(waypoints[0].0, waypoints[0].1, 0.0),
            waypoints: waypoints.iter().copied().map(point).collect(),
            next: 1,
            speed_mps,
        };
        let robot = |name: &str, (x_m, y_m), is_driven| SceneRobot {
            name: name.into(),
            pose: pose(x_m, y_m, 0.0),
            radius_m: RADIUS_M,
            corners: Vec::new(),
            sectors: Vec::new(),
            is_driven,
        };
        Self {
            scene: Scene {
                title: "fake rooms".into(),
                is_grid: false,
                frame,
                walls,
                obstacles: vec![Obstacle {
                    name: "toy".into(),
                    outline: Vec::new(),
                    reach: vec![rectangle(2.0, 10.0, 0.5, 0.5)],
                }],
                robots: vec![robot("curious", tour[0], true), robot("dummy", (7.0, 11.2), false)],
            },
            has_agent: true,
            estimate: None,
            mapper: Mapper::new(&MapperSettings::default(), frame).unwrap(),
            step: 0,
            curious: driver(&tour, 0.5),
            dummy: driver(&[(7.0, 11.2), (11.0, 11.2)], 0.3),
            reading: LaserReading {
                time_s: 0.0,
                pose: Isometry2::identity(),
                twist: Twist::STOP,
                velocities: Vec::new(),
                mount: Isometry2::identity(),
                scan: Scan::default(),
            },
            messages: Vec::new(),
        }
    }

    /// Simulates a tenth of a second.
    pub(crate) fn step(&mut self) {
        self.messages.clear();
        if self.curious.step() {
            let goal = self.curious.waypoints[self.curious.next % self.curious.waypoints.len()];
            let text = format!("goal reached; poisson chooses ({:.1}, {:.1}) m", goal.x, goal.y);
            self.messages.push(Message { level: Level::Decision, text });
        }
        self.dummy.step();
        self.step += 1;
        self.reading =
            LaserReading { time_s: self.time_s(), pose: self.curious.pose, ..self.reading.clone() };
        self.reading.scan = self.scan();
        self.mapper.update(&self.reading).unwrap();
    }

    pub(crate) fn time_s(&self) -> f64 {
        self.step as f64 * TICK_S
    }

    /// The names and the positions of the robots, m.
    pub(crate) fn positions(&self) -> [(&'static str, Point2<f64>); 2] {
        [("curious", &self.curious), ("dummy", &self.dummy)]
            .map(|(name, driver)| (name, driver.pose.translation.vector.into()))
    }

    fn scan(&self) -> Scan {
        let from = Point2::from(self.curious.pose.translation.vector);
        let disc = self.dummy.pose.translation.vector - from.coords;
        let angle_min_rad = heading_rad(&self.curious.pose) - 0.5 * TAU;
        let range_m = |beam: u32| {
            let (sin, cos) = libm::sincos(angle_min_rad + f64::from(beam) * TAU / 720.0);
            let along = Vector2::new(cos, sin);
            let mut range_m = f64::INFINITY;
            for wall in &self.scene.walls {
                for side in 0..wall.len() {
                    let (a, b) = (wall[side], wall[(side + 1) % wall.len()]);
                    let (edge, to) = (b - a, a - from);
                    let cross = along.perp(&edge);
                    let (range, share) = (to.perp(&edge) / cross, to.perp(&along) / cross);
                    if cross != 0.0 && range > 0.0 && (0.0..=1.0).contains(&share) {
                        range_m = range_m.min(range);
                    }
                }
            }
            let (ahead, aside) = (disc.dot(&along), disc.perp(&along));
            if ahead > 0.0 && aside.abs() < RADIUS_M {
                range_m = range_m.min(ahead - (RADIUS_M * RADIUS_M - aside * aside).sqrt());
            }
            if range_m <= 10.0 { range_m as f32 } else { f32::INFINITY }
        };
        Scan {
            angle_min_rad: -0.5 * TAU,
            angle_increment_rad: TAU / 720.0,
            range_min_m: 0.02,
            range_max_m: 10.0,
            sweep_s: 0.0,
            ranges_m: (0..720).map(range_m).collect(),
        }
    }

    /// Calls `use_view` with the present state of the run.
    pub(crate) fn with_view<T>(&mut self, use_view: impl FnOnce(&View) -> T) -> T {
        let features = Features::of(&mut self.mapper);
        let goal = self.curious.waypoints[self.curious.next % self.curious.waypoints.len()];
        let wave = |phase: f64| 1.0 + libm::sin(self.time_s() / 60.0 + phase);
        let strategy = |name: &str, phase: f64| StrategyState {
            name: name.into(),
            value: Some(2.0 * wave(phase)),
            share: 0.25 * wave(phase),
            is_current: phase == 0.0,
        };
        let toy = (self.time_s() > 20.0).then(|| self.scene.obstacles.first()?.reach.first().cloned());
        let seen =
            (0..self.mapper.frame().len()).step_by(7).filter(|&cell| self.mapper.was_ever_seen(cell)).count();
        let coverage = 7.0 * seen as f64 / self.mapper.frame().len() as f64;
        let belief = self
            .estimate
            .clone()
            .map(|estimate| Belief { estimate: Some(estimate.clone()), ..Belief::exact(estimate.pose) });
        use_view(&View {
            time_s: self.time_s(),
            step: self.step,
            features,
            mapper: &self.mapper,
            robots: vec![
                RobotState { pose: self.curious.pose, sight: Some(&self.reading) },
                RobotState { pose: self.dummy.pose, sight: None },
            ],
            belief: belief.as_ref(),
            obstacles: vec![toy.flatten()],
            path: &[Point2::from(self.curious.pose.translation.vector), goal],
            goal: Some(goal),
            strategies: if self.has_agent {
                vec![strategy("recency", 0.0), strategy("poisson", 2.0), strategy("random", 4.0)]
            } else {
                Vec::new()
            },
            measured: Measured {
                coverage_and_quality: Some([coverage, 0.98 * coverage]),
                messages: &self.messages,
            },
        })
    }
}
