//! The flags for rendering as clap parses them, and those that subcommands share. The flags of each subcommand are in
//! its own file.

use super::values::{
    Level, Simd, parse_defocus_angle, parse_duration, parse_focus_distance, parse_frames, parse_isa,
    parse_noise_target, parse_rate, parse_sample_range, parse_seconds, parse_simd, parse_size, parse_turn,
    parse_vector, parse_vfov, whole,
};
use crate::animation::Turn;
use crate::output::{FrameRate, PpmForm};
use crate::recipe::Recipe;
use crate::render::{DEPTH_LIMIT, SAMPLE_LIMIT, SamplerKind};
use crate::scene::VFOV_LIMITS_DEGREES;
use clap::builder::PossibleValue;
use clap::{Args, ValueEnum, ValueHint};
use glam::DVec3;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(super) struct RawRender {
    /// Render to a file, without a window; with --stage all, every stage of the book, to the directory --out
    #[arg(long)]
    pub batch: bool,
    /// List scenes, stages and devices
    #[arg(long)]
    pub list: bool,

    #[command(flatten)]
    pub picture: RawPicture,

    /// Samples per pixel, 1 to 4294967296 [default: the scene's; unlimited with --time-limit or --noise-target]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=SAMPLE_LIMIT, 100),
          allow_hyphen_values = true, help_heading = "When to stop (the first one met)")]
    pub samples: Option<u64>,
    /// Seconds of rendering
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_hyphen_values = true,
          help_heading = "When to stop (the first one met)")]
    pub time_limit: Option<f64>,
    /// Estimated error: root mean square over pixels and channels, linear radiance
    #[arg(long, value_name = "RMSE", value_parser = parse_noise_target, allow_hyphen_values = true,
          help_heading = "When to stop (the first one met)")]
    pub noise_target: Option<f64>,
    /// Render only samples A to B - 1, a part of a picture for `weekender merge`
    #[arg(long, value_name = "A..B", value_parser = parse_sample_range, conflicts_with = "samples",
          help_heading = "When to stop (the first one met)")]
    pub sample_range: Option<Range<u64>>,
    /// Keep samples in two halves, which is needed to estimate the error; off halves the memory
    /// [default: on, or the scene's]
    #[arg(long, value_enum, help_heading = "When to stop (the first one met)")]
    pub estimate_error: Option<RawSwitch>,

    #[command(flatten)]
    pub backend: RawBackend,

    #[command(flatten)]
    pub animation: RawAnimation,

    /// The picture: .png, .ppm or .exr (linear film); with --stage all, the directory; with
    /// --frames, a directory, a pattern such as turn-####.png, or an animated .png [default: SCENE.png]
    #[arg(long, value_name = "FILE", help_heading = "Files")]
    pub out: Option<PathBuf>,
    /// How a .ppm holds its numbers: as bytes (P6), or as text (P3) as in the book [default: binary]
    #[arg(long, value_enum, help_heading = "Files")]
    pub ppm: Option<RawPpm>,
    /// Keep the film so that it can be resumed or merged; it is written regularly and at the end, even after Ctrl-C. An
    /// existing file is never replaced, unless the render continues its film (--continue, --resume)
    #[arg(long, value_name = "FILE.exr", help_heading = "Files")]
    pub checkpoint: Option<PathBuf>,
    /// Continue the film of --checkpoint if it exists, so that one command starts a render and continues it
    #[arg(long = "continue", requires = "checkpoint", conflicts_with = "resume", help_heading = "Files")]
    pub go_on: bool,
    /// Interval at which --checkpoint is written, the most that a power cut can cost: 0.1s to 30d, such as 30s, 5m or
    /// 1h
    /// [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, allow_hyphen_values = true,
          help_heading = "Files")]
    pub every: Option<Duration>,
    /// Continue a film; without --scene and --stage, with its own scene
    #[arg(long, value_name = "FILE.exr", help_heading = "Files")]
    pub resume: Option<PathBuf>,
    /// Write the scene, with the changes of the other flags, as a scene file
    #[arg(long, value_name = "FILE.toml", help_heading = "Files")]
    pub save_scene: Option<PathBuf>,
    /// Write the final figures as JSON; - for standard output
    #[arg(long, value_name = "FILE|-", help_heading = "Files")]
    pub json: Option<PathBuf>,

    /// What draws the window; auto: wgpu, or gl if there is no hardware adapter
    #[arg(long, value_enum, default_value = "auto", conflicts_with = "batch")]
    pub draw_with: DrawWith,

    /// Open the window with its usual first picture instead of what was shown last
    #[arg(long, conflicts_with = "batch")]
    pub fresh: bool,

    /// After how much tracing the window saves the film by itself, and how often, 0.1s to 30d [default: 60s]
    #[arg(long, value_name = "DURATION", value_parser = parse_duration, allow_hyphen_values = true, hide = true)]
    pub autosave_every: Option<Duration>,

    /// Write the times of the window's frames to a file
    #[arg(long, value_name = "FILE", hide = true)]
    pub frame_log: Option<PathBuf>,

    /// Show progress on standard error; auto: if it is a terminal
    #[arg(long, value_enum, default_value = "auto")]
    pub progress: ProgressChoice,
}

/// The flags of animations.
#[derive(Debug, Args)]
pub(super) struct RawAnimation {
    /// Render frames A to B - 1 of an animation to --out; the camera moves by --turntable or by the keyframes of the scene
    /// file [default with --turntable: one turn]
    #[arg(long, value_name = "A..B", value_parser = parse_frames, allow_hyphen_values = true,
          help_heading = "Animation")]
    pub frames: Option<Range<u32>>,
    /// Let the camera circle around --look-at about --vup: the frames of a turn, or the degrees between two frames, such
    /// as 1.5deg or -3deg [without a value: 120 frames]
    #[arg(long, value_name = "FRAMES|DEGREES", value_parser = parse_turn, num_args = 0..=1,
          require_equals = true, default_missing_value = "120", help_heading = "Animation")]
    pub turntable: Option<Turn>,
    /// Frames per second of an animated PNG: a whole number or a fraction such as 30000/1001 [default: 30]
    #[arg(long, value_name = "RATE", value_parser = parse_rate, allow_hyphen_values = true,
          help_heading = "Animation")]
    pub fps: Option<FrameRate>,
}

/// What renders; all commands that render a picture share these flags.
#[derive(Debug, Args)]
pub(super) struct RawBackend {
    /// What renders; auto: the fastest available; cpu,gpu: both at once, into one film
    #[arg(long, value_enum, default_value = "auto", help_heading = "Device")]
    pub device: RawDevice,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING", help_heading = "Device")]
    pub adapter: Option<String>,
    /// Lose the GPU after this many dispatches, to see that the CPU continues (fault injection)
    #[arg(long, value_name = "DISPATCHES", help_heading = "Device")]
    pub simulate_device_lost: Option<u64>,
    /// Use up the GPU's memory after this many dispatches (fault injection)
    #[arg(
        long,
        value_name = "DISPATCHES",
        hide = true,
        conflicts_with = "simulate_device_lost",
        help_heading = "Device"
    )]
    pub simulate_out_of_memory: Option<u64>,
    /// Make an invalid call after this many dispatches (fault injection)
    #[arg(long, value_name = "DISPATCHES", hide = true,
          conflicts_with_all = ["simulate_device_lost", "simulate_out_of_memory"], help_heading = "Device")]
    pub simulate_invalid_call: Option<u64>,
    /// Let the GPU not answer for 10 s after this many dispatches (fault injection)
    #[arg(long, value_name = "DISPATCHES", hide = true,
          conflicts_with_all = ["simulate_device_lost", "simulate_out_of_memory", "simulate_invalid_call"],
          help_heading = "Device")]
    pub simulate_hang: Option<u64>,
    /// Let the CPU's tracer panic after this many tiles (fault injection)
    #[arg(long, value_name = "TILES", hide = true, help_heading = "Device")]
    pub simulate_panic: Option<u64>,
    /// Let the program panic once the film has this many samples per pixel (fault injection)
    #[arg(long, value_name = "SAMPLES", hide = true, help_heading = "Device")]
    pub simulate_crash: Option<u64>,
    /// Lanes of the CPU's packets: auto, off (1), 4, 8, 16
    #[arg(long, value_name = "LANES", value_parser = parse_simd, default_value = "auto",
          help_heading = "Device")]
    pub simd: Simd,
    /// Instruction level of the CPU, for tests and benchmarks: auto, portable, sse4.2, avx2, avx512, neon
    #[arg(long, value_name = "LEVEL", value_parser = parse_isa, default_value = "auto",
          help_heading = "Device")]
    pub isa: Level,
    /// CPU threads, 1 to 1024 [default: one per core]
    #[arg(long, value_name = "COUNT", value_parser = whole(1..=1024_u64, 8),
          allow_hyphen_values = true, help_heading = "Device")]
    pub threads: Option<u64>,
}

/// What is rendered; rendering and comparing share these flags.
#[derive(Debug, Default, PartialEq, Args)]
pub(super) struct RawPicture {
    /// A built-in scene, field:N for a field of N spheres, or a scene file [default: three-spheres]
    #[arg(long, value_name = "NAME|FILE.toml", value_hint = ValueHint::FilePath, conflicts_with = "stage",
          help_heading = "Picture")]
    pub scene: Option<String>,
    /// A stage of the book; --list shows them
    #[arg(long, value_name = "ID", help_heading = "Picture")]
    pub stage: Option<String>,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size, help_heading = "Picture")]
    pub size: Option<(u32, u32)>,
    /// Maximum number of rays per path, including the camera's, 1 to 10000 [default: the scene's]
    #[arg(long, value_name = "RAYS", value_parser = whole(1..=DEPTH_LIMIT, 50),
          allow_hyphen_values = true, help_heading = "Picture")]
    pub depth: Option<u32>,
    /// Source of random numbers: scrambled Sobol points, or independent numbers as in the book
    /// [default: sobol, or the scene's]
    #[arg(long, value_enum, help_heading = "Picture")]
    pub sampler: Option<SamplerKind>,
    /// Seed: pictures with different seeds differ only in their noise, 0 to 4294967295 [default: 0, or the scene's]
    #[arg(long, value_name = "NUMBER", value_parser = whole(0..=u32::MAX, 7),
          allow_hyphen_values = true, help_heading = "Picture")]
    pub seed: Option<u32>,

    /// Position of the eye, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub look_from: Option<DVec3>,
    /// The point in the centre of the picture, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub look_at: Option<DVec3>,
    /// Up direction of the picture, not parallel to the view; its length does not matter
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub vup: Option<DVec3>,
    #[arg(help = format!("Vertical field of view, {} to {} degrees", VFOV_LIMITS_DEGREES[0], VFOV_LIMITS_DEGREES[1]),
          long, value_name = "DEGREES", value_parser = parse_vfov, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub vfov: Option<f64>,
    /// Angle of the cone from the focus point to the lens, from 0 (a pinhole) to below 179 degrees
    #[arg(long, value_name = "DEGREES", value_parser = parse_defocus_angle, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub defocus_angle: Option<f64>,
    /// Distance to the plane in focus, above 0 scene units
    #[arg(long, value_name = "UNITS", value_parser = parse_focus_distance, allow_hyphen_values = true,
          help_heading = "Camera (default: the scene's)")]
    pub focus_distance: Option<f64>,
}

impl RawPicture {
    /// Whether any of these flags is given.
    pub fn is_given(&self) -> bool {
        *self != RawPicture::default()
    }

    /// The flags of the camera, and whether each is given.
    pub fn camera_flags(&self) -> [(&'static str, bool); 6] {
        [
            ("--look-from", self.look_from.is_some()),
            ("--look-at", self.look_at.is_some()),
            ("--vup", self.vup.is_some()),
            ("--vfov", self.vfov.is_some()),
            ("--defocus-angle", self.defocus_angle.is_some()),
            ("--focus-distance", self.focus_distance.is_some()),
        ]
    }

    /// Whether all stages are requested instead of one picture.
    pub fn is_every_stage(&self) -> bool {
        self.stage.as_deref() == Some("all")
    }
}

/// What draws the window; independent of what traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum DrawWith {
    /// Whatever is faster on this machine.
    #[default]
    Auto,
    /// Vulkan, Metal or DX12.
    Wgpu,
    /// OpenGL.
    Gl,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RawDevice {
    Auto,
    Cpu,
    Gpu,
    #[value(name = "cpu,gpu", alias = "gpu,cpu")]
    Both,
    Reference,
}

impl ValueEnum for SamplerKind {
    fn value_variants<'a>() -> &'a [Self] {
        &SamplerKind::ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.name()))
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RawPpm {
    Binary,
    Ascii,
}

impl RawPpm {
    pub fn form(self) -> PpmForm {
        match self {
            RawPpm::Binary => PpmForm::Binary,
            RawPpm::Ascii => PpmForm::Ascii,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RawSwitch {
    On,
    Off,
}

/// Whether progress is shown on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressChoice {
    /// If standard error is a terminal.
    Auto,
    /// Always; as lines if it is not a terminal.
    On,
    /// Never.
    Off,
}

/// Replaces values of the recipe by those of the flags.
pub(super) fn change(recipe: &mut Recipe, raw: &RawPicture, estimate_error: Option<RawSwitch>) {
    fn set<T: Copy>(value: &mut T, flag: Option<T>) {
        if let Some(flag) = flag {
            *value = flag;
        }
    }
    let settings = &mut recipe.settings;
    set(&mut settings.width, raw.size.map(|(width, _)| width));
    set(&mut settings.height, raw.size.map(|(_, height)| height));
    set(&mut settings.max_depth, raw.depth);
    set(&mut settings.sampler, raw.sampler);
    set(&mut settings.seed, raw.seed);
    set(&mut settings.estimate_error, estimate_error.map(|switch| switch == RawSwitch::On));
    let camera = &mut recipe.camera;
    set(&mut camera.look_from, raw.look_from);
    set(&mut camera.look_at, raw.look_at);
    set(&mut camera.vup, raw.vup);
    set(&mut camera.vfov_degrees, raw.vfov);
    set(&mut camera.defocus_angle_degrees, raw.defocus_angle);
    if raw.focus_distance.is_some() {
        camera.focus_distance = raw.focus_distance;
    }
}
