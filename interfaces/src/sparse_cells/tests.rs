use super::*;
use crate::values::{cell_runs, read_values, runs, write_values};
use crate::{Purpose, RandomStream};

/// Grids of many shapes: narrower than a block, as wide as some blocks, and one cell more or less.
const SHAPES: [(usize, usize); 9] =
    [(1, 1), (1, 40), (40, 1), (15, 17), (16, 16), (17, 33), (48, 31), (100, 7), (333, 65)];

/// Both a sparse and a dense list after the same random changes, most of them near each other. Every second one has blocks.
fn changed(width: usize, height: usize, seed: u64) -> (SparseCells<i32>, Vec<i32>) {
    let mut random = RandomStream::new(seed, Purpose::Task);
    let small = if seed.is_multiple_of(2) { 0 } else { SMALL_GRID };
    let (mut sparse, mut dense) =
        (SparseCells::small_up_to(small, width, height, -1), vec![-1; width * height]);
    let mut below = |count: usize| random.uniform(0.0..count as f64) as usize;
    for change in 0..60 {
        let index = below(dense.len());
        let value = change - 3;
        match below(3) {
            0 => {
                sparse[index] = value;
                dense[index] = value;
            }
            1 => {
                sparse.set(index, -1);
                dense[index] = -1;
            }
            _ => {
                if let Some(own) = sparse.stored_mut(index) {
                    *own = value;
                    dense[index] = value;
                }
            }
        }
    }
    (sparse, dense)
}

#[test]
fn sparse_cells_behave_as_a_dense_list() {
    for (seed, (width, height)) in (0..).zip(SHAPES.repeat(4)) {
        let (mut sparse, mut dense) = changed(width, height, seed);
        assert_eq!(sparse.to_vec(), dense, "{width} × {height}");
        assert_eq!((sparse.len(), sparse.get(dense.len())), (dense.len(), None));
        assert!((0..dense.len()).all(|index| sparse[index] == dense[index]));
        assert!(sparse.iter().rev().eq(dense.iter().rev()));
        let rows = (0..height).flat_map(|row| sparse.row(row));
        assert!(rows.eq(&dense));
        let other: Vec<_> = dense.iter().enumerate().filter(|(_, value)| **value != -1).collect();
        assert_eq!(sparse.other_than(-1).collect::<Vec<_>>(), other);
        assert_eq!(sparse.other_than(7).count(), dense.iter().filter(|value| **value != 7).count());
        assert!(sparse.stored().all(|(index, value)| sparse.is_stored(index) && *value == dense[index]));
        assert_eq!(sparse.stored().filter(|(_, value)| **value != -1).count(), other.len());
        assert_eq!(
            sparse.map(|value| value * 2).to_vec(),
            dense.iter().map(|value| value * 2).collect::<Vec<_>>()
        );
        assert_eq!(SparseCells::from_vec(width, dense.clone()), sparse);
        // A run in the middle row.
        let (start, end) = (height / 2 * width + width / 4, height / 2 * width + width - width / 5);
        let mut next = start;
        sparse.each_piece_mut(start, end, |from, until, values| {
            assert_eq!(from, next);
            next = until;
            match values {
                Some(values) => {
                    assert_eq!(*values, dense[from..until]);
                    values.fill(5);
                    dense[from..until].fill(5);
                }
                None => assert!(dense[from..until].iter().all(|value| *value == -1)),
            }
        });
        assert_eq!((next, sparse.to_vec()), (end, dense));
    }
}

#[test]
fn the_bytes_of_a_state_are_those_of_a_dense_list() {
    for (seed, (width, height)) in (0..).zip(SHAPES) {
        let (mut sparse, mut dense) = changed(width, height, seed);
        let (mut of_sparse, mut of_dense) = (Vec::new(), Vec::new());
        write_values(vec![cell_runs(&mut sparse, usize::MAX)], &mut of_sparse).unwrap();
        write_values(vec![runs(&mut dense)], &mut of_dense).unwrap();
        assert_eq!(of_sparse, of_dense, "{width} × {height}");
        // Over other values, and into another list.
        let (mut again, _) = changed(width, height, seed + 1);
        read_values(&mut &of_sparse[..], vec![cell_runs(&mut again, usize::MAX)]).unwrap();
        assert_eq!(again, sparse);
        let runs_of_8 = |sparse: &mut SparseCells<i32>| {
            let mut bytes = Vec::new();
            write_values(vec![cell_runs(sparse, 8)], &mut bytes).unwrap();
            bytes
        };
        let mut of_chunks = Vec::new();
        dense.chunks_mut(8).for_each(|chunk| write_values(vec![runs(chunk)], &mut of_chunks).unwrap());
        assert_eq!(runs_of_8(&mut sparse), of_chunks);
        let mut again = SparseCells::new(width, height, -1);
        read_values(&mut &of_chunks[..], vec![cell_runs(&mut again, 8)]).unwrap();
        assert_eq!(again, sparse);
    }
}

#[test]
fn memory_grows_with_what_differs() {
    // 1 km² in cells of 0.05 m.
    let mut cells = SparseCells::new(20_000, 20_000, 0_u64);
    assert!(cells.bytes() < 7 << 20, "{} bytes", cells.bytes());
    let empty = cells.bytes();
    for row in 0..160 {
        (0..160).for_each(|column| cells[row * 20_000 + column] = 1);
        (0..160).for_each(|column| cells[(19_999 - row) * 20_000 + 19_999 - column] = 1);
    }
    let per_cell = (cells.bytes() - empty) as f64 / (2.0 * 160.0 * 160.0);
    assert!(per_cell < 1.2 * 8.0, "{per_cell} bytes per cell");
    assert_eq!(cells.other_than(0).count(), 2 * 160 * 160);
    cells.set(200_000_000, 0);
    assert!(!cells.is_stored(200_000_000));
}
