//! `initialpose`: where the robot is, as a person says in rviz, or another program.

use super::CuriousNode;
use crate::link::Link;
use crate::message::PoseWithCovarianceStamped;
use interfaces::PoseMode;
use nalgebra::{Isometry2, Matrix3};
use ros::flat;
use std::time::Instant;

/// A pose in the map, and its covariance.
pub(super) type Seat = (Isometry2<f64>, Matrix3<f64>);

impl<L: Link> CuriousNode<L> {
    /// Puts the robot where a message says, or says why not.
    pub(super) fn take_initial_pose(&mut self, message: &PoseWithCovarianceStamped, now: Instant) {
        let (frame, map) = (message.header.frame_id.trim_start_matches('/'), &self.parameters.map_frame);
        let refusal = match message.plane() {
            _ if frame != map => format!("it is in the frame `{frame}`, and not in `{map}`"),
            None => "its pose is not valid".to_owned(),
            Some(_) if self.parameters.pose != PoseMode::Localized => {
                "the parameter `pose` says that the odometry knows the pose".to_owned()
            }
            Some(_) if !self.is_active() => "the node is not active".to_owned(),
            Some(seat) => return self.seat_at(seat),
        };
        self.notes.note(&format!("an initial pose is not used: {refusal}"), now);
    }

    /// Puts the robot at a pose now, or where it is known that a session begins, then.
    pub(super) fn seat_at(&mut self, seat: Seat) {
        let at = seat.0.translation.vector;
        let heading_deg = seat.0.rotation.angle().to_degrees();
        self.notes.say(&format!("the robot is put at ({:.2}, {:.2}), {heading_deg:.0}°", at.x, at.y));
        self.seat = Some(seat);
        if self.continued.is_none() && self.last.is_some() {
            self.take_seat();
        }
    }

    /// Puts the robot at the pose that waits for its first reading.
    pub(super) fn take_seat(&mut self) {
        if let Some((pose, covariance)) = self.seat.take() {
            self.robot.seat(pose, &covariance);
        }
    }
}

impl PoseWithCovarianceStamped {
    /// The pose in the plane, with the covariance of x, y and heading; `None` if a number is not finite.
    fn plane(&self) -> Option<Seat> {
        let pose = flat(&self.pose.pose.isometry()?);
        let covariance = crate::message::of_plane(&self.pose.covariance);
        let is_valid = covariance.iter().all(|value| value.is_finite())
            && covariance.diagonal().iter().all(|variance| *variance >= 0.0);
        is_valid.then_some((pose, covariance))
    }
}
