//! The errors of odometry.

/// The errors of odometry. With all values 0 and no displacements the odometry is exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OdometryError {
    /// Error of the distance per meter traveled.
    pub distance_gain: f64,
    /// Error of the heading per radian turned.
    pub turn_gain: f64,
    /// Error of the heading per meter traveled, rad/m.
    pub turn_radpm: f64,
    /// Standard deviation of the distance after 1 m, m; it grows with the square root of the distance.
    pub distance_noise_m: f64,
    /// Standard deviation of the heading after a turn of 1 rad, rad; it grows with the square root of the turn.
    pub turn_noise_rad: f64,
    /// How much the wheels slip while a contact changes the velocity of the robot, from 0 to 1: the share of the motion
    /// of the free wheels that the odometry measures instead of the motion of the robot. 1: a robot that pushes against
    /// a wall measures that it drives on, and a robot at rest that is pushed away measures nothing.
    pub slip: f64,
    /// Jumps: at random times the odometry changes, and the robot does not move.
    pub jump: Option<DisplacementSpec>,
    /// At random times the robot is carried away and set down at rest, and the odometry does not change. The new pose is
    /// free, and lies in the part of the world that the robot can reach when doors are open. If no such pose is found in
    /// 100 attempts, the robot stays.
    pub carried: Option<DisplacementSpec>,
}

impl OdometryError {
    /// Whether the odometry is exact.
    pub fn is_exact(&self) -> bool {
        *self == Self::default()
    }
}

/// Displacements at random times: a Poisson process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplacementSpec {
    /// The mean time from one displacement to the next, s.
    pub every_s: f64,
    /// The maximum distance, m. The displacement is uniform in the disc of this radius.
    pub distance_m: f64,
    /// The maximum turn to either side, rad. The turn is uniform.
    pub turn_rad: f64,
}
