//! Rendering, in the window or to files.

use super::sources::{self, ChosenRecipe, PictureFlags, SampleFlags};
use super::values::{
    DrawWith, ProgressChoice, file_ending, parse_duration, parse_noise_target, parse_seconds, parse_turn,
    range,
};
use super::{Request, backend, is_given};
use crate::backends::BackendChoice;
use crate::film::checkpoint;
use crate::job::output::{OutputFormat, is_named_picture, read_description};
use crate::job::recipe::{Recipe, plain_name};
use crate::job::render::RenderJob;
use crate::job::saved;
use crate::progressive::{NoiseOf, Plan, Stop};
use crate::scene::animation::{FRAME_LIMIT, Turn};
use crate::stages::Stage;
use crate::system::files::{STANDARD, ShownPath};
use anyhow::{Result, bail, ensure};
use clap::{ArgGroup, ArgMatches, Args};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct RenderFlags {
    /// Render to a file, without a window
    #[arg(long)]
    pub batch: bool,
    /// List scenes, stages and devices
    #[arg(long)]
    pub list: bool,
    /// How to draw the window; auto: wgpu, or gl without a hardware adapter
    #[arg(long, value_enum, default_value = "auto", conflicts_with = "batch")]
    pub draw_with: DrawWith,
    /// Open this film, picture or scene file in the window; FILE without a flag does the same. A picture of another program is checked
    #[arg(long, value_name = "FILE", conflicts_with_all = ["batch", "list", "scene", "stage", "resume", "AnimationFlags"])]
    pub open: Option<PathBuf>,
    /// Open the window with its default picture instead of the last one shown
    #[arg(long, conflicts_with = "batch")]
    pub fresh: bool,
    /// Autosave interval of the window, 0.1s to 30d of tracing
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", hide = true)]
    pub autosave_every: Duration,
    /// Write the times of the window's frames to a file
    #[arg(long, value_name = "FILE", hide = true)]
    pub frame_log: Option<PathBuf>,
    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
    #[command(flatten)]
    pub picture: PictureFlags,
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
#[command(next_help_heading = "Animation", group = ArgGroup::new("moving").multiple(true).conflicts_with("sample_range"))]
pub(super) struct AnimationFlags {
    /// Render frames A to B - 1 of an animation to --out; the camera moves by --turntable or by the keyframes of the scene
    /// file [default with --turntable: one turn]
    #[arg(long, value_name = "A..B", value_parser = range(FRAME_LIMIT, "0..120"), group = "moving")]
    pub frames: Option<Range<u32>>,
    /// Move the camera around --look-at, about --vup: the number of frames per turn, or the degrees per frame, such as
    /// 1.5deg or -3deg [without a value: 120 frames]
    #[arg(long, value_name = "FRAMES|DEGREES", value_parser = parse_turn, num_args = 0..=1,
          require_equals = true, default_missing_value = "120", group = "moving")]
    pub turntable: Option<Turn>,
}

impl AnimationFlags {
    pub fn is_given(&self) -> bool {
        self.frames.is_some() || self.turntable.is_some()
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Files")]
pub(super) struct FileFlags {
    /// The picture: .png, .ppm, .exr (linear film) or .pfm (linear), or - for standard output; with --frames, a
    /// directory or a pattern such as turn-####.png; may be repeated [default: SCENE.png, but none for a --sample-range
    /// with a --checkpoint]
    #[arg(long, value_name = "FILE", requires = "batch")]
    pub out: Vec<PathBuf>,
    /// The format of --out, if its extension does not tell
    #[arg(long, value_enum, requires = "out", conflicts_with = "AnimationFlags")]
    format: Option<OutputFormat>,
    /// Write the denoised picture, with an estimate of its error; an .exr keeps its film and gains the denoised picture
    /// as a layer; --noise-target then applies to the denoised picture
    #[arg(long, requires = "batch", conflicts_with = "AnimationFlags")]
    denoise: bool,
    /// Keep the film so that it can be resumed or merged; it is written regularly and at the end, even after Ctrl-C. An
    /// existing file is never replaced, unless the render continues its film (--continue, --resume)
    #[arg(long, value_name = "FILE.exr", value_parser = file_ending(".exr"), requires = "batch",
          conflicts_with = "AnimationFlags")]
    checkpoint: Option<PathBuf>,
    /// Continue the film of --checkpoint if it exists, so that one command starts a render and continues it; a damaged
    /// film is renamed to FILE.exr.damaged, and rendered again
    #[arg(long = "continue", requires = "checkpoint", conflicts_with = "resume")]
    go_on: bool,
    /// Interval at which --checkpoint is written, the most that a power cut can cost: 0.1s to 30d, such as 30s, 5m or
    /// 1h
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", requires = "checkpoint")]
    every: Duration,
    /// Continue a film; without --scene and --stage, with its own scene
    #[arg(long, value_name = "FILE.exr", value_parser = file_ending(".exr"), conflicts_with = "AnimationFlags")]
    resume: Option<PathBuf>,
    /// Write the scene, with the changes of the other flags, as a scene file
    #[arg(long, value_name = "FILE.toml", conflicts_with = "AnimationFlags")]
    save_scene: Option<PathBuf>,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", requires = "batch")]
    pub json: Option<PathBuf>,
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
    /// Whether a flag set the size of the picture.
    pub is_size_given: bool,
    /// Whether flags chose or changed the picture.
    pub is_picture_given: bool,
    pub backend: BackendChoice,
    /// Whether flags chose the backend.
    pub is_device_given: bool,
    /// When to stop; `None` without such flags.
    pub stop: Option<Stop>,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// The picture of another program to check.
    pub mine: Option<PathBuf>,
    /// Whether the picture was read from a film or another picture.
    pub is_saved: bool,
    /// Whether to open the default picture instead of the last one.
    pub is_fresh: bool,
    /// Tracing time between autosaves.
    pub autosave_every: Duration,
    /// The directory for autosaves; `None` disables them.
    pub state_directory: Option<PathBuf>,
    pub draw_with: DrawWith,
    /// File for the times of the window's frames.
    pub frame_log: Option<PathBuf>,
}

/// Options of `--batch`.
#[derive(Clone, Debug)]
pub struct BatchOptions {
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// Which samples, and when to stop.
    pub plan: Plan,
    /// Whether the picture is denoised.
    pub denoise: bool,
    /// Files of the picture.
    pub out: Vec<(PathBuf, OutputFormat)>,
    /// File of the film, if it is kept.
    pub checkpoint: Option<PathBuf>,
    /// Interval at which the film is written.
    pub every: Duration,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// A scene file to write as well.
    pub save_scene: Option<PathBuf>,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<PathBuf>,
}

impl BatchOptions {
    /// Whether `--out` names this file.
    pub fn writes(&self, path: &Path) -> bool {
        self.out.iter().any(|(out, _)| out == path)
    }

    /// The files of the picture and of its film.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        let film = self.checkpoint.iter().filter(|film| !self.writes(film));
        self.out.iter().map(|(out, _)| out).chain(film)
    }
}

/// Validates the flags without a subcommand.
pub(super) fn request(mut flags: RenderFlags, matches: &ArgMatches) -> Result<Request> {
    if flags.list {
        return Ok(Request::List);
    }
    let (mut picture, mut mine) = (None, None);
    match flags.open.take() {
        Some(path) if is_scene_file(&path) => flags.picture.scene = Some(path.into()),
        Some(path) if checkpoint::read_head(&path).is_ok() => flags.files.resume = Some(path),
        Some(path) if is_others(&path) => mine = Some(path),
        other => picture = other,
    }
    let files = &mut flags.files;
    let is_film = |film: &PathBuf| film.metadata().is_ok_and(|found| found.len() > 0);
    if files.go_on && files.checkpoint.as_ref().is_some_and(is_film) {
        files.resume.clone_from(&files.checkpoint);
    }
    match (flags.batch, &flags.files.save_scene) {
        (false, None) => {
            let options = window(flags, picture.as_deref(), matches)?;
            Ok(Request::Window(Box::new(WindowOptions { mine, ..options })))
        }
        (false, Some(path)) => {
            check_paths(&flags, &[])?;
            let saved = flags.files.resume.as_deref().or(picture.as_deref());
            let (chosen, _) = sources::picture(&flags.picture, &flags.samples, saved)?;
            Ok(Request::SaveScene(Box::new(chosen.recipe), path.clone()))
        }
        (true, _) => Ok(Request::Batch(Box::new(batch(flags)?))),
    }
}

/// Whether a file is a scene rather than a picture, judged by its name.
fn is_scene_file(path: &Path) -> bool {
    path == Path::new(STANDARD) || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Whether a file is a picture of another program.
fn is_others(path: &Path) -> bool {
    is_named_picture(path) && path.exists() && read_description(path).is_err()
}

/// `opened` is a picture without a film.
fn window(flags: RenderFlags, opened: Option<&Path>, matches: &ArgMatches) -> Result<WindowOptions> {
    let RenderFlags { picture, samples, stop, files, .. } = &flags;
    let saved = files.resume.as_deref().or(opened);
    ensure!(
        samples.sample_range.is_none(),
        "--sample-range needs --batch: the window renders all samples of its picture"
    );
    let file = sources::scene_file(picture.scene.as_deref());
    let chosen = sources::find(picture, saved)?;
    let unchanged = chosen.recipe.clone();
    let (ChosenRecipe { recipe, stage }, job) = sources::changed(chosen, picture, samples)?;
    if let Some(film) = &files.resume {
        saved::open(film)?.check_same(&job)?;
    }
    let has_end = samples.samples.is_some() || stop.time_limit.is_some() || stop.noise_target.is_some();
    Ok(WindowOptions {
        stop: has_end.then(|| plan(&flags, &recipe).stop),
        recipe,
        unchanged,
        stage,
        file: file.map(PathBuf::from),
        is_size_given: picture.size.is_some(),
        is_picture_given: picture.is_given() || saved.is_some() || samples.estimate_error.is_some(),
        is_device_given: backend::FLAGS.into_iter().any(|flag| is_given(matches, flag)),
        mine: None,
        is_saved: saved.is_some() && !picture.has_source(),
        resume: files.resume.clone(),
        is_fresh: flags.fresh,
        autosave_every: flags.autosave_every,
        state_directory: None,
        draw_with: flags.draw_with,
        frame_log: flags.frame_log,
        backend: flags.backend,
    })
}

fn batch(flags: RenderFlags) -> Result<BatchOptions> {
    let RenderFlags { picture, samples, files, .. } = &flags;
    let (ChosenRecipe { recipe, stage }, job) = sources::picture(picture, samples, files.resume.as_deref())?;
    let name = stage.map_or(recipe.name.as_str(), |stage| stage.id);
    let mut out = files.out.clone();
    let is_part = samples.sample_range.is_some() && files.checkpoint.is_some();
    if out.is_empty() && !is_part {
        out.push(format!("{}.png", plain_name(name)).into());
    }
    check_paths(&flags, &out)?;
    let with_format = |out: PathBuf| match (files.format, OutputFormat::from_path(&out)) {
        (Some(format), Ok(named)) if format != named => bail!(
            "--format {} contradicts the name {}; leave one of them out",
            &format.ending()[1..],
            out.shown()
        ),
        (Some(format), _) => Ok((out, format)),
        (None, named) => Ok((out, named?)),
    };
    let out = out.into_iter().map(with_format).collect::<Result<Vec<_>>>()?;
    let to_standard = out.iter().map(|(out, _)| out).chain(&files.json);
    ensure!(
        to_standard.filter(|path| *path == Path::new(STANDARD)).count() <= 1,
        "two of --out and --json would both write to standard output; write one of them to a file"
    );
    let comparing = [("--noise-target", flags.stop.noise_target.is_some()), ("--denoise", files.denoise)];
    if let Some((flag, _)) = comparing.into_iter().find(|(_, is_given)| *is_given)
        && !job.settings().estimate_error
    {
        bail!("{flag} needs --estimate-error on: it compares the film's two halves");
    }
    Ok(BatchOptions {
        plan: plan(&flags, &recipe),
        denoise: flags.files.denoise,
        recipe,
        job,
        stage,
        out,
        checkpoint: flags.files.checkpoint,
        every: flags.files.every,
        resume: flags.files.resume,
        save_scene: flags.files.save_scene,
        backend: flags.backend,
        progress: flags.progress,
        json: flags.files.json,
    })
}

/// Refuses outputs that would replace each other or an input.
fn check_paths(flags: &RenderFlags, out: &[PathBuf]) -> Result<()> {
    let files = &flags.files;
    let scene = sources::inputs(flags.picture.scene.as_deref());
    let others = [files.save_scene.as_deref(), files.json.as_deref()].into_iter().flatten();
    // A film may be replaced by its own continuation.
    super::check_paths(files.resume.as_deref(), others.clone())?;
    super::check_paths(
        scene.iter().map(PathBuf::as_path),
        files.checkpoint.iter().chain(out).map(PathBuf::as_path).chain(others),
    )
}

fn plan(flags: &RenderFlags, recipe: &Recipe) -> Plan {
    let StopFlags { time_limit: seconds, noise_target: noise } = flags.stop;
    let (first_sample, samples) = match (&flags.samples.sample_range, flags.samples.samples) {
        (Some(range), _) => (range.start, Some(range.end)),
        (None, None) if seconds.is_some() || noise.is_some() => (0, None),
        (None, _) => (0, Some(recipe.samples_per_pixel)),
    };
    let noise_of = if flags.files.denoise { NoiseOf::Denoised } else { NoiseOf::Film };
    let stop = Stop { samples, seconds, noise, noise_of };
    Plan { first_sample, pass_target: Plan::BATCH_PASS, ..Plan::until(stop) }
}

#[cfg(test)]
mod tests {
    use crate::cli::{Request, parse};
    use crate::job::output::OutputFormat;
    use std::time::Duration;

    fn render(line: &str) -> super::BatchOptions {
        match parse(format!("weekender --batch {line}").split(' ').map(Into::into)).unwrap() {
            Request::Batch(options) => *options,
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
            let plan = render(flags).plan;
            let found = plan.stop.samples.map(|end| plan.first_sample..end);
            assert_eq!((found, plan.stop.seconds, plan.stop.noise), (range, seconds, noise), "{flags}");
        }
    }

    #[test]
    fn files_and_intervals_have_defaults() {
        let options = render("--stage metal --checkpoint no-such.exr");
        assert_eq!(
            (&options.out, options.every),
            (&vec![("metal.png".into(), OutputFormat::Png)], Duration::from_secs(60))
        );
        let options = render("--scene field:9 --checkpoint no-such.exr --every 5m");
        assert_eq!(options.every, Duration::from_secs(300));
    }
}
