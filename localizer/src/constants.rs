//! All constants of the crate that were chosen: each with its unit and its reason.

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
/// End points of neighboring beams that are nearer than this are on one surface, m.
pub(crate) const JOIN_M: f64 = 0.1;
/// The same in spacings of the beams: below about 20° between beam and surface, a third beam must confirm the surface.
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

// Matching

/// Errors of a surfel beyond the noise of its hits, m: surfaces are not perfectly straight.
pub(crate) const SURFEL_STD_M: f64 = 0.003;
/// Minimum range noise that is assumed, m, for the same reason.
pub(crate) const MIN_NOISE_M: f64 = 0.005;
/// What lies within this many standard deviations is the same: points and surfels, poses, motions. What moved by a little more
/// must not pull.
pub(crate) const STDS: f64 = 3.0;
/// The same of points and surfels in live matches, whose maps are followed for hours: with 3, the position is off by 32 mm instead of
/// 19 mm where the noise is 3 cm.
pub(crate) const GATE_STDS: f64 = 3.5;
/// Steps of Gauss-Newton at one gate at most; a step below this ends them.
pub(crate) const MAX_STEPS: usize = 8;
pub(crate) const STEP: Spread = Spread { m: 1e-4, rad: 2e-5 };
/// A point whose noise across the surface is small must not pull where it hits another surface: minimum share of the kernel.
pub(crate) const MIN_KERNEL: f64 = 0.3;
/// The farthest that a match may start from the pose, m: robots that slip.
pub(crate) const WIDE_GATE_M: f64 = 0.3;
/// Innovation over its covariance above which the odometry is an outlier: 1 in 10⁵ by chance.
pub(crate) const OUTLIER: f64 = 26.0;
/// A match without odometry slides at most this far from its start, m.
pub(crate) const MAX_SLIDE_M: f64 = 0.5;
/// Minimum gain of support with which another pose replaces the predicted one.
pub(crate) const BETTER: f64 = 0.05;
/// Errors of the map where other surfaces come into view.
pub(crate) const MAP_STD: Spread = Spread { m: 0.002, rad: 7e-4 };
/// Errors of a match that do not average out, per scan: surfaces that are not straight.
pub(crate) const MODEL_STD: Spread = Spread { m: 5e-4, rad: 1.5e-4 };
/// Minimum weight of a certain pose, of a motion, and of what has stayed: about 30 cm of wall without gaps.
pub(crate) const MIN_CONFIRMED: f64 = 8.0;
/// One of this many beams without a return is compared, with half the weight of a point for each.
pub(crate) const CLEAR_STRIDE: usize = 6;
/// Beams may pass blocked cells this close to their ends, m.
pub(crate) const END_M: f64 = 0.2;

// Line map

/// Side of the cells, reach of a surfel along its surface, and spacing of the points of a keyframe, m.
pub(crate) const SURFEL_M: f64 = 0.1;
/// Surfels in a cell: two sides of a thin wall, and a corner.
pub(crate) const PER_CELL: usize = 4;
/// Scans after which a surfel takes part in matching, has its full weight, and is frozen.
pub(crate) const USABLE_SCANS: u32 = 5;
pub(crate) const TRUSTED_SCANS: u32 = 50;
pub(crate) const FROZEN_SCANS: u32 = 400;
/// Scans as which a surfel of a known map counts: the next ones correct it.
pub(crate) const PRIOR_SCANS: u32 = 20;
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
/// A beam that passes a surfel counts as this many of what may stand in front.
pub(crate) const PASSED_COUNTS: u32 = 4;
/// Scans that made a surfel for each scan that is needed to remove it.
pub(crate) const SCANS_PER_MISS: u32 = 20;
/// Scans between two updates of the weights by rates.
pub(crate) const RATES_EVERY: u32 = 100;

// Much of the view has moved (mixture of two motions)

/// Share of the known surfaces a little off their place with which much of the view may have moved, and share that most of the
/// view leaves over.
pub(crate) const MOVED_SHARE: f64 = 0.12;
pub(crate) const MIN_LEFT: f64 = 0.04;
/// Minimum weight that only the pose of what has stayed explains, about 20 cm of wall, and that only the other pose
/// explains, and its share of the known surfaces.
pub(crate) const MIN_STAYED: f64 = 5.0;
pub(crate) const MIN_MOVED: f64 = 10.0;
pub(crate) const MIN_MOVED_SHARE: f64 = 0.15;
/// Two motions are at least this far apart, m.
pub(crate) const APART_M: f64 = 0.02;
/// Matches nearer than this to each other are the same, m and rad.
pub(crate) const SAME_MATCH: f64 = 0.001;
/// Turns from which the pose of what has stayed is looked for, rad.
pub(crate) const TURNS_RAD: [f64; 2] = [0.006, 0.012];
/// The two poses are fitted in turns this often.
pub(crate) const ROUNDS: usize = 3;
/// Errors of a pose that is about known: of a given start, of what is left over by most of the view, of compared poses; maps
/// with smaller errors are not learned again.
pub(crate) const NEAR_STD: Spread = Spread { m: 0.05, rad: 0.02 };
/// Weights of the log-evidence terms: what both poses explain, what has stayed, and few against many.
pub(crate) const EXPLAINED_COUNTS: f64 = 25.0;
pub(crate) const STAYED_COUNTS: f64 = 2.0;
pub(crate) const RATIO_COUNTS: f64 = 6.0;
/// By this log-evidence, what has stayed must be better.
pub(crate) const MARGIN: f64 = 4.0;

// Certain poses

/// Minimum support of a certain pose.
pub(crate) const MIN_SUPPORT: f64 = 0.85;
/// Maximum errors of a scan that enters the map: those that persist make false changes from 5 mm on (3.7 per 1000 scans of 1 cm
/// noise). The heading for surfaces seen at this lever, m, that of a scan in the middle of a room.
pub(crate) const MAX_STD: Spread = Spread { m: 0.005, rad: 0.003 };
pub(crate) const LEVER_M: f64 = 1.2;
/// The range noise for which these limits hold, m.
pub(crate) const LIMIT_NOISE_M: f64 = 0.01;
/// The line map learns from poses that are less certain by this factor: otherwise a robot with few beams never sees the rest
/// of a new room with certainty.
pub(crate) const LEARNING_LIMITS: f64 = 10.0;
/// Rest at the start from nothing, s: the first scans decide the heading of all that follows (0.076° → 0.024°).
pub(crate) const SETTLE_S: f64 = 2.0;
/// Errors of a pose that is lost.
pub(crate) const LOST_STD: Spread = Spread { m: 5.0, rad: 3.0 };

// Relocalization

/// A robot that was pushed or carried a little: where it may be by odometry for some time after its last certain pose, s, and
/// where it is searched for first.
pub(crate) const CARRIED: Spread = Spread { m: 1.3, rad: 1.2 };
pub(crate) const CARRIED_S: f64 = 10.0;
pub(crate) const PUSHED: Spread = Spread { m: 1.5, rad: 1.3 };
/// A pose is elsewhere if it is farther from the pose prior than this, beyond its errors.
pub(crate) const ELSEWHERE: Spread = Spread::of_motion(0.3);
pub(crate) const ELSEWHERE_STDS: f64 = 4.0;
/// Half a second of scans: between searches in the whole map, and at rest before a replay.
pub(crate) const SEARCH_EVERY: u32 = 5;
/// Minimum score of a found pose: in the search, and refined.
pub(crate) const MIN_FOUND: f64 = 0.55;
pub(crate) const MIN_SCORE: f64 = 0.65;
/// Another pose is possible with this share of the best score, equal with this.
pub(crate) const AMBIGUOUS: f64 = 0.9;
pub(crate) const EQUAL: f64 = 0.95;
/// What a score counts at the next scan: about five scans decide.
pub(crate) const SCORE_MEMORY: f64 = 0.8;
/// Scans in a row that confirm a found pose, or that a surface has moved.
pub(crate) const CONFIRM_SCANS: u32 = 3;
/// Errors of a found pose, of which a loop that is off by more is used at once; and poses that are the same.
pub(crate) const FOUND_STD: Spread = Spread { m: 0.1, rad: 0.03 };
pub(crate) const SAME_POSE: Spread = Spread::of_motion(0.1);
/// The same of poses in a search, and of places of submaps.
pub(crate) const SAME_PLACE: Spread = Spread { m: 0.4, rad: 0.35 };
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
/// Surfaces farther away are not looked for in parts of a map, m.
pub(crate) const MAX_REACH_M: f64 = 28.8;
/// A surfel reaches this far along its surface, m: neighbors join.
pub(crate) const ALONG_M: f64 = 0.08;

// Verification of found poses

/// What contradicts the map counts this many times.
pub(crate) const CONTRADICTION: f64 = 4.0;
/// Agreement that says nothing: near the pose by odometry, and elsewhere, where that of wrong poses was at most 0.25.
pub(crate) const FAIR_NEAR: f64 = 0.2;
pub(crate) const FAIR: f64 = 0.35;
/// Share of a scan below which a viewpoint counts against a pose, and below which a pose must be verified.
pub(crate) const FAIR_SHARE: f64 = 0.7;
/// Evidence of a viewpoint per agreement, for and against a pose; and the evidence that decides.
pub(crate) const GAIN: f64 = 4.0;
pub(crate) const LOSS: f64 = 20.0;
pub(crate) const ENOUGH: f64 = 3.0;
/// Viewpoints that the first one counts: of a laser that sees all around.
pub(crate) const FIRST_VIEWS: f64 = 2.0;
/// Way to another viewpoint, m.
pub(crate) const VIEW_M: f64 = 0.25;

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
/// many beams pass, two others of the same submap suffice.
pub(crate) const PLACE_OVERLAP: f64 = 0.45;
pub(crate) const PLACE_AGREEMENT: f64 = 0.8;
pub(crate) const STRONG_OVERLAP: f64 = 0.5;
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
