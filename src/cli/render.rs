//! Rendering, in the window or to files.

use super::animation::AnimationFlags;
use super::error::CliError;
use super::raw::{DrawWith, ProgressChoice, RawPicture};
use super::sources::{self, ChosenRecipe, SampleFlags};
use super::values::{
    JsonTarget, check_ending, json_target, parse_duration, parse_noise_target, parse_seconds,
};
use super::{Line, Paths, Request, backend};
use crate::backends::BackendChoice;
use crate::job::output::{OutputFormat, PpmForm};
use crate::job::recipe::{Recipe, plain_name};
use crate::job::render::RenderJob;
use crate::job::saved;
use crate::progressive::{Plan, Stop};
use crate::stages::Stage;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct RenderFlags {
    /// Render to a file, without a window; with --stage all, every stage of the book, to the directory --out
    #[arg(long)]
    pub batch: bool,
    /// List scenes, stages and devices
    #[arg(long)]
    pub list: bool,
    /// What draws the window; auto: wgpu, or gl if there is no hardware adapter
    #[arg(long, value_enum, default_value = "auto", conflicts_with = "batch")]
    pub draw_with: DrawWith,
    /// Open the window with its usual first picture instead of what was shown last
    #[arg(long, conflicts_with = "batch")]
    pub fresh: bool,
    /// After how much tracing the window saves the film by itself, and how often, 0.1s to 30d
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", hide = true)]
    pub autosave_every: Duration,
    /// Write the times of the window's frames to a file
    #[arg(long, value_name = "FILE", hide = true)]
    pub frame_log: Option<PathBuf>,
    /// Let the program panic once the film has this many samples per pixel (fault injection)
    #[arg(long, value_name = "SAMPLES", hide = true, conflicts_with = "AnimationFlags")]
    pub simulate_crash: Option<u64>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub picture: RawPicture,
    #[command(flatten)]
    pub samples: SampleFlags,
    #[command(flatten)]
    pub stop: StopFlags,
    #[command(flatten)]
    pub backend: BackendChoice,
    #[command(flatten)]
    pub animation: AnimationFlags,
    #[command(flatten)]
    pub files: FileFlags,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "When to stop, besides --samples (the first one met)")]
pub(super) struct StopFlags {
    /// Seconds of rendering
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, conflicts_with = "AnimationFlags")]
    time_limit: Option<f64>,
    /// Estimated error: root mean square over pixels and channels, linear radiance
    #[arg(long, value_name = "RMSE", value_parser = parse_noise_target, conflicts_with = "AnimationFlags")]
    noise_target: Option<f64>,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Files")]
pub(super) struct FileFlags {
    /// The picture: .png, .ppm or .exr (linear film); with --stage all, the directory; with
    /// --frames, a directory, a pattern such as turn-####.png, or an animated .png [default: SCENE.png]
    #[arg(long, value_name = "FILE", requires = "batch")]
    pub out: Option<PathBuf>,
    /// How a .ppm holds its numbers: as bytes (P6), or as text (P3) as in the book [default: binary]
    #[arg(long, value_enum, requires = "batch", conflicts_with = "AnimationFlags")]
    ppm: Option<PpmForm>,
    /// Keep the film so that it can be resumed or merged; it is written regularly and at the end, even after Ctrl-C. An
    /// existing file is never replaced, unless the render continues its film (--continue, --resume)
    #[arg(long, value_name = "FILE.exr", requires = "batch", conflicts_with = "AnimationFlags")]
    checkpoint: Option<PathBuf>,
    /// Continue the film of --checkpoint if it exists, so that one command starts a render and continues it
    #[arg(long = "continue", requires = "checkpoint", conflicts_with = "resume")]
    go_on: bool,
    /// Interval at which --checkpoint is written, the most that a power cut can cost: 0.1s to 30d, such as 30s, 5m or
    /// 1h
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", requires = "checkpoint")]
    every: Duration,
    /// Continue a film; without --scene and --stage, with its own scene
    #[arg(long, value_name = "FILE.exr", conflicts_with = "AnimationFlags")]
    resume: Option<PathBuf>,
    /// Write the scene, with the changes of the other flags, as a scene file
    #[arg(long, value_name = "FILE.toml", conflicts_with = "AnimationFlags")]
    save_scene: Option<PathBuf>,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", value_parser = json_target(), requires = "batch")]
    pub json: Option<JsonTarget>,
}

/// Options of `--batch`.
#[derive(Debug)]
pub struct BatchOptions {
    /// The pictures: one, or those of all stages.
    pub renders: Vec<RenderOptions>,
    /// The directory for the pictures of all stages, which is created if necessary.
    pub directory: Option<PathBuf>,
    /// A scene file to write as well.
    pub save_scene: Option<SaveSceneOptions>,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<JsonTarget>,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
}

/// Options of the window.
#[derive(Clone, Debug)]
pub struct WindowOptions {
    /// The picture at the start.
    pub recipe: Recipe,
    /// The picture without the changes of the flags.
    pub unchanged: Recipe,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// The scene file that it comes from.
    pub file: Option<PathBuf>,
    /// Whether a flag gave the picture its size.
    pub is_size_given: bool,
    /// Whether flags chose or changed the picture.
    pub is_picture_given: bool,
    pub backend: BackendChoice,
    /// Whether flags chose the backend.
    pub is_device_given: bool,
    /// When to stop, if given.
    pub stop: Option<Stop>,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// Whether to open the usual first picture instead of the last one.
    pub is_fresh: bool,
    /// Tracing time after which the film is saved, and again each time.
    pub autosave_every: Duration,
    /// The directory in which the window saves its film by itself; without one, it doesn't.
    pub state_directory: Option<PathBuf>,
    pub draw_with: DrawWith,
    /// File for the times of the window's frames.
    pub frame_log: Option<PathBuf>,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
}

/// A picture to render.
#[derive(Clone, Debug)]
pub struct RenderOptions {
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// Which samples, and when to stop.
    pub plan: Plan,
    /// File of the picture.
    pub out: PathBuf,
    /// File of the film, if it is kept.
    pub checkpoint: Option<PathBuf>,
    /// Interval at which the film is written.
    pub every: Duration,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    pub ppm: PpmForm,
    /// The command that renders it.
    pub command: String,
    /// Warnings about flags that have no effect.
    pub notes: Vec<String>,
}

/// A scene file to write.
#[derive(Clone, Debug)]
pub struct SaveSceneOptions {
    /// Already validated.
    pub recipe: Recipe,
    pub path: PathBuf,
}

/// Validates the flags without a subcommand.
pub(super) fn request(mut flags: RenderFlags, line: &Line) -> Result<Request, CliError> {
    if flags.list {
        return Ok(Request::List);
    }
    let files = &mut flags.files;
    for (flag, path) in [("--checkpoint", &files.checkpoint), ("--resume", &files.resume)] {
        path.as_ref().map_or(Ok(()), |path| check_ending(flag, path, "a film file", ".exr"))?;
    }
    if files.go_on && files.checkpoint.as_ref().is_some_and(|film| film.exists()) {
        files.resume.clone_from(&files.checkpoint);
    }
    match (flags.batch, &flags.files.save_scene) {
        (false, None) => Ok(Request::Window(Box::new(window(flags, line)?))),
        (false, Some(path)) => {
            check_paths(&flags, &[])?;
            let recipe =
                sources::picture(&flags.picture, &flags.samples, flags.files.resume.as_deref())?.0.recipe;
            Ok(Request::SaveScene(Box::new(SaveSceneOptions { recipe, path: path.clone() })))
        }
        (true, _) => batch(flags, line),
    }
}

fn window(flags: RenderFlags, line: &Line) -> Result<WindowOptions, CliError> {
    let RenderFlags { picture, samples, stop, files, .. } = &flags;
    if picture.is_every_stage() || samples.sample_range.is_some() {
        let flag = if picture.is_every_stage() { "--stage all" } else { "--sample-range" };
        let reason = "the window shows one picture, with buttons for the other stages";
        return Err(CliError::Needs { flag, other: "--batch", reason });
    }
    let file = sources::scene_file(picture.scene.as_deref());
    Paths::default()
        .read("--scene", file)
        .read("--resume", files.resume.as_deref())
        .write("--frame-log", flags.frame_log.as_deref())
        .check(&[])?;
    let unchanged = sources::find(picture, files.resume.as_deref())?.recipe;
    let (ChosenRecipe { recipe, stage }, job) = sources::picture(picture, samples, files.resume.as_deref())?;
    if let Some(film) = &files.resume {
        saved::check_resume(film, &job)?;
    }
    let has_end = samples.samples.is_some() || stop.time_limit.is_some() || stop.noise_target.is_some();
    Ok(WindowOptions {
        stop: has_end.then(|| plan(&flags, &recipe).stop),
        recipe,
        unchanged,
        stage,
        file: file.map(PathBuf::from),
        is_size_given: picture.size.is_some(),
        is_picture_given: picture.is_given() || files.resume.is_some() || samples.estimate_error.is_some(),
        is_device_given: backend::FLAGS.into_iter().any(|flag| line.is_given(flag)),
        resume: files.resume.clone(),
        is_fresh: flags.fresh,
        autosave_every: flags.autosave_every,
        state_directory: None,
        draw_with: flags.draw_with,
        frame_log: flags.frame_log,
        crashes_at: flags.simulate_crash,
        backend: flags.backend,
    })
}

fn batch(flags: RenderFlags, line: &Line) -> Result<Request, CliError> {
    let RenderFlags { picture, samples, files, .. } = &flags;
    let (renders, directory) = if picture.is_every_stage() {
        let directory = directory_of_all(files)?;
        let of_stage = |stage: &'static Stage| {
            let chosen = ChosenRecipe { recipe: stage.recipe(), stage: Some(stage) };
            let (chosen, job) = sources::changed(chosen, picture, samples)?;
            // Flags that one stage ignores may be needed by another, so there are no notes.
            render(chosen, job, &flags, directory.join(format!("{}.png", stage.id)), line)
        };
        (Stage::ALL.iter().map(of_stage).collect::<Result<Vec<_>, _>>()?, Some(directory))
    } else {
        let (chosen, job) = sources::picture(picture, samples, files.resume.as_deref())?;
        let notes = sources::notes(&job, &chosen, picture, samples);
        let out = files.out.clone().unwrap_or_else(|| default_name(&chosen));
        (vec![RenderOptions { notes, ..render(chosen, job, &flags, out, line)? }], None)
    };
    check_paths(&flags, &renders)?;
    let save_scene = files.save_scene.clone().zip(renders.first());
    Ok(Request::Batch(Box::new(BatchOptions {
        save_scene: save_scene.map(|(path, only)| SaveSceneOptions { recipe: only.recipe.clone(), path }),
        renders,
        directory,
        backend: flags.backend,
        progress: flags.progress,
        json: flags.files.json,
        crashes_at: flags.simulate_crash,
    })))
}

fn render(
    chosen: ChosenRecipe,
    job: RenderJob,
    flags: &RenderFlags,
    out: PathBuf,
    line: &Line,
) -> Result<RenderOptions, CliError> {
    let (files, format) = (&flags.files, OutputFormat::from_path(&out)?);
    if files.ppm.is_some() && format != OutputFormat::P6 {
        let reason = "it is about how a PPM holds its numbers";
        return Err(CliError::Needs { flag: "--ppm", other: "--out FILE.ppm", reason });
    }
    if flags.stop.noise_target.is_some() && !job.settings().estimate_error {
        let reason = "the error is estimated from the film's two halves";
        return Err(CliError::Needs { flag: "--noise-target", other: "--estimate-error on", reason });
    }
    Ok(RenderOptions {
        plan: plan(flags, &chosen.recipe),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        out,
        checkpoint: files.checkpoint.clone(),
        every: files.every,
        resume: files.resume.clone(),
        ppm: files.ppm.unwrap_or_default(),
        command: line.command.clone(),
        notes: Vec::new(),
    })
}

/// Refuses outputs that would replace each other or an input. A resumed film may be replaced by its continuation.
fn check_paths(flags: &RenderFlags, renders: &[RenderOptions]) -> Result<(), CliError> {
    let files = &flags.files;
    let paths = Paths::default()
        .read("--scene", sources::scene_file(flags.picture.scene.as_deref()))
        .read("--resume", files.resume.as_deref())
        .write("--checkpoint", files.checkpoint.as_deref())
        .write("--save-scene", files.save_scene.as_deref())
        .write_json(files.json.as_ref());
    let paths = renders.iter().fold(paths, |paths, render| paths.write("--out", Some(&render.out)));
    paths.check(&[("--out", "--resume"), ("--checkpoint", "--resume")])
}

fn plan(flags: &RenderFlags, recipe: &Recipe) -> Plan {
    let StopFlags { time_limit: seconds, noise_target: noise } = flags.stop;
    let (first_sample, samples) = match (&flags.samples.sample_range, flags.samples.samples) {
        (Some(range), _) => (range.start, Some(range.end)),
        (None, None) if seconds.is_some() || noise.is_some() => (0, None),
        (None, _) => (0, Some(recipe.samples_per_pixel)),
    };
    let stop = Stop { samples, seconds, noise };
    Plan { first_sample, pass_target: Plan::BATCH_PASS, ..Plan::until(stop) }
}

/// The directory of `--stage all`, which excludes the flags of a single film or scene.
fn directory_of_all(files: &FileFlags) -> Result<PathBuf, CliError> {
    if files.checkpoint.is_some() || files.resume.is_some() || files.save_scene.is_some() {
        return Err(CliError::Together {
            flag: "--stage all",
            other: "--checkpoint, --resume or --save-scene",
            reason: "these are for a single picture; choose one stage",
        });
    }
    let reason = "it writes one picture for each stage";
    files.out.clone().ok_or(CliError::Needs { flag: "--stage all", other: "--out DIR", reason })
}

/// `SCENE.png` in the current directory.
fn default_name(chosen: &ChosenRecipe) -> PathBuf {
    let name = chosen.stage.map_or(chosen.recipe.name.as_str(), |stage| stage.id);
    PathBuf::from(format!("{}.png", plain_name(name)))
}

#[cfg(test)]
mod tests {
    use crate::cli::{Request, parse};
    use std::path::Path;
    use std::time::Duration;

    fn renders(line: &str) -> Vec<super::RenderOptions> {
        match parse(format!("weekender --batch {line}").split(' ').map(Into::into)).unwrap() {
            Request::Batch(options) => options.renders,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn renders_end_as_requested() {
        for (flags, range, seconds, noise) in [
            ("--stage metal", Some(0..128), None, None),
            ("--samples 7 --noise-target 0.01", Some(0..7), None, Some(0.01)),
            ("--time-limit 5", None, Some(5.0), None),
            ("--sample-range 4..9 --time-limit 5", Some(4..9), Some(5.0), None),
            ("--sample-range 4294967295..4294967296", Some(4_294_967_295..4_294_967_296), None, None),
        ] {
            let plan = &renders(flags)[0].plan;
            let found = plan.stop.samples.map(|end| plan.first_sample..end);
            assert_eq!((found, plan.stop.seconds, plan.stop.noise), (range, seconds, noise), "{flags}");
        }
    }

    #[test]
    fn files_and_intervals_have_defaults() {
        let render = &renders("--stage metal --checkpoint no-such.exr")[0];
        assert_eq!((render.out.as_path(), render.every), (Path::new("metal.png"), Duration::from_secs(60)));
        let render = &renders("--scene field:9 --checkpoint no-such.exr --every 5m")[0];
        assert_eq!(render.every, Duration::from_secs(300));
        assert_eq!(renders("--stage all --out no-such").len(), crate::stages::Stage::ALL.len());
    }
}
