//! Much of the view has shifted at once: either the robot has moved and its odometry missed it, or the things have moved.
//!
//! Two poses explain such a scan: that of the surfaces which have stayed, and that of a robot which follows the surfaces that
//! have moved. Most of the view fixes neither of the two well, and may fix a third one between them; so both are fitted in turns,
//! each to the points that lie better there: a mixture of two rigid motions, as in the segmentation of motions in images
//! (Jepson & Black 1993). Then the odometry decides, unless few surfaces are against many.
//!
//! Points are compared with surfaces that were never seen to move, in the mean over their neighbors on the same surface: that
//! tells apart what the noise of a single point hides.

use crate::constants::{MAJORITY, MIN_LEFT, MOVED_M, NEAR_STD, SURFEL_STD_M};
use crate::match_scene::MatchScene;
use crate::matcher::{Match, Prior, difference};
use crate::motion::Predicted;
use crate::placement::Placement;
use crate::scan_points::{ScanPoint, means};
use crate::support::Support;
use nalgebra::Isometry2;

/// Minimum weight that only the pose of what has stayed explains, about 20 cm of wall, and that only the other pose
/// explains, and its share of the known surfaces.
const MIN_STAYED: f64 = 5.0;
const MIN_MOVED: f64 = 10.0;
const MIN_MOVED_SHARE: f64 = 0.15;
/// Two motions are at least this far apart, m.
const APART_M: f64 = 0.02;
/// Matches nearer than this to each other are the same, m and rad.
const SAME_MATCH: f64 = 0.001;
/// Turns from which the pose of what has stayed is looked for, rad.
const TURNS_RAD: [f64; 2] = [0.006, 0.012];
/// The two poses are fitted in turns this often.
const ROUNDS: usize = 3;
/// Weights of the log-evidence terms: what both poses explain, what has stayed, and few against many.
const EXPLAINED_COUNTS: f64 = 25.0;
const STAYED_COUNTS: f64 = 2.0;
const RATIO_COUNTS: f64 = 6.0;
/// Weights below this are none.
const MIN_WEIGHT: f64 = 1e-3;
/// By this log-evidence, what has stayed must be better.
const MARGIN: f64 = 4.0;

/// The pose of a robot of which much of the view does not know that it has stayed.
pub(crate) struct Stayed {
    pub(crate) found: Match,
    /// If much of the view has moved: the pose of a robot that follows it.
    pub(crate) follower: Option<Isometry2<f64>>,
}

/// Looks for surfaces that have stayed where the odometry says, against the pose `most` of most of the view. `None` if there
/// are too few. Not of scans that sweep: most of their view does not fix a pose without the odometry.
pub(crate) fn stayed(scene: &MatchScene, predicted: &Predicted, most: &Placement) -> Option<Stayed> {
    let scene = &scene.tight();
    let prior = predicted.prior().filter(|prior| prior.begin.is_none())?;
    let most = scene.align(&most.pose, None, 0.0, false)?;
    let offsets = Offsets::new(scene, &most.placement);
    let known = offsets.weight(|_| true);
    let is_left = |at: usize| offsets.is_known(at) && !offsets.is_exact(at);
    if known <= 0.0 || offsets.weight(is_left) < MIN_LEFT * known {
        return None;
    }
    let mut pairs: Vec<Pair> = Vec::new();
    let mut tried: Vec<Isometry2<f64>> = Vec::new();
    for start in starts(scene, predicted, &prior, &most, &offsets.choose(scene.points, is_left)) {
        let pose = start.placement.pose;
        if tried.iter().all(|other| difference(&pose, other).abs().max() >= SAME_MATCH) {
            tried.push(pose);
            pairs.extend(separate(scene, &prior, start, &most));
        }
    }
    let information = predicted.covariance.try_inverse()?;
    let from_odometry = |found: &Match| {
        let off = difference(&found.placement.pose, &predicted.pose);
        (off.transpose() * information * off)[0]
    };
    let score = |pair: &Pair| pair.score() - from_odometry(&pair.stayed);
    let pair = pairs.iter().max_by(|a, b| score(a).total_cmp(&score(b)))?;
    let is_better =
        from_odometry(&pair.stayed) + pair.few_against_many() + MARGIN < from_odometry(&pair.moved);
    let is_much = pair.only_moved >= MIN_MOVED.max(MIN_MOVED_SHARE * known);
    (is_better && pair.is_coherent() && pair.explains(&scene.judge(&pair.stayed.placement)))
        .then_some(Stayed { found: pair.stayed, follower: is_much.then_some(pair.moved.placement.pose) })
}

/// Matches that may have found what has stayed: most of the view itself, what it leaves over (`left`), and what is near the
/// odometry, from several headings.
fn starts(
    scene: &MatchScene,
    predicted: &Predicted,
    prior: &Prior,
    most: &Match,
    left: &[ScanPoint],
) -> Vec<Match> {
    let wide_m = 2.0 * scene.gate_m();
    let of_left =
        MatchScene { points: left, ..*scene }.align(&most.placement.pose, Some(prior), MOVED_M, false);
    let turned = |turn_rad: f64| {
        let rotation = interfaces::rotation(turn_rad) * most.placement.pose.rotation;
        Isometry2::from_parts(predicted.pose.translation, rotation)
    };
    let poses = std::iter::once(predicted.pose)
        .chain(TURNS_RAD.into_iter().flat_map(|turn_rad| [turned(-turn_rad), turned(turn_rad)]));
    let near = poses.filter_map(|pose| scene.align(&pose, Some(prior), wide_m, false));
    std::iter::once(*most).chain(of_left).chain(near).collect()
}

/// Two poses that explain a scan.
struct Pair {
    /// Of what has stayed.
    stayed: Match,
    /// Of a robot that follows what has moved.
    moved: Match,
    /// The weights that the first pose explains, that only the first explains, and that only the second explains.
    in_place: f64,
    only_stayed: f64,
    only_moved: f64,
}

impl Pair {
    /// How well both poses explain the scan.
    fn score(&self) -> f64 {
        let log = |weight: f64| libm::log(weight.max(MIN_WEIGHT));
        EXPLAINED_COUNTS * log(self.in_place + self.only_moved) + STAYED_COUNTS * log(self.in_place)
    }

    /// What speaks against the first pose: little has stayed, much has moved.
    fn few_against_many(&self) -> f64 {
        RATIO_COUNTS * libm::log(self.only_moved.max(MIN_WEIGHT) / self.only_stayed.max(MIN_WEIGHT))
    }

    /// Whether the two poses explain most of a scan with this support.
    fn explains(&self, support: &Support) -> bool {
        self.in_place + self.only_moved >= MAJORITY * (support.confirmed + support.contradicted)
    }

    /// Whether there are two different poses.
    fn is_coherent(&self) -> bool {
        let apart = difference(&self.stayed.placement.pose, &self.moved.placement.pose);
        (APART_M..=MOVED_M).contains(&apart.xy().norm()) && self.only_stayed >= MIN_STAYED
    }
}

/// Separates what has stayed from what has moved: each pose is that of the points which lie better there. `None` if the
/// points do not fix the poses.
fn separate(scene: &MatchScene, prior: &Prior, start: Match, most: &Match) -> Option<Pair> {
    let information = NEAR_STD.information();
    let near_most = Prior { pose: most.placement.pose, information, begin: None };
    let of = |points: &[ScanPoint], at: &Match, prior: &Prior| {
        MatchScene { points, ..*scene }.align(&at.placement.pose, Some(prior), 0.0, false)
    };
    let (mut stayed, mut moved) = (start, *most);
    let mut in_place = Offsets::new(scene, &stayed.placement);
    for _ in 0..ROUNDS {
        let is_off = |at: usize| in_place.is_known(at) && !in_place.is_exact(at);
        moved = of(&in_place.choose(scene.points, is_off), &moved, &near_most)?;
        let followed = Offsets::new(scene, &moved.placement);
        let gate_m = scene.gate_m();
        let is_nearer = |at: usize| {
            in_place.off_m(at) <= gate_m && in_place.off_m(at) <= followed.off_m(at) + SURFEL_STD_M
        };
        stayed = of(&in_place.choose(scene.points, is_nearer), &stayed, prior)?;
        in_place = Offsets::new(scene, &stayed.placement);
    }
    let followed = Offsets::new(scene, &moved.placement);
    Some(Pair {
        stayed,
        moved,
        in_place: in_place.weight(|at| in_place.is_exact(at)),
        only_stayed: in_place.weight(|at| in_place.is_exact(at) && !followed.is_exact(at)),
        only_moved: followed.weight(|at| followed.is_exact(at) && !in_place.is_exact(at)),
    })
}

/// How far the points of a scan lie off the surfaces that were never seen to move.
struct Offsets {
    /// Per point the distance, in the mean over its neighbors on the same surface, m, and the weight.
    points: Vec<Option<(f64, f64)>>,
    exact_m: f64,
}

impl Offsets {
    fn new(scene: &MatchScene, placement: &Placement) -> Self {
        let rotation = placement.pose.rotation;
        let off_m = |point: &ScanPoint| {
            let normal = rotation * point.normal;
            let (index, off_m) = scene.surfels.nearest(&placement.place(point), &normal, MOVED_M)?;
            scene.surfels.surfel(index).is_permanent().then_some(off_m)
        };
        let offs_m: Vec<Option<f64>> = scene.points.iter().map(off_m).collect();
        let means = means(scene.points, &offs_m).into_iter().zip(scene.points);
        let points = means.map(|(mean_m, point)| Some((mean_m?.abs(), point.weight))).collect();
        Self { points, exact_m: scene.exact_m() }
    }

    fn is_known(&self, at: usize) -> bool {
        self.points[at].is_some()
    }

    /// The distance of a point; infinite if there is no surface near it.
    fn off_m(&self, at: usize) -> f64 {
        self.points[at].map_or(f64::INFINITY, |(off_m, _)| off_m)
    }

    fn is_exact(&self, at: usize) -> bool {
        self.off_m(at) <= self.exact_m
    }

    /// The weight of some of the points near surfaces.
    fn weight(&self, choose: impl Fn(usize) -> bool) -> f64 {
        let all = self.points.iter().enumerate().filter(|(at, _)| choose(*at));
        all.filter_map(|(_, point)| point.map(|(_, weight)| weight)).sum()
    }

    fn choose(&self, points: &[ScanPoint], choose: impl Fn(usize) -> bool) -> Vec<ScanPoint> {
        let all = points.iter().enumerate().filter(|(at, _)| choose(*at));
        all.map(|(_, point)| *point).collect()
    }
}
