//! Rendering, in the window or to files.

use super::backend::BackendFlags;
use super::sources::{self, ChosenRecipe, PictureFlags, SampleFlags};
use super::values::{file_ending, parse_duration, parse_noise_target, parse_seconds, range, whole};
use crate::batch::{BatchOptions, Output};
use crate::job::output::OutputFormat;
use crate::job::recipe::{Recipe, plain_name};
use crate::progressive::{NoiseOf, Plan, Stop};
use crate::scene::animation::FRAME_LIMIT;
use crate::system::files::{STANDARD, ShownPath};
use crate::system::terminal::ProgressChoice;
use anyhow::{Result, anyhow, bail, ensure};
use clap::Args;
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
    #[cfg(feature = "window")]
    #[command(flatten)]
    pub window: WindowFlags,
    /// Open this film, picture or scene file in the window; FILE without a flag does the same. A picture of another program is checked
    #[arg(long, value_name = "FILE", conflicts_with_all = ["batch", "list", "scene", "stage", "resume", "AnimationFlags"])]
    pub open: Option<PathBuf>,
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
    pub backend: BackendFlags,
    #[command(flatten)]
    pub animation: AnimationFlags,
    #[command(flatten)]
    pub files: FileFlags,
}

/// How the window is drawn; independent of the tracer.
#[cfg(feature = "window")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum DrawWith {
    /// Whatever is faster on this machine
    #[default]
    Auto,
    /// Vulkan, Metal or DX12
    Wgpu,
    /// OpenGL
    Gl,
}

#[cfg(feature = "window")]
#[derive(Debug, Args)]
pub(super) struct WindowFlags {
    /// How to draw the window; auto: wgpu, or gl without a hardware adapter
    #[arg(long, value_enum, default_value = "auto", conflicts_with = "batch")]
    pub draw_with: DrawWith,
    /// Open the window with its default picture instead of the last one shown
    #[arg(long, conflicts_with = "batch")]
    pub fresh: bool,
    /// Autosave interval of the window, 0.1s to 30d of tracing
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", hide = true)]
    pub autosave_every: Duration,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "When to stop, besides --samples (the first one met)")]
pub(super) struct StopFlags {
    /// Seconds of rendering, for each frame of an animation
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    pub time_limit: Option<f64>,
    /// Estimated error: root mean square over pixels and channels, linear radiance
    #[arg(long, value_name = "RMSE", value_parser = parse_noise_target)]
    pub noise_target: Option<f64>,
}

#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Animation")]
pub(super) struct AnimationFlags {
    /// Render frames A to B - 1 of an animation to --out; the camera moves by --turntable or by the keyframes of the scene
    /// file [default with --turntable: one turn]
    #[arg(long, value_name = "A..B", value_parser = range(FRAME_LIMIT, "0..120"))]
    pub frames: Option<Range<u32>>,
    /// Move the camera around --look-at, about --vup, in this number of frames, 2 to 100000 [without a value: 120]
    #[arg(long, value_name = "FRAMES", value_parser = whole::<u32>(2..=FRAME_LIMIT.into()), num_args = 0..=1,
          require_equals = true, default_missing_value = "120")]
    pub turntable: Option<u32>,
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
    #[arg(long, value_enum, requires = "out")]
    pub format: Option<OutputFormat>,
    /// Write the denoised picture, with an estimate of its error; an .exr keeps its film and gains the denoised picture
    /// as a layer; --noise-target then applies to the denoised picture. With --resume and without --samples,
    /// --time-limit and --noise-target, nothing is rendered
    #[arg(long, requires = "batch")]
    denoise: bool,
    /// Keep the film so that it can be resumed or merged; it is written regularly and at the end, even after Ctrl-C. An
    /// existing file is never replaced, unless the render continues its film (--continue, --resume)
    #[arg(long, value_name = "FILE.exr", value_parser = file_ending(".exr"), requires = "batch")]
    pub checkpoint: Option<PathBuf>,
    /// Continue the film of --checkpoint if it exists, so that one command starts a render and continues it; a damaged
    /// film is renamed to FILE.exr.damaged, and rendered again
    #[arg(long = "continue", requires = "checkpoint", conflicts_with = "resume")]
    pub go_on: bool,
    /// Interval at which --checkpoint is written, the most that a power cut can cost: 0.1s to 30d, such as 30s, 5m or
    /// 1h
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, default_value = "60s", requires = "checkpoint")]
    every: Duration,
    /// Continue a film; without --scene and --stage, with its own scene
    #[arg(long, value_name = "FILE.exr", value_parser = file_ending(".exr"))]
    pub resume: Option<PathBuf>,
    /// Write the scene, with the changes of the other flags, as a scene file
    #[arg(long, value_name = "FILE.toml")]
    pub save_scene: Option<PathBuf>,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", requires = "batch")]
    pub json: Option<PathBuf>,
}

/// Whether a file is a scene rather than a picture, judged by its name.
pub(super) fn is_scene_file(path: &Path) -> bool {
    path == Path::new(STANDARD) || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

pub(super) fn batch(flags: RenderFlags, command: String) -> Result<BatchOptions> {
    let RenderFlags { picture, samples, files, .. } = &flags;
    let (ChosenRecipe { recipe, stage }, job) = sources::picture(picture, samples, files.resume.as_deref())?;
    let is_part = samples.sample_range.is_some() && files.checkpoint.is_some();
    let name = stage.map_or(recipe.name.as_str(), |stage| stage.id);
    let outputs = outputs(files, (!is_part).then_some(name))?;
    check_paths(&flags, &outputs)?;
    let to_standard = outputs.iter().map(|output| &output.path).chain(&files.json);
    ensure!(
        to_standard.filter(|path| *path == Path::new(STANDARD)).count() <= 1,
        "two of --out and --json would both write to standard output; write one of them to a file"
    );
    Ok(BatchOptions {
        plan: plan(&flags, &recipe),
        denoise: flags.files.denoise,
        recipe,
        job,
        stage,
        outputs,
        every: flags.files.every,
        resume: flags.files.resume,
        save_scene: flags.files.save_scene,
        backend: flags.backend.choice()?,
        progress: flags.progress,
        json: flags.files.json,
        command,
        frame: None,
    })
}

/// The files to write, films first. The default is a PNG file of this name.
fn outputs(files: &FileFlags, default: Option<&str>) -> Result<Vec<Output>> {
    let default = default.map(|name| PathBuf::from(format!("{}.png", plain_name(name))));
    let out = if files.out.is_empty() { default.as_slice() } else { &files.out };
    let output = |path: &PathBuf| {
        let format = match (files.format, OutputFormat::from_path(path)) {
            (Some(format), Ok(named)) if format != named => bail!(
                "--format {} contradicts the name {}; leave one of them out",
                &format.ending()[1..],
                path.shown()
            ),
            (Some(format), _) => format,
            (None, named) => named.map_err(|error| anyhow!("{error}, or add --format"))?,
        };
        Ok(Output { path: path.clone(), format, is_checkpoint: false })
    };
    let mut outputs = out.iter().map(output).collect::<Result<Vec<_>>>()?;
    outputs.sort_by_key(|output| output.format != OutputFormat::Exr);
    let checkpoint = files.checkpoint.clone();
    let checkpoint = checkpoint.map(|path| Output { path, format: OutputFormat::Exr, is_checkpoint: true });
    Ok(checkpoint.into_iter().chain(outputs).collect())
}

/// Refuses outputs that would replace each other or an input.
pub(super) fn check_paths(flags: &RenderFlags, outputs: &[Output]) -> Result<()> {
    let files = &flags.files;
    let scene = sources::inputs(flags.picture.scene.as_deref());
    let others = [files.save_scene.as_deref(), files.json.as_deref()].into_iter().flatten();
    // A film may be replaced by its own continuation.
    super::check_paths(files.resume.as_deref(), others.clone())?;
    super::check_paths(
        scene.iter().map(PathBuf::as_path),
        outputs.iter().map(|output| output.path.as_path()).chain(others),
    )
}

pub(super) fn plan(flags: &RenderFlags, recipe: &Recipe) -> Plan {
    let StopFlags { time_limit: seconds, noise_target: noise } = flags.stop;
    let (first_sample, samples) = match (&flags.samples.sample_range, flags.samples.samples) {
        (Some(range), _) => (range.start, Some(range.end)),
        (None, None) if seconds.is_some() || noise.is_some() => (0, None),
        (None, None) if flags.files.denoise && flags.files.resume.is_some() && !flags.files.go_on => {
            (0, Some(0))
        }
        (None, _) => (0, Some(recipe.samples_per_pixel)),
    };
    let noise_of = if flags.files.denoise { NoiseOf::Denoised } else { NoiseOf::Film };
    let stop = Stop { samples, seconds, noise, noise_of };
    Plan { first_sample, pass_target: Plan::BATCH_PASS, ..Plan::until(stop) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::tests::batch;

    #[test]
    fn renders_end_as_requested() {
        for (flags, range, seconds, noise) in [
            ("--stage metal", Some(0..128), None, None),
            ("--samples 7 --noise-target 0.01", Some(0..7), None, Some(0.01)),
            ("--time-limit 5", None, Some(5.0), None),
            ("--sample-range 4..9 --time-limit 5", Some(4..9), Some(5.0), None),
            ("--sample-range 4294967295..4294967296", Some(4_294_967_295..4_294_967_296), None, None),
        ] {
            let plan = batch(flags).plan;
            let found = plan.stop.samples.map(|end| plan.first_sample..end);
            assert_eq!((found, plan.stop.seconds, plan.stop.noise), (range, seconds, noise), "{flags}");
        }
    }

    #[test]
    fn files_and_intervals_have_defaults() {
        let options = batch("--stage metal --checkpoint no-such.exr");
        let [film, picture] = ["no-such.exr", "metal.png"].map(PathBuf::from);
        let film = Output { path: film, format: OutputFormat::Exr, is_checkpoint: true };
        let picture = Output { path: picture, format: OutputFormat::Png, is_checkpoint: false };
        assert_eq!((options.outputs, options.every), (vec![film, picture], Duration::from_secs(60)));
        assert_eq!(batch("--checkpoint no-such.exr --every 5m").every, Duration::from_secs(300));
    }
}
