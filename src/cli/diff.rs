//! The flags of `weekender diff`.

use super::sources::{self, ChosenRecipe, PictureFlags};
use super::values::{backend_named, number, parse_pixel, whole};
use crate::backends::BackendChoice;
use crate::job::render::{RenderJob, SAMPLE_LIMIT};
use anyhow::{Result, bail, ensure};
use clap::Args;
use std::path::PathBuf;

/// Options of `weekender diff`.
#[derive(Debug, Args)]
#[command(next_help_heading = "Comparison")]
pub struct DiffOptions {
    /// The pixel; 0,0 is the upper left one
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, required_unless_present = "find", conflicts_with = "find")]
    pixel: Option<[u32; 2]>,
    /// Index of the sample, from 0
    #[arg(long, value_name = "NUMBER", value_parser = whole::<u64>(0..=SAMPLE_LIMIT - 1), default_value = "0",
          conflicts_with = "find")]
    pub sample: u64,
    /// Search this many samples of every pixel for the one that differs most; without --size, the picture is at most
    /// 200 pixels wide
    #[arg(long, value_name = "SAMPLES", value_parser = whole::<u64>(1..=SAMPLE_LIMIT), num_args = 0..=1,
          default_missing_value = "4")]
    pub find: Option<u64>,
    /// The two backends to compare: cpu, portable (multiply and add rounded separately), reference (f64) or gpu
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_value = "cpu,gpu")]
    sides: Vec<String>,
    /// Largest relative difference that is ignored
    #[arg(long, value_name = "SHARE", value_parser = number(0.0..=1.0, "from 0 to 1, such as 1e-4"),
          default_value = "1e-4")]
    pub tolerance: f64,
    /// Use the GPU whose name, kind, backend or driver contains this; required for a software adapter
    #[arg(long, value_name = "SUBSTRING")]
    adapter: Option<String>,
    /// Write both paths and the verdict as JSON; - for standard output
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureFlags,
}

/// Largest width of a picture that is searched if no size is given, pixels.
const FIND_WIDTH: u32 = 200;

impl DiffOptions {
    /// Checks that the JSON can be written and does not replace the scene file.
    ///
    /// # Errors
    /// If not.
    pub fn check(&self) -> Result<()> {
        let scene = sources::inputs(self.picture.scene.as_deref());
        super::check_outputs(scene.iter().map(PathBuf::as_path), self.json.as_deref())
    }

    /// The job, small for a search unless a size is given, and the name of its scene or stage.
    ///
    /// # Errors
    /// If there is no such scene, or it cannot be rendered.
    pub fn job(&self) -> Result<(String, RenderJob)> {
        let ChosenRecipe { mut recipe, stage } = sources::find(&self.picture, None)?;
        self.picture.change(&mut recipe, None);
        if self.find.is_some() && self.picture.size.is_none() && recipe.settings.width > FIND_WIDTH {
            sources::scale(&mut recipe.settings, FIND_WIDTH);
        }
        let job = recipe.job()?;
        job.check_memory(2)?;
        Ok((stage.map_or(recipe.name, |stage| stage.id.to_owned()), job))
    }

    /// The pixel, column and row.
    ///
    /// # Errors
    /// If it is not in the picture.
    pub fn pixel(&self, job: &RenderJob) -> Result<[u32; 2]> {
        let (width, height) = (job.settings().width, job.settings().height);
        let [x, y] = self.pixel.unwrap_or_default();
        ensure!(
            x < width && y < height,
            "--pixel is {x},{y}, but the picture has {width}x{height} pixels: the last one is {},{}",
            width - 1,
            height - 1
        );
        Ok([x, y])
    }

    /// The two backends.
    ///
    /// # Errors
    /// Unless two known names are given.
    pub fn sides(&self) -> Result<[BackendChoice; 2]> {
        ensure!(
            self.adapter.is_none() || self.sides.iter().any(|name| name == "gpu"),
            "--adapter needs the side gpu in --sides: it applies only to that side; otherwise leave it out"
        );
        let [a, b] = self.sides.as_slice() else {
            bail!("--sides must be two of {} separated by a comma", BackendChoice::NAMES.join(", "))
        };
        let side = |name: &str| backend_named(name, self.adapter.as_deref());
        Ok([side(a)?, side(b)?])
    }
}
