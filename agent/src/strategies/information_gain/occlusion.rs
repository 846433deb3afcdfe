use super::clusters::Clusters;
use mapper::Mapper;

/// Occlusion by moving things, in a grid whose cells are as large as the things.
///
/// A cell that changed is hidden while a cell between it and the robot is blocked. In addition, a thing that enters
/// the cell from the side of the robot comes out of its own shadow: the robot does not see the cell free and then
/// blocked, finds both changes too late, and estimates too low a rate. If a cell with k changing neighbors is
/// entered from such a neighbor, the visible share of the events falls by 2 / k: once for the event, and once for
/// the time that is counted without the event.
#[derive(Clone, Debug)]
pub(super) struct Occlusion<'a> {
    clusters: &'a Clusters,
    mapper: &'a Mapper,
    /// The probability that a cell is blocked, for each cell that changed.
    blocked: Vec<f64>,
}

impl<'a> Occlusion<'a> {
    pub(super) fn new(mapper: &'a Mapper, clusters: &'a Clusters) -> Self {
        let mut blocked = vec![0.0; mapper.frame().len()];
        for cell in mapper.changed() {
            blocked[cell] = mapper.blocked_probability(cell);
        }
        Self { clusters, mapper, blocked }
    }

    /// The share of the events of a changed cell that is seen from another cell, from 1 down to −1. A negative
    /// share means that an observation from there makes the estimate worse.
    pub(super) fn visible_share(&self, from: usize, to: usize) -> f64 {
        let frame = self.mapper.frame();
        let (start, end) = (frame.cell(from), frame.cell(to));
        let (dx, dy) = (end.x - start.x, end.y - start.y);
        let length = dx.abs().max(dy.abs());
        if length <= 1 {
            return 1.0;
        }
        // Rounded to the nearest cell; halves are rounded away from the robot.
        let part = |d: i32, step: i32| d.signum() * ((2 * d.abs() * step + length) / (2 * length));
        let index = |x: i32, y: i32| (start.y + y) as usize * frame.width() + (start.x + x) as usize;
        let mut share = 1.0;
        for step in 1..length {
            share *= 1.0 - self.blocked[index(part(dx, step), part(dy, step))];
        }
        let towards = match dx.abs().cmp(&dy.abs()) {
            std::cmp::Ordering::Greater => index(dx - dx.signum(), dy),
            std::cmp::Ordering::Less => index(dx, dy - dy.signum()),
            std::cmp::Ordering::Equal => return share,
        };
        if self.clusters.has(towards) {
            share *= 1.0 - 2.0 / f64::from(self.clusters.degree(to).max(1));
        }
        share
    }
}
