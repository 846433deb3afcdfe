//! Whether the speeds that an odometry reports are those of its poses and times.

use nalgebra::Vector2;

/// Speeds are compared over pieces of this length, m; at least this number of them.
const PIECE_M: f64 = 0.25;
const MIN_PIECES: usize = 20;
/// Slower steps are rest and noise, m/s; over longer ones, s, a speed says little.
const MIN_MPS: f64 = 0.02;
const MAX_STEP_S: f64 = 2.0;
/// A factor between these is wrong; a larger one is that of another unit of the speeds, which are not used.
const FACTORS: [f64; 2] = [1.5, 30.0];
/// The factor is that of the whole log if this share of the pieces is this near to it.
const MIN_SHARE: f64 = 0.8;
const NEAR: f64 = 0.25;

/// Compares the speeds that an odometry reports with its poses and times.
#[derive(Clone, Debug, Default)]
pub(crate) struct Speeds {
    last: Option<(f64, Vector2<f64>)>,
    /// The length of the present piece, by the speeds and by the poses, m.
    reported_m: f64,
    moved_m: f64,
    /// Length by the speeds per length by the poses, of each piece.
    ratios: Vec<f64>,
}

impl Speeds {
    /// Adds a position, m, with the speed that is reported there.
    pub(crate) fn add(&mut self, time_s: f64, at: Vector2<f64>, speed_mps: f64) {
        let Some((last_s, last)) = self.last.replace((time_s, at)) else { return };
        let (elapsed_s, step_m) = (time_s - last_s, (at - last).norm());
        let is_step = elapsed_s > 0.0 && elapsed_s <= MAX_STEP_S && speed_mps.is_finite();
        let moves = speed_mps.abs() >= MIN_MPS && step_m >= MIN_MPS * elapsed_s; // false for NaN
        if !(is_step && moves) {
            return;
        }
        self.reported_m += speed_mps.abs() * elapsed_s;
        self.moved_m += step_m;
        if self.moved_m >= PIECE_M {
            self.ratios.push(self.reported_m / self.moved_m);
            (self.reported_m, self.moved_m) = (0.0, 0.0);
        }
    }

    /// Why speeds, poses and times cannot all be true, if it is sure: they differ by one factor in the whole log.
    pub(crate) fn impossible(&self) -> Option<String> {
        let pieces = self.ratios.len();
        if pieces < MIN_PIECES {
            return None;
        }
        let factor = interfaces::median(self.ratios.iter().copied())?;
        let near = self.ratios.iter().filter(|ratio| (*ratio / factor - 1.0).abs() < NEAR).count();
        let is_wrong = (FACTORS[0]..=FACTORS[1]).contains(&factor.max(1.0 / factor));
        (is_wrong && near as f64 >= MIN_SHARE * pieces as f64).then(|| {
            format!(
                "the speeds of the odometry are {factor:.2} times those of its poses and times (in {near} of {pieces} pieces of \
                 {PIECE_M} m): the times, the lengths or the speeds are wrong; if only the speeds are, write 0: they are \
                 not used"
            )
        })
    }
}
