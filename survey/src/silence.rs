//! When the laser of a log was silent: nothing was in view then.

use interfaces::median;
use localizer::TrajectoryPose;

/// The longest time between two scans of a log during which things are in view, s; see [`robot::max_step_s`].
pub(crate) fn max_step_s(poses: &[TrajectoryPose], hiding_s: f64) -> f64 {
    robot::max_step_s(hiding_s, median(steps_s(poses)).unwrap_or_default())
}

/// What users should know about the times without a scan, in a sentence.
pub(crate) fn note(poses: &[TrajectoryPose], hiding_s: f64) -> Option<String> {
    let max_s = max_step_s(poses, hiding_s);
    let silent_s: Vec<f64> = steps_s(poses).filter(|step_s| *step_s > max_s).collect();
    let (total_s, count) = (silent_s.iter().sum::<f64>(), silent_s.len());
    (count > 0).then(|| {
        let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        let total = match total_s {
            time_s if time_s < 90.0 => format!("{time_s:.0} s"),
            time_s if time_s < 5400.0 => format!("{:.0} min", time_s / 60.0),
            time_s => format!("{:.1} h", time_s / 3600.0),
        };
        format!(
            "the laser was silent {times} for more than {max_s:.0} s, {total} in all: this time counts as not observed"
        )
    })
}

fn steps_s(poses: &[TrajectoryPose]) -> impl Iterator<Item = f64> {
    poses.windows(2).map(|pair| pair[1].time_s - pair[0].time_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use localizer::PoseState;
    use nalgebra::Isometry2;

    fn poses(times_s: &[f64]) -> Vec<TrajectoryPose> {
        let (pose, state) = (Isometry2::identity(), PoseState::Tracking);
        times_s.iter().map(|time_s| TrajectoryPose { time_s: *time_s, pose, state }).collect()
    }

    #[test]
    fn silence_is_much_longer_than_the_usual_step() {
        let dense: Vec<f64> = (0..100).map(|scan| 0.1 * f64::from(scan)).chain([17.8, 46_800.0]).collect();
        assert_eq!(max_step_s(&poses(&dense), 8.0), 8.0);
        let expected =
            "the laser was silent once for more than 8 s, 13.0 h in all: this time counts as not observed";
        assert_eq!(note(&poses(&dense), 8.0).as_deref(), Some(expected));
        let rare: Vec<f64> =
            (0..100).map(|scan| 5.0 * f64::from(scan)).chain([540.0, 595.0, 650.0]).collect();
        assert_eq!(max_step_s(&poses(&rare), 8.0), 50.0);
        let expected =
            "the laser was silent 2 times for more than 50 s, 2 min in all: this time counts as not observed";
        assert_eq!(note(&poses(&rare), 8.0).as_deref(), Some(expected));
        for few in [&[][..], &[3.0], &rare[..100]] {
            assert_eq!((max_step_s(&poses(few), 8.0) >= 8.0, note(&poses(few), 8.0)), (true, None));
        }
    }
}
