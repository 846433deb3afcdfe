//! Sparse linear equations with blocks of 3 × 3, as of a pose graph: a symmetric positive definite matrix is eliminated
//! node by node, always the node with the fewest neighbors next (minimum degree: Tinney & Walker 1967), so that a chain
//! of poses costs no more than its length.

use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// The equations: a block per node on the diagonal, and a block per pair of neighbors.
#[derive(Clone, Debug)]
pub(super) struct Equations {
    pub(super) diagonal: Vec<Matrix3<f64>>,
    /// For each node, its neighbors, with the block of its row and their column.
    neighbors: Vec<BTreeMap<usize, Matrix3<f64>>>,
    pub(super) right: Vec<Vector3<f64>>,
}

impl Equations {
    pub(super) fn new(nodes: usize) -> Self {
        Self {
            diagonal: vec![Matrix3::zeros(); nodes],
            neighbors: vec![BTreeMap::new(); nodes],
            right: vec![Vector3::zeros(); nodes],
        }
    }

    /// Adds to the block of two different nodes, and its transpose to the other block.
    pub(super) fn add_pair(&mut self, row: usize, column: usize, block: &Matrix3<f64>) {
        *self.neighbors[row].entry(column).or_insert_with(Matrix3::zeros) += block;
        *self.neighbors[column].entry(row).or_insert_with(Matrix3::zeros) += block.transpose();
    }

    /// The solution; `None` if the matrix is not positive definite.
    pub(super) fn solve(mut self) -> Option<Vec<Vector3<f64>>> {
        let nodes = self.diagonal.len();
        let mut queue: BTreeSet<(usize, usize)> =
            self.neighbors.iter().enumerate().map(|(node, neighbors)| (neighbors.len(), node)).collect();
        let mut eliminated = Vec::with_capacity(nodes);
        while let Some((_, pivot)) = queue.pop_first() {
            let inverse = self.diagonal[pivot].cholesky()?.inverse();
            let row: Vec<(usize, Matrix3<f64>)> =
                std::mem::take(&mut self.neighbors[pivot]).into_iter().collect();
            for (node, _) in &row {
                queue.remove(&(self.neighbors[*node].len(), *node));
                self.neighbors[*node].remove(&pivot);
            }
            self.eliminate(pivot, &inverse, &row);
            queue.extend(row.iter().map(|(node, _)| (self.neighbors[*node].len(), *node)));
            eliminated.push((pivot, inverse, row));
        }
        let mut solution = vec![Vector3::zeros(); nodes];
        for (pivot, inverse, row) in eliminated.into_iter().rev() {
            let known: Vector3<f64> = row.iter().map(|(node, block)| block * solution[*node]).sum();
            solution[pivot] = inverse * (self.right[pivot] - known);
        }
        Some(solution)
    }

    /// Takes a node out of the equations of its neighbors, which become neighbors of each other.
    fn eliminate(&mut self, pivot: usize, inverse: &Matrix3<f64>, row: &[(usize, Matrix3<f64>)]) {
        let right = self.right[pivot];
        for (place, (node, block)) in row.iter().enumerate() {
            let factor = block.transpose() * inverse;
            self.right[*node] -= factor * right;
            self.diagonal[*node] -= factor * block;
            for (other, other_block) in &row[place + 1..] {
                self.add_pair(*node, *other, &-(factor * other_block));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Purpose, RandomStream};
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn the_solution_is_that_of_the_dense_equations() {
        let nodes = 12;
        let mut random = RandomStream::new(100, Purpose::Agent);
        let mut equations = Equations::new(nodes);
        let mut dense = DMatrix::<f64>::zeros(3 * nodes, 3 * nodes);
        let mut right = DVector::<f64>::zeros(3 * nodes);
        let pairs = (1..nodes).map(|node| (node - 1, node)).chain([(0, 9), (2, 7), (7, 2), (3, 11), (1, 5)]);
        for (a, b) in pairs {
            let j = [0, 1].map(|_| Matrix3::from_fn(|_, _| random.uniform(-1.0..1.0)));
            equations.diagonal[a] += j[0].transpose() * j[0];
            equations.diagonal[b] += j[1].transpose() * j[1];
            equations.add_pair(a, b, &(j[0].transpose() * j[1]));
            for (row, jr) in [(a, &j[0]), (b, &j[1])] {
                for (column, jc) in [(a, &j[0]), (b, &j[1])] {
                    let mut view = dense.fixed_view_mut::<3, 3>(3 * row, 3 * column);
                    view += jr.transpose() * jc;
                }
            }
        }
        for node in 0..nodes {
            equations.diagonal[node] += Matrix3::identity() * 0.1;
            let part = Vector3::from_fn(|_, _| random.uniform(-1.0..1.0));
            equations.right[node] += part;
            right.fixed_rows_mut::<3>(3 * node).copy_from(&part);
            for axis in 0..3 {
                dense[(3 * node + axis, 3 * node + axis)] += 0.1;
            }
        }
        let expected = dense.cholesky().unwrap().solve(&right);
        for (node, found) in equations.solve().unwrap().iter().enumerate() {
            let error = (found - expected.fixed_rows::<3>(3 * node)).norm();
            assert!(error < 1e-9, "node {node}: {error}");
        }
    }

    #[test]
    fn equations_without_a_solution_are_refused() {
        assert!(Equations::new(2).solve().is_none());
    }
}
