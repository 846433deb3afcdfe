//! Constants of live matches: the line map, what has moved, and when a pose is certain.

use crate::spread::Spread;

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

/// Side of the cells, reach of a surfel along its surface, distance between end points of neighboring beams on one surface, and
/// spacing of the points of a keyframe, m.
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
/// Weights below this are none.
pub(crate) const MIN_WEIGHT: f64 = 1e-3;
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
/// The noise of the lasers of logs, whose walls are less straight, m.
pub(crate) const LOG_NOISE_M: f64 = 0.02;
/// The line map learns from poses that are less certain by this factor: otherwise a robot with few beams never sees the rest
/// of a new room with certainty.
pub(crate) const LEARNING_LIMITS: f64 = 10.0;
/// Rest at the start from nothing, s: the first scans decide the heading of all that follows (0.076° → 0.024°).
pub(crate) const SETTLE_S: f64 = 2.0;
/// Errors of a pose that is lost.
pub(crate) const LOST_STD: Spread = Spread { m: 5.0, rad: 3.0 };
