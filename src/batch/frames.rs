//! `--frames`: the frames of an animation. Each is written as soon as it is rendered, and complete ones are kept, so
//! the same command continues an interrupted run.

use super::picture::display;
use super::studio::{Event, Studio};
use super::{Line, ended, report};
use crate::backends::BackendChoice;
use crate::film::key;
use crate::job::output::write_image;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::job::saved::is_whole_frame;
use crate::progressive::Phase;
use crate::progressive::describe::{SOFTWARE, counted, describe, seconds};
use crate::scene::animation::CameraPath;
use crate::stages::Stage;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{ShownPath, check_writable, make_directory};
use crate::system::interrupt::Interrupt;
use crate::system::journal;
use crate::system::terminal::{Display, ProgressChoice};
use anyhow::{Context, Result, anyhow};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Options of `--batch --frames`.
#[derive(Debug)]
pub struct FramesOptions {
    /// The scene and its settings. Each frame replaces its camera.
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// How the camera moves. The camera of every frame is valid.
    pub path: CameraPath,
    /// Numbers of the frames, at least one.
    pub frames: Range<u32>,
    /// The files of the frames.
    pub names: FrameNames,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<PathBuf>,
    /// The command line, as files record it; `None` in the window.
    pub command: Option<String>,
}

impl FramesOptions {
    /// Checks the camera of every frame.
    ///
    /// # Errors
    /// The first frame that cannot be rendered, and why.
    pub fn check(&self) -> Result<()> {
        let FramesOptions { job, path, frames, .. } = self;
        for frame in frames.clone() {
            job.seen_by(path.camera(frame), *job.settings()).with_context(|| format!("frame {frame}"))?;
        }
        Ok(())
    }
}

/// Renders the missing frames. A signal drops the frame in progress.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered; [`Failure::BrokeOff`] if a render failed but earlier frames are
/// complete; [`Failure::Run`] otherwise.
pub fn render_frames(options: FramesOptions) -> Result<ExitCode, Failure> {
    check(&options)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut run = Run::new(&options, &interrupt);
    let failure = match run.render_all(|_| {}) {
        Err(failure @ Failure::Input(_)) => return Err(failure),
        outcome => outcome.err(),
    };
    run.display.clear();
    let figures = report(&run.json(), &LINES, options.json.as_deref(), None);
    if failure.is_none() && run.done() < options.frames.len() as u32 {
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
    check(options)?;
    Run::new(options, interrupt).render_all(look)
}

fn check(options: &FramesOptions) -> Result<(), Failure> {
    make_directory(&options.names.directory).map_err(Failure::Input)?;
    let first = options.names.path(options.frames.start);
    for path in [Some(first.as_path()), options.json.as_deref()].into_iter().flatten() {
        check_writable(path).map_err(Failure::input)?;
    }
    options.job.check_memory(1, 0).map_err(Failure::input)
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
    display: Display,
    begin: Instant,
    rendered: u32,
    kept: u32,
    rendering: Duration,
    warnings: Vec<String>,
}

impl<'a> Run<'a> {
    fn new(options: &'a FramesOptions, interrupt: &'a Interrupt) -> Self {
        Run {
            options,
            interrupt,
            display: display(options.progress, options.frames.len() as u64, &options.recipe.name),
            begin: Instant::now(),
            rendered: 0,
            kept: 0,
            rendering: Duration::ZERO,
            warnings: Vec::new(),
        }
    }

    fn done(&self) -> u32 {
        self.rendered + self.kept
    }

    fn render_all(&mut self, mut look: impl FnMut(u32)) -> Result<(), Failure> {
        let mut studio = None;
        for frame in self.options.frames.clone() {
            look(self.done());
            if self.interrupt.is_set() {
                return Ok(());
            }
            let recipe = self.options.recipe.at_frame(&self.options.path, frame);
            let path = self.options.names.path(frame);
            if is_whole_frame(&path, &recipe, SOFTWARE) {
                log::debug!("kept {}", path.display());
                self.kept += 1;
                continue;
            }
            let studio = match &mut studio {
                Some(studio) => studio,
                none => none.insert(Studio::open(&self.options.backend, self.interrupt)?),
            };
            let begin = Instant::now();
            let rendered = self.render(studio, frame, &recipe, &path);
            if !rendered.map_err(|error| broken_off(error, frame, self.done()))? {
                return Ok(());
            }
            self.rendered += 1;
            self.rendering += begin.elapsed();
        }
        Ok(())
    }

    /// Renders and writes a frame; `false` after a signal.
    fn render(
        &mut self,
        studio: &mut Studio,
        frame: u32,
        recipe: &Recipe,
        path: &Path,
    ) -> anyhow::Result<bool> {
        // All frames share the scene, so it is validated and prepared once if the camera allows.
        let job = self.options.job.seen_by(recipe.camera, *self.options.job.settings())?;
        let plan = Studio::plan(recipe.samples_per_pixel);
        let (status, film) = studio.render(job, plan, None, |event| match event {
            Event::Warning(warning) if self.warnings.iter().any(|known| known == warning) => {}
            Event::Warning(warning) => {
                self.display.warn(warning);
                self.warnings.push(warning.to_owned());
            }
            Event::Stopping => {
                self.display.say(&format!("dropping frame {frame}; the frames before it are complete"));
            }
            Event::Status(_, status) => {
                let (done, count) = (self.done(), self.options.frames.len() as u32);
                let left = match self.rendered {
                    0 => String::new(),
                    rendered => {
                        let left = self.rendering / rendered * (count - done);
                        format!(", {} left", seconds(left.as_secs_f64()))
                    }
                };
                self.display.update(u64::from(done), || {
                    let samples = status.samples_per_pixel;
                    format!("frame {frame}: {done} of {count} frames done, {samples} spp{left}")
                });
            }
        });
        if let Phase::Failed(reason) = &status.phase {
            journal::write_report();
            return Err(anyhow!("{reason}"));
        }
        let whole = film.filter(|film| film.sample_count() >= recipe.samples_per_pixel);
        let Some(film) = whole else { return Ok(false) };
        let _writing = self.interrupt.while_writing(path.shown());
        let mut description = describe(recipe, self.options.stage, &film, &status, Some(0.0));
        description.set(key::FRAME, frame);
        if let Some(command) = &self.options.command {
            description.set(key::COMMAND, command.clone());
        }
        write_image(path, &film, recipe.rules.transfer, &description)?;
        log::info!("wrote {}", path.display());
        Ok(true)
    }

    /// The first and the last finished file. Frames finish in order.
    fn files(&self) -> Option<[PathBuf; 2]> {
        let FramesOptions { frames, names, .. } = self.options;
        let last = frames.start + self.done().checked_sub(1)?;
        Some([frames.start, last].map(|frame| names.path(frame)))
    }

    fn json(&self) -> Value {
        let FramesOptions { recipe, frames, names, .. } = self.options;
        let [first, last] = self.files().map_or([None, None], |files| files.map(Some));
        json!({
            "scene": recipe.name,
            "width": recipe.settings.width,
            "height": recipe.settings.height,
            "samples_per_pixel": recipe.samples_per_pixel,
            "first_frame": frames.start,
            "last_frame": frames.end - 1,
            "frames": frames.len(),
            "frames_done": self.done(),
            "rendered": self.rendered,
            "kept": self.kept,
            "rendering_seconds": self.rendering.as_secs_f64(),
            "total_seconds": self.begin.elapsed().as_secs_f64(),
            "directory": names.directory.to_string_lossy(),
            "first_file": first.map(|path| path.to_string_lossy().into_owned()),
            "last_file": last.map(|path| path.to_string_lossy().into_owned()),
            "warnings": self.warnings,
        })
    }
}

/// The failure of a frame after `done` complete ones.
fn broken_off(error: anyhow::Error, frame: u32, done: u32) -> Failure {
    if done == 0 {
        return Failure::Run(error);
    }
    let done = counted(u64::from(done), "frame");
    let context =
        format!("frame {frame} failed; {done} before it are kept; run the same command again to continue");
    Failure::BrokeOff(error.context(context))
}

/// Where an animation's frames are: a directory, and a name with a place for the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub directory: PathBuf,
    before: String,
    /// Minimum number of digits.
    digits: usize,
    after: String,
}

impl FrameNames {
    /// Names from a pattern such as `shots/turn-####.png`, whose `#` signs stand for the number and its minimum digits.
    /// `None` unless the file name has exactly one run of them.
    pub fn of_pattern(pattern: &Path) -> Option<FrameNames> {
        let name = pattern.file_name()?.to_str()?;
        let (before, rest) = name.split_once('#')?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return None;
        }
        Some(FrameNames {
            directory: pattern.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.to_owned(),
            digits: name.len() - before.len() - after.len(),
            after: after.to_owned(),
        })
    }

    pub fn path(&self, frame: u32) -> PathBuf {
        let FrameNames { directory, before, digits, after } = self;
        directory.join(format!("{before}{frame:0digits$}{after}"))
    }
}
