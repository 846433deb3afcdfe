use crate::deskew::deskewed_scan;
use crate::scan_path::ScanPath;
use crate::scan_points::Directions;
use interfaces::LaserReading;
use nalgebra::Isometry2;

/// The poses of the source, taken as they are. Scans are deskewed with them, the first scan with its velocities.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct GivenPoses {
    /// The time and the pose of the last reading.
    last: Option<(f64, Isometry2<f64>)>,
    #[serde(skip)]
    directions: Directions,
}

impl GivenPoses {
    /// The reading with a scan whose beams all belong to its pose.
    pub fn deskewed(&mut self, mut reading: LaserReading) -> LaserReading {
        let (motion, elapsed_s) = match self.last.replace((reading.time_s, reading.pose)) {
            Some((last_s, last)) => (last.inv_mul(&reading.pose), reading.time_s - last_s),
            None => ScanPath::by_velocities(&reading),
        };
        if let Some(path) = ScanPath::of_sweep(&reading, &motion, elapsed_s) {
            reading.scan = deskewed_scan(&mut self.directions, &reading, &path);
        }
        reading
    }
}
