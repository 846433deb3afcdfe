//! How long robots stood still.

use nalgebra::Point2;

/// A robot that is no farther than this from a former position has not moved away from it, m.
const STILL_M: f64 = 0.1;

/// The longest standstill of every robot so far. Turning on the spot is a standstill.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Standstills {
    /// For each robot, the position and the time of the beginning of the present standstill, m and s.
    since: Vec<(Point2<f64>, f64)>,
    /// For each robot, the duration and the position of the longest standstill, s and m.
    longest: Vec<(f64, Point2<f64>)>,
}

impl Standstills {
    /// Observes the positions of all robots (m) at a time (s).
    pub fn observe(&mut self, time_s: f64, robots: impl Iterator<Item = Point2<f64>>) {
        for (robot, at) in robots.enumerate() {
            if robot == self.since.len() {
                self.since.push((at, time_s));
                self.longest.push((0.0, at));
            }
            let (from, since_s) = self.since[robot];
            if (at - from).norm() > STILL_M {
                self.since[robot] = (at, time_s);
            } else if time_s - since_s > self.longest[robot].0 {
                self.longest[robot] = (time_s - since_s, from);
            }
        }
    }

    /// For each robot, the longest time for which it did not move farther than 0.1 m from a position, and this position,
    /// s and m.
    pub fn longest(&self) -> &[(f64, Point2<f64>)] {
        &self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_motion_is_no_standstill_but_trembling_is() {
        let mut standstills = Standstills::default();
        for second in 0..100_u32 {
            let time_s = f64::from(second);
            let slow = Point2::new(0.02 * time_s, 0.0);
            let trembling = Point2::new(0.0, 0.04 * f64::from(second % 2));
            let pausing = Point2::new(if second < 30 { 0.0 } else { time_s }, 0.0);
            standstills.observe(time_s, [slow, trembling, pausing].into_iter());
        }
        let longest_s: Vec<f64> = standstills.longest().iter().map(|(longest_s, _)| *longest_s).collect();
        assert_eq!(longest_s, [5.0, 99.0, 29.0]);
    }
}
