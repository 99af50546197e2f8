//! `--frames`: the frames of an animation. Each is written as soon as it is rendered, and one that is there and whole is
//! kept, so an interrupted run is continued by the same command.

use super::ended;
use super::frames_summary::{SCHEMA, Summary, files_of_done};
use super::progress::LINE_INTERVAL;
use crate::backends;
use crate::cli::{FramesOptions, JsonTarget};
use crate::describe::{SOFTWARE, counted, describe, describe_animation, seconds};
use crate::failure::Failure;
use crate::files::{JsonPath, ShownPath, check_writable};
use crate::film::{Film, key};
use crate::interrupt::Interrupt;
use crate::journal;
use crate::output::{write_animation, write_image};
use crate::progressive::{Phase, Plan, Progressive, RenderRequest, Status, Stop};
use crate::recipe::Recipe;
use crate::saved::FrameState;
use crate::terminal::{Display, print_beside, write_json};
use anyhow::{Context, anyhow};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Renders the frames that are not there yet, and makes an animated PNG of all if that is asked for. After a signal, the
/// frame in progress is dropped.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered; [`Failure::BrokeOff`] if a render failed but earlier frames are whole;
/// [`Failure::Run`] otherwise.
pub fn render_frames(options: FramesOptions) -> Result<ExitCode, Failure> {
    check_before(&options)?;
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut run = Run::new(&options, &interrupt);
    let failure = match run.render_all() {
        Err(failure @ Failure::Input(_)) => return Err(failure),
        outcome => outcome.err(),
    };
    run.display.clear();
    let summary = run.summary();
    let printed = print_beside(options.json.as_ref(), &format!("{summary}\n"));
    let figures = options.json.as_ref().map_or(Ok(()), |target| write_json(&summary, target));
    ended(failure, printed.and(figures), &interrupt)
}

/// Checks for everything that could otherwise fail after rendering.
fn check_before(options: &FramesOptions) -> Result<(), Failure> {
    let directory = &options.names.directory;
    if !directory.as_os_str().is_empty() {
        std::fs::create_dir_all(directory)
            .with_context(|| {
                format!("cannot create the directory {}; choose another with --out", directory.shown())
            })
            .map_err(Failure::Input)?;
    }
    let json = match &options.json {
        Some(JsonTarget::File(path)) => Some(path),
        _ => None,
    };
    let animation = options.animation.as_ref().map(|(path, _)| path);
    for path in [Some(&options.names.path(options.frames.start)), animation, json].into_iter().flatten() {
        check_writable(path).map_err(Failure::input)?;
    }
    options.job.check_memory(1).map_err(Failure::input)
}

/// An animation in progress.
struct Run<'a> {
    options: &'a FramesOptions,
    interrupt: &'a Interrupt,
    display: Display,
    progressive: Option<Progressive>,
    begin: Instant,
    rendered: u32,
    kept: u32,
    rendering: Duration,
    animation: Option<PathBuf>,
    warnings: Vec<String>,
}

impl<'a> Run<'a> {
    fn new(options: &'a FramesOptions, interrupt: &'a Interrupt) -> Self {
        let template = "{prefix} [{bar:24}] {wide_msg}";
        let count = options.frames.len() as u64;
        let display = Display::new(options.progress, count, template, &options.recipe.name, LINE_INTERVAL);
        options.notes.iter().for_each(|note| display.say(&format!("warning: {note}")));
        Run {
            options,
            interrupt,
            display,
            progressive: None,
            begin: Instant::now(),
            rendered: 0,
            kept: 0,
            rendering: Duration::ZERO,
            animation: None,
            warnings: options.notes.clone(),
        }
    }

    fn render_all(&mut self) -> Result<(), Failure> {
        for frame in self.options.frames.clone() {
            if self.interrupt.is_set() {
                return Ok(());
            }
            let recipe = self.recipe(frame);
            let path = self.options.names.path(frame);
            if FrameState::of(&path, &recipe, SOFTWARE) == FrameState::Whole {
                log::debug!("kept {}", path.display());
                self.kept += 1;
                continue;
            }
            let begin = Instant::now();
            match self.render(frame, &recipe, &path) {
                Ok(true) => {
                    self.rendered += 1;
                    self.rendering += begin.elapsed();
                }
                Ok(false) => return Ok(()),
                Err(Failure::Run(error)) => return Err(broken_off(error, frame, self.rendered + self.kept)),
                Err(error) => return Err(error),
            }
        }
        self.assemble().map_err(Failure::Run)
    }

    /// The picture of a frame.
    fn recipe(&self, frame: u32) -> Recipe {
        self.options.recipe.at_frame(&self.options.path, frame)
    }

    /// Renders and writes a frame; `false` after a signal.
    fn render(&mut self, frame: u32, recipe: &Recipe, path: &Path) -> Result<bool, Failure> {
        let job = &self.options.job;
        // The scene is shared by all frames, so it is validated and prepared once, as far as the camera allows.
        let job = job.seen_by(recipe.camera, *job.settings()).map_err(Failure::run)?;
        let plan =
            Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(Stop::at_samples(recipe.samples_per_pixel)) };
        let mut request = RenderRequest::new(job, self.options.backend.clone(), plan);
        let mut progressive = match self.progressive.take() {
            Some(progressive) => progressive,
            None => {
                request.renderer = Some(backends::create(&self.options.backend).map_err(Failure::input)?);
                Progressive::spawn().context("cannot start the render thread").map_err(Failure::Run)?
            }
        };
        let status = self.watch(frame, &mut progressive, request);
        let film = progressive.take_film();
        self.progressive = Some(progressive);
        if let Phase::Failed(reason) = &status.phase {
            journal::write_report();
            return Err(Failure::Run(anyhow!("{reason}")));
        }
        let Some(film) = film.filter(|film| film.sample_count() >= recipe.samples_per_pixel) else {
            return Ok(false);
        };
        self.write(frame, recipe, path, &film, &status).map_err(Failure::run)?;
        Ok(true)
    }

    fn watch(&mut self, frame: u32, progressive: &mut Progressive, request: RenderRequest) -> Status {
        let (mut told, mut is_stopping) = (0, false);
        progressive.watch(request, |progressive, status| {
            for message in status.messages.iter().skip(told) {
                if !self.warnings.contains(message) {
                    self.display.say(&format!("warning: {message}"));
                    self.warnings.push(message.clone());
                }
            }
            told = status.messages.len();
            if self.interrupt.is_set() && !is_stopping && !status.phase.is_over() {
                is_stopping = true;
                self.display.say(&format!("dropping frame {frame}; the frames before it are whole"));
                progressive.stop();
            }
            self.show(frame, status);
        })
    }

    fn show(&mut self, frame: u32, status: &Status) {
        let done = self.rendered + self.kept;
        let count = self.options.frames.len() as u32;
        let took = (self.rendering, self.rendered);
        self.display.update(u64::from(done), || so_far(frame, status.samples_per_pixel, [done, count], took));
    }

    fn write(
        &self,
        frame: u32,
        recipe: &Recipe,
        path: &Path,
        film: &Film,
        status: &Status,
    ) -> anyhow::Result<()> {
        let _writing = self.interrupt.while_writing(path.shown());
        let mut description = describe(recipe, self.options.stage, film, status, Some(0.0));
        description.set(key::FRAME, frame);
        description.set(key::COMMAND, &self.options.command);
        write_image(path, film, recipe.rules.transfer, &description)?;
        log::info!("wrote {}", path.display());
        Ok(())
    }

    /// Makes the animated PNG.
    fn assemble(&mut self) -> anyhow::Result<()> {
        let Some((path, rate)) = &self.options.animation else { return Ok(()) };
        let count = self.options.frames.len();
        self.display.announce(count as u64, || format!("writing {}", path.shown()));
        let _writing = self.interrupt.while_writing(path.shown());
        let recipe = &self.options.recipe;
        let description = describe_animation(recipe, &self.options.command);
        let size = [recipe.settings.width, recipe.settings.height];
        let first = self.options.frames.start;
        let files = (0..count).map(|index| self.options.names.path(first + index as u32));
        write_animation(path, size, *rate, files, &description)?;
        log::info!("wrote {}", path.display());
        self.animation = Some(path.clone());
        Ok(())
    }

    fn summary(&self) -> Summary {
        let FramesOptions { recipe, frames, names, .. } = self.options;
        let done = self.rendered + self.kept;
        let [first_file, last_file] = files_of_done(frames.start, done, |frame| names.path(frame));
        Summary {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            scene: recipe.name.clone(),
            width: recipe.settings.width,
            height: recipe.settings.height,
            samples_per_pixel: recipe.samples_per_pixel,
            first_frame: frames.start,
            last_frame: frames.end - 1,
            frames: frames.end - frames.start,
            frames_done: done,
            rendered: self.rendered,
            kept: self.kept,
            rendering_seconds: self.rendering.as_secs_f64(),
            total_seconds: self.begin.elapsed().as_secs_f64(),
            directory: names.directory.clone().into(),
            first_file,
            last_file,
            animation: self.animation.clone().map(JsonPath),
            warnings: self.warnings.clone(),
        }
    }
}

/// The failure of a frame before which `done` frames are whole.
fn broken_off(error: anyhow::Error, frame: u32, done: u32) -> Failure {
    if done == 0 {
        return Failure::Run(error);
    }
    let done = counted(u64::from(done), "frame");
    let words = format!("frame {frame} failed; {done} before it stay, and the same command goes on");
    Failure::BrokeOff(error.context(words))
}

/// How far the animation is: the frame in work and its samples, frames done and in total, and how long rendering took for
/// how many frames.
fn so_far(
    frame: u32,
    samples: u64,
    [done, count]: [u32; 2],
    (rendering, rendered): (Duration, u32),
) -> String {
    let left = if rendered > 0 {
        let each = rendering.as_secs_f64() / f64::from(rendered);
        format!(", {} left", seconds(each * f64::from(count.saturating_sub(done))))
    } else {
        String::new()
    };
    format!("frame {frame}: {done} of {count} frames done, {samples} spp{left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_the_frames_that_are_not_done() {
        let told = |took| so_far(3, 4, [2, 6], took);
        assert_eq!(told((Duration::ZERO, 0)), "frame 3: 2 of 6 frames done, 4 spp");
        assert_eq!(told((Duration::from_secs(5), 2)), "frame 3: 2 of 6 frames done, 4 spp, 10.0 s left");
    }

    #[test]
    fn a_run_breaks_off_only_if_there_are_frames_that_stay() {
        let failure = |done| broken_off(anyhow!("no space"), 7, done);
        assert!(matches!(failure(0), Failure::Run(error) if format!("{error:#}") == "no space"));
        for (done, words) in [(1, "1 frame before it stay"), (7, "7 frames before it stay")] {
            let Failure::BrokeOff(error) = failure(done) else { panic!("{done}") };
            let told = format!("frame 7 failed; {words}, and the same command goes on: no space");
            assert_eq!(format!("{error:#}"), told);
        }
    }
}
