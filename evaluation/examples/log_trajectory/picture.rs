//! All points along a trajectory as a picture: the darker, the more often a place was hit. A wall that is there twice
//! shows at once.

use image::codecs::png::PngEncoder;
use image::{Rgb, RgbImage};
use interfaces::LaserReading;
use localizer::Trajectory;
use nalgebra::{Point2, Vector2};
use std::io;
use std::path::Path;

/// The side of a pixel, m; larger where the picture would have more than [`MAX_PIXELS`] along a side.
const PIXEL_M: f64 = 0.05;
const MAX_PIXELS: f64 = 4000.0;
/// Hits farther away than this are not drawn, m.
const FARTHEST_M: f64 = 20.0;
/// The number of hits at which a pixel is black.
const BLACK: f64 = 8.0;

/// Writes the picture.
pub(crate) fn write(
    file: &Path,
    trajectory: &Trajectory,
    readings: &[LaserReading],
) -> Result<(), Box<dyn std::error::Error>> {
    let mut points = Vec::new();
    for (pose, reading) in trajectory.poses.iter().zip(readings) {
        let near = reading.hits().filter(|hit| hit.coords.norm() < FARTHEST_M);
        points.extend(near.map(|hit| pose.pose * hit));
    }
    let route: Vec<Point2<f64>> =
        trajectory.poses.iter().map(|pose| pose.pose.translation.vector.into()).collect();
    let Some(first) = route.first() else { return Ok(()) };
    let (low, high) = points.iter().chain(&route).fold((*first, *first), |(low, high), point| {
        (low.coords.inf(&point.coords).into(), high.coords.sup(&point.coords).into())
    });
    let size: Vector2<f64> = high - low;
    let pixel_m = PIXEL_M.max(size.max() / MAX_PIXELS);
    let (width, height) = ((size.x / pixel_m) as u32 + 1, (size.y / pixel_m) as u32 + 1);
    let pixel = |point: &Point2<f64>| {
        let at = (point - low) / pixel_m;
        (at.x as u32, height - 1 - at.y as u32)
    };
    let mut counts = vec![0_u32; (width * height) as usize];
    for point in &points {
        let (x, y) = pixel(point);
        counts[(y * width + x) as usize] += 1;
    }
    let mut image = RgbImage::from_fn(width, height, |x, y| {
        let share = (f64::from(counts[(y * width + x) as usize]) / BLACK).min(1.0).sqrt();
        Rgb([(255.0 * (1.0 - share)) as u8; 3])
    });
    for point in &route {
        let (x, y) = pixel(point);
        image.put_pixel(x, y, Rgb([220, 60, 30]));
    }
    files::write_file(file, |to| image.write_with_encoder(PngEncoder::new(to)).map_err(io::Error::other))?;
    Ok(())
}
