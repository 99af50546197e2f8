//! `--frames`: the frames of an animation. Each is a picture, written as soon as it is rendered, and complete ones are
//! kept, so the same command continues an interrupted run. Runs in one directory share the frames.

use super::files::Files;
use super::picture::{self, Screen};
use super::studio::Studio;
use super::summary::with_recipe;
use super::{BatchOptions, Line, Output, check_before, ended, report};
use crate::film::{SOFTWARE, key};
use crate::job::output::OutputFormat;
use crate::job::saved::is_whole_frame;
use crate::progressive::describe::{counted, seconds};
use crate::scene::animation::CameraPath;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::make_directory;
use crate::system::interrupt::Interrupt;
use anyhow::{Context, Result};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Options of `--batch --frames`.
#[derive(Debug)]
pub struct FramesOptions {
    /// The picture of each frame, except for its camera. Its output has a pattern for a name.
    pub picture: BatchOptions,
    /// How the camera moves. The camera of every frame is valid.
    pub path: CameraPath,
    /// Numbers of the frames, at least one.
    pub frames: Range<u32>,
    /// The files of the frames.
    pub names: FrameNames,
}

impl FramesOptions {
    /// The picture of a frame. All frames share the scene, so it is validated and prepared once if the camera allows.
    fn at(&self, frame: u32) -> Result<BatchOptions> {
        let FramesOptions { picture, path, names, .. } = self;
        let recipe = picture.recipe.at_frame(path, frame);
        let job = picture.job.seen_by(recipe.camera, *picture.job.settings())?;
        let output = |output: &Output| Output { path: names.path(frame), ..output.clone() };
        let outputs = picture.outputs.iter().map(output).collect();
        Ok(BatchOptions { recipe, job, outputs, frame: Some(frame), ..picture.clone() })
    }

    /// Checks the camera of every frame. Returns a warning if the picture turns over on the way.
    ///
    /// # Errors
    /// The first frame that cannot be rendered, and why.
    pub fn check(&self) -> Result<Option<String>> {
        let FramesOptions { picture: BatchOptions { job, .. }, path, frames, .. } = self;
        for frame in frames.clone() {
            job.seen_by(path.camera(frame), *job.settings()).with_context(|| format!("frame {frame}"))?;
        }
        let turns_over = |frame: &u32| {
            let [before, after] = [*frame, frame + 1].map(|frame| path.camera(frame).basis());
            before.w.dot(after.w) > LEAST_COSINE && before.u.dot(after.u) < LEAST_COSINE
        };
        let mut turns = (frames.start..frames.end - 1).filter(turns_over);
        let first = turns.next().filter(|_| matches!(path, CameraPath::Keyframes(_)));
        Ok(first.map(|first| {
            let last = turns.next_back().unwrap_or(first) + 1;
            format!(
                "the picture turns over between the frames {first} and {last}: the camera passes over or under its \
                 look_at, where vup no longer tells which way is up; give the keyframes around them a vup of their own"
            )
        }))
    }
}

/// Of 30 degrees: a picture that turns more about its centre from one frame to the next, though the camera looks in
/// nearly the same direction, turns over.
const LEAST_COSINE: f64 = 0.866;

/// Pause before frames are looked at again that another run renders.
const PAUSE: Duration = Duration::from_millis(100);

/// Renders the missing frames. A signal drops the frame in progress.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered; [`Failure::BrokeOff`] if a render failed but earlier frames are
/// complete; [`Failure::Run`] otherwise.
pub fn render_frames(options: FramesOptions) -> Result<ExitCode, Failure> {
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut run = Run::new(&options, &interrupt)?;
    let failure = run.render_all(|_| {}).err();
    run.screen.display.clear();
    let figures = report(&run.json(), &LINES, &options.picture);
    if failure.is_none() && !run.is_done() {
        console::note("run the same command again to continue");
    }
    ended(failure, figures, &interrupt)
}

/// Renders the missing frames until `interrupt` is set, like [`render_frames`]. `look` gets the number of frames that are
/// done.
///
/// # Errors
/// Those of [`render_frames`].
pub fn write_frames(
    options: &FramesOptions,
    interrupt: &Interrupt,
    look: impl FnMut(u32),
) -> Result<(), Failure> {
    Run::new(options, interrupt)?.render_all(look)
}

const LINES: [Line; 4] = [
    ("scene", &["{scene}, {width}x{height}, {samples_per_pixel} samples per pixel"]),
    ("frames", &["{frames_done} of {frames} done: {rendered} rendered, {kept} already there"]),
    ("time", &["{total_seconds}, {rendering_seconds} of it for the frames rendered"]),
    ("files", &["{first_file} to {last_file}"]),
];

/// An animation in progress.
struct Run<'a> {
    options: &'a FramesOptions,
    interrupt: &'a Interrupt,
    studio: Studio<'a>,
    screen: Screen,
    begin: Instant,
    /// The frames that are there.
    done: BTreeSet<u32>,
    /// How many of them this run has rendered, and how long that took.
    rendered: usize,
    rendering: Duration,
}

impl<'a> Run<'a> {
    /// Checks what could otherwise fail after rendering.
    fn new(options: &'a FramesOptions, interrupt: &'a Interrupt) -> Result<Self, Failure> {
        let FramesOptions { picture, frames, names, .. } = options;
        let warning = options.check().map_err(Failure::Input)?;
        make_directory(&names.directory).map_err(Failure::Input)?;
        check_before(&options.at(frames.start).map_err(Failure::Input)?)?;
        let mut screen = Screen::new(picture, frames.len() as u64);
        warning.iter().for_each(|warning| screen.warn(warning));
        let studio = Studio::open(&picture.backend, interrupt)?;
        let (begin, rendering, done) = (Instant::now(), Duration::ZERO, BTreeSet::new());
        Ok(Run { options, interrupt, studio, screen, begin, done, rendered: 0, rendering })
    }

    fn render_all(&mut self, mut look: impl FnMut(u32)) -> Result<(), Failure> {
        loop {
            for frame in self.options.frames.clone() {
                look(self.done.len() as u32);
                if self.interrupt.is_set() {
                    return Ok(());
                }
                if !self.done.contains(&frame) && self.finish(frame)? {
                    self.done.insert(frame);
                }
            }
            if self.is_done() {
                return Ok(());
            }
            std::thread::sleep(PAUSE);
        }
    }

    fn is_done(&self) -> bool {
        self.done.len() == self.options.frames.len()
    }

    /// Renders and writes a frame, unless it is there. Returns `false` after a signal, or if another run renders it.
    fn finish(&mut self, frame: u32) -> Result<bool, Failure> {
        let options = self.options.at(frame).map_err(Failure::Run)?;
        let (file, until) = (self.options.names.path(frame), options.until());
        let Ok(files) = Files::lock(options, Duration::ZERO) else { return Ok(false) };
        if is_whole_frame(&file, &files.options.recipe, SOFTWARE, (key::UNTIL, &until)) {
            return Ok(true);
        }
        let is_undescribed = |Output { path, format, .. }: &Output| {
            matches!(format, OutputFormat::P6 | OutputFormat::Pfm) && path.exists()
        };
        if files.options.outputs.iter().any(is_undescribed) {
            self.screen.warn(
                "frames that are there are rendered again: PPM and PFM cannot record how a frame was made, as PNG and EXR do",
            );
        }
        let (begin, done, count) = (Instant::now(), self.done.len(), self.options.frames.len());
        let per_frame = self.rendering.checked_div(self.rendered as u32);
        let left = per_frame.map(|time| time.as_secs_f64() * (count - done) as f64);
        let left = left.map_or_else(String::new, |left| format!(", {} left", seconds(left)));
        let (rendered, outcome) = picture::render(
            &Arc::new(files),
            None,
            &mut self.screen,
            &mut self.studio,
            self.interrupt,
            |display, status| {
                display.update(done as u64, || {
                    let samples = status.samples_per_pixel;
                    format!("frame {frame}: {done} of {count} frames done, {samples} spp{left}")
                });
            },
        );
        outcome.map_err(|failure| match failure {
            Failure::Run(error) if done > 0 => {
                let done = counted(done as u64, "frame");
                Failure::BrokeOff(error.context(format!(
                    "frame {frame} failed; {done} are kept; run the same command again to continue"
                )))
            }
            failure => failure,
        })?;
        if rendered.written.files.is_empty() {
            return Ok(false);
        }
        self.rendered += 1;
        self.rendering += begin.elapsed();
        Ok(true)
    }

    fn json(&self) -> Value {
        let FramesOptions { picture: BatchOptions { recipe, .. }, frames, names, .. } = self.options;
        let file = |end: Option<&u32>| Some(names.path(*end?).to_string_lossy().into_owned());
        let figures = json!({
            "samples_per_pixel": recipe.samples_per_pixel,
            "first_frame": frames.start,
            "last_frame": frames.end - 1,
            "frames": frames.len(),
            "frames_done": self.done.len(),
            "rendered": self.rendered,
            "kept": self.done.len() - self.rendered,
            "rendering_seconds": self.rendering.as_secs_f64(),
            "total_seconds": self.begin.elapsed().as_secs_f64(),
            "directory": names.directory.to_string_lossy(),
            "first_file": file(self.done.first()),
            "last_file": file(self.done.last()),
            "warnings": self.screen.warnings,
        });
        with_recipe(recipe, figures)
    }
}

/// Where an animation's frames are: a directory, and a name with a place for the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub directory: PathBuf,
    name: String,
}

impl FrameNames {
    /// Names from a pattern such as `shots/turn-####.png`, whose `#` signs stand for the number and its minimum digits.
    /// `None` unless the file name has exactly one run of them.
    pub fn of_pattern(pattern: &Path) -> Option<FrameNames> {
        let name = pattern.file_name()?.to_str()?;
        let place = place(name);
        let is_one = !place.is_empty() && place.bytes().all(|sign| sign == b'#');
        is_one.then(|| FrameNames {
            directory: pattern.parent().map(Path::to_owned).unwrap_or_default(),
            name: name.to_owned(),
        })
    }

    pub fn path(&self, frame: u32) -> PathBuf {
        let place = place(&self.name);
        let number = format!("{frame:0digits$}", digits = place.len());
        self.directory.join(self.name.replace(place, &number))
    }
}

/// A name from its first `#` to its last.
fn place(name: &str) -> &str {
    name.trim_matches(|sign| sign != '#')
}
