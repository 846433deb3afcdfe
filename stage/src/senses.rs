//! What a robot sees, hears and finds tags with.

use super::place::Place;
use super::robot::INVERSE_ROOT_3;
use super::tree::Thing;
use super::values::{Pose, Reader};
use super::{StageFiducial, StageLaser, StageSonar};
use std::f64::consts::{PI, TAU};

/// A sensor of Stage, where the file says nothing.
const DEFAULT_SENSOR_RANGE_M: [f64; 2] = [0.0, 5.0];
const DEFAULT_SENSOR_FOV_RAD: f64 = 0.1;
/// The same for an old laser.
const DEFAULT_LASER_RANGE_M: [f64; 2] = [0.0, 8.0];
const DEFAULT_LASER_SAMPLES: f64 = 180.0;
/// Stage updates a model so often, ms.
const DEFAULT_INTERVAL_MS: f64 = 100.0;
/// The longest that a sensor may wait, ms.
const MOST_INTERVAL_MS: f64 = 100_000.0;
/// A fiducial finder of Stage: how far it sees tags at all, and how far it tells them apart, m.
const DEFAULT_FIDUCIAL_RANGE_M: f64 = 8.0;
const DEFAULT_FIDUCIAL_RANGE_ID_M: f64 = 5.0;
/// The narrowest and the widest cone of a sonar here, rad.
const CONE_RAD: [f64; 2] = [PI / 180.0, PI];

/// A sensor of a `ranger`, by its number of samples.
pub(super) enum Sensor {
    Laser(StageLaser),
    Sonar(StageSonar),
}

/// What a sensor measures.
struct Ranges {
    fov_rad: f64,
    least_m: f64,
    most_m: f64,
    interval_ms: u32,
}

impl Reader<'_, '_> {
    /// The sensors of a `ranger`, which stands `at` as seen from its robot, with their heights, m.
    pub(super) fn ranger(&mut self, ranger: &Thing, at: &Pose) -> Vec<(Sensor, f64)> {
        let interval_ms = self.interval_ms(ranger);
        let sensors: Vec<&Thing> = ranger.parts.iter().filter(|part| part.kind == "sensor").collect();
        if sensors.is_empty() {
            let help = "in Stage, too, it sees nothing";
            self.sources.warning(ranger.place, "this ranger has no `sensor`", "", help);
        }
        let sensors = sensors.into_iter().filter_map(|sensor| {
            let pose = self.pose(sensor, "pose").unwrap_or(Pose::origin());
            let size_m = self.size(sensor, [0.02; 3]);
            let range_m = match self.numbers(sensor, "range", 2..=2) {
                Some((numbers, _)) => [numbers[0] * self.length_m, numbers[1] * self.length_m],
                None => DEFAULT_SENSOR_RANGE_M,
            };
            let samples = self.number(sensor, "samples", 1.0..=10_000.0).unwrap_or(1.0);
            let fov_rad = self.fov_rad(sensor).unwrap_or(DEFAULT_SENSOR_FOV_RAD);
            let mount = at.then(&pose);
            let ranges = Ranges { fov_rad, least_m: range_m[0], most_m: range_m[1], interval_ms };
            let sensor = self.sensor(sensor, &mount, samples, &ranges)?;
            Some((sensor, mount.z_m + size_m[2] / 2.0))
        });
        let sensors: Vec<(Sensor, f64)> = sensors.collect();
        if sensors.iter().any(|(sensor, _)| matches!(sensor, Sensor::Sonar(_))) {
            let help =
                "here it is a cone as wide as its `fov` (1° to 180°), and the nearest thing in it counts";
            self.sources.warning(ranger.place, "in Stage a sensor of one sample is a single ray", "", help);
        }
        sensors
    }

    /// The laser of a `laser`, as older files have it.
    pub(super) fn old_laser(&mut self, laser: &Thing, at: &Pose) -> Option<(Sensor, f64)> {
        let interval_ms = self.interval_ms(laser);
        let [least, most] = DEFAULT_LASER_RANGE_M;
        let least = self.number(laser, "range_min", 0.0..=1e5).map_or(least, |range| range * self.length_m);
        let most = self.number(laser, "range_max", 0.0..=1e5).map_or(most, |range| range * self.length_m);
        let samples = self.number(laser, "samples", 1.0..=10_000.0).unwrap_or(DEFAULT_LASER_SAMPLES);
        let fov_rad = self.fov_rad(laser).unwrap_or(TAU / 2.0);
        let ranges = Ranges { fov_rad, least_m: least, most_m: most, interval_ms };
        Some((self.sensor(laser, at, samples, &ranges)?, at.z_m))
    }

    fn sensor(&mut self, thing: &Thing, mount: &Pose, samples: f64, ranges: &Ranges) -> Option<Sensor> {
        let Ranges { fov_rad, least_m: range_min_m, most_m: range_max_m, interval_ms } = *ranges;
        let noise_std_m = self.noise(thing);
        let (place, mount, at) = (self.sources.name(thing.place), mount.flat, thing.place);
        if !(0.0 <= range_min_m && range_min_m < range_max_m) {
            let help = "the least range must be 0 or more, and smaller than the greatest";
            self.sources.error(thing.place, "a laser sees nothing", "", help);
            return None;
        }
        if samples < 2.0 {
            let cone_rad = fov_rad.clamp(CONE_RAD[0], CONE_RAD[1]);
            return Some(Sensor::Sonar(StageSonar {
                place,
                mount,
                cone_rad,
                range_min_m,
                range_max_m,
                interval_ms,
                noise_std_m,
                at,
            }));
        }
        if fov_rad > TAU - 1e-6 {
            let help = "Stage's first and last beam are one: here it is left out the second time, and the others have \
                        Stage's angles";
            self.sources.warning(thing.place, "a laser sees all around", "", help);
        }
        let doubled = if fov_rad > TAU - 1e-6 { 1 } else { 0 };
        Some(Sensor::Laser(StageLaser {
            place,
            mount,
            beams: (samples as usize - doubled).max(2),
            fov_rad: fov_rad.min(TAU),
            range_min_m,
            range_max_m,
            interval_ms,
            noise_std_m,
            at,
        }))
    }

    /// A fiducial finder, which stands `at` as seen from its robot.
    pub(super) fn fiducial(&mut self, finder: &Thing, at: &Pose) -> Option<StageFiducial> {
        let mut range_m = |name: &str, default_m: f64| {
            self.number(finder, name, 0.0..=1e5).map_or(default_m, |range| range * self.length_m)
        };
        let least_m = range_m("range_min", 0.0);
        let (most_m, most_id_m) = (
            range_m("range_max", DEFAULT_FIDUCIAL_RANGE_M),
            range_m("range_max_id", DEFAULT_FIDUCIAL_RANGE_ID_M),
        );
        let fov_rad = self.fov_rad(finder).unwrap_or(PI);
        let interval_ms = self.interval_ms(finder);
        if least_m > 0.0 {
            let help = "nearer tags are found here, at their true range";
            self.sources.warning(finder.place, "a fiducial finder with a `range_min`", "", help);
        }
        if most_id_m < most_m {
            let what =
                format!("in Stage this finder sees tags from {most_id_m} to {most_m} m, but not which");
            self.sources.warning(finder.place, &what, "", "here it does not see them at all so far away");
        }
        let range_max_m = most_m.min(most_id_m);
        if range_max_m <= 0.0 || fov_rad <= 0.0 {
            let help = "`range_max`, `range_max_id` and `fov` must be greater than 0";
            self.sources.error(finder.place, "a fiducial finder finds nothing", "", help);
            return None;
        }
        Some(StageFiducial {
            place: self.sources.name(finder.place),
            mount: at.flat,
            fov_rad: fov_rad.min(TAU),
            range_max_m,
            interval_ms,
            at: finder.place,
        })
    }

    /// The tag of a thing; 0 is none.
    pub(super) fn tag(&mut self, thing: &Thing) -> Option<(u32, Place)> {
        let (numbers, place) = self.numbers(thing, "fiducial_return", 1..=1)?;
        if numbers[0] < 0.0 || numbers[0] != numbers[0].trunc() {
            let what = format!("the tag {} is left out", numbers[0]);
            self.sources.warning(place, &what, "", "tags here are whole numbers above 0");
            return None;
        }
        (numbers[0] > 0.0).then_some((numbers[0] as u32, place))
    }

    fn fov_rad(&mut self, thing: &Thing) -> Option<f64> {
        let most = TAU / self.angle_rad + 1e-6;
        self.number(thing, "fov", 0.0..=most).map(|fov| fov * self.angle_rad)
    }

    /// Stage wakes a sensor in the first of its steps that is not too early.
    fn interval_ms(&mut self, thing: &Thing) -> u32 {
        let given_ms = self
            .number(thing, "update_interval", 1.0..=MOST_INTERVAL_MS)
            .unwrap_or(DEFAULT_INTERVAL_MS) as u32;
        let step_ms = self.interval_sim_ms;
        let interval_ms = given_ms.next_multiple_of(step_ms).min(MOST_INTERVAL_MS as u32);
        if interval_ms != given_ms {
            let place = thing.properties.get("update_interval").map_or(thing.place, |key| key.place());
            let what = format!("every {given_ms} ms is no multiple of Stage's step, which is {step_ms} ms");
            let help = format!(
                "in Stage, too, this sensor senses every {interval_ms} ms; see `interval_sim` and `update_interval`"
            );
            self.sources.warning(place, &what, "", &help);
        }
        interval_ms
    }

    /// `[constant proportional angle]`: Stage adds an even spread over ±1 times each.
    fn noise(&mut self, thing: &Thing) -> f64 {
        let Some((numbers, place)) = self.numbers(thing, "noise", 3..=3) else {
            return 0.0;
        };
        self.noise_warning(place, &numbers);
        numbers[0].abs() * self.length_m * INVERSE_ROOT_3
    }

    fn noise_warning(&mut self, place: Place, numbers: &[f64]) {
        if numbers[1] != 0.0 || numbers[2] != 0.0 {
            let help = "only the first number, the same at every range, is heeded";
            self.sources.warning(place, "noise that grows with the range, or of the angle", "", help);
        }
        if numbers[0] != 0.0 {
            let help = "here it is normal, of the same standard deviation: the number times 0.577";
            self.sources.warning(place, "Stage's noise is spread evenly", "", help);
        }
    }
}
