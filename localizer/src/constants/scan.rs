//! Constants of poses, points of scans and the motion prior.

use crate::spread::Spread;

// Poses

/// Way equivalent of a turn, m/rad: the arc of the wheels of a robot of 0.6 m.
pub(crate) const TURN_M: f64 = 0.3;
/// Rotation equivalent to 1 m of a path within a scan, rad.
pub(crate) const RAD_PER_M: f64 = 3.0;
/// Share of a scan, or of a map, that decides: poses with less of a scan are not followed.
pub(crate) const MAJORITY: f64 = 0.5;
/// Share of a scan, or of a map, that decides nothing.
pub(crate) const MINOR: f64 = 0.1;

// Deskew and points of scans

/// Largest difference between the motion and the sum of the velocities within a scan. Beyond it, the odometry has jumped.
pub(crate) const MAX_MISMATCH: Spread = Spread { m: 0.1, rad: 0.15 };
/// No robot is faster than this, m/s.
pub(crate) const MAX_MPS: f64 = 50.0;
/// Largest turn of which the chord approximates the arc, rad: wrong by less than 1e-5 rad.
pub(crate) const MAX_CHORD_RAD: f64 = 0.1;
/// End points of neighboring beams that are nearer than this, in spacings of the beams, are on one surface: below about 20° between
/// beam and surface, a third beam must confirm the surface.
pub(crate) const JOIN_SPACINGS: f64 = 3.0;
/// End points of beams that graze one surface may be this far apart, m.
pub(crate) const GRAZING_M: f64 = 1.0;
/// The third end point lies off the line by at most this many standard deviations of the noise across the surface, and by no
/// more than this, m.
pub(crate) const GRAZING_STDS: f64 = 8.0;
pub(crate) const GRAZING_OFF_M: f64 = 0.03;
/// Minimum cosine of the angle of incidence of a point: below it, surfaces are rarely straight enough.
pub(crate) const MIN_GRAZING: f64 = 0.06;
/// Minimum cosine of the angle of incidence of a beam that contradicts a surfel, and a submap.
pub(crate) const MIN_INCIDENCE: f64 = 0.3;
pub(crate) const MIN_SURE_INCIDENCE: f64 = 0.35;
/// Normals are fitted to the points up to this far away, m: with less, the noise of 1 cm turns them by degrees.
pub(crate) const NORMAL_REACH_M: f64 = 0.2;
/// Normals are fitted to at most this number of points on either side, which bounds the work of a scan.
pub(crate) const MAX_NEIGHBORS: usize = 1000;
/// Points lie on a line if their mean square distance is below that of this many standard deviations, and this
/// more, m.
pub(crate) const STRAIGHT_STDS: f64 = 1.3;
pub(crate) const STRAIGHT_M: f64 = 0.002;
/// Length of surface with weight 1, m: a beam that grazes a wall does not confirm all of it.
pub(crate) const FULL_WEIGHT_M: f64 = 0.04;
/// Minimum cosine of the angle between normals on one surface.
pub(crate) const SAME_SURFACE: f64 = 0.95;
/// The mean over this many neighbors of a point on either side tells apart what the noise of a point hides.
pub(crate) const AVERAGED: usize = 4;

// Motion prior

/// Hard drift, the largest errors of an odometry that are expected by default: gains, and noise after 1 m and after 1 rad; and
/// rad per m, which is 3°.
pub(crate) const HARD_DRIFT: f64 = 0.05;
pub(crate) const HARD_DRIFT_RADPM: f64 = 0.052;
/// Errors at rest: vibration, and rounding of the odometry.
pub(crate) const REST_STD: Spread = Spread { m: 2e-4, rad: 1e-4 };
/// Share of a motion that slips to the side.
pub(crate) const SLIP: f64 = 0.02;
/// The expected errors count as larger by this: what is the same from scan to scan would bend the map.
pub(crate) const PRIOR_FACTOR: f64 = 1.5;
/// Errors of an odometry after an outlier, for this many scans; and of a robot without odometry.
pub(crate) const DISTRUSTED_STD: Spread = Spread { m: 0.05, rad: 0.1 };
pub(crate) const DISTRUST_SCANS: u32 = 20;
/// Minimum motion that shows that odometry exists, and that makes a repeated scan a frozen one.
pub(crate) const MIN_MOTION: Spread = Spread::of_motion(0.005);
pub(crate) const FROZEN_MOTION: Spread = Spread::of_motion(0.01);
/// The gains are learned from about this many motions: the floor and the load change.
pub(crate) const LEARNED_MOTIONS: f64 = 300.0;
/// Minimum motion that says something about the gains.
pub(crate) const LEARNED_MOTION: Spread = Spread { m: 0.01, rad: 0.005 };
/// Errors of a matched motion, from scan to scan and between keyframes: those of two matches.
pub(crate) const MOTION_STD: Spread = Spread { m: 0.004, rad: 0.002 };
