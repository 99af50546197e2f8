//! The flags of a picture, which rendering, planning and comparing share, and the values that several commands take.

use super::values::{number, parse_size, parse_vector, whole};
use crate::job::recipe::Recipe;
use crate::job::render::{DEPTH_LIMIT, SamplerKind};
use crate::scene::VFOV_LIMITS_DEGREES;
use clap::{Args, ValueEnum, ValueHint};
use glam::DVec3;

/// What is rendered.
#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Picture")]
pub(super) struct RawPicture {
    /// A built-in scene, field:N for a field of N spheres, or a scene file [default: three-spheres]
    #[arg(long, value_name = "NAME|FILE.toml", value_hint = ValueHint::FilePath, conflicts_with = "stage")]
    pub scene: Option<String>,
    /// A stage of the book; --list shows them
    #[arg(long, value_name = "ID")]
    pub stage: Option<String>,
    /// Width and height in pixels, each 1 to 16384 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Maximum number of rays per path, including the camera's, 1 to 10000 [default: the scene's]
    #[arg(long, value_name = "RAYS", value_parser = whole(1..=DEPTH_LIMIT, 50))]
    pub depth: Option<u32>,
    /// Source of random numbers: scrambled Sobol points, or independent numbers as in the book
    /// [default: sobol, or the scene's]
    #[arg(long, value_enum)]
    pub sampler: Option<SamplerKind>,
    /// Seed: pictures with different seeds differ only in their noise, 0 to 4294967295 [default: 0, or the scene's]
    #[arg(long, value_name = "NUMBER", value_parser = whole(0..=u32::MAX, 7))]
    pub seed: Option<u32>,
    #[command(flatten)]
    pub camera: CameraFlags,
}

#[derive(Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Camera (default: the scene's)")]
pub(super) struct CameraFlags {
    /// Position of the eye, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    look_from: Option<DVec3>,
    /// The point in the centre of the picture, scene units
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    look_at: Option<DVec3>,
    /// Up direction of the picture, not parallel to the view; its length does not matter
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_vector, allow_hyphen_values = true)]
    vup: Option<DVec3>,
    #[arg(help = format!("Vertical field of view, {} to {} degrees", VFOV_LIMITS_DEGREES[0], VFOV_LIMITS_DEGREES[1]),
          long, value_name = "DEGREES", value_parser = number(.., "a number, such as 20"), allow_hyphen_values = true)]
    vfov: Option<f64>,
    /// Angle of the cone from the focus point to the lens, from 0 (a pinhole) to below 179 degrees
    #[arg(long, value_name = "DEGREES", value_parser = number(.., "a number, such as 0.6"), allow_hyphen_values = true)]
    defocus_angle: Option<f64>,
    /// Distance to the plane in focus, above 0 scene units
    #[arg(long, value_name = "UNITS", value_parser = number(.., "a number, such as 10"), allow_hyphen_values = true)]
    pub focus_distance: Option<f64>,
}

impl RawPicture {
    /// Whether any of these flags is given.
    pub fn is_given(&self) -> bool {
        *self != RawPicture::default()
    }
}

/// What draws the window; independent of what traces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum DrawWith {
    /// Whatever is faster on this machine
    #[default]
    Auto,
    /// Vulkan, Metal or DX12
    Wgpu,
    /// OpenGL
    Gl,
}

/// Whether progress is shown on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressChoice {
    /// If standard error is a terminal
    Auto,
    /// Always; as lines if it is not a terminal
    On,
    /// Never
    Off,
}

/// Replaces values of the recipe by those of the flags.
pub(super) fn change(recipe: &mut Recipe, raw: &RawPicture, estimate_error: Option<bool>) {
    fn set<T: Copy>(value: &mut T, flag: Option<T>) {
        *value = flag.unwrap_or(*value);
    }
    let (settings, camera, flags) = (&mut recipe.settings, &mut recipe.camera, &raw.camera);
    set(&mut settings.width, raw.size.map(|(width, _)| width));
    set(&mut settings.height, raw.size.map(|(_, height)| height));
    set(&mut settings.max_depth, raw.depth);
    set(&mut settings.sampler, raw.sampler);
    set(&mut settings.seed, raw.seed);
    set(&mut settings.estimate_error, estimate_error);
    set(&mut camera.look_from, flags.look_from);
    set(&mut camera.look_at, flags.look_at);
    set(&mut camera.vup, flags.vup);
    set(&mut camera.vfov_degrees, flags.vfov);
    set(&mut camera.defocus_angle_degrees, flags.defocus_angle);
    camera.focus_distance = flags.focus_distance.or(camera.focus_distance);
}
