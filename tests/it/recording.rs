//! Reads a recording back, as a viewer does.

use rerun::components::{LineStrip2D, Scalar, Text, Translation3D};
use rerun::{
    ChunkStore, ChunkStoreConfig, Component, ComponentIdentifier, EntityPath, LineStrips2D, Scalars,
    StoreKind, TextLog, Transform3D,
};
use std::path::Path;

/// A recording in memory.
pub(crate) struct Recording(ChunkStore);

impl Recording {
    pub(crate) fn read(path: &Path) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let stores = ChunkStore::from_rrd_reader(&ChunkStoreConfig::ALL_DISABLED, &mut &*bytes).unwrap();
        let mut stores = stores.into_values().filter(|store| store.id().kind() == StoreKind::Recording);
        let store = stores.next().unwrap();
        assert!(stores.next().is_none(), "more than one recording in {}", path.display());
        Self(store)
    }

    /// The paths of all logged entities, without those that the SDK adds.
    pub(crate) fn entities(&self) -> Vec<String> {
        let paths = self.0.all_entities_sorted();
        paths.iter().map(|path| path.to_string()).filter(|path| !path.starts_with("/__")).collect()
    }

    /// All times on a timeline at which `entity` was logged, in order; for `/`, the times of all entities.
    pub(crate) fn times(&self, entity: &str, timeline: &str) -> Vec<i64> {
        let entity = EntityPath::parse_forgiving(entity);
        let mut times = Vec::new();
        for chunk in self.0.iter_physical_chunks() {
            if chunk.entity_path() == &entity || entity.is_root() {
                let column = chunk.timelines().values().find(|column| column.name() == timeline);
                times.extend(column.into_iter().flat_map(|column| column.times_raw().to_vec()));
            }
        }
        times.sort_unstable();
        times
    }

    /// The latest simulated time, s.
    pub(crate) fn end_s(&self) -> f64 {
        *self.times("/", "sim_time").last().unwrap() as f64 * 1e-9
    }

    /// The names of the timelines, sorted.
    pub(crate) fn timelines(&self) -> Vec<String> {
        let mut names: Vec<_> = self.0.schema().timelines().keys().map(|name| name.to_string()).collect();
        names.sort();
        names
    }

    /// A curve: simulated time, s, and value.
    pub(crate) fn curve(&self, entity: &str) -> Vec<(f64, f64)> {
        let points = self.rows::<Scalar>(entity, "sim_time", Scalars::descriptor_scalars().component);
        points.iter().map(|(time_ns, values)| (*time_ns as f64 * 1e-9, values[0].0.0)).collect()
    }

    /// A curve over steps.
    pub(crate) fn curve_over_steps(&self, entity: &str) -> Vec<(i64, f64)> {
        let points = self.rows::<Scalar>(entity, "step", Scalars::descriptor_scalars().component);
        points.iter().map(|(step, values)| (*step, values[0].0.0)).collect()
    }

    /// The positions of a robot, whenever it has moved: step and position, m.
    pub(crate) fn places(&self, entity: &str) -> Vec<(i64, [f32; 2])> {
        let component = Transform3D::descriptor_translation().component;
        let places = self.rows::<Translation3D>(entity, "step", component);
        places.iter().map(|(step, places)| (*step, [places[0].x(), places[0].y()])).collect()
    }

    /// The corners of a thing, whenever they have changed: step and positions, m.
    pub(crate) fn outlines(&self, entity: &str) -> Vec<(i64, Vec<[f32; 2]>)> {
        let strips = self.rows::<LineStrip2D>(entity, "step", LineStrips2D::descriptor_strips().component);
        let corners = |strip: &LineStrip2D| strip.0.iter().map(|corner| [corner.x(), corner.y()]).collect();
        strips.iter().map(|(step, strips)| (*step, corners(&strips[0]))).collect()
    }

    /// The lines of the log, with their steps.
    pub(crate) fn log(&self) -> Vec<(i64, String)> {
        let lines = self.rows::<Text>("/log", "step", TextLog::descriptor_text().component);
        lines.iter().map(|(step, lines)| (*step, lines[0].0.to_string())).collect()
    }

    /// The rows of a component of an entity in the order of their times.
    fn rows<C: Component + Clone>(
        &self,
        entity: &str,
        timeline: &str,
        component: ComponentIdentifier,
    ) -> Vec<(i64, Vec<C>)> {
        let entity = EntityPath::parse_forgiving(entity);
        let mut rows = Vec::new();
        for chunk in self.0.iter_physical_chunks().filter(|chunk| chunk.entity_path() == &entity) {
            if chunk.is_static() {
                continue; // the style
            }
            let times = chunk.timelines().values().find(|column| column.name() == timeline).unwrap();
            let items = chunk.iter_component::<C>(component).map(|items| items.as_slice().to_vec());
            rows.extend(times.times_raw().iter().copied().zip(items));
        }
        rows.sort_by_key(|row| row.0);
        rows
    }
}
