//! A tree of upright boxes: it finds the shapes near a place without a look at all of them.

use super::Rectangle;
use super::shape::TOUCH_M;
use nalgebra::{Point2, Vector2};

/// The lower left and the upper right corner of an upright box, m.
type Bounds = (Point2<f64>, Point2<f64>);

/// The boxes around some shapes, nearby ones together. To build it takes n log n; a search takes the logarithm of n,
/// and the time for the shapes near the place.
#[derive(Clone, Debug, Default)]
pub struct BoxTree {
    /// Every node before the nodes below it.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    /// The box around all shapes of the node.
    area: Rectangle,
    /// The lowest index of these shapes.
    first: usize,
    /// The number of nodes below this one; 0: it is a single shape.
    below: usize,
}

impl BoxTree {
    /// The tree of the shapes that lie in these boxes, each from its lower left to its upper right corner, m.
    pub fn new(boxes: impl IntoIterator<Item = (Point2<f64>, Point2<f64>)>) -> Self {
        let mut boxes: Vec<(usize, Bounds)> = boxes.into_iter().enumerate().collect();
        let mut tree = Self { nodes: Vec::with_capacity(2 * boxes.len()) };
        tree.add(&mut boxes);
        tree
    }

    fn add(&mut self, boxes: &mut [(usize, Bounds)]) {
        let Some(&(one, (low, high))) = boxes.first() else { return };
        let around = |(low, high): Bounds, (_, next): &(usize, Bounds)| (low.inf(&next.0), high.sup(&next.1));
        let (low, high) = boxes.iter().fold((low, high), around);
        // What touches is not left out because of rounding.
        let margin = Vector2::repeat(TOUCH_M);
        let area = Rectangle::between(low - margin, high + margin);
        let first = boxes.iter().fold(one, |first, (index, _)| first.min(*index));
        let at = self.nodes.len();
        self.nodes.push(Node { area, first, below: 0 });
        if boxes.len() == 1 {
            return;
        }
        // In two halves along the longer side.
        let axis = (high - low).imax();
        let middle = |(_, (low, high)): &(usize, Bounds)| low[axis] + high[axis];
        let half = boxes.len() / 2;
        boxes.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)).then(a.0.cmp(&b.0)));
        let (lower, upper) = boxes.split_at_mut(half);
        self.add(lower);
        self.add(upper);
        self.nodes[at].below = self.nodes.len() - at - 1;
    }

    /// The lowest index below `limit` of a shape for which `is_it` holds. `may_be` says whether that is possible for
    /// a shape within a box: it must hold for a box that holds a smaller box for which it holds.
    pub fn first_below(
        &self,
        limit: usize,
        may_be: impl Fn(&Rectangle) -> bool,
        is_it: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let (mut best, mut at) = (limit, 0);
        while let Some(node) = self.nodes.get(at) {
            at += 1;
            if node.first >= best || !may_be(&node.area) {
                at += node.below;
            } else if node.below == 0 && is_it(node.first) {
                best = node.first;
            }
        }
        (best < limit).then_some(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};

    #[test]
    fn it_finds_what_a_look_at_all_finds() {
        let mut random = RandomStream::new(3, Purpose::Behavior(0));
        let mut within = |low: f64, high: f64| random.uniform(low..high);
        let mut shape = |reach_m: f64| {
            let center = Point2::new(within(0.0, reach_m), within(0.0, reach_m));
            Rectangle::around(center, Vector2::new(within(0.01, 2.0), within(0.01, 2.0)), within(0.0, 7.0))
        };
        for count in [0, 1, 2, 3, 50, 400] {
            let shapes: Vec<Rectangle> = (0..count).map(|_| shape(20.0)).collect();
            let tree = BoxTree::new(shapes.iter().map(Rectangle::bounds));
            for i in 0..200 {
                let (other, limit) = (shape(20.0), if i % 2 == 0 { usize::MAX } else { i });
                let found =
                    tree.first_below(limit, |area| area.overlaps(&other), |i| shapes[i].overlaps(&other));
                let all = (0..count.min(limit)).find(|i| shapes[*i].overlaps(&other));
                assert_eq!(found, all, "{count}");
            }
        }
    }
}
