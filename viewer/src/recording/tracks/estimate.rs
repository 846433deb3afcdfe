//! Where the curious robot believes to be: its body, its trail, its uncertainty, and the scan at the believed pose.

use super::bodies::add_trail;
use super::{Kind, ON_CHANGE, Strip, Tracks, WORLD, closed, color, line, order, points, position, strips};
use draw::palette;
use draw::view::View;
use localizer::PoseEstimate;
use nalgebra::{Isometry2, Point2, SymmetricEigen, Vector2};
use rerun::{Points2D, Radius, RecordingStreamResult};
use std::f64::consts::TAU;

/// The ellipse of the uncertainty is drawn at this many standard deviations, ...
const STDS: f64 = 2.0;
/// ... and larger than it is: an uncertainty of millimeters could not be seen beside a robot.
const ENLARGED: f64 = 20.0;
/// The corners of a round outline.
const CORNERS: u32 = 32;
/// One of this many hits is drawn as a point.
const EVERY: usize = 4;

/// Adds all entities of the estimate; nothing for a robot whose poses are exact.
pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    let Some(belief) = tracks.view.belief else { return Ok(()) };
    let path = |part: &str| format!("{WORLD}/estimate/{part}");
    let own = color(palette::ESTIMATE, 255);
    let (body, trail, scan) = (path("body"), path("trail"), path("scan"));
    tracks.always(&body, &line(own, 1.5, order::HEADING))?;
    tracks.always(&trail, &line(color(palette::ESTIMATE, 160), 1.0, order::TRAIL))?;
    let dots = Points2D::update_fields()
        .with_colors([own])
        .with_radii([Radius::new_ui_points(1.0)])
        .with_draw_order(order::SIGHT_OUTLINE);
    tracks.always(&scan, &dots)?;
    let driven = tracks.scene.robots.iter().find(|robot| robot.is_driven);
    let radius_m = driven.map_or(0.2, |robot| robot.radius_m);
    let outline = move |view: &View| view.belief.iter().map(|it| self::body(&it.pose, radius_m)).collect();
    tracks.add(body, ON_CHANGE, outline, strips);
    add_trail(tracks, trail, |view| Some(view.belief?.pose));
    let when = (Kind::State, 1.0);
    tracks.add(scan, when, hits, points);
    if belief.estimate.is_some() {
        let uncertainty = path(&format!("uncertainty_{ENLARGED}_times_enlarged"));
        tracks.always(&uncertainty, &line(own, 1.0, order::HEADING))?;
        tracks.add(uncertainty, ON_CHANGE, |view| estimate(view).map(ellipse).into_iter().collect(), strips);
    }
    Ok(())
}

fn estimate<'a>(view: &View<'a>) -> Option<&'a PoseEstimate> {
    view.belief?.estimate.as_ref()
}

/// A circle with a line to the front.
fn body(believed: &Isometry2<f64>, radius_m: f64) -> Strip {
    let circle =
        (0..=CORNERS).map(|corner| interfaces::rotation(TAU * f64::from(corner) / f64::from(CORNERS)));
    let circle = circle.map(|rotation| Point2::from(rotation * Vector2::x() * radius_m));
    let middle = [Point2::origin()].into_iter();
    middle.chain(circle).map(|point| position(&(believed * point))).collect()
}

/// The ellipse of the position.
fn ellipse(estimate: &PoseEstimate) -> Strip {
    let eigen = SymmetricEigen::new(estimate.covariance.fixed_view::<2, 2>(0, 0).into_owned());
    let axes = eigen.eigenvalues.map(|variance| ENLARGED * STDS * variance.max(0.0).sqrt());
    let at = Point2::from(estimate.pose.translation.vector);
    let corner = |corner: u32| {
        let unit = interfaces::rotation(TAU * f64::from(corner) / f64::from(CORNERS)) * Vector2::x();
        at + eigen.eigenvectors * unit.component_mul(&axes)
    };
    closed(&Vec::from_iter((0..CORNERS).map(corner)))
}

/// Some of the hits of the scan, at the believed pose.
fn hits(view: &View) -> Vec<[f32; 2]> {
    let Some(reading) = view.sight() else { return Vec::new() };
    reading.hits().step_by(EVERY).map(|hit| position(&(reading.pose * hit))).collect()
}
