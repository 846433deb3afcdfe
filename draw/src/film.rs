//! A moving picture of a run: the map with the robots on the left, and how often its cells change on the right.

use crate::canvas::{Area, Canvas, Drawn, PictureError, ink, px, why};
use crate::layers::Layer;
use crate::outline::field_of_view;
use crate::palette::{self, Rgb};
use crate::panel::{Chart, Panel, pair};
use crate::plan::NamedLine;
use crate::scene::Scene;
use crate::trajectory::line;
use crate::view::{Trail, View};
use crate::{legend, plan};
use files::UnfinishedFile;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use mapper::{Door, Mapper};
use plotters::prelude::*;
use results::numbers::duration;
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// The number of frames.
const FRAMES: u32 = 130;
/// The share of the run before the first frame, which sites show as a preview: a room is known then.
const BEGIN: f64 = 0.02;
/// The duration of a frame, and of the last frame, 1/100 s.
const DELAY: u16 = 10;
const LAST_DELAY: u16 = 250;
/// The color index of a pixel that is as in the frame before.
const SAME: u8 = 255;

/// The frames so far of a moving picture.
pub struct Film {
    file: UnfinishedFile,
    scene: Scene,
    duration_s: f64,
    panels: [Panel; 2],
    colors: Colors,
    frames: Vec<Frame<'static>>,
    /// The color indices of the last frame.
    last: Vec<u8>,
}

impl Film {
    /// A moving picture of a run in `scene`, to be written to a GIF file.
    pub fn new(file: UnfinishedFile, scene: Scene, duration_s: f64) -> Self {
        let panels = [false, true].map(|has_bar| Panel::of_film(&scene.frame, has_bar));
        Self {
            file,
            scene,
            duration_s,
            panels,
            colors: Colors::default(),
            frames: Vec::new(),
            last: Vec::new(),
        }
    }

    /// Adds the present state of the run, with the trails of the robots. Frames are frequent at the start, when
    /// most of the map is new, and rare at the end.
    ///
    /// # Errors
    ///
    /// When a frame cannot be drawn.
    pub fn add(&mut self, view: &View, trails: &[Trail]) -> Result<(), PictureError> {
        let part = self.frames.len() as f64 / f64::from(FRAMES - 1);
        let due = BEGIN + (1.0 - BEGIN) * part * part.sqrt();
        if view.time_s < self.duration_s * due || self.frames.len() >= FRAMES as usize {
            return Ok(());
        }
        let size = self.size();
        let canvas = Canvas::draw(size, |area| self.draw(area, view, trails));
        let canvas = canvas.map_err(|why| PictureError::Draw { name: "the moving picture".into(), why })?;
        let pixels = canvas.pixels.as_chunks::<3>().0;
        if self.frames.is_empty() {
            self.colors = Colors::of(pixels);
        }
        let colors = &mut self.colors;
        let indices: Vec<u8> = pixels.iter().map(|&color| colors.index(color)).collect();
        self.frames.push(difference(&self.last, &indices, size));
        self.last = indices;
        Ok(())
    }

    /// Writes the file; the picture repeats forever.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn write(mut self) -> Result<(), PictureError> {
        if let Some(last) = self.frames.last_mut() {
            last.delay = LAST_DELAY;
        }
        let [width, height] = self.size().map(|length| length as u16);
        let colors: Vec<u8> = self.colors.all.iter().flatten().copied().collect();
        let frames = self.frames;
        let write = |to: &mut dyn Write| -> Result<(), gif::EncodingError> {
            let mut encoder = Encoder::new(to, width, height, &colors)?;
            encoder.set_repeat(Repeat::Infinite)?;
            frames.iter().try_for_each(|frame| encoder.write_frame(frame))
        };
        Ok(self.file.write(|to| write(to).map_err(io::Error::other))?)
    }

    /// Width and height, pixels.
    fn size(&self) -> [u32; 2] {
        let [[left, height], [right, other]] = self.panels.map(|panel| panel.size());
        [left + right, height.max(other)]
    }

    fn draw(&self, area: &Area, view: &View, trails: &[Trail]) -> Drawn {
        let [left, right] = &self.panels;
        let (first, second) = area.split_horizontally(px(left.size()[0]));
        let time_s = view.time_s as u64;
        let title = format!("{}: the map after {} min {:02} s", self.scene.title, time_s / 60, time_s % 60);
        let (chart, legend) = left.axes(&first, &title)?;
        left.cells(&chart, Layer::Occupancy, &Layer::Occupancy.classes(view.mapper))?;
        self.robots(left, &chart, view, trails)?;
        left.frame(&chart)?;
        left.legend(&legend, &legend::of_run(&self.scene, view))?;
        let chart = right.layer(&second, view.mapper, Layer::Interval)?;
        plan::lines(right, &chart, &doors(view.mapper))
    }

    /// Draws what is on the map: the field of view, what moves, the plan, and the robots with their trails.
    fn robots(
        &self,
        panel: &Panel,
        chart: &Chart<impl DrawingBackend>,
        view: &View,
        trails: &[Trail],
    ) -> Drawn {
        let plot = chart.plotting_area();
        if let Some(reading) = view.sight() {
            let corners: Vec<(f64, f64)> = field_of_view(reading).iter().map(pair).collect();
            plot.draw(&Polygon::new(corners, ink(palette::SENSOR).mix(0.25).filled())).map_err(why)?;
        }
        for (obstacle, outline) in self.scene.obstacles.iter().zip(&view.obstacles) {
            if let Some(outline) = outline.as_ref().filter(|_| !obstacle.is_fixed()) {
                plan::fill(chart, outline, palette::MOVING)?;
            }
        }
        for (robot, trail) in self.scene.robots.iter().zip(trails) {
            line(panel, chart, &Vec::from_iter(trail.recent()), (robot.color(), 3))?;
        }
        line(panel, chart, view.path, (palette::PATH, 3))?;
        if let Some(goal) = view.goal {
            let goal = plot.map_coordinate(&pair(&goal));
            panel.pen.dot(&plot.use_screen_coord(), goal, palette::GOAL)?;
        }
        for (robot, state) in self.scene.robots.iter().zip(&view.robots) {
            plan::draw_robot(panel, chart, robot, &state.pose, robot.radius_m)?;
        }
        Ok(())
    }
}

/// The doors that opened twice in view, each with how often it opens.
fn doors(mapper: &Mapper) -> Vec<NamedLine> {
    let door = |door: &Door| {
        let name = format!("door: every {}", duration(3600.0 / door.openings_per_hour().0));
        (door.evidence().events()[1] >= 2).then_some(NamedLine { ends: door.closed.ends, name })
    };
    mapper.doors().iter().filter_map(door).collect()
}

/// The part of a picture that differs from the picture before.
fn difference(before: &[u8], now: &[u8], [width, height]: [u32; 2]) -> Frame<'static> {
    let width = width as usize;
    let is_new = |at: usize| before.get(at) != Some(&now[at]);
    let changed: Vec<usize> = (0..now.len()).filter(|&at| is_new(at)).collect();
    let rows = changed.first().map_or(0..1, |first| first / width..changed[changed.len() - 1] / width + 1);
    let buffer = (rows.start * width..rows.end * width).map(|at| if is_new(at) { now[at] } else { SAME });
    debug_assert!(rows.end <= height as usize);
    Frame {
        delay: DELAY,
        dispose: DisposalMethod::Keep,
        transparent: Some(SAME),
        top: rows.start as u16,
        width: width as u16,
        height: rows.len() as u16,
        buffer: buffer.collect::<Vec<u8>>().into(),
        ..Frame::default()
    }
}

/// The colors of a film: the most frequent ones of its first frame, whose maps, color bar and legends have all that matter.
#[derive(Default)]
struct Colors {
    all: Vec<Rgb>,
    /// The nearest of all colors.
    known: BTreeMap<Rgb, u8>,
}

impl Colors {
    fn of(pixels: &[Rgb]) -> Self {
        let mut counts: BTreeMap<Rgb, usize> = BTreeMap::new();
        pixels.iter().for_each(|color| *counts.entry(*color).or_default() += 1);
        let mut all: Vec<Rgb> = counts.keys().copied().collect();
        all.sort_by_key(|color| Reverse(counts[color]));
        all.truncate(usize::from(SAME));
        Self { all, known: BTreeMap::new() }
    }

    fn index(&mut self, color: Rgb) -> u8 {
        let distance = |other: &Rgb| -> u32 {
            color.iter().zip(other).map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2)).sum()
        };
        *self.known.entry(color).or_insert_with(|| {
            let nearest = self.all.iter().enumerate().min_by_key(|(_, other)| distance(other));
            nearest.map_or(0, |(index, _)| index as u8)
        })
    }
}
