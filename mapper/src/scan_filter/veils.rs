//! Veils and edges: what a scan says where its range jumps from a near surface to a far one.

use interfaces::Scan;

/// The noise of ranges within one surface, m: a hit that is farther than this from both surfaces is on neither.
const NOISE_M: f64 = 0.04;

/// Where the range of a scan jumps.
pub(super) struct Jumps {
    /// The number of beams.
    beams: isize,
    is_full_turn: bool,
    /// The ranges of the hits, m; NaN without a hit. Before the first and after the last beam are [`Self::around`] more:
    /// those around the turn, where there is one.
    ranges_m: Vec<f64>,
    cos: f64,
    sin: f64,
    min_tangent: f64,
}

impl Jumps {
    /// Two hits beside each other belong to different surfaces if the line between them has a smaller angle to the beam.
    pub(super) fn new(scan: &Scan, min_angle_rad: f64) -> Self {
        let step = interfaces::rotation(scan.angle_increment_rad.abs());
        let (beams, is_full_turn) = (scan.ranges_m.len() as isize, scan.is_full_turn());
        let empty = Self {
            beams,
            is_full_turn,
            ranges_m: Vec::new(),
            cos: step.re,
            sin: step.im,
            min_tangent: min_angle_rad.tan(),
        };
        let range_m = |beam| empty.index(beam).map_or(f64::NAN, |beam| f64::from(scan.ranges_m[beam]));
        let ranges_m = (-empty.around()..beams + empty.around()).map(range_m);
        let ranges_m = ranges_m.map(|range_m| if range_m.is_finite() { range_m } else { f64::NAN }).collect();
        Self { ranges_m, ..empty }
    }

    fn around(&self) -> isize {
        self.beams / 4 + 2
    }

    /// The veils: hits between a near and a far surface, where nothing is. A beam that meets the edge of the near surface
    /// hits it in part, and in part the surface behind: the laser reports a range between both. With the range of the near
    /// surface, m; also the number of jumps.
    pub(super) fn veils(&self) -> (Vec<(usize, f64)>, usize) {
        let (mut veils, mut jumps, mut before) = (Vec::new(), 0, self.is_jump(-1, 0));
        for beam in 0..self.beams {
            let after = self.is_jump(beam, beam + 1);
            jumps += usize::from(after);
            if (before || after) && self.is_veil(beam) {
                veils.push((beam as usize, self.range_m(beam - 1).min(self.range_m(beam + 1))));
            }
            before = after;
        }
        (veils, jumps)
    }

    /// The hits on the far side of a jump, nearer to the edge of the near surface than `edge_m` across the beams. A thing
    /// that stands out there has a jump of its own: it and what is beyond it stay. With the range of the edge, m.
    pub(super) fn beside_edges(&self, edge_m: f64) -> Vec<(usize, f64)> {
        let mut beside = Vec::new();
        for (edge, side) in (0..self.beams).flat_map(|beam| [(beam, -1), (beam, 1)]) {
            let near_m = self.range_m(edge);
            if !self.is_jump(edge, edge + side) || self.range_m(edge + side) < near_m {
                continue;
            }
            let reach = ((edge_m / (near_m * self.sin)) as isize).min(self.beams / 4);
            let far = (1..=reach).map(|far| edge + side * far);
            let is_nearer = |beam: isize| {
                self.is_jump(beam, beam - side) && self.range_m(beam) < self.range_m(beam - side)
            };
            let far = far.take_while(|beam| *beam == edge + side || !is_nearer(*beam));
            let behind = far.filter(|beam| self.range_m(*beam) > near_m);
            beside.extend(behind.filter_map(|beam| Some((self.index(beam)?, near_m))));
        }
        beside
    }

    /// The index of a beam; around the turn, where there is one.
    fn index(&self, beam: isize) -> Option<usize> {
        let beam = if self.is_full_turn { beam.rem_euclid(self.beams) } else { beam };
        (0..self.beams).contains(&beam).then_some(beam as usize)
    }

    fn range_m(&self, beam: isize) -> f64 {
        self.ranges_m[(beam + self.around()) as usize]
    }

    /// Whether the range jumps between two hits beside each other.
    fn is_jump(&self, first: isize, second: isize) -> bool {
        let [first, second] = [first, second].map(|beam| self.range_m(beam));
        let (near, far) = (first.min(second), first.max(second));
        // The line between both hits has these components across and along the beam of the farther one. Of NaN, the other
        // number would be the least: the sum is NaN.
        first + second > 0.0 && near * self.sin < self.min_tangent * (far - near * self.cos)
    }

    /// Whether a hit lies between the hits beside it, and on the surface of neither.
    fn is_veil(&self, beam: isize) -> bool {
        let [before, at, after] = [-1, 0, 1].map(|side| self.range_m(beam + side));
        let is_between = (before < at && at < after) || (after < at && at < before);
        is_between && !self.continues(beam, -1) && !self.continues(beam, 1)
    }

    /// Whether a hit continues the surface of the two hits beside it on one side, −1 or 1.
    fn continues(&self, beam: isize, side: isize) -> bool {
        let [next, second] = [1, 2].map(|steps| 1.0 / self.range_m(beam + side * steps));
        if !self.is_jump(beam, beam + side) && (second.is_nan() || self.is_jump(beam + side, beam + 2 * side))
        {
            return true; // Two hits are a surface: a thin thing.
        }
        // One over the range of a straight wall is a sinusoid of the angle.
        let expected_m = 1.0 / (2.0 * self.cos * next - second);
        let tolerance_m = NOISE_M * expected_m * expected_m * (2.0 * next * next).hypot(second * second);
        (self.range_m(beam) - expected_m).abs() <= tolerance_m
    }
}
