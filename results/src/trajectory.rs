//! Trajectories in the TUM format: one line per pose, `time x y z qx qy qz qw` (s, m, a unit quaternion). Programs that
//! evaluate trajectories read it, such as `evo`.

use files::{OutputError, UnfinishedFile};
use nalgebra::Isometry2;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A trajectory file that is being written. The first error ends the file; [`finish`](Self::finish) reports it.
#[derive(Debug)]
pub struct TrajectoryFile {
    file: io::Result<BufWriter<UnfinishedFile>>,
}

impl TrajectoryFile {
    /// Creates the file. It has its name when it is complete.
    pub fn create(path: &Path) -> Self {
        Self { file: UnfinishedFile::create(path).map(BufWriter::new).map_err(why) }
    }

    /// Adds the pose at a time, s, m and rad.
    pub fn add(&mut self, time_s: f64, pose: &Isometry2<f64>) {
        let Ok(file) = &mut self.file else { return };
        let (at, (sin, cos)) = (pose.translation, libm::sincos(interfaces::heading_rad(pose) / 2.0));
        if let Err(error) = writeln!(file, "{time_s:.6} {:.6} {:.6} 0 0 0 {sin:.9} {cos:.9}", at.x, at.y) {
            self.file = Err(error);
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    ///
    /// When the file could not be created, or a line could not be written.
    pub fn finish(self) -> io::Result<()> {
        self.file?.into_inner().map_err(|error| error.into_error())?.finish().map_err(why)
    }
}

fn why(error: OutputError) -> io::Error {
    error.why
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_line_has_the_time_the_position_and_a_quaternion() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trajectory.tum");
        let mut file = TrajectoryFile::create(&path);
        file.add(0.1, &interfaces::pose(1.5, -2.0, PI / 2.0));
        file.add(0.2, &interfaces::pose(0.0, 0.0, PI));
        file.finish().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            text,
            "0.100000 1.500000 -2.000000 0 0 0 0.707106781 0.707106781\n\
             0.200000 0.000000 0.000000 0 0 0 1.000000000 0.000000000\n"
        );
    }

    #[test]
    fn an_error_is_reported_at_the_end() {
        let mut file = TrajectoryFile::create(Path::new("/no/such/folder/trajectory.tum"));
        file.add(0.1, &Isometry2::identity());
        assert!(file.finish().is_err());
    }
}
