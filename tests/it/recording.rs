//! Reads a recording back, as a viewer does.

use rerun::components::Scalar;
use rerun::{ChunkStore, ChunkStoreConfig, EntityPath, Scalars, StoreKind};
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

    /// A curve: simulated time, s, and value.
    pub(crate) fn curve(&self, entity: &str) -> Vec<(f64, f64)> {
        let (entity, component) =
            (EntityPath::parse_forgiving(entity), Scalars::descriptor_scalars().component);
        let mut points = Vec::new();
        for chunk in self.0.iter_physical_chunks().filter(|chunk| chunk.entity_path() == &entity) {
            if chunk.is_static() {
                continue; // the style
            }
            let times = chunk.timelines().values().find(|column| column.name() == "sim_time").unwrap();
            let values = chunk.iter_component::<Scalar>(component).map(|values| values.as_slice()[0].0.0);
            points.extend(times.times_raw().iter().map(|time_ns| *time_ns as f64 * 1e-9).zip(values));
        }
        points.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
        points
    }
}
