//! What other nodes hear of a reading.

use super::CuriousNode;
use crate::link::Link;
use crate::maps::PublishedMaps;
use crate::message::{
    Message, Path, Pose, PoseStamped, PoseWithCovarianceStamped, Time, Topic, Twist as TwistMessage,
    TwistStamped, header, transform,
};
use crate::parameters::{Navigator, Parameters};
use crate::pilot::Order;
use interfaces::{LaserReading, Twist};
use nalgebra::{Isometry2, Point2};
use robot::{Belief, Level, Pilot, PilotView, Turn};
use std::time::{Duration, Instant};

/// What other nodes have heard.
#[derive(Default)]
pub(super) struct Published {
    pub(super) maps: PublishedMaps,
    pub(super) next_diagnostics: Option<Instant>,
    /// The path to the goal.
    path: Vec<Point2<f64>>,
    /// The pose of the frame of the odometry in the frame of the map.
    pub(super) map_to_odom: Option<Isometry2<f64>>,
    pub(super) next_transform: Option<Instant>,
    pub(super) is_lost: bool,
}

impl<L: Link> CuriousNode<L> {
    pub(super) fn publish_reading(&mut self, stamp: Time, turn: &Turn<LaserReading, Order>, now: Instant) {
        self.obey(turn.command, stamp);
        self.publish_transform(now);
        self.publish_pose(stamp, &turn.belief);
        let header = header(stamp, &self.parameters.map_frame);
        let (parameters, mapper) = (&self.parameters, &self.robot.mapper);
        let name = |topic| self.link.name(topic);
        for (topic, message) in self.published.maps.after(parameters, mapper, &header, now, name) {
            if !self.link.send(topic, message) {
                self.published.maps.repeat();
            }
        }
        self.publish_edges(now);
        let PilotView { goal, path, .. } = self.robot.pilot.view();
        let path: Vec<Point2<f64>> = path.iter().copied().chain(goal).collect();
        if path != self.published.path {
            let stamped = |at: &Point2<f64>| {
                let pose = Pose::in_plane(&interfaces::pose(at.x, at.y, 0.0));
                PoseStamped { header: header.clone(), pose }
            };
            let poses = path.iter().map(stamped).collect();
            self.link.send(Topic::Path, Message::Path(Path { header, poses }));
            self.published.path = path;
        }
        for message in self.robot.pilot.take_messages() {
            if message.level != Level::Event {
                self.notes.say(&message.text);
            }
        }
    }

    pub(super) fn obey(&mut self, order: Order, stamp: Time) {
        match order {
            Order::None => {}
            Order::Velocity(twist) => {
                self.is_stopped = false;
                let twist = TwistMessage::in_plane(&twist);
                if self.parameters.enable_stamped_cmd_vel {
                    let header = header(stamp, self.source.base());
                    let message = Message::TwistStamped(TwistStamped { header, twist });
                    self.link.send(Topic::StampedVelocity, message);
                } else {
                    self.link.send(Topic::Velocity, Message::Twist(twist));
                }
            }
            Order::Goal(pose) => {
                let header = header(stamp, &self.parameters.map_frame);
                let goal = PoseStamped { header, pose: Pose::in_plane(&pose) };
                if self.parameters.navigator == Navigator::Nav2 {
                    self.link.navigate(Some(goal.clone()));
                } else {
                    self.link.send(Topic::GoalPose, Message::Pose(goal));
                }
            }
            Order::Cancel => self.link.navigate(None),
        }
    }

    fn publish_pose(&mut self, stamp: Time, belief: &Belief) {
        let Some(estimate) = &belief.estimate else { return };
        let header = header(stamp, &self.parameters.map_frame);
        let pose = PoseWithCovarianceStamped::in_plane(header, &belief.pose, &estimate.covariance);
        self.link.send(Topic::EstimatedPose, Message::PoseWithCovariance(Box::new(pose)));
    }

    pub(super) fn stop_robot(&mut self) {
        if !self.is_stopped {
            let stamp = self.last.map_or(Time::default(), |(stamp, _)| stamp);
            self.obey(Order::Velocity(Twist::STOP), stamp);
            self.is_stopped = true;
        }
    }

    pub(super) fn publish_transform(&mut self, now: Instant) {
        let period_s = self.parameters.transform_publish_period_s;
        if period_s <= 0.0 {
            return;
        }
        self.published.next_transform = Some(now + Duration::from_secs_f64(period_s));
        let (Some(map_to_odom), Some((stamp, at))) = (&self.published.map_to_odom, self.last) else { return };
        // A robot that has fallen silent does not move in the map for long.
        let timeout_s = self.parameters.transform_timeout_s;
        let since_s = now.duration_since(at).as_secs_f64().min(timeout_s);
        let Parameters { map_frame, odom_frame, .. } = &self.parameters;
        let ahead_ns = ((since_s + timeout_s) * 1e9) as i64;
        let stamp = Time::from_ns(stamp.ns().saturating_add(ahead_ns));
        let message = transform(stamp, (map_frame, odom_frame), Pose::in_plane(map_to_odom));
        self.link.send(Topic::Transforms, message);
    }
}
