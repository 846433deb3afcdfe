//! The layout that a viewer opens a recording with.
//!
//! Logged component by component, since the SDK's layout types cannot set a view's bounds, the
//! axis of a plot, or how much of a trail is shown.

use super::path;
use super::rows::timeline;
use super::tracks::{BAR_SHARE, LEGEND_SHARE, has_choice, plots};
use crate::layers::Layer;
use crate::scene::{Scene, TimeUnit};
use crate::view::View;
use nalgebra::{Point2, Vector2};
use rerun::blueprint::components::{ContainerKind, Corner2D, PanelState, PlayState};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::datatypes::{self as blueprint_types, TextLogColumnKind};
use rerun::external::re_sdk_types::blueprint::{archetypes as blueprint, components::VisibleTimeRange};
use rerun::external::re_sdk_types::datatypes;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

/// How much of the curious robot's trail is shown, on the timeline: all of it would hide the map.
fn recent(unit: TimeUnit) -> i64 {
    match unit {
        TimeUnit::Second => 300 * 1_000_000_000,
        TimeUnit::Step => 60,
    }
}

/// Sends the layout for a run whose first view is `view`. Only panels that will have a content are shown.
pub(super) fn send(
    stream: &RecordingStream,
    application: &'static str,
    scene: &Scene,
    view: &View,
) -> RecordingStreamResult<()> {
    let (layout, storage) = RecordingStreamBuilder::new(application).enabled(true).blueprint().memory()?;
    layout.set_time_sequence("blueprint", 0);
    let layout = Layout { stream: layout, unit: scene.unit, count: 0.into() };

    let scene_view = layout.scene(scene, view)?;
    let maps = [Layer::Interval, Layer::ChangeProbability, Layer::Recency];
    let maps = maps.map(|layer| layout.map(view, layer)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let mut curves = Vec::new();
    for plot in plots(scene, view) {
        curves.push(layout.plot(&plot.title, plot.entity, plot.range)?);
    }
    if has_choice(view) {
        let title = "Strategy that chose the goal";
        curves.push(layout.view("StateTimeline", title, &[format!("+ {}/**", path::STRATEGY)])?);
    }
    let log = layout.log()?;

    let maps = layout.container(ContainerKind::Vertical, &maps, &[])?;
    let curves = layout.container(ContainerKind::Vertical, &curves, &[])?;
    let left = layout.container(ContainerKind::Vertical, &[scene_view, log], &[4.5, 1.0])?;
    let root = layout.container(ContainerKind::Horizontal, &[left, maps, curves], &[2.4, 1.0, 1.3])?;
    layout.finish(root)?;

    let id = storage.store_id();
    if let Some(id) = id {
        stream.send_blueprint(storage.take(), BlueprintActivationCommand::make_active(id));
    }
    Ok(())
}

/// The ground around the maps. It is light, because labels are dark.
const GROUND: [u8; 3] = [236, 238, 241];

struct Layout {
    stream: RecordingStream,
    unit: TimeUnit,
    count: std::cell::Cell<u8>,
}

/// A view or container in the blueprint.
struct Part {
    path: String,
    id: [u8; 16],
}

impl Layout {
    fn part(&self, kind: &str) -> Part {
        // Ids need to be unique within this layout only.
        self.count.set(self.count.get() + 1);
        let id = [self.count.get(); 16];
        Part { path: format!("{kind}/{}", rerun::external::uuid::Uuid::from_bytes(id)), id }
    }

    fn log(&self) -> RecordingStreamResult<Part> {
        let view = self.view("TextLog", "What happened", &[path::LOG.into()])?;
        let time =
            blueprint_types::TimelineColumn { visible: true.into(), timeline: timeline(self.unit).into() };
        let columns = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body];
        let columns = columns.map(|kind| blueprint_types::TextLogColumn { kind, visible: true.into() });
        let columns =
            blueprint::TextLogColumns::new().with_timeline_columns([time]).with_text_log_columns(columns);
        self.property(&view, "TextLogColumns", &columns)?;
        Ok(view)
    }

    fn view(&self, class: &str, name: &str, contents: &[String]) -> RecordingStreamResult<Part> {
        let part = self.part("view");
        let view = blueprint::ViewBlueprint::new(class).with_display_name(name).with_space_origin("/");
        self.stream.log(part.path.as_str(), &view)?;
        let queries = contents.iter().map(String::as_str);
        self.property(&part, "ViewContents", &blueprint::ViewContents::new(queries))?;
        Ok(part)
    }

    fn property(&self, view: &Part, name: &str, value: &dyn AsComponents) -> RecordingStreamResult<()> {
        self.stream.log(format!("{}/{name}", view.path), value)
    }

    /// A view of a part of the world. The bounds are in the frame of the viewer, whose y axis points down.
    fn spatial(
        &self,
        name: &str,
        contents: &[String],
        from: Point2<f64>,
        to: Point2<f64>,
    ) -> RecordingStreamResult<Part> {
        let view = self.view("2D", name, contents)?;
        let bounds = datatypes::Range2D { x_range: [from.x, to.x].into(), y_range: [-to.y, -from.y].into() };
        self.property(&view, "VisualBounds2D", &blueprint::VisualBounds2D::new(bounds))?;
        let background = blueprint::Background::new(rerun::blueprint::components::BackgroundKind::SolidColor);
        self.property(&view, "Background", &background.with_color(rerun::Color::from(GROUND)))?;
        Ok(view)
    }

    fn scene(&self, scene: &Scene, view: &View) -> RecordingStreamResult<Part> {
        let (from, to) = bounds(view);
        let margin = Vector2::new(0.02, 0.02) * (to.x - from.x);
        let legend = Vector2::new(0.0, LEGEND_SHARE * (to.y - from.y));
        let contents =
            ["walls", "obstacles/**", "robots/**", "maps/occupancy/**", "field_of_view/**", "goal", "path"];
        let contents =
            contents.iter().chain(&["legend/**"]).map(|entity| format!("+ {}/{entity}", path::WORLD));
        let name = format!("The map so far: {}", scene.title);
        let contents: Vec<String> = contents.collect();
        let part = self.spatial(&name, &contents, from - margin - legend, to + margin)?;
        for robot in &scene.robots {
            let start = if robot.is_driven { back(recent(scene.unit)) } else { past().start };
            let range = datatypes::TimeRange { start, ..past() };
            let timeline = timeline(scene.unit).into();
            let range = VisibleTimeRange(datatypes::VisibleTimeRange { timeline, range });
            let trail = path::robot(&robot.name, "trail");
            let property = format!("ViewContents/overrides{trail}/visualizers");
            self.property(&part, &property, &blueprint::VisibleTimeRanges::new([range]))?;
        }
        Ok(part)
    }

    fn map(&self, view: &View, layer: Layer) -> RecordingStreamResult<Part> {
        let (from, to) = bounds(view);
        let bar = Vector2::new(0.0, BAR_SHARE * (to.y - from.y));
        self.spatial(&layer.title(self.unit), &[format!("+ {}/**", path::map(layer))], from - bar, to)
    }

    fn plot(&self, name: &str, entity: &str, range: Option<[f64; 2]>) -> RecordingStreamResult<Part> {
        let view = self.view("TimeSeries", name, &[format!("+ {entity}/**")])?;
        self.property(&view, "PlotLegend", &blueprint::PlotLegend::new().with_corner(Corner2D::LeftTop))?;
        self.whole_past(&view)?;
        if let Some(range) = range {
            let range = rerun::components::Range1D::from(range);
            self.property(&view, "ScalarAxis", &blueprint::ScalarAxis::new().with_range(range))?;
        }
        Ok(view)
    }

    fn whole_past(&self, view: &Part) -> RecordingStreamResult<()> {
        self.property(view, "TimeAxis", &blueprint::TimeAxis::new().with_view_range(past()))
    }

    fn container(&self, kind: ContainerKind, parts: &[Part], shares: &[f32]) -> RecordingStreamResult<Part> {
        let part = self.part("container");
        let mut container = blueprint::ContainerBlueprint::new(kind)
            .with_contents(parts.iter().map(|part| part.path.as_str()));
        let shares = shares.iter().copied();
        container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            _ => container.with_row_shares(shares),
        };
        self.stream.log(part.path.as_str(), &container)?;
        Ok(part)
    }

    fn finish(&self, root: Part) -> RecordingStreamResult<()> {
        let viewport = blueprint::ViewportBlueprint::new()
            .with_root_container(datatypes::Uuid { bytes: root.id })
            .with_auto_layout(false)
            .with_auto_views(false);
        self.stream.log("viewport", &viewport)?;
        let hidden = blueprint::PanelBlueprint::new().with_state(PanelState::Hidden);
        self.stream.log("blueprint_panel", &hidden)?;
        self.stream.log("selection_panel", &hidden)?;
        let time = blueprint::TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(timeline(self.unit))
            .with_play_state(PlayState::Following);
        self.stream.log("time_panel", &time)
    }
}

/// From the start to what is shown.
fn past() -> datatypes::TimeRange {
    let start = datatypes::TimeRangeBoundary::Absolute(datatypes::TimeInt(0));
    datatypes::TimeRange { start, end: datatypes::TimeRangeBoundary::AT_CURSOR }
}

/// A duration before what is shown, on the timeline.
fn back(by: i64) -> datatypes::TimeRangeBoundary {
    datatypes::TimeRangeBoundary::CursorRelative(datatypes::TimeInt(-by))
}

fn bounds(view: &View) -> (Point2<f64>, Point2<f64>) {
    let frame = view.mapper.frame();
    let size = nalgebra::Vector2::new(frame.width() as f64, frame.height() as f64) * frame.resolution_m();
    (frame.origin(), frame.origin() + size)
}
