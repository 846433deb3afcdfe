//! A file that fails at any byte, as a full disk or a pipe whose reader has ended, is an error and no panic.

use interfaces::{LaserReading, Scan, Twist};
use nalgebra::Isometry2;
use ros::McapWriter;
use std::io::{BufWriter, Error, ErrorKind, Result, Write};

/// A file with space for this number of bytes.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        let fits = bytes.len().min(self.0);
        self.0 -= fits;
        if fits == 0 && !bytes.is_empty() { Err(Error::from(ErrorKind::StorageFull)) } else { Ok(fits) }
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}

fn reading(number: u32) -> LaserReading {
    // Ranges that hardly compress: several chunks are written.
    let range_m = |beam: u32| {
        1.0 + (beam.wrapping_mul(2_654_435_761).wrapping_add(number * 97_531) % 9973) as f32 * 1e-3
    };
    let scan = Scan {
        angle_min_rad: 0.0,
        angle_increment_rad: 0.0001,
        range_min_m: 0.1,
        range_max_m: 12.0,
        sweep_s: 0.0,
        ranges_m: (0..20_000).map(range_m).collect(),
    };
    let time_s = f64::from(number);
    let (pose, mount) = (Isometry2::identity(), Isometry2::identity());
    LaserReading { time_s, pose, twist: Twist::STOP, velocities: Vec::new(), mount, scan }
}

/// Writes a bag to a file with space for this number of bytes.
fn write(to: impl Write) -> Result<()> {
    let mut writer = McapWriter::new(to, "bag", 0.0)?;
    (0..25).try_for_each(|number| writer.reading(&reading(number)))?;
    writer.finish()?.flush()
}

#[test]
fn a_file_that_fails_at_any_byte_is_an_error() {
    let mut length = 0;
    write(Counted(&mut length)).unwrap();
    for space in (0..length).step_by(length / 60).chain(0..400).chain(length - 400..length) {
        write(Full(space)).unwrap_err();
        write(BufWriter::with_capacity(1000, Full(space))).unwrap_err();
    }
    write(Full(length)).unwrap();
}

struct Counted<'a>(&'a mut usize);

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize> {
        *self.0 += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<()> {
        Ok(())
    }
}
