//! `--frames`: the frames of an animation. Each is a picture, written as soon as it is rendered, and complete ones are
//! kept, so the same command continues an interrupted run. Runs in one directory share the frames.

use super::files::Files;
use super::picture::{self, Screen};
use super::studio::Studio;
use super::{BatchOptions, Line, Output, ended, report};
use crate::film::{SOFTWARE, key};
use crate::job::saved::is_whole_frame;
use crate::progressive::describe::{counted, seconds};
use crate::scene::animation::CameraPath;
use crate::system::console;
use crate::system::failure::Failure;
use crate::system::files::{check_writable, make_directory};
use crate::system::interrupt::Interrupt;
use anyhow::{Context, Result};
use serde_json::{Value, json};
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
    let failure = match run.render_all(|_| {}) {
        Err(failure @ Failure::Input(_)) => return Err(failure),
        outcome => outcome.err(),
    };
    run.screen.display.clear();
    let figures = report(&run.json(), &LINES, options.picture.json.as_deref(), None);
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
    studio: Option<Studio<'a>>,
    screen: Screen,
    begin: Instant,
    rendered: u32,
    kept: u32,
    /// The first and the last frame that are done.
    ends: Option<[u32; 2]>,
    rendering: Duration,
}

impl<'a> Run<'a> {
    /// Checks what could otherwise fail after rendering.
    fn new(options: &'a FramesOptions, interrupt: &'a Interrupt) -> Result<Self, Failure> {
        let FramesOptions { picture, frames, names, .. } = options;
        make_directory(&names.directory).map_err(Failure::Input)?;
        let first = names.path(frames.start);
        for path in [Some(first.as_path()), picture.json.as_deref()].into_iter().flatten() {
            check_writable(path).map_err(Failure::input)?;
        }
        picture.check_memory()?;
        let mut screen = Screen::new(picture, frames.len() as u64);
        options.check().map_err(Failure::Input)?.iter().for_each(|warning| screen.warn(warning));
        let (begin, rendering) = (Instant::now(), Duration::ZERO);
        Ok(Run {
            options,
            interrupt,
            studio: None,
            screen,
            begin,
            rendered: 0,
            kept: 0,
            ends: None,
            rendering,
        })
    }

    fn done(&self) -> u32 {
        self.rendered + self.kept
    }

    fn render_all(&mut self, mut look: impl FnMut(u32)) -> Result<(), Failure> {
        let mut missing: Vec<u32> = self.options.frames.clone().collect();
        while !missing.is_empty() {
            let mut left = Vec::new();
            for frame in missing {
                look(self.done());
                if self.interrupt.is_set() {
                    return Ok(());
                }
                if self.finish(frame)? {
                    let [first, last] = self.ends.unwrap_or([frame; 2]);
                    self.ends = Some([first.min(frame), last.max(frame)]);
                } else {
                    left.push(frame);
                }
            }
            missing = left;
            if !missing.is_empty() && !self.interrupt.is_set() {
                std::thread::sleep(PAUSE);
            }
        }
        Ok(())
    }

    /// Renders and writes a frame, unless it is there. Returns `false` after a signal, or if another run renders it.
    fn finish(&mut self, frame: u32) -> Result<bool, Failure> {
        let FramesOptions { picture, path, names, .. } = self.options;
        let recipe = picture.recipe.at_frame(path, frame);
        // All frames share the scene, so it is validated and prepared once if the camera allows.
        let job = picture.job.seen_by(recipe.camera, *picture.job.settings()).map_err(Failure::run)?;
        let file = names.path(frame);
        let outputs = picture.outputs.iter().map(|output| Output { path: file.clone(), ..output.clone() });
        let options =
            BatchOptions { recipe, job, frame: Some(frame), outputs: outputs.collect(), ..picture.clone() };
        let until = options.until();
        let is_whole =
            |options: &BatchOptions| is_whole_frame(&file, &options.recipe, SOFTWARE, (key::UNTIL, &until));
        if is_whole(&options) {
            self.kept += 1;
            return Ok(true);
        }
        let Ok(files) = Files::lock(options, Duration::ZERO) else { return Ok(false) };
        // Another run may have just finished it.
        if is_whole(&files.options) {
            self.kept += 1;
            return Ok(true);
        }
        let studio = match &mut self.studio {
            Some(studio) => studio,
            none => none.insert(Studio::open(&picture.backend, self.interrupt)?),
        };
        let (begin, done, count) =
            (Instant::now(), self.rendered + self.kept, self.options.frames.len() as u32);
        let left = match self.rendered {
            0 => String::new(),
            rendered => {
                format!(", {} left", seconds((self.rendering / rendered * (count - done)).as_secs_f64()))
            }
        };
        let (rendered, outcome) = picture::render(
            &Arc::new(files),
            None,
            &mut self.screen,
            studio,
            self.interrupt,
            |display, status| {
                display.update(u64::from(done), || {
                    let samples = status.samples_per_pixel;
                    format!("frame {frame}: {done} of {count} frames done, {samples} spp{left}")
                });
            },
        );
        match outcome {
            Err(Failure::Input(error) | Failure::Run(error) | Failure::BrokeOff(error)) => {
                return Err(broken_off(error, frame, done));
            }
            outcome => outcome?,
        }
        if rendered.written.files.is_empty() {
            return Ok(false);
        }
        self.rendered += 1;
        self.rendering += begin.elapsed();
        Ok(true)
    }

    fn json(&self) -> Value {
        let FramesOptions { picture: BatchOptions { recipe, .. }, frames, names, .. } = self.options;
        let file = |end: usize| Some(names.path(self.ends?[end]).to_string_lossy().into_owned());
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
            "first_file": file(0),
            "last_file": file(1),
            "warnings": self.screen.warnings,
        })
    }
}

/// The failure of a frame after `done` complete ones.
fn broken_off(error: anyhow::Error, frame: u32, done: u32) -> Failure {
    if done == 0 {
        return Failure::Run(error);
    }
    let done = counted(u64::from(done), "frame");
    let context = format!("frame {frame} failed; {done} are kept; run the same command again to continue");
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
