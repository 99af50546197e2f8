//! Renders the stills that are missing or have changed.

use super::fingerprint::Fingerprints;
use super::still::{self, Still, Stills};
use super::{Quality, still::INDEX};
use crate::backends::{self, BackendChoice};
use crate::describe::describe;
use crate::failure::Failure;
use crate::files::check_writable;
use crate::film::key;
use crate::interrupt::Interrupt;
use crate::output::{Forms, PngForm, write_image_as};
use crate::progressive::{Phase, Plan, Progressive, RenderRequest, Status, Stop};
use crate::recipe::Recipe;
use crate::render::Renderer;
use crate::stages::Stage;
use anyhow::{Context, anyhow};
use std::path::Path;

/// Which stills are wanted, and where.
#[derive(Clone, Debug)]
pub struct Order<'a> {
    /// The directory of the stills, which is created if necessary.
    pub directory: &'a Path,
    /// The stages; others are left as they are.
    pub stages: &'a [&'static Stage],
    /// The effort for each still. A full still is kept when quick ones are wanted.
    pub quality: Quality,
    /// The backend that renders.
    pub backend: &'a BackendChoice,
}

/// What happens while stills are rendered.
#[derive(Debug)]
pub enum Event<'a> {
    /// A still is being rendered.
    Rendering(&'a Work<'a>),
    /// A still is finished and written.
    Finished(&'a Still),
    /// Something that the user should know, in words.
    Warning(&'a str),
}

/// A still in progress.
#[derive(Debug)]
pub struct Work<'a> {
    /// Its stage.
    pub stage: &'static Stage,
    /// Its place among those that must be rendered, from 1.
    pub number: usize,
    /// How many must be rendered.
    pub count: usize,
    /// The state of its render.
    pub status: &'a Status,
    /// The part of all work that is done, 0 to 1.
    pub share: f64,
}

/// The result of an order.
#[derive(Debug)]
pub struct Outcome {
    /// All stills of the directory.
    pub stills: Stills,
    /// How many were rendered now.
    pub rendered: usize,
    /// How many of the wanted ones did not have to be rendered.
    pub kept: usize,
    /// How many are still missing because of Ctrl-C.
    pub missing: usize,
}

/// A still that must be rendered.
struct Task {
    stage: &'static Stage,
    recipe: Recipe,
    fingerprint: String,
    cost: f64,
}

/// A path among this many spheres or more costs several times as much.
const MANY_SPHERES: usize = 16;

/// How much more a path among many spheres costs, as measured with the book's final picture.
const COST_OF_MANY: f64 = 5.0;

/// Renders those of the wanted stills that are missing, damaged or made from other settings or by another tracer, and
/// writes each with its description as soon as it is finished. After Ctrl-C, the still in progress is dropped.
///
/// # Errors
/// [`Failure::Input`] if nothing was rendered, otherwise [`Failure::BrokeOff`] or [`Failure::Run`]. Finished stills are
/// kept.
pub fn render(
    order: &Order<'_>,
    interrupt: &Interrupt,
    mut tell: impl FnMut(Event<'_>),
) -> Result<Outcome, Failure> {
    let directory = order.directory;
    std::fs::create_dir_all(directory)
        .with_context(|| {
            format!("cannot create the directory {}; choose another with --out", directory.display())
        })
        .map_err(Failure::Input)?;
    let (mut stills, note) = Stills::read(directory);
    if let Some(note) = note {
        tell(Event::Warning(&note));
    }
    let tasks = tasks(order, &stills).map_err(Failure::Input)?;
    let files = tasks.iter().map(|task| Still::file_name(task.stage)).chain([INDEX.to_owned()]);
    for file in files {
        check_writable(&directory.join(file)).map_err(Failure::input)?;
    }
    let kept = order.stages.len() - tasks.len();
    let mut rendered = 0;
    if !tasks.is_empty() {
        let mut studio = Studio::open(order.backend)?;
        let total: f64 = tasks.iter().map(|task| task.cost).sum();
        let mut done = 0.0;
        for task in &tasks {
            let (count, number) = (tasks.len(), rendered + 1);
            let still = studio.render(task, directory, interrupt, |happened| match happened {
                Happened::Traced(status) => {
                    let share = (done + task.cost * progress_of(status)) / total;
                    tell(Event::Rendering(&Work { stage: task.stage, number, count, status, share }));
                }
                Happened::Warned(words) => tell(Event::Warning(words)),
            });
            let Some(still) = still.map_err(|error| broke_off(error, rendered))? else { break };
            stills.set(still.clone());
            stills.write().map_err(Failure::Run)?;
            rendered += 1;
            done += task.cost;
            tell(Event::Finished(&still));
        }
    }
    Ok(Outcome { stills, rendered, kept, missing: tasks.len() - rendered })
}

/// The stills that must be rendered.
fn tasks(order: &Order<'_>, stills: &Stills) -> anyhow::Result<Vec<Task>> {
    let mut fingerprints = Fingerprints::new()?;
    let mut tasks = Vec::new();
    for stage in order.stages {
        let recipe = order.quality.recipe(stage);
        let fingerprint = fingerprints.of(&recipe)?;
        let better = fingerprints.of(&Quality::Full.recipe(stage))?;
        if stills.is_fresh(stage, &[fingerprint.clone(), better]) {
            continue;
        }
        recipe.job()?.check_memory(1)?;
        let cost = cost(&recipe);
        tasks.push(Task { stage, recipe, fingerprint, cost });
    }
    Ok(tasks)
}

/// How long a still takes, in paths among few spheres.
fn cost(recipe: &Recipe) -> f64 {
    let settings = &recipe.settings;
    let paths = f64::from(settings.width) * f64::from(settings.height) * recipe.samples_per_pixel as f64;
    let is_crowd = recipe.scene.spheres.len() >= MANY_SPHERES;
    paths * if is_crowd { COST_OF_MANY } else { 1.0 }
}

/// The part of a still that is done, 0 to 1.
fn progress_of(status: &Status) -> f64 {
    status.samples_per_pixel as f64 / status.planned_samples_per_pixel.max(1) as f64
}

fn broke_off(error: anyhow::Error, rendered: usize) -> Failure {
    match rendered {
        0 => Failure::Run(error),
        _ => Failure::BrokeOff(error.context(format!("broke off after {rendered} pictures, which are kept"))),
    }
}

enum Happened<'a> {
    Traced(&'a Status),
    Warned(&'a str),
}

/// What renders one still after the other.
struct Studio<'a> {
    backend: &'a BackendChoice,
    renderer: Option<Box<dyn Renderer>>,
    progressive: Progressive,
}

impl<'a> Studio<'a> {
    fn open(backend: &'a BackendChoice) -> Result<Self, Failure> {
        let renderer = Some(backends::create(backend).map_err(Failure::input)?);
        let progressive =
            Progressive::spawn().context("cannot start the render thread").map_err(Failure::Run)?;
        Ok(Studio { backend, renderer, progressive })
    }

    /// Renders and writes a still; `None` after Ctrl-C.
    fn render(
        &mut self,
        task: &Task,
        directory: &Path,
        interrupt: &Interrupt,
        mut happened: impl FnMut(Happened<'_>),
    ) -> anyhow::Result<Option<Still>> {
        let recipe = &task.recipe;
        let stop = Stop::at_samples(recipe.samples_per_pixel);
        let request = RenderRequest {
            renderer: self.renderer.take(),
            ..RenderRequest::new(
                recipe.job()?,
                self.backend.clone(),
                Plan { pass_target: Plan::BATCH_PASS, ..Plan::until(stop) },
            )
        };
        let mut told = 0;
        let status = self.progressive.watch(request, |progressive, status| {
            for message in status.messages.iter().skip(told) {
                happened(Happened::Warned(message));
            }
            told = status.messages.len();
            happened(Happened::Traced(status));
            if interrupt.is_set() && !status.phase.is_over() {
                progressive.stop();
            }
        });
        let film = self.progressive.take_film();
        if let Phase::Failed(reason) = &status.phase {
            return Err(anyhow!("{}: {reason}", task.stage.id));
        }
        let film = film.filter(|film| film.sample_count() >= recipe.samples_per_pixel);
        let Some(film) = film else { return Ok(None) };

        let path = directory.join(Still::file_name(task.stage));
        let _writing = interrupt.while_writing(path.display().to_string());
        let description = describe(recipe, Some(task.stage), &film, &status, Some(0.0));
        let forms = Forms { png: PngForm::Small, ..Forms::default() };
        write_image_as(&path, &film, recipe.rules.transfer, &description, forms)?;
        let error = film.error();
        Ok(Some(Still {
            trace_seconds: status.trace.as_secs_f64(),
            rmse_estimate: error.map(|error| error.rmse),
            rmse_deviation: error.map(|error| error.rmse_deviation),
            backend: description.get(key::BACKEND).unwrap_or_default().to_owned(),
            checksum: still::checksum(&path)?,
            ..Still::new(task.stage, recipe, task.fingerprint.clone())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render_cpu::CpuOptions;

    #[test]
    fn a_path_among_many_spheres_costs_more() {
        let cost_of = |count: usize| {
            // A field has the ground besides.
            let mut recipe = Recipe::builtin(&format!("field:{}", count - 1)).unwrap();
            assert_eq!(recipe.scene.spheres.len(), count);
            (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel) = (4, 3, 2);
            cost(&recipe)
        };
        assert_eq!([15, 16, 17].map(cost_of), [24.0, 120.0, 120.0]);
    }

    #[test]
    fn progress_is_the_part_of_the_planned_samples() {
        for (done, planned, expected) in [(0, 0, 0.0), (0, 1, 0.0), (1, 1, 1.0), (1, 4, 0.25), (4, 4, 1.0)] {
            let status =
                Status { samples_per_pixel: done, planned_samples_per_pixel: planned, ..Status::default() };
            assert_eq!(progress_of(&status), expected, "{done} of {planned}");
        }
    }

    #[test]
    fn all_stills_together_are_the_whole_work() {
        let directory = tempfile::tempdir().unwrap();
        let stages = ["ppm-tiny", "aliased"].map(|id| Stage::find(id).unwrap());
        let backend = BackendChoice::Cpu(CpuOptions { threads: Some(1), ..CpuOptions::default() });
        let order = Order {
            directory: directory.path(),
            stages: &stages,
            quality: Quality::Quick,
            backend: &backend,
        };
        let (mut shares, mut works, mut finished, mut warned) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut look = |event: Event<'_>| match event {
            Event::Rendering(Work { stage, number, count, share, .. }) => {
                works.push((stage.id, *number, *count));
                shares.push(*share);
            }
            Event::Finished(still) => finished.push((still.stage.clone(), shares.last().copied())),
            Event::Warning(words) => warned.push(words.to_owned()),
        };
        std::fs::write(directory.path().join(INDEX), "{").unwrap();
        let interrupt = Interrupt::unheard();
        let outcome = render(&order, &interrupt, &mut look).unwrap();
        assert_eq!((outcome.rendered, outcome.kept, outcome.missing), (2, 0, 0));
        let again = render(&order, &interrupt, &mut look).unwrap();
        assert_eq!((again.rendered, again.kept, again.missing), (0, 2, 0));
        assert_eq!(again.stills, outcome.stills);

        works.dedup();
        assert_eq!(works, [("ppm-tiny", 1, 2), ("aliased", 2, 2)]);
        assert!(shares.is_sorted(), "{shares:?}");
        // 16 x 9 and 480 x 270 pixels, one sample each.
        let first = 144.0 / (144.0 + 129_600.0);
        let expected = [("ppm-tiny".to_owned(), Some(first)), ("aliased".to_owned(), Some(1.0))];
        assert_eq!(finished, expected);
        assert!(matches!(warned.as_slice(), [one] if one.contains(INDEX)), "{warned:?}");
    }

    #[test]
    fn a_failure_after_the_first_still_leaves_what_is_finished() {
        assert!(matches!(broke_off(anyhow!("full"), 0), Failure::Run(error) if error.to_string() == "full"));
        let Failure::BrokeOff(error) = broke_off(anyhow!("full"), 1) else { panic!("not broken off") };
        assert_eq!(format!("{error:#}"), "broke off after 1 pictures, which are kept: full");
    }

    #[test]
    fn a_warning_of_a_render_is_told_once_and_the_still_is_finished() {
        let directory = tempfile::tempdir().unwrap();
        let broken = CpuOptions { threads: Some(1), panics_after: Some(0), ..CpuOptions::default() };
        let order = Order {
            directory: directory.path(),
            stages: &[Stage::find("ppm-tiny").unwrap()],
            quality: Quality::Quick,
            backend: &BackendChoice::Cpu(broken),
        };
        let (mut warned, mut finished) = (Vec::new(), 0);
        let outcome = render(&order, &Interrupt::unheard(), |event| match event {
            Event::Warning(words) => warned.push(words.to_owned()),
            Event::Finished(still) => {
                finished += 1;
                assert_eq!(still.samples_per_pixel, 1);
            }
            Event::Rendering(_) => {}
        });
        assert_eq!((outcome.unwrap().rendered, finished), (1, 1));
        assert!(matches!(warned.as_slice(), [one] if one.contains("panicked")), "{warned:?}");
    }
}
