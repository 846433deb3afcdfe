//! The layout that a viewer opens a recording with.
//!
//! Logged component by component, since the SDK's layout types cannot set a view's bounds, the
//! axis of a plot, or how much of a trail is shown.

use super::tracks::{self, SIM_TIME, has_choice, plots};
use draw::layers::Layer;
use draw::scene::{Scene, extent};
use draw::view::View;
use rerun::blueprint::components::{BackgroundKind, ContainerKind, Corner2D, PanelState, PlayState};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes as blueprint;
use rerun::external::re_sdk_types::blueprint::components::VisibleTimeRange;
use rerun::external::re_sdk_types::blueprint::datatypes::{TextLogColumn, TextLogColumnKind, TimelineColumn};
use rerun::external::re_sdk_types::datatypes::{self, TimeInt, TimeRange, TimeRangeBoundary};
use rerun::{Archetype, AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

/// Sends the layout for a run whose first view is `view`. Only panels that will have a content are shown.
pub(super) fn send(
    stream: &RecordingStream,
    application: &'static str,
    scene: &Scene,
    view: &View,
) -> RecordingStreamResult<()> {
    let (layout, storage) = RecordingStreamBuilder::new(application).enabled(true).blueprint().memory()?;
    layout.set_time_sequence("blueprint", 0);
    let mut layout = Layout { stream: layout, scene, view, count: 0 };
    let left = [layout.scene()?, layout.log()?];
    let others = [Layer::Recency].into_iter().chain(Layer::PREDICTED);
    let others = others.map(|layer| layout.map(layer)).collect::<Result<Vec<_>, _>>()?;
    let maps = [
        layout.map(Layer::Interval)?,
        layout.map(Layer::ChangeProbability)?,
        layout.container(ContainerKind::Tabs, &others, &[])?,
    ];
    let curves = layout.curves()?;
    let columns = [
        layout.container(ContainerKind::Vertical, &left, &[4.5, 1.0])?,
        layout.container(ContainerKind::Vertical, &maps, &[])?,
        layout.container(ContainerKind::Vertical, &curves, &[])?,
    ];
    let root = layout.container(ContainerKind::Horizontal, &columns, &[2.4, 1.0, 1.3])?;
    layout.finish(root)?;
    if let Some(id) = storage.store_id() {
        stream.send_blueprint(storage.take(), BlueprintActivationCommand::make_active(id));
    }
    Ok(())
}

/// The margin around a map, as a share of its width.
const MARGIN: f64 = 0.02;
/// The ground around the maps. It is light, because labels are dark.
const GROUND: [u8; 3] = [236, 238, 241];

struct Layout<'a> {
    stream: RecordingStream,
    scene: &'a Scene,
    view: &'a View<'a>,
    /// The number of parts so far.
    count: u8,
}

/// A view or container in the blueprint.
struct Part {
    path: String,
    id: [u8; 16],
}

impl Layout<'_> {
    fn part(&mut self, kind: &str, part: &dyn AsComponents) -> RecordingStreamResult<Part> {
        // Ids need to be unique within this layout only.
        self.count += 1;
        let id = [self.count; 16];
        let path = format!("{kind}/{}", rerun::external::uuid::Uuid::from_bytes(id));
        self.stream.log(path.as_str(), part)?;
        Ok(Part { path, id })
    }

    fn container(
        &mut self,
        kind: ContainerKind,
        parts: &[Part],
        shares: &[f32],
    ) -> RecordingStreamResult<Part> {
        let shares = shares.iter().copied();
        let container = blueprint::ContainerBlueprint::new(kind)
            .with_contents(parts.iter().map(|part| part.path.as_str()));
        let container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            _ => container.with_row_shares(shares),
        };
        self.part("container", &container)
    }

    fn view(&mut self, class: &str, name: &str, contents: &[&str]) -> RecordingStreamResult<Part> {
        let view = blueprint::ViewBlueprint::new(class).with_display_name(name).with_space_origin("/");
        let view = self.part("view", &view)?;
        self.property(&view, &blueprint::ViewContents::new(contents.iter().copied()))?;
        Ok(view)
    }

    fn property<A: Archetype + AsComponents>(&self, view: &Part, value: &A) -> RecordingStreamResult<()> {
        self.stream.log(format!("{}/{}", view.path, A::name().short_name()), value)
    }

    /// A view of the map with a margin around it. The bounds are in the frame of the viewer, whose y axis points down.
    fn spatial(&mut self, name: &str, contents: &[&str]) -> RecordingStreamResult<Part> {
        let view = self.view("2D", name, contents)?;
        let (from, size) = extent(&self.scene.frame);
        let margin = MARGIN * size.x;
        let bounds = datatypes::Range2D {
            x_range: [from.x - margin, from.x + size.x + margin].into(),
            y_range: [-from.y - size.y - margin, -from.y + margin].into(),
        };
        self.property(&view, &blueprint::VisualBounds2D::new(bounds))?;
        let background = blueprint::Background::new(BackgroundKind::SolidColor);
        self.property(&view, &background.with_color(rerun::Color::from(GROUND)))?;
        Ok(view)
    }

    fn scene(&mut self) -> RecordingStreamResult<Part> {
        let scene = self.scene;
        let name = format!("The map so far: {}", scene.title);
        let contents = ["+ /world/**", "- /world/maps/**", "+ /world/maps/occupancy/**"];
        let part = self.spatial(&name, &contents)?;
        // Nanoseconds of the curious robot's trail: all of it would hide the map.
        let recent = TimeRangeBoundary::CursorRelative(TimeInt(-300 * 1_000_000_000));
        for robot in &scene.robots {
            let start = if robot.is_driven { recent } else { past().start };
            let range = TimeRange { start, ..past() };
            let range = VisibleTimeRange(datatypes::VisibleTimeRange { timeline: SIM_TIME.into(), range });
            let trail = tracks::robot(&robot.name, "trail");
            let path = format!("{}/ViewContents/overrides{trail}/visualizers", part.path);
            self.stream.log(path, &blueprint::VisibleTimeRanges::new([range]))?;
        }
        Ok(part)
    }

    fn map(&mut self, layer: Layer) -> RecordingStreamResult<Part> {
        let contents = format!("+ {}/**", tracks::map(layer));
        self.spatial(layer.title(), &[&contents])
    }

    fn log(&mut self) -> RecordingStreamResult<Part> {
        let view = self.view("TextLog", "What happened", &[tracks::LOG])?;
        let timeline = SIM_TIME.into();
        let columns = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body];
        let columns = blueprint::TextLogColumns::new()
            .with_timeline_columns([TimelineColumn { visible: true.into(), timeline }])
            .with_text_log_columns(columns.map(|kind| TextLogColumn { kind, visible: true.into() }));
        self.property(&view, &columns)?;
        Ok(view)
    }

    fn curves(&mut self) -> RecordingStreamResult<Vec<Part>> {
        let mut views = Vec::new();
        for plot in plots(self.view) {
            let view = self.view("TimeSeries", plot.title, &[&format!("+ {}/**", plot.path)])?;
            self.property(&view, &blueprint::PlotLegend::new().with_corner(Corner2D::LeftTop))?;
            self.property(&view, &blueprint::TimeAxis::new().with_view_range(past()))?;
            if let Some(range) = plot.range {
                let range = rerun::components::Range1D::from(range);
                self.property(&view, &blueprint::ScalarAxis::new().with_range(range))?;
            }
            views.push(view);
        }
        if has_choice(self.view) {
            let contents = format!("+ {}/**", tracks::STRATEGY);
            views.push(self.view("StateTimeline", "Strategy that chose the goal", &[&contents])?);
        }
        Ok(views)
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
            .with_timeline(SIM_TIME)
            .with_play_state(PlayState::Following);
        self.stream.log("time_panel", &time)
    }
}

/// From the start to what is shown.
fn past() -> TimeRange {
    TimeRange { start: TimeRangeBoundary::Absolute(TimeInt(0)), end: TimeRangeBoundary::AT_CURSOR }
}
