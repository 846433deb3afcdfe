use interfaces::Cell;
use nalgebra::{Point2, Vector2};

/// A path of straight lines between points, and the position of the robot on it.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct Path {
    points: Vec<Point2<f64>>,
    /// The length of the path from each point to the end, m.
    remaining_m: Vec<f64>,
    /// The robot is between the points `leg` and `leg + 1`.
    leg: usize,
}

impl Path {
    /// The points of the path, from the position where it was planned to its end, m; empty without a path.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The points ahead of the robot, up to the end, m.
    pub fn ahead(&self) -> &[Point2<f64>] {
        self.points.get(self.leg + 1..).unwrap_or(&[])
    }

    /// The end of the path, m; `None` without a path.
    pub fn end(&self) -> Option<&Point2<f64>> {
        self.points.last()
    }

    /// The distance from `position` to the end along the path, m.
    pub fn remaining_m(&self, position: &Point2<f64>) -> f64 {
        match self.ahead().first() {
            Some(next) => (next - position).norm() + self.remaining_m[self.leg + 1],
            None => self.end().map_or(0.0, |end| (end - position).norm()),
        }
    }

    /// Removes the path.
    pub fn clear(&mut self) {
        self.points.clear();
        self.remaining_m.clear();
        self.leg = 0;
    }

    /// Replaces the path.
    pub(crate) fn set(&mut self, points: impl IntoIterator<Item = Point2<f64>>) {
        self.clear();
        self.points.extend(points);
        self.measure();
    }

    /// Cuts the path at `length_m` from its start.
    pub(crate) fn truncate(&mut self, length_m: f64) {
        let mut walked_m = 0.0;
        for index in 1..self.points.len() {
            let step = self.points[index] - self.points[index - 1];
            let step_m = step.norm();
            if walked_m + step_m >= length_m && step_m > 0.0 {
                self.points[index] = self.points[index - 1] + step * ((length_m - walked_m) / step_m);
                self.points.truncate(index + 1);
                break;
            }
            walked_m += step_m;
        }
        self.measure();
    }

    /// The first point, in steps of this length, m, for which `is_end`, with its distance along the path, m.
    pub(crate) fn first(
        &self,
        step_m: f64,
        is_end: impl Fn(&Point2<f64>) -> bool,
    ) -> Option<(f64, Point2<f64>)> {
        let start = self.points.first()?;
        let steps = (self.remaining_m[0] / step_m) as usize;
        let at =
            |step| self.lookahead_point(start, step as f64 * step_m).map(|at| (step as f64 * step_m, at));
        (0..=steps).filter_map(at).find(|(_, at)| is_end(at))
    }

    fn measure(&mut self) {
        self.remaining_m.clear();
        self.remaining_m.resize(self.points.len(), 0.0);
        for index in (1..self.points.len()).rev() {
            let step_m = (self.points[index] - self.points[index - 1]).norm();
            self.remaining_m[index - 1] = self.remaining_m[index] + step_m;
        }
    }

    /// Advances to the leg (line between two points) that is nearest to `position`, never backward. Returns the
    /// distance of the position from that leg, m; infinite without a path.
    pub(crate) fn advance(&mut self, position: &Point2<f64>) -> f64 {
        let Some(mut off_m) = self.distance_m(self.leg, position) else {
            return self.end().map_or(f64::INFINITY, |end| (end - position).norm());
        };
        while let Some(next_m) = self.distance_m(self.leg + 1, position).filter(|next_m| *next_m <= off_m) {
            self.leg += 1;
            off_m = next_m;
        }
        off_m
    }

    /// The point that is `ahead_m` farther along the path than the point nearest to `position`, at most the end.
    pub(crate) fn lookahead_point(&self, position: &Point2<f64>, ahead_m: f64) -> Option<Point2<f64>> {
        let (Some(from), Some(to)) = (self.points.get(self.leg), self.points.get(self.leg + 1)) else {
            return self.end().copied();
        };
        let mut at = nearest_on_line(from, to, position);
        let mut left_m = ahead_m;
        for next in self.ahead() {
            let step: Vector2<f64> = next - at;
            let step_m = step.norm();
            if step_m > left_m {
                return Some(at + step * (left_m / step_m));
            }
            left_m -= step_m;
            at = *next;
        }
        Some(at)
    }

    /// The distance of `position` from a leg, m; `None` beyond the last leg.
    fn distance_m(&self, leg: usize, position: &Point2<f64>) -> Option<f64> {
        let (from, to) = (self.points.get(leg)?, self.points.get(leg + 1)?);
        Some((nearest_on_line(from, to, position) - position).norm())
    }
}

/// The point of the line from `from` to `to` that is nearest to `position`.
fn nearest_on_line(from: &Point2<f64>, to: &Point2<f64>, position: &Point2<f64>) -> Point2<f64> {
    let line = to - from;
    let square = line.norm_squared();
    if square == 0.0 { *from } else { from + line * ((position - from).dot(&line) / square).clamp(0.0, 1.0) }
}

/// Reduces a path of touching cells to its corners: goes straight on while the straight line costs no more
/// than the path. `cost` is the cost of the path between two of its indices, `line` the cost of the straight
/// line between two cells, if the line is traversable.
pub(super) fn corners(
    path: &[Cell],
    cost: impl Fn(usize, usize) -> u32,
    line: impl Fn(Cell, Cell) -> Option<u32>,
) -> Vec<Cell> {
    let (mut corners, mut from) = (Vec::new(), 0);
    while from < path.len() {
        corners.push(path[from]);
        let straight = |to: usize| line(path[from], path[to]).is_some_and(|line| line <= cost(from, to));
        let mut to = from + 1;
        // Looks ahead by doubling, then cell by cell: long lines need fewer checks.
        let mut stride = 8;
        while to + stride < path.len() && straight(to + stride) {
            to += stride;
            stride *= 2;
        }
        while to + 1 < path.len() && straight(to + 1) {
            to += 1;
        }
        from = to;
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length_m(path: &Path) -> f64 {
        path.remaining_m.first().copied().unwrap_or(0.0)
    }

    fn path(points: &[(f64, f64)]) -> Path {
        let mut path = Path::default();
        path.set(points.iter().map(|(x, y)| Point2::new(*x, *y)));
        path
    }

    #[test]
    fn the_robot_goes_along_the_legs() {
        let mut path = path(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        assert_eq!(length_m(&path), 4.0);
        assert_eq!(path.advance(&Point2::new(1.0, 0.1)), 0.1);
        assert_eq!(path.lookahead_point(&Point2::new(1.0, 0.1), 1.5), Some(Point2::new(2.0, 0.5)));
        assert_eq!(path.advance(&Point2::new(2.1, 0.5)), 2.1 - 2.0);
        assert_eq!(path.ahead(), [Point2::new(2.0, 2.0)]);
        assert_eq!(path.remaining_m(&Point2::new(2.0, 0.5)), 1.5);
        assert_eq!(path.lookahead_point(&Point2::new(2.0, 1.0), 9.0), Some(Point2::new(2.0, 2.0)));
        path.advance(&Point2::new(0.0, 0.0));
        assert_eq!(path.ahead().len(), 1, "never back");
    }

    #[test]
    fn a_path_can_be_cut_short() {
        let mut path = path(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        path.truncate(2.5);
        assert_eq!(path.end(), Some(&Point2::new(2.0, 0.5)));
        assert_eq!(length_m(&path), 2.5);
        path.truncate(9.0);
        assert_eq!(length_m(&path), 2.5);
    }

    #[test]
    fn no_path_and_a_single_point_are_valid() {
        let mut none = Path::default();
        assert_eq!(none.advance(&Point2::origin()), f64::INFINITY);
        assert_eq!((none.lookahead_point(&Point2::origin(), 1.0), length_m(&none)), (None, 0.0));
        let mut point = path(&[(1.0, 0.0)]);
        point.truncate(0.5);
        assert_eq!(point.advance(&Point2::origin()), 1.0);
        assert_eq!(point.lookahead_point(&Point2::origin(), 0.1), Some(Point2::new(1.0, 0.0)));
        assert_eq!(point.remaining_m(&Point2::origin()), 1.0);
    }

    #[test]
    fn a_path_without_obstacles_is_its_two_ends() {
        let cells: Vec<_> = (0..40).map(|x| Cell::new(x, 0)).collect();
        let found = corners(&cells, |from, to| (to - from) as u32, |a, b| Some((b.x - a.x) as u32));
        assert_eq!(found, [Cell::new(0, 0), Cell::new(39, 0)]);
    }
}
