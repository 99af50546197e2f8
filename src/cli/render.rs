//! Validates the flags for rendering, in the window or to files.

use super::Request;
use super::backend;
use super::error::CliError;
use super::frames;
use super::paths::Paths;
use super::raw::{self, DrawWith, ProgressChoice, RawPpm, RawRender};
use super::sources::{self, ChosenRecipe};
use super::unused;
use super::values::JsonTarget;
use crate::backends::BackendChoice;
use crate::output::{OutputFormat, PpmForm};
use crate::progressive::{Plan, Stop};
use crate::recipe::{Recipe, plain_name};
use crate::render::RenderJob;
use crate::saved;
use crate::stages::Stage;
use std::path::PathBuf;
use std::time::Duration;

/// Interval at which a checkpoint is written by default.
pub const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);

/// Options of `--batch`.
#[derive(Debug)]
pub struct BatchOptions {
    /// The pictures: one, or those of all stages.
    pub renders: Vec<RenderOptions>,
    /// The directory for the pictures of all stages, which is created if necessary.
    pub directory: Option<PathBuf>,
    /// A scene file to write as well.
    pub save_scene: Option<SaveSceneOptions>,
    /// The backend.
    pub backend: BackendChoice,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
}

/// Options of the window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// The picture at the start.
    pub recipe: Recipe,
    /// The same without the changes of the flags.
    pub unchanged: Recipe,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// The scene file that it comes from.
    pub file: Option<PathBuf>,
    /// Whether a flag gave the picture its size.
    pub is_size_given: bool,
    /// Whether flags chose or changed the picture.
    pub is_picture_given: bool,
    /// The backend.
    pub backend: BackendChoice,
    /// Whether flags chose the backend.
    pub is_device_given: bool,
    /// When to stop, if given.
    pub stop: Option<Stop>,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// Whether to open the usual first picture instead of what was shown last.
    pub is_fresh: bool,
    /// After how much tracing the film is saved, and how often.
    pub autosave_every: Duration,
    /// The directory in which the window keeps what it shows; without one, it keeps nothing.
    pub state_directory: Option<PathBuf>,
    /// The file of the settings, which all windows share; without one, nothing is remembered.
    pub settings: Option<PathBuf>,
    /// What kept pictures may take in that directory, bytes, if not the usual limit.
    pub kept_limit: Option<u64>,
    /// What draws the window.
    pub draw_with: DrawWith,
    /// File for the times of the window's frames.
    pub frame_log: Option<PathBuf>,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
}

/// A picture to render.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    /// What to render.
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// When to stop.
    pub plan: Plan,
    /// File of the picture.
    pub out: PathBuf,
    /// File of the film, if it is kept.
    pub checkpoint: Option<PathBuf>,
    /// Interval at which the film is written.
    pub every: Duration,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// Whether it is a part of a plan, which only goes on with a film in the part's own file.
    pub is_part: bool,
    /// Samples per pixel that `--samples` asks for.
    pub asked_samples: Option<u64>,
    /// How a PPM holds its numbers.
    pub ppm: PpmForm,
    /// The command that renders it.
    pub command: String,
    /// Warnings about flags that have no effect.
    pub notes: Vec<String>,
}

/// A scene file to write.
#[derive(Clone, Debug)]
pub struct SaveSceneOptions {
    /// Its content, which has been validated.
    pub recipe: Recipe,
    /// Path of the file.
    pub path: PathBuf,
}

/// Validates the flags, except `--list` and the subcommands.
pub(super) fn request(mut raw: RawRender, command: String) -> Result<Request, CliError> {
    if let Some(request) = frames::request(&raw, &command)? {
        return Ok(request);
    }
    let backend = backend::choice(&raw.backend)?;
    check_film_names(&raw)?;
    if raw.go_on && raw.checkpoint.as_ref().is_some_and(|film| film.exists()) {
        raw.resume.clone_from(&raw.checkpoint);
    }
    if !raw.batch && raw.save_scene.is_none() {
        return Ok(Request::Window(Box::new(window(&raw, backend)?)));
    }
    let (renders, directory) = if raw.picture.is_every_stage() {
        let directory = directory_of_all(&raw)?;
        let renders = Stage::ALL
            .iter()
            .map(|stage| {
                let chosen = ChosenRecipe { recipe: stage.recipe(), stage: Some(stage) };
                render(chosen, &raw, directory.join(format!("{}.png", stage.id)), &command)
            })
            .collect::<Result<_, _>>()?;
        (renders, Some(directory))
    } else {
        let chosen = sources::find(&raw.picture, raw.resume.as_deref())?;
        let out = raw.out.clone().unwrap_or_else(|| default_name(&chosen));
        (vec![render(chosen, &raw, out, &command)?], None)
    };
    let save_scene = match (&raw.save_scene, renders.as_slice()) {
        (Some(path), [only]) => Some(SaveSceneOptions { recipe: only.recipe.clone(), path: path.clone() }),
        _ => None,
    };
    let json = raw.json.clone().map(JsonTarget::from);
    check_paths(&raw, &renders, json.as_ref())?;
    match save_scene {
        Some(options) if !raw.batch => Ok(Request::SaveScene(Box::new(options))),
        save_scene => Ok(Request::Batch(Box::new(BatchOptions {
            renders,
            directory,
            save_scene,
            backend,
            progress: raw.progress,
            json,
            crashes_at: raw.backend.simulate_crash,
        }))),
    }
}

fn window(raw: &RawRender, backend: BackendChoice) -> Result<WindowOptions, CliError> {
    if raw.picture.is_every_stage() {
        return Err(CliError::Needs {
            flag: "--stage all",
            other: "--batch",
            reason: "the window shows one stage at a time, with buttons for the previous and the next one",
        });
    }
    for (flag, is_given) in [
        ("--out", raw.out.is_some()),
        ("--checkpoint", raw.checkpoint.is_some()),
        ("--every", raw.every.is_some()),
        ("--json", raw.json.is_some()),
        ("--ppm", raw.ppm.is_some()),
        ("--sample-range", raw.sample_range.is_some()),
    ] {
        if is_given {
            let reason = "it is for rendering to files; in the window, use the File menu";
            return Err(CliError::Needs { flag, other: "--batch", reason });
        }
    }
    let mut chosen = sources::find(&raw.picture, raw.resume.as_deref())?;
    let unchanged = chosen.recipe.clone();
    raw::change(&mut chosen.recipe, &raw.picture, raw.estimate_error);
    chosen.recipe.samples_per_pixel = raw.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    let ends = raw.samples.is_some() || raw.time_limit.is_some() || raw.noise_target.is_some();
    let file = sources::scene_file(raw.picture.scene.as_deref());
    Paths::default()
        .read("--scene", file)
        .read("--resume", raw.resume.as_deref())
        .write("--frame-log", raw.frame_log.as_deref())
        .check(&[])?;
    if let Some(film) = &raw.resume {
        saved::check_resume(film, &job)?;
    }
    Ok(WindowOptions {
        stop: ends.then(|| plan(raw, &chosen.recipe).stop),
        recipe: chosen.recipe,
        unchanged,
        stage: chosen.stage,
        file: file.map(PathBuf::from),
        backend,
        is_size_given: raw.picture.size.is_some(),
        is_picture_given: raw.picture.is_given() || raw.resume.is_some() || raw.estimate_error.is_some(),
        is_device_given: backend::is_given(&raw.backend),
        resume: raw.resume.clone(),
        is_fresh: raw.fresh,
        autosave_every: raw.autosave_every.unwrap_or(CHECKPOINT_INTERVAL),
        state_directory: None,
        settings: None,
        kept_limit: None,
        draw_with: raw.draw_with,
        frame_log: raw.frame_log.clone(),
        crashes_at: raw.backend.simulate_crash,
    })
}

fn render(
    mut chosen: ChosenRecipe,
    raw: &RawRender,
    out: PathBuf,
    command: &str,
) -> Result<RenderOptions, CliError> {
    raw::change(&mut chosen.recipe, &raw.picture, raw.estimate_error);
    chosen.recipe.samples_per_pixel = raw.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    if raw.noise_target.is_some() && !chosen.recipe.settings.estimate_error {
        return Err(CliError::Needs {
            flag: "--noise-target",
            other: "--estimate-error on",
            reason: "the error is estimated from the film's two halves",
        });
    }
    let format = OutputFormat::from_path(&out)?;
    if raw.ppm.is_some() && format != OutputFormat::P6 {
        let reason = "it is about how a PPM holds its numbers";
        return Err(CliError::Needs { flag: "--ppm", other: "--out FILE.ppm", reason });
    }
    if raw.every.is_some() && raw.checkpoint.is_none() {
        let reason = "it is the interval at which that film is written";
        return Err(CliError::Needs { flag: "--every", other: "--checkpoint FILE.exr", reason });
    }
    // What one stage ignores, another needs.
    let notes = match raw.picture.is_every_stage() {
        true => Vec::new(),
        false => unused::notes(&job, chosen.stage, &raw.picture, &raw.animation, raw.samples),
    };
    Ok(RenderOptions {
        plan: plan(raw, &chosen.recipe),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        out,
        checkpoint: raw.checkpoint.clone(),
        every: raw.every.unwrap_or(CHECKPOINT_INTERVAL),
        resume: raw.resume.clone(),
        is_part: false,
        asked_samples: raw.samples,
        ppm: raw.ppm.map_or(PpmForm::Binary, RawPpm::form),
        command: command.to_owned(),
        notes,
    })
}

fn check_film_names(raw: &RawRender) -> Result<(), CliError> {
    for (flag, path) in [("--checkpoint", &raw.checkpoint), ("--resume", &raw.resume)] {
        if let Some(path) = path {
            sources::check_ending(flag, path, "a film file", ".exr")?;
        }
    }
    Ok(())
}

/// Returns an error if outputs would replace each other or an input. A resumed film may be replaced by its
/// continuation.
fn check_paths(
    raw: &RawRender,
    renders: &[RenderOptions],
    json: Option<&JsonTarget>,
) -> Result<(), CliError> {
    let paths = Paths::default()
        .read("--scene", sources::scene_file(raw.picture.scene.as_deref()))
        .read("--resume", raw.resume.as_deref());
    let outs = renders.iter().filter(|_| raw.batch).map(|render| render.out.as_path());
    outs.fold(paths, |paths, out| paths.write("--out", Some(out)))
        .write("--checkpoint", raw.checkpoint.as_deref())
        .write("--save-scene", raw.save_scene.as_deref())
        .write_json(json)
        .check(&[("--out", "--resume"), ("--checkpoint", "--resume")])
}

fn plan(raw: &RawRender, recipe: &Recipe) -> Plan {
    let (seconds, noise) = (raw.time_limit, raw.noise_target);
    let (first_sample, samples) = match (&raw.sample_range, raw.samples) {
        (Some(range), _) => (range.start, Some(range.end)),
        (None, None) if seconds.is_some() || noise.is_some() => (0, None),
        (None, _) => (0, Some(recipe.samples_per_pixel)),
    };
    let stop = Stop { samples, seconds, noise };
    Plan { first_sample, pass_target: Plan::BATCH_PASS, ..Plan::until(stop) }
}

/// The directory of `--stage all`, which excludes many other flags.
fn directory_of_all(raw: &RawRender) -> Result<PathBuf, CliError> {
    let single = [
        ("--checkpoint", raw.checkpoint.is_some()),
        ("--resume", raw.resume.is_some()),
        ("--save-scene", raw.save_scene.is_some()),
    ];
    if let Some((flag, _)) = single.into_iter().find(|(_, is_given)| *is_given) {
        let reason = "it applies to a single picture; choose one stage";
        return Err(CliError::Together { flag, other: "--stage all", reason });
    }
    raw.out.clone().ok_or(CliError::Needs {
        flag: "--stage all",
        other: "--out DIR",
        reason: "it writes one picture for each stage",
    })
}

/// `SCENE.png` in the current directory.
fn default_name(chosen: &ChosenRecipe) -> PathBuf {
    let name = chosen.stage.map_or(chosen.recipe.name.as_str(), |stage| stage.id);
    PathBuf::from(format!("{}.png", plain_name(name)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::parse;

    fn window(flags: &str) -> WindowOptions {
        let line = format!("weekender --device cpu {flags}");
        match parse(line.split(' ').map(Into::into)).unwrap() {
            Request::Window(options) => *options,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_picture_is_given_by_the_flags_that_choose_or_change_it() {
        for (flags, is_given) in [
            ("--fresh", false),
            ("--samples 7", false),
            ("--time-limit 3", false),
            ("--draw-with gl", false),
            ("--estimate-error on", true),
            ("--scene three-spheres", true),
            ("--size 8x4", true),
            ("--seed 0", true),
            ("--focus-distance 3", true),
        ] {
            assert_eq!(window(flags).is_picture_given, is_given, "{flags}");
        }
    }

    #[test]
    fn the_window_knows_its_picture_without_the_changes_of_flags() {
        let options = window("--stage metal --vfov 30 --samples 7 --estimate-error off");
        let own = Stage::find("metal").unwrap().recipe();
        assert_eq!((&options.unchanged, options.stage), (&own, Some(Stage::find("metal").unwrap())));
        let mut changed = own;
        (changed.camera.vfov_degrees, changed.samples_per_pixel) = (30.0, 7);
        changed.settings.estimate_error = false;
        assert_eq!(options.recipe, changed);
    }
}
