//! Constants of relocalization.

use crate::spread::Spread;

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
