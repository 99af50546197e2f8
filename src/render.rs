//! What every backend renders and how it is asked: [`RenderJob`] and the [`Renderer`] trait.
//!
//! **A sample is a pure function** of (job, pixel, sample index). It does not depend on the backend, the packet
//! width, the thread, its neighbours or what was rendered before. Everything else rests on that.

mod settings;

pub use settings::{NamedSetting, RenderSettings, SamplerKind, SettingValue};

pub use crate::film::{SAMPLE_LIMIT, SIZE_LIMIT};

use crate::film::Film;
use crate::memory::{self, MemoryError};
use crate::scene::{Camera, Scene, SceneError};
use crate::stages::Rules;
use serde::Serialize;
use std::any::Any;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use thiserror::Error;

/// Largest number of rays a path may have.
pub const DEPTH_LIMIT: u32 = 10_000;

/// What a pixel takes besides its sums while the picture is written.
const OUTPUT_BYTES_PER_PIXEL: u64 = 4;

/// What a sphere takes besides its place in the scene: prepared scene, hierarchy, and what building them takes at its peak.
pub const TRACING_BYTES_PER_SPHERE: u64 = 400;

/// A picture to be rendered, checked once. Two equal jobs have the same samples.
#[derive(Clone, Debug)]
pub struct RenderJob {
    scene: Arc<Scene>,
    camera: Camera,
    settings: RenderSettings,
    rules: Rules,
}

impl PartialEq for RenderJob {
    /// Scenes that are one in memory are not compared sphere by sphere.
    fn eq(&self, other: &Self) -> bool {
        (self.camera, self.settings, self.rules) == (other.camera, other.settings, other.rules)
            && (Arc::ptr_eq(&self.scene, &other.scene) || self.scene == other.scene)
    }
}

impl RenderJob {
    /// Checks everything that a backend relies on.
    ///
    /// # Errors
    /// The first thing that is wrong, with its value, its limit and what to do.
    pub fn new(
        scene: impl Into<Arc<Scene>>,
        camera: Camera,
        settings: RenderSettings,
        rules: Rules,
    ) -> Result<Self, JobError> {
        let scene = scene.into();
        scene.validate()?;
        RenderJob { scene, camera, settings, rules }.seen_by(camera, settings)
    }

    /// The same scene under the same rules, seen by another camera or in another size: the scene is shared, and
    /// not checked again.
    ///
    /// # Errors
    /// The first thing that is wrong with the camera or the settings.
    pub fn seen_by(&self, camera: Camera, settings: RenderSettings) -> Result<Self, JobError> {
        camera.validate()?;
        for (what, pixels) in [("width", settings.width), ("height", settings.height)] {
            if !(1..=SIZE_LIMIT).contains(&pixels) {
                return Err(JobError::Size { what, pixels });
            }
        }
        if !(1..=DEPTH_LIMIT).contains(&settings.max_depth) {
            return Err(JobError::Depth { depth: settings.max_depth });
        }
        Ok(RenderJob { scene: Arc::clone(&self.scene), camera, settings, rules: self.rules })
    }

    /// Whether both have one scene in memory, under the same rules.
    pub fn shares_scene_with(&self, other: &RenderJob) -> bool {
        Arc::ptr_eq(&self.scene, &other.scene) && self.rules == other.rules
    }

    /// Spheres, materials and sky.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Size, depth, sampler, seed, halves.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The rules in force.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// An empty film for this job.
    pub fn new_film(&self) -> Film {
        Film::new(self.settings.width, self.settings.height, self.settings.half_count())
    }

    /// Refuses a job that would not fit into memory with `films` films of its size, while it is prepared, traced and
    /// written.
    ///
    /// # Errors
    /// [`MemoryError`], with what to do.
    pub fn check_memory(&self, films: u64) -> Result<(), MemoryError> {
        let RenderSettings { width, height, .. } = self.settings;
        let film = Film::bytes(width, height, self.settings.half_count()).saturating_mul(films);
        let output = u64::from(width) * u64::from(height) * OUTPUT_BYTES_PER_PIXEL;
        let spheres = self.scene.spheres.len();
        let remedy = match self.settings.half_count() {
            1 => "choose a smaller --size, or a scene of fewer spheres",
            _ => {
                "choose a smaller --size, or halve the film with --estimate-error off, or choose a scene of fewer spheres"
            }
        };
        memory::check(
            || format!("a picture of {width}x{height} of {spheres} spheres"),
            film.saturating_add(output).saturating_add(TRACING_BYTES_PER_SPHERE * spheres as u64),
            remedy,
        )
    }

    /// Whether a film has the shape of this job's.
    pub fn fits(&self, film: &Film) -> bool {
        let RenderSettings { width, height, .. } = self.settings;
        (film.width(), film.height(), film.halves().len()) == (width, height, self.settings.half_count())
    }
}

/// A job that cannot be rendered.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum JobError {
    /// The scene or camera.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The picture's size.
    #[error(
        "the picture's {what} is {pixels} pixels, but must be within 1 and {SIZE_LIMIT}; choose a smaller picture or stitch several"
    )]
    Size {
        /// "width" or "height".
        what: &'static str,
        /// Pixels.
        pixels: u32,
    },
    /// The depth.
    #[error("max_depth is {depth}, but must be within 1 and {DEPTH_LIMIT} rays a path; 50 is the book's")]
    Depth {
        /// Rays a path.
        depth: u32,
    },
}

/// What a call to [`Renderer::accumulate`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Paths that were finished: pixels times samples.
    pub paths: u64,
    /// Rays that were traced.
    pub rays: u64,
    /// Samples that were NaN, infinite or negative.
    pub rejected: u64,
    /// Lanes that traced a ray, over all intersections of packets.
    pub busy_lanes: u64,
    /// Lanes there were, over all intersections of packets.
    pub offered_lanes: u64,
    /// Wall time of tracing.
    pub trace: Duration,
}

impl Stats {
    /// Adds another call's figures.
    pub fn add(&mut self, other: &Stats) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.rejected += other.rejected;
        self.busy_lanes += other.busy_lanes;
        self.offered_lanes += other.offered_lanes;
        self.trace += other.trace;
    }
}

/// How full the packets were in each tile of a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TileOccupancy {
    /// Side of a tile, pixels.
    pub side: u32,
    /// Tiles in a row.
    pub columns: u32,
    /// Lanes that traced a ray, and lanes there were, over all intersections; row by row from the top.
    pub tiles: Vec<[u64; 2]>,
}

impl TileOccupancy {
    /// Share of lanes in use in the tile of a pixel, `0..=1`; `None` where nothing has been traced.
    pub fn share_at(&self, [x, y]: [u32; 2]) -> Option<f64> {
        let side = self.side.max(1);
        let [busy, offered] = *self.tiles.get((y / side * self.columns + x / side) as usize)?;
        (offered > 0).then(|| busy as f64 / offered as f64)
    }
}

/// Why samples could not be added.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The caller asked to stop in the middle. The film's sums are then of no use.
    #[error("cancelled")]
    Cancelled,
    /// The backend failed; another can go on from the last good film.
    #[error("{backend} failed: {reason}")]
    Backend {
        /// Its name.
        backend: &'static str,
        /// What it said.
        reason: String,
    },
    /// The backend failed in the middle of adding, and what it had added could not be taken away again: the film is of
    /// no use.
    #[error("{backend} failed: {reason}; the samples that it was adding spoiled the film")]
    FilmLost {
        /// Its name.
        backend: &'static str,
        /// What it said.
        reason: String,
    },
    /// The same samples were asked for twice.
    #[error(transparent)]
    Film(#[from] crate::film::FilmError),
}

impl RenderError {
    /// What a panic of a backend's is to others.
    pub fn of_panic(backend: &'static str, payload: &(dyn Any + Send)) -> Self {
        RenderError::Backend { backend, reason: format!("it panicked: {}", panic_text(payload)) }
    }
}

/// What a panic said.
pub fn panic_text(payload: &(dyn Any + Send)) -> &str {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("for no stated reason")
}

/// What a backend is, for reports.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BackendInfo {
    /// "cpu", "reference" or "gpu".
    pub name: &'static str,
    /// The instruction level or the adapter.
    pub device: String,
    /// Paths that advance in step.
    pub lanes: usize,
    /// Threads.
    pub threads: usize,
}

/// Adds samples to a film.
pub trait Renderer: Send {
    /// What this is.
    fn info(&self) -> BackendInfo;

    /// Who added the samples of the last [`Renderer::accumulate`], which were `added` a pixel. One renderer alone
    /// added them all.
    fn credits(&self, added: u64) -> Vec<(BackendInfo, u64)> {
        vec![(self.info(), added)]
    }

    /// What the user should know and has not been told: a software adapter in use, a part that failed.
    fn take_messages(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Wall time that building the prepared job's hierarchy took; zero where there is none.
    fn hierarchy_time(&self) -> Duration {
        Duration::ZERO
    }

    /// What the device spent on all dispatches since this was made, by its own clock; `None` without one.
    fn device_time(&self) -> Option<Duration> {
        None
    }

    /// What the prepared job's kernel contains, and what making it took, in words.
    fn kernel(&self) -> String {
        String::new()
    }

    /// How full the packets were since the prepared job's first pass; `None` if it traces without packets.
    fn tile_occupancy(&self) -> Option<TileOccupancy> {
        None
    }

    /// Begins a film of `job`: builds what tracing it needs (prepared scene, hierarchy, kernels), unless that is there, and
    /// forgets what was traced and not collected.
    ///
    /// `cancel` is looked at while kernels are compiled.
    ///
    /// # Errors
    /// [`RenderError::Backend`] if the backend cannot render this job, [`RenderError::Cancelled`].
    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError>;

    /// Adds samples `range` of every pixel to `film` and records them there. Prepares if need be.
    ///
    /// `cancel` is looked at between small units of work.
    ///
    /// # Errors
    /// [`RenderError::Cancelled`] and [`RenderError::FilmLost`] leave the film's sums incomplete: throw it away. After
    /// any other error it is as it was, and so it is after a panic: whoever adds to it in pieces catches panics and
    /// takes the pieces away again.
    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError>;

    /// As [`Renderer::accumulate`], but need not wait for the results: samples may stay with the renderer and be
    /// added to the same film by a later call. The film records those that it has, and the figures are of those
    /// that this call added to it.
    ///
    /// # Errors
    /// As [`Renderer::accumulate`]; samples that are not in the film are then lost.
    fn advance(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.accumulate(job, range, film, cancel)
    }

    /// Sends for what was traced so far: the next [`Renderer::advance`] adds it to the film while it traces.
    ///
    /// # Errors
    /// [`RenderError::Backend`].
    fn fetch(&mut self) -> Result<(), RenderError> {
        Ok(())
    }

    /// Adds to the film all that was traced and is not in it; waits for it.
    ///
    /// # Errors
    /// [`RenderError::Backend`]; samples that are not in the film are then lost.
    fn collect(&mut self, _film: &mut Film) -> Result<Stats, RenderError> {
        Ok(Stats::default())
    }
}
