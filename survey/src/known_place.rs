//! The map of the first log when it is complete: the place in which later logs find theirs.

use crate::settings::SurveySettings;
use interfaces::{CellState, Grid, GridFrame, ValueError, Values, runs, value};
use localizer::{ChangingMap, LineMap, TrajectorySettings};
use std::collections::BTreeMap;

/// The map of the first log, as later logs need it.
#[derive(Clone, Debug)]
pub struct KnownPlace {
    pub(crate) settings: SurveySettings,
    pub(crate) cells: KnownCells,
    /// The map of what is permanent.
    pub(crate) permanent: Grid<CellState>,
    /// The surfaces, which are more exact than cells.
    pub(crate) lines: LineMap,
}

/// The cells that the first log has left.
#[derive(Clone, Debug)]
pub(crate) struct KnownCells {
    pub(crate) states: Grid<CellState>,
    /// The rates of the cells that changed, in cycles per second, by index.
    pub(crate) rates: BTreeMap<usize, f64>,
}

impl ChangingMap for KnownCells {
    fn states(&self) -> &Grid<CellState> {
        &self.states
    }

    fn rate(&self, index: usize) -> f64 {
        self.rates.get(&index).copied().unwrap_or_default()
    }
}

impl KnownPlace {
    pub(crate) fn new(
        settings: SurveySettings,
        cells: KnownCells,
        permanent: Grid<CellState>,
        lines: LineMap,
    ) -> Self {
        Self { settings, cells, permanent, lines }
    }

    /// Everything that the log has left, as bytes; settings are not in it.
    pub(crate) fn snapshot(mut self) -> Vec<u8> {
        let mut bytes = interfaces::snapshot(vec![value(&mut self.cells.states.frame().clone())]);
        let mut lines = self.lines.snapshot();
        bytes.extend(interfaces::snapshot(self.values(&mut lines)));
        bytes
    }

    /// The place from its snapshot, with the settings of the survey that has made it.
    pub(crate) fn restored(settings: &SurveySettings, mut snapshot: &[u8]) -> Result<Self, ValueError> {
        let frame: GridFrame = interfaces::read_value(&mut snapshot)?;
        let unknown = Grid::filled(frame, CellState::Unknown);
        let lines = LineMap::new(&TrajectorySettings::default(), &frame).map_err(|_| ValueError)?;
        let cells = KnownCells { states: unknown.clone(), rates: BTreeMap::new() };
        let mut place = Self::new(settings.clone(), cells, unknown, lines);
        let mut lines = Vec::new();
        interfaces::restore(place.values(&mut lines), snapshot)?;
        place.lines.restore(&lines)?;
        Ok(place)
    }

    fn values<'a>(&'a mut self, lines: &'a mut Vec<u8>) -> Values<'a> {
        vec![
            runs(self.cells.states.cells_mut()),
            value(&mut self.cells.rates),
            runs(self.permanent.cells_mut()),
            value(lines),
        ]
    }
}
