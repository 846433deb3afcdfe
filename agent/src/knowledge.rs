use mapper::Mapper;

/// How much is known of how often cells change: Σ over the cells that changed in view of
/// ln 10 − 1/√n, where n is how many changes of the cell were seen.
///
/// After n events of a Poisson process the logarithm of its rate is known to about 1/√n; without any,
/// the error counts as ln 10, as where rates are judged. So the first event of a cell is worth most, and
/// each further one less.
pub(crate) fn knowledge(mapper: &Mapper) -> f64 {
    let of_cell = |cell| {
        let seen = mapper.statistics(cell);
        let events = f64::from(seen.block_events) + f64::from(seen.free_events);
        if events > 0.0 { std::f64::consts::LN_10 - 1.0 / events.sqrt() } else { 0.0 }
    };
    mapper.changed().map(of_cell).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Cell, CellReading, GridFrame};
    use mapper::MapperSettings;
    use nalgebra::{Isometry2, Point2};

    #[test]
    fn the_first_event_is_worth_most() {
        let frame = GridFrame::new(Point2::origin(), 1.0, 2, 1).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let mut known = Vec::new();
        for step in 0..5 {
            let cells = vec![(Cell::new(0, 0), step % 2 == 1), (Cell::new(1, 0), false)];
            let (time, pose) = (f64::from(step), Isometry2::identity());
            mapper.update(&CellReading { time, pose, cells }).unwrap();
            known.push(knowledge(&mapper));
        }
        let ln_10 = std::f64::consts::LN_10;
        let expected = [0.0, ln_10 - 1.0, ln_10 - 0.5f64.sqrt(), ln_10 - 3f64.sqrt() / 3.0, ln_10 - 0.5];
        assert!(known.iter().zip(expected).all(|(known, expected)| (known - expected).abs() < 1e-12));
        // A change found after a gap tells no rate.
        let away =
            CellReading { time: 5.0, pose: Isometry2::identity(), cells: vec![(Cell::new(0, 0), false)] };
        mapper.update(&away).unwrap();
        let found =
            CellReading { time: 9.0, pose: Isometry2::identity(), cells: vec![(Cell::new(1, 0), true)] };
        mapper.update(&found).unwrap();
        assert!((knowledge(&mapper) - expected[4]).abs() < 1e-12);
    }
}
