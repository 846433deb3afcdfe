//! Constants of trajectories: submaps, loops and the first map.

use crate::spread::Spread;

// Trajectories: matches with submaps

/// A scan becomes a keyframe after this way, m, or turn, rad; the robot has another viewpoint.
pub(crate) const KEYFRAME: Spread = Spread { m: 0.3, rad: 0.2 };
/// Keyframes of a submap; it covers this far around the first, m.
pub(crate) const SUBMAP_KEYFRAMES: usize = 20;
pub(crate) const SUBMAP_REACH_M: f64 = 35.0;
/// Points farther away are left out of keyframes and of parts of a map, m: neighboring beams are on different surfaces.
pub(crate) const KEYFRAME_RANGE_M: f64 = 25.0;
/// Neighboring points are on one line up to this share of their distance.
pub(crate) const OFF_LINE: f64 = 0.15;
/// Points of a keyframe that are kept for the end: ten thousand keyframes of 1000 points are too many.
pub(crate) const KEPT_POINTS: usize = 120;
/// Points this near to a surface must lie on it, points twice as far apart may be on one, and a match starts at most this far
/// from the prediction, m.
pub(crate) const JUDGED_M: f64 = 0.4;
/// Minimum number of points on a submap.
pub(crate) const MIN_POINTS: usize = 12;
/// Minimum share of what can be judged that agrees; of the points that can be judged, and of those that a search finds.
pub(crate) const MIN_AGREEMENT: f64 = 0.75;
pub(crate) const MIN_OVERLAP: f64 = 0.4;
/// Where less agrees: turns that are tried, rad (a laser out of step with the odometry), then a search.
pub(crate) const OTHER_TURNS_RAD: [f64; 3] = [0.08, 0.16, 0.25];
pub(crate) const MIN_SHARE: f64 = 0.3;
pub(crate) const SEARCHED: Spread = Spread { m: 0.8, rad: 0.4 };
/// Errors of the prediction in a search: along a corridor nothing but the odometry says how far the robot went.
pub(crate) const SEARCHED_STD: Spread = Spread { m: 0.05, rad: 0.3 };
/// Share of the best score with which other poses are examined.
pub(crate) const EXAMINED: f64 = 0.75;
/// Another pose must confirm more by this factor.
pub(crate) const CLEARLY: f64 = 1.15;
/// Errors of a motion without odometry, and without a match.
pub(crate) const MISSING_STD: Spread = Spread::of_motion(0.3);
/// Errors of matched poses that do not average out: of a scan, between keyframes, of submaps in each
/// other, and of keyframes in submaps.
pub(crate) const SCAN_STD: Spread = Spread { m: 0.001, rad: 3e-4 };
pub(crate) const KEYFRAME_STD: Spread = Spread { m: 0.004, rad: 0.0015 };
pub(crate) const PLACE_MODEL_STD: Spread = Spread { m: 0.02, rad: 0.004 };
pub(crate) const SUBMAP_STD: Spread = Spread { m: 0.015, rad: 0.003 };
/// Contradiction to the odometry over its covariance that means nothing.
pub(crate) const EXPECTED: f64 = 4.0;
/// Share of the information that may come from normals that are a little off.
pub(crate) const SPURIOUS: f64 = 0.03;
/// Errors of a direction that no surface fixes.
pub(crate) const LOOSE_STD: Spread = Spread { m: 10.0, rad: 1.0 };

// Trajectories: scans that are far from the one before

/// A motion between two scans after which the robot has another viewpoint.
pub(crate) const FAR_SCAN: Spread = Spread { m: 0.3, rad: 0.3 };
/// A scan is compared with at most this number of keyframes before it within this distance, m; beams up to this range, m.
pub(crate) const CORRELATED_KEYFRAMES: usize = 40;
pub(crate) const CORRELATED_M: f64 = 20.0;
pub(crate) const CORRELATION_RANGE_M: f64 = 30.0;
/// The window around the prediction; what a pose at its border counts less.
pub(crate) const CORRELATED: Spread = Spread { m: 0.3, rad: 0.35 };
pub(crate) const CORRELATION_PENALTY: f64 = 0.4;
/// Cells, m, steps of the heading, rad, and the standard deviation of end points, m.
pub(crate) const CORRELATION_CELL_M: f64 = 0.02;
pub(crate) const CORRELATION_STEP_RAD: f64 = 0.0044;
pub(crate) const CORRELATION_STD_M: f64 = 0.05;
/// Below the first response, all headings are searched among this number of keyframes: the odometry has missed a turn. Such a
/// pose counts from the second response on, and if it is better by this factor.
pub(crate) const MIN_RESPONSE: f64 = 0.35;
pub(crate) const SURE_RESPONSE: f64 = 0.72;
pub(crate) const SURE_FACTOR: f64 = 1.5;
pub(crate) const RECENT_KEYFRAMES: usize = 8;
pub(crate) const ALL_HEADINGS: Spread = Spread { m: 0.8, rad: std::f64::consts::PI };

// Trajectories: chains of keyframes that are far from each other

/// A keyframe is far from the one before after this motion.
pub(crate) const SPARSE: Spread = Spread { m: 0.5, rad: 0.4 };
/// A chain: keyframes in a row within this distance, m; minimum length; number of chains that are tried, the nearest first; keyframes
/// before and after them that are compared as well.
pub(crate) const CHAIN_M: f64 = 4.0;
pub(crate) const MIN_CHAIN: usize = 4;
pub(crate) const MAX_CHAINS: usize = 2;
pub(crate) const CHAIN_KEYFRAMES: usize = 8;
/// Minimum response of a keyframe in a chain, and number of rounds.
pub(crate) const CHAIN_RESPONSE: f64 = 0.45;
pub(crate) const CHAIN_ROUNDS: usize = 2;

// Trajectories: the scale of the distances of the odometry

/// Motions of at least this length, m, whose distance the scan fixes with at most this standard deviation, m, at least this many;
/// the noise of the odometry after 1 m, m.
pub(crate) const SCALED_M: f64 = 0.2;
pub(crate) const SCALED_STD_M: f64 = 0.03;
pub(crate) const SCALED_MOTIONS: usize = 30;
pub(crate) const SCALE_NOISE_M: f64 = 0.04;
/// A scale that is off by a smaller share than this, or by fewer standard deviations, needs no second pass.
pub(crate) const MIN_SCALE: f64 = 0.005;
pub(crate) const MIN_SCALE_STDS: f64 = 4.0;
/// A scale beyond this factor, in either direction, is no error of wheels.
pub(crate) const MAX_SCALE: f64 = 2.0;

// Trajectories: loops

/// Ways between submaps that need no loop, and that need no second one, m.
pub(crate) const MIN_WAY_M: f64 = 8.0;
pub(crate) const SHORT_WAY_M: f64 = 20.0;
/// Submaps and keyframes are compared where their middles are this near, m.
pub(crate) const NEAR_M: f64 = 6.0;
/// Earlier submaps in which one is searched for, with the score grids of twice as many; points that are compared.
pub(crate) const MAX_SEARCHES: usize = 3;
pub(crate) const COMPARED_POINTS: usize = 300;
/// Errors of a found pose of a submap.
pub(crate) const PLACE_STD: Spread = Spread { m: 0.3, rad: 0.05 };
/// A place: minimum overlap and agreement, maximum share of beams that pass its walls. Where little speaks against it, and half as
/// many beams pass, two others of the same submap suffice, and the minimum overlap is `MAJORITY`.
pub(crate) const PLACE_OVERLAP: f64 = 0.45;
pub(crate) const PLACE_AGREEMENT: f64 = 0.8;
pub(crate) const STRONG_AGREEMENT: f64 = 0.88;
pub(crate) const MAX_PASSING: f64 = 0.06;
/// Minimum score of a pose in a search.
pub(crate) const PLACE_SCORE: f64 = 0.35;
/// Poses of submaps that are the same.
pub(crate) const SAME_SUBMAP: Spread = Spread { m: 0.5, rad: 0.1 };
/// What a pose at the border of the window counts less.
pub(crate) const UNLIKELY: f64 = 0.3;
/// A submap with twice as many references nearer than this is no reference, m: hours in one place.
pub(crate) const REFERENCE_M: f64 = 3.0;
/// A beam passes a surface that it ends behind by this share of the range more.
pub(crate) const PASSED_SHARE: f64 = 0.02;
/// Loops that confirm each other begin and end at most this many submaps apart.
pub(crate) const NEIGHBORS: usize = 6;
/// Errors after a way: at least these, m and rad; per way; per root of the way, rad; at most this, m.
pub(crate) const DRIFT: Spread = Spread { m: 0.4, rad: 0.08 };
pub(crate) const DRIFT_PER_M: f64 = 0.03;
pub(crate) const MAX_DRIFT_M: f64 = 12.0;
/// Way between keyframes, and over a loop, m.
pub(crate) const LOOP_M: f64 = 0.5;
pub(crate) const KEYFRAME_WAY_M: f64 = 0.35;
/// Steps of the graph at most; the change that ends them; a loop off by this (over its covariance) counts a quarter; factor
/// by which this limit shrinks.
pub(crate) const GRAPH_STEPS: usize = 25;
pub(crate) const GRAPH_KERNEL: f64 = 16.0;
pub(crate) const GRAPH_SHRINK: f64 = 3.0;
/// Rounds of the refinement: one of this many keyframes, from poses with these errors.
pub(crate) const REFINE: [(usize, Spread); 2] = [(7, PLACE_STD), (3, Spread { m: 0.15, rad: 0.03 })];
/// Share of the residuals before the tail; fewer points say nothing; standard deviation in medians.
pub(crate) const TAIL: f64 = 0.97;
pub(crate) const MIN_RESIDUALS: usize = 200;
pub(crate) const STD_PER_MEDIAN: f64 = 1.4826;
/// No map of points is larger, m.
pub(crate) const MAX_PLACE_M: f64 = 200.0;

// The first map and its loops

/// Motions in the map and by matching that differ by more than this, and than this many standard deviations, are inconsistent.
pub(crate) const INCONSISTENT: Spread = Spread::of_error(0.06);
/// New ground is farther than this from all places before, m.
pub(crate) const NEW_GROUND_M: f64 = 4.0;
/// Keyframes of the longer way over which motions are compared: about 5 m.
pub(crate) const WINDOW: usize = 16;
/// Ways on known ground after which the map is frozen: without openings, and with openings that may be too narrow, m.
pub(crate) const FROZEN_WAY_M: f64 = 60.0;
pub(crate) const OPENING_WAY_M: f64 = 300.0;
/// A narrower gap is no opening, m; cells so near to a surface are part of it.
pub(crate) const OPENING_M: f64 = 0.5;
pub(crate) const OPENING_CELLS: i32 = 2;
/// The first map is frozen after this number of readings, which bounds the memory: half an hour at 10 Hz.
pub(crate) const MAX_READINGS: usize = 18_000;
/// The same after this many readings in a row that do not agree with those before: the robot was carried.
pub(crate) const BROKEN_READINGS: u32 = 10;
/// Maximum number of rejected replays.
pub(crate) const MAX_REJECTED: u32 = 3;
/// A replay is rejected if this share fewer poses would be certain; it is accepted if this share more are, or if some move.
pub(crate) const CHANGED_CERTAIN: f64 = 0.02;
/// Errors of a certain pose, and of the corrected trajectory, which are the same for many scans.
pub(crate) const CERTAIN_STD: Spread = Spread { m: 0.01, rad: 0.003 };
pub(crate) const CORRECTED_STD: Spread = Spread::of_error(0.003);
