//! The stages' pictures. Each is a PNG that says how it was made, so only those are rendered that are missing, damaged, or
//! made from other settings or by another tracer.

use crate::options::Options;
use anyhow::{Result, bail};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use weekender::batch::{Event, Studio};
use weekender::film::{SOFTWARE, key};
use weekender::job::output::write_small_png;
use weekender::job::recipe::Recipe;
use weekender::job::saved::is_whole_frame;
use weekender::progressive::Phase;
use weekender::progressive::describe::{counted, describe};
use weekender::stages::Stage;
use weekender::system::console;
use weekender::system::failure::Failure;
use weekender::system::files::{check_writable, make_directory};
use weekender::system::interrupt::Interrupt;
use weekender::system::terminal::{Display, print};

/// Maximum width of a quick still, pixels.
const QUICK_WIDTH: u32 = 480;

/// Maximum samples per pixel of a quick still.
const QUICK_SAMPLES: u64 = 64;

/// Minimum width of a full still, pixels: almost twice the pixels that most figures are wide.
const FULL_WIDTH: u32 = 800;

/// Samples per pixel of a full still. The estimated error is then at most 0.003, about half an 8-bit step.
const FULL_SAMPLES: u64 = 1024;

/// Interval of progress lines without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(5);

/// The progress bar, which counts paths.
const TEMPLATE: &str = "[{bar:24}] {eta} left, {wide_msg}";

/// The stage's own recipe with the size and samples of a still.
fn recipe(stage: &Stage, is_quick: bool) -> Recipe {
    let mut recipe = stage.recipe();
    if stage.setup.is_about_pixels {
        return recipe;
    }
    let (settings, samples) = (&mut recipe.settings, &mut recipe.samples_per_pixel);
    let width = if is_quick { settings.width.min(QUICK_WIDTH) } else { settings.width.max(FULL_WIDTH) };
    settings.height = (settings.height * width).div_ceil(settings.width);
    settings.width = width;
    // A stage with one sample sends it through the pixel's centre; more would be the same.
    if *samples > 1 {
        *samples = if is_quick { QUICK_SAMPLES.min(*samples) } else { FULL_SAMPLES };
    }
    recipe
}

/// A still to render.
#[derive(Debug)]
struct Task {
    stage: &'static Stage,
    recipe: Recipe,
    path: PathBuf,
}

impl Task {
    fn new(options: &Options, stage: &'static Stage) -> Self {
        let path = options.figures().join(format!("{}.png", stage.id));
        Task { stage, recipe: recipe(stage, options.quick), path }
    }

    /// A full still satisfies a quick order.
    fn is_done(&self) -> bool {
        let is_made_of = |recipe: &Recipe| {
            let samples = recipe.samples_per_pixel.to_string();
            is_whole_frame(&self.path, recipe, SOFTWARE, (key::SAMPLES, &samples))
        };
        is_made_of(&self.recipe) || is_made_of(&recipe(self.stage, false))
    }

    /// The paths of all its samples.
    fn paths(&self) -> u64 {
        self.recipe.samples_per_pixel * self.pixels()
    }

    fn pixels(&self) -> u64 {
        u64::from(self.recipe.settings.width) * u64::from(self.recipe.settings.height)
    }
}

/// The stills that must be rendered.
pub struct Work<'a> {
    options: &'a Options,
    interrupt: &'a Interrupt,
    tasks: Vec<Task>,
    /// `None` if there is nothing to render.
    studio: Option<Studio<'a>>,
}

#[derive(Debug)]
pub struct Outcome {
    /// How many were rendered.
    pub rendered: usize,
    /// How many were up to date.
    pub kept: usize,
    /// How many are missing because of a signal.
    pub missing: usize,
}

impl Outcome {
    /// Reports what was done, and where the result is or how to continue.
    pub fn report(&self, made: &Path, interrupt: &Interrupt) -> Result<ExitCode, Failure> {
        if self.missing > 0 {
            let missing = counted(self.missing as u64, "picture");
            console::note(&format!("interrupted: {missing} missing; run the same command again to continue"));
            return Ok(interrupt.exit_code());
        }
        let rendered = counted(self.rendered as u64, "picture");
        print(&format!("{rendered} rendered, {} unchanged\nopen {}\n", self.kept, made.display()))
            .map_err(Failure::Run)?;
        Ok(ExitCode::SUCCESS)
    }
}

impl<'a> Work<'a> {
    /// Checks everything that may be refused, and only then makes the directory.
    ///
    /// # Errors
    /// [`Failure::Input`] if a still cannot be rendered or written.
    pub fn begin(options: &'a Options, interrupt: &'a Interrupt) -> Result<Self, Failure> {
        let tasks = options.stages().map(|stage| Task::new(options, stage));
        let tasks: Vec<Task> = tasks.filter(|task| !task.is_done()).collect();
        for task in &tasks {
            task.recipe.job().map_err(Failure::input)?.check_memory(1, 0).map_err(Failure::input)?;
        }
        let is_needed = !tasks.is_empty();
        let studio = is_needed.then(|| Studio::open(&options.backend, interrupt)).transpose()?;
        make_directory(&options.figures()).map_err(Failure::Input)?;
        tasks.iter().try_for_each(|task| check_writable(&task.path)).map_err(Failure::input)?;
        Ok(Work { options, interrupt, tasks, studio })
    }

    /// Renders the stills, and writes each with its description as soon as it is finished. Ctrl-C drops the still in
    /// progress.
    ///
    /// # Errors
    /// [`Failure::Run`], or [`Failure::BrokeOff`] if some are finished; they are kept.
    pub fn render(mut self) -> Result<Outcome, Failure> {
        let mut rendered = 0;
        if let Some(mut studio) = self.studio.take() {
            let steps = self.tasks.iter().map(Task::paths).sum();
            let mut display = Display::new(self.options.progress, steps, TEMPLATE, "", LINE_INTERVAL);
            let outcome = loop {
                if rendered == self.tasks.len() || self.interrupt.is_set() {
                    break Ok(());
                }
                match self.still(rendered, &mut studio, &mut display) {
                    Ok(true) => rendered += 1,
                    Ok(false) => break Ok(()),
                    Err(error) => break Err(error),
                }
            };
            display.clear();
            outcome.map_err(|error| match rendered {
                0 => Failure::Run(error),
                _ => {
                    let kept = counted(rendered as u64, "picture");
                    Failure::BrokeOff(error.context(format!("broke off; kept: {kept}")))
                }
            })?;
        }
        let kept = self.options.stages().count() - self.tasks.len();
        Ok(Outcome { rendered, kept, missing: self.tasks.len() - rendered })
    }

    /// Renders and writes the still of task `number`; `false` after a signal.
    fn still(&self, number: usize, studio: &mut Studio<'a>, display: &mut Display) -> Result<bool> {
        let (task, count) = (&self.tasks[number], self.tasks.len());
        let before: u64 = self.tasks[..number].iter().map(Task::paths).sum();
        let Task { stage, recipe, path } = task;
        let planned = recipe.samples_per_pixel;
        let (status, film) = studio.render(recipe.job()?, Studio::plan(planned), None, |event| match event {
            Event::Warning(message) => display.warn(message),
            Event::Stopping => {}
            Event::Status(_, status) => {
                let done = status.samples_per_pixel;
                display.update(before + done * task.pixels(), || {
                    let error = status.error.map(|error| format!(", error {:.1e}", error.rmse));
                    let (number, error) = (number + 1, error.unwrap_or_default());
                    format!("{number} of {count}, {}: {done} of {planned} spp{error}", stage.id)
                });
            }
        });
        if let Phase::Failed(reason) = &status.phase {
            bail!("{}: {reason}", stage.id);
        }
        let Some(film) = film.filter(|film| film.sample_count() >= planned) else { return Ok(false) };
        let _writing = self.interrupt.while_writing(path.display().to_string());
        let description = describe(recipe, Some(stage), &film, &status, Some(0.0));
        write_small_png(path, &film, recipe.rules.transfer, &description)?;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stills_keep_aspect_ratio() {
        for stage in Stage::ALL {
            let own = stage.recipe();
            for is_quick in [true, false] {
                let recipe = recipe(stage, is_quick);
                recipe.job().expect(stage.id);
                let [shape, own_shape] = [&recipe.settings, &own.settings]
                    .map(|settings| f64::from(settings.width) / f64::from(settings.height));
                assert!((shape / own_shape - 1.0).abs() < 0.01, "{}: {shape}", stage.id);
                assert_eq!(recipe.samples_per_pixel == 1, own.samples_per_pixel == 1, "{}", stage.id);
                if stage.setup.is_about_pixels {
                    assert_eq!(recipe, own);
                }
            }
        }
        let sizes = |id: &str| {
            [true, false].map(|is_quick| {
                let recipe = recipe(Stage::find(id).unwrap(), is_quick);
                (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel)
            })
        };
        assert_eq!(sizes("book"), [(480, 270, 64), (1200, 675, 1024)]);
        assert_eq!(sizes("sky"), [(480, 270, 1), (800, 450, 1)]);
    }
}
