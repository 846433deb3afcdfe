//! The walls that nearer walls hide from a laser are left out.
//!
//! A turn is divided into sectors. For every edge that may be seen from a cell, the potentially visible set lists the
//! sectors in which the edge may lie. The edges are added from near to far. A sector is closed as soon as all its beams
//! have hits that are nearer than the edges that follow; edges that lie in closed sectors only change no range.

use super::beams::Hits;
use super::edges::Edge;
use interfaces::{approximate_atan2, wrap_rad};
use nalgebra::Point2;
use std::f64::consts::{PI, TAU};

/// Directions in the frame of the world: bit i stands for those from i to i + 1 sectors after −π.
type Sectors = u32;

/// An edge that may be seen from a cell of the potentially visible set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SeenEdge {
    /// Its index.
    pub(super) edge: u32,
    /// At most the shortest distance between a point of the cell and the edge, m.
    pub(super) nearest_m: f32,
    /// The directions from points of the cell to points of the edge.
    pub(super) sectors: Sectors,
}

/// All directions.
const ALL: Sectors = Sectors::MAX;
/// The width of a sector, rad.
const SECTOR_RAD: f64 = TAU / Sectors::BITS as f64;
/// Directions this near to a sector may count as being in the sector, rad: far above the error of
/// [`approximate_atan2`].
const MARGIN_RAD: f64 = 1e-3;
/// The number of edges that are added before the next search for closed sectors.
const EDGES_AT_ONCE: usize = 32;

/// The sectors that contain the directions from any point of a convex quadrilateral to any point of an edge.
pub(super) fn sectors_of(corners: &[Point2<f64>; 4], edge: &Edge) -> Sectors {
    // The differences of the points form a convex polygon. This is one of its points.
    let middle = nalgebra::center(&edge.from, &edge.to) - nalgebra::center(&corners[0], &corners[2]);
    let (mut low_rad, mut high_rad) = (0.0_f64, 0.0_f64);
    for corner in corners {
        for to in [edge.from - corner, edge.to - corner] {
            let angle_rad = approximate_atan2(middle.perp(&to), middle.dot(&to));
            (low_rad, high_rad) = (low_rad.min(angle_rad), high_rad.max(angle_rad));
        }
    }
    // If the edge may touch the quadrilateral, the polygon contains the origin.
    if middle.norm_squared() == 0.0 || high_rad - low_rad > PI - MARGIN_RAD {
        return ALL;
    }
    let angle_rad = approximate_atan2(middle.y, middle.x) + PI;
    let sector = |angle_rad: f64| (angle_rad / SECTOR_RAD).floor() as i32;
    let (first, last) = (sector(angle_rad + low_rad - MARGIN_RAD), sector(angle_rad + high_rad + MARGIN_RAD));
    (first..=last).fold(0, |sectors, i| sectors | 1 << i.rem_euclid(Sectors::BITS as i32))
}

/// Adds the edges of walls that may be seen from the cell of the laser, the nearest first.
pub(super) fn add_edges(seen: &[SeenEdge], edges: &[Edge], hits: &mut Hits<'_>) {
    let rotation = hits.laser.rotation;
    let heading_rad = approximate_atan2(rotation.im, rotation.re);
    let mut open = ALL;
    for (round, some) in seen.chunks(EDGES_AT_ONCE).enumerate() {
        let nearest_m = some.first().map_or(0.0, |first| f64::from(first.nearest_m));
        if nearest_m > hits.beams.range_max_m {
            return;
        }
        if round > 0 && nearest_m > 0.0 {
            open = still_open(open, heading_rad, 1.0 / nearest_m, hits);
        }
        for seen in some.iter().filter(|seen| seen.sectors & open != 0) {
            hits.add_edge(&edges[seen.edge as usize]);
        }
    }
}

/// The `open` sectors in which a hit with an inverse range of `nearest` (1/m) or less can change a range.
fn still_open(open: Sectors, heading_rad: f64, nearest: f64, hits: &Hits<'_>) -> Sectors {
    let half_rad = 0.5 * SECTOR_RAD + MARGIN_RAD;
    let is_open = |sector: &u32| {
        let middle_rad = (f64::from(*sector) + 0.5) * SECTOR_RAD - PI;
        open >> sector & 1 == 1 && !hits.is_hidden(wrap_rad(middle_rad - heading_rad), half_rad, nearest)
    };
    (0..Sectors::BITS).filter(is_open).fold(0, |sectors, sector| sectors | 1 << sector)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};

    #[test]
    fn the_sectors_of_an_edge_contain_all_directions_to_it() {
        let mut random = RandomStream::new(5, Purpose::Agent);
        let (mut partial, mut all) = (0, 0);
        for _ in 0..2000 {
            let mut point = || Point2::new(random.uniform(-3.0..3.0), random.uniform(-3.0..3.0));
            let edge = Edge::new(point(), point());
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Point2::new(x, y));
            let sectors = sectors_of(&corners, &edge);
            partial += usize::from(sectors != ALL);
            all += usize::from(sectors == ALL);
            for _ in 0..20 {
                let from = Point2::new(random.uniform(0.0..1.0), random.uniform(0.0..1.0));
                let to = edge.from.lerp(&edge.to, random.uniform(0.0..1.0)) - from;
                let sector = ((libm::atan2(to.y, to.x) + PI) / SECTOR_RAD) as u32;
                assert!(
                    sectors >> sector.min(Sectors::BITS - 1) & 1 == 1,
                    "{edge:?} from {from}: {sectors:b}"
                );
            }
        }
        assert!(partial > 1000 && all > 100, "{partial} {all}");
    }
}
