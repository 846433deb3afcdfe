//! Everything that shows one run: the recording, the moving picture, and the pictures at the end.

use crate::recording::{Recorder, RecordingError};
use draw::Film;
use draw::canvas::PictureError;
use draw::layers::Layer;
use draw::pictures::{self, Trails};
use draw::scene::Scene;
use draw::view::{Trail, View};
use interfaces::GridFrame;
use mapper::Mapper;
use nalgebra::Isometry2;
use results::thinned::Goals;
use std::path::Path;

/// Shows a run, and keeps the trails of its robots.
pub struct Show {
    scene: Scene,
    trails: Vec<Trail>,
    /// The trail of where the curious robot believed to be; empty if its poses are exact.
    believed: Trail,
    recorder: Option<Recorder>,
    film: Option<Film>,
}

/// The error for a recording or a film that cannot continue. The run does.
#[derive(Debug, thiserror::Error)]
pub enum ShowError {
    /// The recording cannot continue.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A picture cannot be made.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl Show {
    /// Shows a run in `scene` to a recorder, in a film, in both or in none of them.
    pub fn new(scene: Scene, recorder: Option<Recorder>, film: Option<Film>) -> Self {
        let trails = vec![Trail::default(); scene.robots.len()];
        Self { scene, trails, believed: Trail::default(), recorder, film }
    }

    /// Adds a pose of the curious robot from before this run to its trail.
    pub fn pass(&mut self, pose: &Isometry2<f64>) {
        self.trails.iter_mut().take(1).for_each(|trail| trail.push(pose.translation.vector.into()));
    }

    /// The pictures show the place as large as this, because the run has ended before it knew more.
    pub fn end_in(&mut self, frame: GridFrame) {
        self.scene.frame = frame;
    }

    /// Shows the run as it is now. The last view closes the recording.
    ///
    /// # Errors
    ///
    /// When the recording cannot be written, or a frame of the film cannot be drawn. Each is reported once: the
    /// recording or the film is given up then, and everything else goes on.
    pub fn add(&mut self, view: &View, is_last: bool) -> Result<(), ShowError> {
        for (trail, robot) in self.trails.iter_mut().zip(&view.robots) {
            trail.push(robot.pose.translation.vector.into());
        }
        if let Some(belief) = view.belief {
            self.believed.push(belief.pose.translation.vector.into());
        }
        let recorded = self.recorder.as_mut().map_or(Ok(()), |recorder| recorder.log(view, is_last));
        if recorded.is_err() {
            // A viewer shows the run without the file.
            self.recorder.take_if(|recorder| !recorder.is_live());
        }
        let filmed = self.film.as_mut().map_or(Ok(()), |film| film.add(view, &self.trails));
        if filmed.is_err() {
            self.film = None;
        }
        recorded?;
        Ok(filmed?)
    }

    /// Why a viewer does not show the run, or no longer shows it. The file is not affected.
    pub fn live_problem(&self) -> Option<String> {
        self.recorder.as_ref()?.live_problem()
    }

    /// Writes the pictures into `folder`: of these layers, and of the trails.
    ///
    /// # Errors
    ///
    /// When a picture cannot be drawn or written.
    pub fn write_pictures(
        &self,
        folder: &Path,
        mapper: &Mapper,
        goals: &Goals,
        layers: &[Layer],
    ) -> Result<(), PictureError> {
        pictures::write_all(
            folder,
            &self.scene,
            mapper,
            &Trails { true_poses: &self.trails, believed: &self.believed },
            goals,
            layers,
        )
    }

    /// Writes the film to its file, if there is one.
    ///
    /// # Errors
    ///
    /// When the film cannot be written.
    pub fn write_film(self) -> Result<(), PictureError> {
        self.film.map_or(Ok(()), Film::write)
    }
}
