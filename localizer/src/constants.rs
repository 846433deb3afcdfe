//! Constants with several users: each with its unit and its reason. Others stand beside their formulas.

use interfaces::Spread;

// Matching

/// Errors of a surfel beyond the noise of its hits, m: surfaces are not perfectly straight.
pub(crate) const SURFEL_STD_M: f64 = 0.003;
/// Minimum range noise that is assumed, m, for the same reason.
pub(crate) const MIN_NOISE_M: f64 = 0.005;
/// What lies within this many standard deviations is the same: points and surfels, poses, motions. What moved by a little more
/// must not pull.
pub(crate) const STDS: f64 = 3.0;
/// Steps of Gauss-Newton at one gate at most; a step below this ends them.
pub(crate) const MAX_STEPS: usize = 8;
pub(crate) const STEP: Spread = Spread { m: 1e-4, rad: 2e-5 };
/// The farthest that a match may start from the pose, m: robots that slip.
pub(crate) const WIDE_GATE_M: f64 = 0.3;
/// Minimum weight of a certain pose, of a motion, and of what has stayed: about 30 cm of wall without gaps.
pub(crate) const MIN_CONFIRMED: f64 = 8.0;
/// Beams may pass blocked cells this close to their ends, m.
pub(crate) const END_M: f64 = 0.2;

// Line map

/// Side of the cells, reach of a surfel along its surface, distance between end points of neighboring beams on one surface, and
/// spacing of the points of a keyframe, m.
pub(crate) const SURFEL_M: f64 = 0.1;
/// Scans after which a surfel takes part in matching, has its full weight, and is frozen.
pub(crate) const USABLE_SCANS: u32 = 5;
pub(crate) const TRUSTED_SCANS: u32 = 50;
pub(crate) const FROZEN_SCANS: u32 = 400;
/// Minimum cosine of the angle between the normals of a point and of its surfel.
pub(crate) const SAME_NORMAL: f64 = 0.8;
/// Near to a surface with the same direction, and to the ends of beams, m, there is no other: a copy beside a wall is how a wrong pose becomes a wrong map.
pub(crate) const CLEARANCE_M: f64 = 0.25;
/// Half the thickness of what counts as the same surface in a map of cells of 5 cm, m.
pub(crate) const THICK_M: f64 = 0.15;
/// A surface seen off its place by less than this has moved, m; beyond, it is another one.
pub(crate) const MOVED_M: f64 = 0.12;
/// Weight of a surfel that has moved; scans in one place after which it counts as if it had not: ten minutes.
pub(crate) const SUSPECT_WEIGHT: f64 = 0.03;
pub(crate) const SETTLED_SCANS: u32 = 6000;
/// One of this many surfels is checked per scan; surfaces farther than this are not compared, m.
pub(crate) const CHECK_TURNS: usize = 10;
pub(crate) const NEAR_RANGE_M: f64 = 10.0;
/// Surfels farther than this are not checked, and points at this range move by two cells from heading to heading of a search, m.
pub(crate) const FAR_M: f64 = 8.0;

// Much of the view has moved (mixture of two motions)

/// Share of the known surfaces a little off their place with which much of the view may have moved, and share that most of the
/// view leaves over.
pub(crate) const MOVED_SHARE: f64 = 0.12;
pub(crate) const MIN_LEFT: f64 = 0.04;
/// Errors of a pose that is about known: of a given start, of what is left over by most of the view, of compared poses; maps
/// with smaller errors are not learned again.
pub(crate) const NEAR_STD: Spread = Spread { m: 0.05, rad: 0.02 };

// Certain poses

/// Minimum support of a certain pose.
pub(crate) const MIN_SUPPORT: f64 = 0.85;
/// The range noise for which these limits hold, m.
pub(crate) const LIMIT_NOISE_M: f64 = 0.01;
/// The noise of the lasers of logs, whose walls are less straight, m.
pub(crate) const LOG_NOISE_M: f64 = 0.02;
/// Errors of a pose that is lost.
pub(crate) const LOST_STD: Spread = Spread { m: 5.0, rad: 3.0 };

// Relocalization

/// A robot that was pushed or carried a little: where it may be by odometry for some time after its last certain pose, s, and
/// where it is searched for first.
pub(crate) const CARRIED: Spread = Spread { m: 1.3, rad: 1.2 };
pub(crate) const CARRIED_S: f64 = 10.0;
pub(crate) const PUSHED: Spread = Spread { m: 1.5, rad: 1.3 };
/// Half a second of scans: between searches in the whole map, and at rest before a replay.
pub(crate) const SEARCH_EVERY: u32 = 5;
/// Minimum score of a found pose: in the search, and refined.
pub(crate) const MIN_FOUND: f64 = 0.55;
pub(crate) const MIN_SCORE: f64 = 0.65;
/// Another pose is possible with this share of the best score, equal with this.
pub(crate) const AMBIGUOUS: f64 = 0.9;
pub(crate) const EQUAL: f64 = 0.95;
/// Scans in a row that confirm a found pose, or that a surface has moved.
pub(crate) const CONFIRM_SCANS: u32 = 3;
/// Errors of a found pose, of which a loop that is off by more is used at once; and poses that are the same.
pub(crate) const FOUND_STD: Spread = Spread { m: 0.1, rad: 0.03 };
pub(crate) const SAME_POSE: Spread = Spread::of_motion(0.1);
/// Search: number of points, of poses, and of points after which a bad square is left.
pub(crate) const SEARCH_POINTS: usize = 64;
pub(crate) const MAX_CANDIDATES: usize = 16;
pub(crate) const SEARCH_CHUNK: usize = 8;
/// Work of a search in one scan, in scores that are looked up: 40 ms; two cells of their tables take as long as one.
pub(crate) const MAX_WORK: usize = 16_000_000;
pub(crate) const CELLS_PER_LOOKUP: usize = 2;
/// Side of the cells of a search, m; maximum side of a part of a map, m; sides of the largest squares, as a power of 2.
pub(crate) const SCORE_CELL_M: f64 = 0.05;
pub(crate) const MAX_SIDE_M: f64 = 102.4;
pub(crate) const TOP: usize = 6;

// Verification of found poses

/// Share of a scan below which a viewpoint counts against a pose, and below which a pose must be verified.
pub(crate) const FAIR_SHARE: f64 = 0.7;

// Poses

/// Way equivalent of a turn, m/rad: the arc of the wheels of a robot of 0.6 m.
pub(crate) const TURN_M: f64 = 0.3;
/// Share of a scan, or of a map, that decides: poses with less of a scan are not followed.
pub(crate) const MAJORITY: f64 = 0.5;
/// Share of a scan, or of a map, that decides nothing.
pub(crate) const MINOR: f64 = 0.1;

// Deskew and points of scans

/// Minimum cosine of the angle of incidence of a beam that contradicts a surfel, and a submap.
pub(crate) const MIN_INCIDENCE: f64 = 0.3;
pub(crate) const MIN_SURE_INCIDENCE: f64 = 0.35;
/// Minimum cosine of the angle between normals on one surface.
pub(crate) const SAME_SURFACE: f64 = 0.95;

// Motion prior

/// The largest errors of an odometry that are expected: systematic errors per meter and per radian, and the standard deviation of
/// the noise after 1 m (m) and after 1 rad (rad), whose variance grows with the distance.
pub(crate) const HARD_DRIFT: f64 = 0.05;
/// The same for the heading per meter traveled, rad/m: 3°.
pub(crate) const HARD_DRIFT_RADPM: f64 = 0.052;
/// Errors of an odometry after an outlier, for this many scans; and of a robot without odometry.
pub(crate) const DISTRUSTED_STD: Spread = Spread { m: 0.05, rad: 0.1 };
pub(crate) const DISTRUST_SCANS: u32 = 20;
/// Minimum motion that shows that odometry exists, and that makes a repeated scan a frozen one.
pub(crate) const MIN_MOTION: Spread = Spread::of_motion(0.005);
pub(crate) const FROZEN_MOTION: Spread = Spread::of_motion(0.01);

// Trajectories: matches with submaps

/// A scan becomes a keyframe after this way, m, or turn, rad; the robot has another viewpoint.
pub(crate) const KEYFRAME: Spread = Spread { m: 0.3, rad: 0.2 };
/// Keyframes of a submap; it covers this far around the first, m.
pub(crate) const SUBMAP_KEYFRAMES: usize = 20;
pub(crate) const SUBMAP_REACH_M: f64 = 35.0;
/// Points this near to a surface must lie on it, points twice as far apart may be on one, and a match starts at most this far
/// from the prediction, m.
pub(crate) const JUDGED_M: f64 = 0.4;
/// Minimum share of what can be judged that agrees; of the points that can be judged, and of those that a search finds.
pub(crate) const MIN_AGREEMENT: f64 = 0.75;
pub(crate) const MIN_OVERLAP: f64 = 0.4;
/// Share of the best score with which other poses are examined.
pub(crate) const EXAMINED: f64 = 0.75;
/// Errors of matched poses that do not average out: of a scan, between keyframes, of submaps in each
/// other, and of keyframes in submaps.
pub(crate) const SCAN_STD: Spread = Spread { m: 0.001, rad: 3e-4 };
pub(crate) const KEYFRAME_STD: Spread = Spread { m: 0.004, rad: 0.0015 };
pub(crate) const PLACE_MODEL_STD: Spread = Spread { m: 0.02, rad: 0.004 };
pub(crate) const SUBMAP_STD: Spread = Spread { m: 0.015, rad: 0.003 };

// Trajectories: scans that are far from the one before

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

// Trajectories: loops

/// Ways between submaps that need no loop, and that need no second one, m.
pub(crate) const MIN_WAY_M: f64 = 8.0;
pub(crate) const SHORT_WAY_M: f64 = 20.0;
/// Submaps and keyframes are compared where their middles are this near, m.
pub(crate) const NEAR_M: f64 = 6.0;
/// Errors of a found pose of a submap.
pub(crate) const PLACE_STD: Spread = Spread { m: 0.3, rad: 0.05 };
/// A place: minimum overlap and agreement, maximum share of beams that pass its walls. Where little speaks against it, and half as
/// many beams pass, two others of the same submap suffice, and the minimum overlap is `MAJORITY`.
pub(crate) const PLACE_OVERLAP: f64 = 0.45;
pub(crate) const PLACE_AGREEMENT: f64 = 0.8;
pub(crate) const STRONG_AGREEMENT: f64 = 0.88;
pub(crate) const MAX_PASSING: f64 = 0.06;
/// Loops that confirm each other begin and end at most this many submaps apart.
pub(crate) const NEIGHBORS: usize = 6;
/// Way between keyframes, and over a loop, m.
pub(crate) const LOOP_M: f64 = 0.5;
pub(crate) const KEYFRAME_WAY_M: f64 = 0.35;
/// Rounds of the refinement: one of this many keyframes, from poses with these errors.
pub(crate) const REFINE: [(usize, Spread); 2] = [(7, PLACE_STD), (3, Spread { m: 0.15, rad: 0.03 })];
