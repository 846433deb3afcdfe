mod disk;

use super::*;
use crate::fake_run::FakeRun;
use draw::layers::Layer;
use localizer::{PoseEstimate, PoseState};
use nalgebra::{Matrix3, Point2, Vector3};
use rerun::components::{ImageBuffer, Scalar, Text, Translation3D};
use rerun::external::re_log_encoding::Decoder;
use rerun::{
    ChunkStore, ChunkStoreConfig, Component, ComponentIdentifier, EntityPath, Scalars, SegmentationImage,
    StoreKind, TextLog, Transform3D,
};
use std::path::Path;

fn to(file: &Path) -> Result<Recorder, RecordingError> {
    let file = UnfinishedFile::create(file).map_err(|error| RecordingError::Sdk(error.to_string()))?;
    Recorder::new(Some(file), &[], FakeRun::new().scene)
}

/// Records `ticks` of a simulated run. Returns the bytes of the file.
fn record(run: &mut FakeRun, ticks: u64) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.rrd");
    let mut recorder =
        Recorder::new(Some(UnfinishedFile::create(&file).unwrap()), &[], run.scene.clone()).unwrap();
    for _ in 0..ticks {
        run.step();
        run.with_view(|view| recorder.log(view, false)).unwrap();
    }
    run.with_view(|view| recorder.log(view, true)).unwrap();
    std::fs::read(&file).unwrap()
}

fn store(bytes: &[u8], kind: StoreKind) -> ChunkStore {
    let stores = ChunkStore::from_rrd_reader(&ChunkStoreConfig::ALL_DISABLED, &mut &*bytes).unwrap();
    let mut stores = stores.into_values().filter(|store| store.id().kind() == kind);
    let store = stores.next().unwrap();
    assert!(stores.next().is_none());
    store
}

/// The rows of a component of an entity in the order of their simulated time, ns.
fn rows<C: Component + Clone>(
    store: &ChunkStore,
    entity: &str,
    component: ComponentIdentifier,
) -> Vec<(i64, Vec<C>)> {
    let entity = EntityPath::parse_forgiving(entity);
    let mut rows = Vec::new();
    for chunk in store.iter_physical_chunks() {
        if chunk.entity_path() == &entity && !chunk.is_static() {
            let time = chunk.timelines().values().find(|time| time.name() == tracks::SIM_TIME);
            let times = time.unwrap().times_raw();
            let items = chunk.iter_component::<C>(component).map(|items| items.as_slice().to_vec());
            rows.extend(times.iter().copied().zip(items));
        }
    }
    rows.sort_by_key(|row: &(i64, Vec<C>)| row.0);
    rows
}

/// The entities of a recording.
fn entities() -> Vec<String> {
    let of_robot = |robot| ["body", "body/name", "trail"].map(|part| format!("/world/robots/{robot}/{part}"));
    let others = "/curves/expected_changes/p /curves/longest_unseen/r /curves/scores/coverage /curves/scores/map_quality \
                  /curves/strategy /curves/strategy_share/poisson /curves/strategy_share/random /curves/strategy_share/recency \
                  /curves/strategy_value/poisson /curves/strategy_value/random /curves/strategy_value/recency /log /world \
                  /world/field_of_view /world/goal /world/obstacles/toy /world/path /world/walls";
    let mut entities: Vec<String> = others.split(' ').map(str::to_owned).collect();
    entities.extend(Layer::ALL.map(tracks::map));
    entities.extend(["curious", "dummy"].into_iter().flat_map(of_robot));
    entities.sort();
    entities
}

#[test]
fn every_entity_is_there() {
    let store = store(&record(&mut FakeRun::new(), 300), StoreKind::Recording);
    let mut found = Vec::from_iter(store.all_entities_sorted().iter().map(|path| path.to_string()));
    found.retain(|path| !path.starts_with("/__"));
    found.sort();
    assert_eq!(found, entities());
    assert_eq!(timelines(&store), ["sim_time", "step"]);
}

#[test]
fn a_robot_that_is_localized_is_there_twice() {
    let mut run = FakeRun::new();
    run.estimate = Some(PoseEstimate {
        pose: interfaces::pose(3.0, 3.0, 0.5),
        covariance: Matrix3::from_diagonal(&Vector3::new(1e-4, 4e-4, 1e-6)),
        support: 0.75,
        state: PoseState::Tracking,
    });
    let store = store(&record(&mut run, 50), StoreKind::Recording);
    let entities = Vec::from_iter(store.all_entities_sorted().iter().map(|path| path.to_string()));
    for entity in ["body", "scan", "trail", "uncertainty_20_times_enlarged"] {
        assert!(entities.contains(&format!("/world/estimate/{entity}")), "{entity} is not in {entities:?}");
    }
    let support = rows::<Scalar>(&store, "/curves/support/support", Scalars::descriptor_scalars().component);
    assert!(!support.is_empty() && support.iter().all(|(_, values)| values[0].0.0 == 0.75), "{support:?}");
}

#[test]
fn what_is_read_back_is_what_happened() {
    let mut run = FakeRun::new();
    let store = store(&record(&mut run, 305), StoreKind::Recording);

    let position = Transform3D::descriptor_translation().component;
    for (name, at) in run.positions() {
        let body = rows::<Translation3D>(&store, &tracks::robot(name, "body"), position);
        assert!(body.len() > 250, "{name}: {}", body.len());
        let (time, positions) = body.last().unwrap();
        assert_eq!(*time, 30_500_000_000);
        let last = Point2::new(f64::from(positions[0].x()), f64::from(positions[0].y()));
        assert!((last - at).norm() < 1e-5);
    }
    let buffer = SegmentationImage::descriptor_buffer().component;
    for layer in Layer::ALL {
        let maps = rows::<ImageBuffer>(&store, &tracks::map(layer), buffer);
        let most = if layer == Layer::Occupancy { 32 } else { 5 };
        assert!((2..=most).contains(&maps.len()), "{layer:?}: {}", maps.len());
        let last = maps.last().unwrap().1[0].0.to_vec();
        assert_eq!(last, layer.classes(&run.mapper).cells().to_vec(), "{layer:?} at the end");
    }
    let coverage = rows::<Scalar>(&store, "/curves/scores/coverage", Scalars::descriptor_scalars().component);
    assert_eq!(coverage.len(), 32); // once a second, and at the end
    assert!(coverage.windows(2).all(|pair| pair[0].1[0].0 <= pair[1].1[0].0));
    let log = rows::<Text>(&store, tracks::LOG, TextLog::descriptor_text().component);
    assert!(log.iter().any(|(_, text)| text[0].0.as_str().starts_with("goal reached; poisson chooses")));
    let toy = rows::<rerun::LineStrip2D>(
        &store,
        "/world/obstacles/toy",
        rerun::LineStrips2D::descriptor_strips().component,
    );
    assert_eq!(toy.len(), 1);
    assert_eq!(toy[0].0, 20_100_000_000);
}

/// The titles of the views in the layout of a recording, sorted.
fn titles(recording: &[u8]) -> Vec<String> {
    let store = store(recording, StoreKind::Blueprint);
    let name = rerun::external::re_sdk_types::blueprint::archetypes::ViewBlueprint::descriptor_display_name();
    let mut names: Vec<String> = Vec::new();
    for chunk in store.iter_physical_chunks() {
        let found = chunk.iter_component::<rerun::components::Name>(name.component);
        names.extend(found.flat_map(|names| names.as_slice().to_vec()).map(|name| name.0.to_string()));
    }
    names.sort();
    names
}

fn timelines(store: &ChunkStore) -> Vec<String> {
    let mut timelines: Vec<_> = store.schema().timelines().keys().map(|name| name.to_string()).collect();
    timelines.sort();
    timelines
}

#[test]
fn the_layout_shows_every_view() {
    assert_eq!(
        titles(&record(&mut FakeRun::new(), 3)),
        [
            "Changes expected out of view",
            "Cycle time: seconds per cycle",
            "Longest time since a cell was seen (s)",
            "Map: coverage and quality",
            "Probability of a change since last seen",
            "Probability of being blocked in 1 h",
            "Probability of being blocked in 1 min",
            "Probability of being blocked in 10 min",
            "Probability of being blocked now",
            "Recency: seconds since last seen",
            "Strategies: expected map updates per step",
            "Strategies: share of the goals",
            "Strategy that chose the goal",
            "The map so far: fake rooms",
            "What happened",
        ]
    );
}

#[test]
fn a_minute_is_small() {
    // 30 MB are allowed for twenty of them.
    assert!(record(&mut FakeRun::new(), 600).len() < 1_500_000);
}

#[test]
fn a_killed_run_leaves_what_was_sent() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.rrd");
    let mut run = FakeRun::new();
    let mut recorder = to(&file).unwrap();
    for _ in 0..100 {
        run.step();
        run.with_view(|view| recorder.log(view, false)).unwrap();
    }
    recorder.flush().unwrap();
    recorder.stream.flush_blocking().unwrap();
    // What the disk has now, whole and with the last message torn.
    let killed = std::fs::read(folder.path().join("run.unfinished.rrd")).unwrap();
    let whole = store(&killed, StoreKind::Recording);
    let position = Transform3D::descriptor_translation().component;
    let body = rows::<Translation3D>(&whole, &tracks::robot("curious", "body"), position);
    assert_eq!(body.last().unwrap().0, 10_000_000_000);
    let messages = |bytes: &[u8]| {
        Decoder::<rerun::log::LogMsg>::decode_eager(std::io::Cursor::new(bytes.to_vec()))
            .unwrap()
            .take_while(Result::is_ok)
            .count()
    };
    let all = messages(&killed);
    assert!(all > 50, "{all}");
    assert_eq!(messages(&killed[..killed.len() - 5]), all - 1);
    drop(recorder);
}
