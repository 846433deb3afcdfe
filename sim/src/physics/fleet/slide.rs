//! Steps in which no body moves another one: see [`ContactModel::Sliding`].

use super::Fleet;
use crate::physics::bodies::{SEPARATE_M, Touch};
use crate::physics::obstacles::Obstacle;
use crate::physics::report::Body;
use crate::physics::shape::Rectangle;
use crate::physics::sliding::{Slide, slide};
use crate::physics::spec::ContactModel;
use nalgebra::{Point2, Vector2};

/// Bodies that may come as near as this in a step may touch, m.
const NEAR_M: f64 = 2.0 * SEPARATE_M as f64;
/// The walls within this distance of a robot are noted together, m.
const REACH_M: f64 = 1.0;

/// What is kept from step to step so that it need not be found again; the motions do not depend on it.
#[derive(Clone, Default)]
pub(super) struct Sliding {
    /// For each robot the walls around it.
    walls: Vec<Walls>,
    wanted_m: Vec<Vector2<f64>>,
    slides: Vec<Slide>,
    near: Near,
}

/// The walls within reach of a robot that is at `center`, m.
#[derive(Clone, Default)]
struct Walls {
    center: Option<Point2<f64>>,
    near: Vec<usize>,
}

/// The bodies near a robot.
#[derive(Clone, Default)]
struct Near {
    bodies: Vec<Body>,
    shapes: Vec<Rectangle>,
}

impl Near {
    fn add(&mut self, body: Body, shape: &Rectangle) {
        self.bodies.push(body);
        self.shapes.push(*shape);
    }
}

impl Fleet {
    /// Simulates the bodies for one step without rapier, where the model of contacts allows it and no robot can meet a body
    /// that contacts move. Returns whether it did.
    pub(super) fn slide(&mut self) -> bool {
        if self.spec().contacts != ContactModel::Sliding || !self.bodies.boxes_rest() {
            return false;
        }
        let mut sliding = std::mem::take(&mut self.sliding);
        sliding.wanted_m.clear();
        sliding.wanted_m.extend((0..self.robots.len()).map(|robot| self.bodies.wanted_m(robot)));
        sliding.walls.resize_with(self.robots.len(), Walls::default);
        sliding.slides.clear();
        let slides = !self.may_push(&sliding.wanted_m) && self.find_slides(&mut sliding).is_some();
        if slides {
            self.move_along(&mut sliding);
        }
        self.sliding = sliding;
        slides
    }

    /// Whether a robot may meet another one, or a box, in a step with these motions (m).
    fn may_push(&self, wanted_m: &[Vector2<f64>]) -> bool {
        let robots = self.robots.iter().zip(wanted_m);
        let mut discs: Vec<(Point2<f64>, f64)> =
            robots.map(|(robot, wanted_m)| (robot.at(), robot.spec.radius_m + wanted_m.norm())).collect();
        let meet = |a: &(Point2<f64>, f64), b: &(Point2<f64>, f64)| {
            (a.0 - b.0).norm_squared() < (a.1 + b.1 + NEAR_M).powi(2)
        };
        let boxes = self.obstacles.iter().filter(|obstacle| obstacle.is_pushed());
        for Obstacle { shape, .. } in boxes {
            let around = (shape.pose.translation.vector.into(), shape.half_m.norm());
            if discs.iter().any(|disc| meet(disc, &around)) {
                return true;
            }
        }
        // From left to right: each is compared with those that begin before it ends.
        let (left_m, right_m) =
            (|disc: &(Point2<f64>, f64)| disc.0.x - disc.1, |disc: &(Point2<f64>, f64)| disc.0.x + disc.1);
        discs.sort_by(|a, b| left_m(a).total_cmp(&left_m(b)));
        discs.iter().enumerate().any(|(index, disc)| {
            let mut beside =
                discs[index + 1..].iter().take_while(|other| left_m(other) < right_m(disc) + NEAR_M);
            beside.any(|other| meet(disc, other))
        })
    }

    /// Finds the motions of all robots. `None` if one of them needs rapier.
    fn find_slides(&self, sliding: &mut Sliding) -> Option<()> {
        let Sliding { walls, wanted_m, slides, near } = sliding;
        for ((index, walls), wanted_m) in walls.iter_mut().enumerate().zip(wanted_m) {
            self.find_near(index, wanted_m, walls, near);
            let spec = &self.robots[index].spec;
            if !spec.corners.is_empty() && !near.bodies.is_empty() {
                return None;
            }
            slides.push(slide(&self.robots[index].at(), spec.radius_m, wanted_m, &near.shapes)?);
        }
        Some(())
    }

    /// Finds the walls and the obstacles that a robot may touch in a step with a motion of `wanted_m` (m).
    fn find_near(&self, robot: usize, wanted_m: &Vector2<f64>, walls: &mut Walls, near: &mut Near) {
        let (at, spec) = (self.robots[robot].at(), self.spec());
        let reach_m = self.robots[robot].spec.radius_m + wanted_m.norm() + NEAR_M;
        let is_known =
            walls.center.is_some_and(|center| (at - center).norm() + wanted_m.norm() + NEAR_M < REACH_M);
        if !is_known {
            let reach_m = reach_m + REACH_M;
            walls.center = Some(at);
            walls.near.clear();
            walls
                .near
                .extend((0..spec.walls.len()).filter(|wall| spec.walls[*wall].distance_m(&at) < reach_m));
        }
        near.bodies.clear();
        near.shapes.clear();
        for wall in &walls.near {
            if spec.walls[*wall].distance_m(&at) < reach_m {
                near.add(Body::Wall(*wall), &spec.walls[*wall]);
            }
        }
        for (index, obstacle) in self.obstacles.iter().enumerate() {
            let shape = &obstacle.shape;
            let is_near = || {
                let center = Point2::from(shape.pose.translation.vector);
                (center - at).norm_squared() < (shape.half_m.norm() + reach_m).powi(2)
            };
            if is_near() && obstacle.is_standing() && shape.distance_m(&at) < reach_m {
                near.add(Body::Obstacle(index), shape);
            }
        }
    }

    /// Moves all robots, and notes what they touch.
    fn move_along(&mut self, sliding: &mut Sliding) {
        let (mut touches, step_s) = (Vec::new(), self.spec().step_s);
        let Sliding { walls, wanted_m, slides, near } = sliding;
        for (index, Slide { moved_m, stops }) in slides.iter().enumerate() {
            self.find_near(index, &wanted_m[index], &mut walls[index], near);
            self.bodies.slide(index, moved_m);
            let (at, radius_m) = (self.robots[index].at() + moved_m, self.robots[index].spec.radius_m);
            for (body, (with, shape)) in near.bodies.iter().zip(&near.shapes).enumerate() {
                let stopped_m =
                    stops.iter().find(|(stop, _)| *stop == body).map_or(0.0, |(_, part_m)| *part_m);
                let nearest = shape.nearest(&at);
                let to = nearest - at;
                if stopped_m > 0.0 || to.norm() - radius_m < f64::from(SEPARATE_M) {
                    let touch = Touch {
                        with: *with,
                        at: nearest,
                        towards: to.try_normalize(0.0).unwrap_or_else(Vector2::x),
                        ends: [nearest; 2],
                        impulse_ns: self.bodies.mass_kg(index) * stopped_m / step_s,
                    };
                    touches.push((index, touch));
                }
            }
        }
        self.bodies.end_slide(touches);
    }
}
