//! All that one scan is compared with.

use crate::constants::{MOVED_M, SURFEL_STD_M};
use crate::matcher::{Gates, Match, Prior, align, derivative};
use crate::placement::Placement;
use crate::scan_points::ScanPoint;
use crate::settings::LocalizerSettings;
use crate::support::{ClearBeams, Support, is_contradicted};
use crate::surfel_map::{Surfel, SurfelMap};
use interfaces::{CellState, Grid};
use nalgebra::{Isometry2, Point2};

/// The same of points and surfels in live matches, whose maps are followed for hours: with 3, the position is off by 32 mm instead of
/// 19 mm where the noise is 3 cm.
const GATE_STDS: f64 = 3.5;

/// One scan, and the maps.
pub(crate) struct MatchScene<'a> {
    pub(crate) surfels: &'a SurfelMap,
    pub(crate) states: &'a Grid<CellState>,
    pub(crate) points: &'a [ScanPoint],
    pub(crate) clear: &'a ClearBeams,
    /// The pose of the laser in the frame of the robot.
    pub(crate) mount: Isometry2<f64>,
    pub(crate) settings: &'a LocalizerSettings,
    /// Whether only what lies in place counts: much of the view may have moved.
    pub(crate) is_tight: bool,
}

impl MatchScene<'_> {
    /// The distance up to which a point confirms a surfel, m.
    pub(crate) fn gate_m(&self) -> f64 {
        let stds = if self.is_tight { GATE_STDS / 2.0 } else { GATE_STDS };
        stds * hit_std_m(self.settings.range_noise_std_m)
    }

    /// The distance up to which the mean over some points is exactly in place, m.
    pub(crate) fn exact_m(&self) -> f64 {
        exact_m(self.settings.range_noise_std_m)
    }

    /// Matches the scan from `start`; points belong to surfels up to `first_m` away in the first steps.
    pub(crate) fn align(
        &self,
        start: &Isometry2<f64>,
        prior: Option<&Prior>,
        first_m: f64,
        by_rates: bool,
    ) -> Option<Match> {
        let last_m = self.gate_m();
        let gates = Gates {
            noise_m: self.settings.range_noise_std_m.max(SURFEL_STD_M),
            first_m: first_m.max(last_m),
            last_m,
            by_rates,
        };
        align(self.surfels, self.points, start, prior, &gates)
    }

    /// The same scene, in which only what lies in place counts.
    pub(crate) fn tight(&self) -> Self {
        MatchScene { is_tight: true, ..*self }
    }

    /// The agreement of the scan with the maps at a pose. A point within the gate of a surfel is confirmed, within the tight gate it is
    /// in place.
    pub(crate) fn judge(&self, placement: &Placement) -> Support {
        let MatchScene { surfels, states, points, .. } = *self;
        let (place_m, gate_m) = (self.tight().gate_m(), self.gate_m());
        let laser = placement.pose * self.mount;
        let origin = Point2::from(laser.translation.vector);
        let mut support = Support::default();
        for point in points {
            let at = placement.place(point);
            let arm = at.coords - placement.pose.translation.vector;
            let normal = placement.pose.rotation * point.normal;
            match surfels.nearest(&at, &normal, gate_m) {
                Some((index, off_m)) if surfels.surfel(index).weight() > 0.0 => {
                    support.confirmed += point.weight;
                    let surfel = surfels.surfel(index);
                    match off_m.abs() <= place_m {
                        _ if !surfel.is_permanent() => {}
                        true => support.in_place += point.weight,
                        false => support.displaced += point.weight,
                    }
                    let j = derivative(&arm, &surfel.normal);
                    support.geometry += j * j.transpose() * point.weight;
                }
                Some(_) => support.new += point.weight,
                None => {
                    let beside =
                        surfels.nearest(&at, &normal, MOVED_M).map(|(index, _)| surfels.surfel(index));
                    if beside.is_some_and(Surfel::is_permanent) {
                        support.displaced += point.weight;
                    }
                    // What has moved before says nothing against a pose.
                    match !beside.is_some_and(Surfel::is_suspect) && is_contradicted(states, &origin, &at) {
                        true => support.contradicted += point.weight,
                        false => support.new += point.weight,
                    }
                }
            }
        }
        support.blind = self.clear.contradicted(states, &laser);
        support.contradicted += support.blind;
        support
    }
}

/// The distance up to which the mean over some points of a laser with this noise is exactly in place, m.
pub(crate) fn exact_m(noise_m: f64) -> f64 {
    GATE_STDS / 4.0 * hit_std_m(noise_m)
}

/// The standard deviation of the distance of a point from its surfel, m.
pub(crate) fn hit_std_m(noise_m: f64) -> f64 {
    (noise_m * noise_m + SURFEL_STD_M * SURFEL_STD_M).sqrt()
}
