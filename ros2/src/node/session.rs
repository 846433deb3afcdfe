//! Sessions of the node: a state that goes on, a clock that starts anew, and where the robot is, as a person says in rviz, or
//! another program (`initialpose`).

use super::CuriousNode;
use crate::link::Link;
use crate::message::{PoseWithCovarianceStamped, Time};
use interfaces::{LaserReading, PoseMode};
use nalgebra::{Isometry2, Matrix3};
use ros::flat;
use std::time::Instant;

/// A pose in the map, and its covariance.
pub(super) type Seat = (Isometry2<f64>, Matrix3<f64>);

/// The time between two sessions whose clocks cannot be compared, s.
const RESTART_GAP_S: f64 = 1.0;
/// A longer time between two sessions is that between a simulated clock and one that counts from 1970, s: ten years.
const OTHER_CLOCK_S: f64 = 3.2e8;

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

    /// Begins a session with a reading, where the clock of the robot or a state that was loaded demands it.
    pub(super) fn begin_session(&mut self, reading: &LaserReading, stamp: Time, is_restart: bool) {
        let gap_s = match self.continued.take() {
            Some(last) => Some(self.gap_s(last, stamp)),
            None => is_restart.then_some(RESTART_GAP_S),
        };
        if gap_s.is_some() {
            self.settle();
            self.robot.begin_session(reading.time_s, gap_s);
        } else if self.last.is_none() {
            self.robot.session_mut().offset_s = -reading.time_s;
        }
    }

    /// The time since the last reading of the state that was loaded, s.
    fn gap_s(&mut self, last: Time, stamp: Time) -> f64 {
        let gap_s = stamp.ns().saturating_sub(last.ns()) as f64 * 1e-9;
        if gap_s > OTHER_CLOCK_S {
            self.notes.say(&format!(
                "the state ends at {:.0} s by its clock, and the scans begin at {:.0} s by theirs: one of the two is simulated, \
                 and the time between them counts as {RESTART_GAP_S} s",
                last.ns() as f64 * 1e-9,
                stamp.ns() as f64 * 1e-9
            ));
            return RESTART_GAP_S;
        }
        // A simulation that starts anew is earlier.
        gap_s.max(RESTART_GAP_S)
    }

    /// Waits for the map that is being learned again.
    pub(super) fn settle(&mut self) {
        if !self.robot.is_settled() {
            self.notes.say("waiting for the map that a closed loop has corrected");
            self.robot.settle();
            self.published.maps.repeat();
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
