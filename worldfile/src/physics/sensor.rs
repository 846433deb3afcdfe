//! The sensors of a robot: lasers, bumpers, sonars.

use crate::reader::{Figure, Table, valid};
use interfaces::pose;
use nalgebra::{Isometry2, Point2};
use sim::physics::{BumperSpec, LaserSpec, SonarSpec};

/// The maximum distance by which a sensor may be outside of the circle around its robot, m.
pub const MAX_OUT_M: f64 = 1.0;
/// The maximum number of lasers of a robot.
const MAX_LASERS: usize = 100;

const LASER_KEYS: &str = "beams, fov_deg, range_min_m, range_max_m, rate_hz, sweep_s, mount_m, mount_deg, noise_std_m, dropout, \
     beam_width_deg";
const SONAR_KEYS: &str = "cone_deg, range_min_m, range_max_m, rate_hz, mount_m, mount_deg, noise_std_m";

/// The properties of a robot to which its sensors must fit: the physics step (s) and the radius of the body (m).
#[derive(Clone, Copy)]
pub(super) struct Carrier {
    pub(super) step_s: f64,
    pub(super) radius_m: f64,
}

impl Carrier {
    /// The first laser of the robot `name`, and the others.
    pub(super) fn lasers(self, robot: &Table<'_>, name: &str) -> Option<(LaserSpec, Vec<LaserSpec>)> {
        let tables = robot.needed("laser")?.table_or_tables(LASER_KEYS)?;
        if tables.is_empty() || tables.len() > MAX_LASERS {
            let what = format!("the robot `{name}` has {} lasers", tables.len());
            let help = format!("it must have 1 to {MAX_LASERS}");
            return robot.error(&what, (robot.at("laser"), "these lasers"), &[], &help);
        }
        let lasers: Vec<_> = tables.iter().map(|table| self.laser(table)).collect();
        let mut lasers = lasers.into_iter();
        Some((lasers.next()??, lasers.collect::<Option<_>>()?))
    }

    fn laser(self, table: &Table<'_>) -> Option<LaserSpec> {
        let (range, rate, mount) =
            (range(table, "a laser sees nothing"), self.rate(table), self.mount(table, "a laser"));
        let sweep_s = sweep(table, rate);
        table.sound(LaserSpec {
            beams: table.count("beams", 2..=10_000),
            fov_rad: table.number_or("fov_deg", 360.0, 1.0..=360.0).to_radians(),
            noise_std_m: table.number_or("noise_std_m", 0.0, 0.0..=1.0),
            dropout: table.number_or("dropout", 0.0, 0.0..=1.0),
            range_min_m: range?[0],
            range_max_m: range?[1],
            rate_hz: rate?.0,
            period_steps: rate?.1,
            sweep_s: sweep_s?,
            mount: mount?,
            beam_width_rad: table.number_or("beam_width_deg", 0.0, 0.0..=5.0).to_radians(),
        })
    }

    pub(super) fn sonars(self, robot: &Table<'_>) -> Option<Vec<SonarSpec>> {
        let tables = robot.tables("sonar", SONAR_KEYS);
        let sonars: Vec<_> = tables.iter().map(|table| self.sonar(table)).collect();
        sonars.into_iter().collect()
    }

    fn sonar(self, table: &Table<'_>) -> Option<SonarSpec> {
        let (range, rate, mount) =
            (range(table, "a sonar hears nothing"), self.rate(table), self.mount(table, "a sensor"));
        table.sound(SonarSpec {
            cone_rad: table.number("cone_deg", 1.0..=180.0).to_radians(),
            noise_std_m: table.number_or("noise_std_m", 0.0, 0.0..=1.0),
            range_min_m: range?[0],
            range_max_m: range?[1],
            period_steps: rate?.1,
            mount: mount?,
        })
    }

    /// A rate (Hz), and the physics steps from one measurement to the next.
    fn rate(self, table: &Table<'_>) -> Option<(f64, u64)> {
        let (rate_hz, step_s) = (valid(table.number("rate_hz", 0.01..=1000.0))?, self.step_s);
        let steps = 1.0 / (rate_hz * step_s);
        if steps.round() >= 1.0 && (steps - steps.round()).abs() <= 1e-6 * steps {
            return Some((rate_hz, steps.round() as u64));
        }
        let path = table.path("rate_hz");
        let what = format!("`{path}` is {rate_hz}, a scan every {steps:.3} physics steps of {step_s} s");
        let whole = steps.floor().max(1.0);
        let near = [whole, whole + 1.0].map(|steps| format!("{:.6}", 1.0 / (steps * step_s)));
        let near = near.map(|hz| hz.trim_end_matches('0').trim_end_matches('.').to_owned());
        let help = format!("scans must be whole steps apart: {} or {} Hz would be", near[0], near[1]);
        table.error(&what, (table.at("rate_hz"), "not whole steps apart"), &[], &help)
    }

    /// The pose of the sensor `what` on its robot.
    fn mount(self, table: &Table<'_>, what: &str) -> Option<Isometry2<f64>> {
        let at = table.get("mount_m");
        let at = at.map_or(Some(Point2::origin()), |value| value.pair_within(&(-10.0..=10.0)));
        let mount_deg = table.number_or("mount_deg", 0.0, -360.0..=360.0);
        let (at, radius_m) = (at?, self.radius_m);
        if at.coords.norm() > radius_m + MAX_OUT_M {
            let what = format!("{what} is mounted off its robot");
            let help = format!(
                "it must lie within the robot's radius of {radius_m} m, or stick out by {MAX_OUT_M} m at most"
            );
            return table.error(&what, (table.at("mount_m"), "off the robot"), &[], &help);
        }
        Some(pose(at.x, at.y, mount_deg.to_radians()))
    }
}

/// `Some(None)`: the robot has none.
pub(super) fn bumper(robot: &Table<'_>) -> Option<Option<BumperSpec>> {
    let Some(value) = robot.get("bumper") else { return Some(None) };
    let table = value.table("sectors, fov_deg")?;
    let fov_deg = table.number_or("fov_deg", 360.0, 1.0..=360.0);
    table.sound(Some(BumperSpec { sectors: table.count("sectors", 1..=64), fov_rad: fov_deg.to_radians() }))
}

/// The time from the first to the last beam of a laser, s, for a rate (Hz) with the physics steps between scans.
fn sweep(laser: &Table<'_>, rate: Option<(f64, u64)>) -> Option<f64> {
    let sweep_s = laser.number_or("sweep_s", 0.0, 0.0..=100.0);
    let period_s = 1.0 / rate?.0;
    // The period may be rounded: 0.333333 s at 3 Hz, and 0.333333 Hz for 3 s.
    if sweep_s > period_s * (1.0 + 1e-5) {
        let path = laser.path("sweep_s");
        let what = format!("`{path}` is {sweep_s}: a sweep takes longer than from one scan to the next");
        let others = [(laser.at("rate_hz"), "the time between scans")];
        let help = format!("it must be at most 1 / `rate_hz`, which is {}", Figure(period_s));
        return laser.error(&what, (laser.at("sweep_s"), "too long"), &others, &help);
    }
    Some(sweep_s)
}

/// The least and the greatest range, m; `what`: the message if there is no range between them.
fn range(table: &Table<'_>, what: &str) -> Option<[f64; 2]> {
    let range_min_m = table.number_or("range_min_m", 0.0, 0.0..=1000.0);
    let range_max_m = table.number("range_max_m", 0.01..=1000.0);
    if range_min_m >= range_max_m {
        let others = [(table.at("range_max_m"), "not below this")];
        let help = "`range_min_m` must be smaller than `range_max_m`";
        return table.error(what, (table.at("range_min_m"), "too far"), &others, help);
    }
    Some([range_min_m, range_max_m])
}
