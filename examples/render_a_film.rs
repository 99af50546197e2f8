//! Renders a scene on the CPU and keeps the result twice: as a picture, and as a film that can be continued.
//!
//! ```sh
//! cargo run --release --example render_a_film -- book OUTPUT-DIRECTORY
//! cargo run --release --example render_a_film -- assets/scenes/metals.toml OUTPUT-DIRECTORY
//! ```
//!
//! The scene is a built-in one (`weekender --list`) or a scene file.

use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use weekender::{
    CpuOptions, CpuRenderer, ErrorEstimate, Film, Recipe, Renderer, Status, describe, scene_file, write_image,
};

/// Samples per pixel.
const SAMPLES: u64 = 64;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "three-spheres".to_owned());
    let directory = PathBuf::from(arguments.next().unwrap_or_else(|| ".".to_owned()));

    // A recipe is what a scene file says: scene, camera, settings and the wanted samples. Nothing is checked yet.
    let mut recipe = match scene.strip_suffix(".toml") {
        Some(_) => scene_file::load(Path::new(&scene))?,
        None => Recipe::find(&scene)?,
    };
    recipe.settings.width = 400;
    recipe.settings.height = 225;
    recipe.samples_per_pixel = SAMPLES;

    let (film, error) = render(&recipe, &directory)?;
    println!("{} samples per pixel", film.sample_count());
    println!("error {:.2e} {} RMSE, linear radiance", error.rmse, error.uncertainty());
    Ok(())
}

/// Renders `recipe` and writes `NAME.png` and `NAME.exr` to `directory`. Returns the film and its estimated error.
pub fn render(recipe: &Recipe, directory: &Path) -> Result<(Film, ErrorEstimate)> {
    // The job is the checked recipe. A sample depends only on the job, its pixel and its index.
    let job = recipe.job()?;
    let mut film = job.new_film();
    let never = AtomicBool::new(false);

    // The widest kernel that this processor supports. `CpuOptions` can ask for another one, or for fewer threads.
    let mut renderer = CpuRenderer::new(CpuOptions::default())?;
    renderer.prepare(&job, &never)?;
    // Any range of samples can be added, in any order, but each only once. Here they come in two steps, to look at the
    // film in between.
    let half = recipe.samples_per_pixel / 2;
    renderer.accumulate(&job, 0..half, &mut film, &never)?;
    let early = film.error().context("no path has found light")?;
    renderer.accumulate(&job, half..recipe.samples_per_pixel, &mut film, &never)?;
    let error = film.error().context("no path has found light")?;
    println!("error {:.2e} after {half} samples per pixel", early.rmse);

    // Every file records how it was made, so that it can be opened, continued and compared.
    let description = describe(recipe, None, &film, &Status::default(), None);
    for ending in ["png", "exr"] {
        let path = directory.join(format!("{}.{ending}", recipe.name));
        write_image(&path, &film, recipe.rules.transfer, &description)?;
        println!("wrote {}", path.display());
    }
    Ok((film, error))
}
