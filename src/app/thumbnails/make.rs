//! Renders small pictures, or reads them from the cache.

use crate::app::answers::Answer;
use crate::film::Description;
use crate::job::output::{read_rgb8, write_image};
use crate::job::recipe::Recipe;
use crate::job::render::Renderer;
use crate::page::gallery::{fingerprint, is_about_pixels};
use crate::render_cpu::{CpuOptions, CpuRenderer, give_way};
use crate::stages::Stage;
use anyhow::Result;
use eframe::egui::{Vec2, vec2};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Weak;
use std::sync::atomic::AtomicBool;

/// The size of a small picture in points.
pub const SIZE: Vec2 = vec2(80.0, 45.0);

/// Samples per pixel, if the stage has as many.
const SAMPLES: u64 = 32;

/// A finished small picture.
pub(super) struct Thumbnail {
    pub stage: &'static Stage,
    pub scale: u32,
    pub size: [u32; 2],
    pub rgb8: Vec<u8>,
}

/// What the thread is to make, in this order.
pub(super) struct Request {
    pub answers: Vec<(&'static Stage, Answer<Thumbnail>)>,
    pub scale: u32,
    pub directory: Option<PathBuf>,
    /// Ends when nobody waits for the pictures any more.
    pub alive: Weak<()>,
}

/// Starts the thread.
pub(super) fn begin(request: Request) -> io::Result<()> {
    std::thread::Builder::new().name("thumbnails".to_owned()).spawn(move || {
        // The tracer's threads have a low priority already, and those of this thread get a lower one.
        give_way();
        if let Err(error) = work(request) {
            log::info!("no more small pictures of the stages: {error:#}");
        }
    })?;
    Ok(())
}

fn work(request: Request) -> Result<()> {
    let Request { answers, scale, directory, alive } = request;
    let directory = directory.map(|directory| directory.join("thumbnails"));
    let mut maker = Maker::new(scale);
    for (stage, answer) in answers {
        if alive.strong_count() == 0 {
            break;
        }
        let (size, rgb8) = maker.picture(stage, directory.as_deref())?;
        answer.give(Thumbnail { stage, scale, size, rgb8 });
    }
    log::debug!("small pictures of the stages: {} rendered, the others read", maker.rendered);
    Ok(())
}

struct Maker {
    scale: u32,
    /// Started with the first picture that is not in the cache.
    renderer: Option<CpuRenderer>,
    rendered: usize,
}

impl Maker {
    fn new(scale: u32) -> Self {
        Maker { scale, renderer: None, rendered: 0 }
    }

    /// The size and the bytes of a stage's picture. It is rendered unless `directory` has it.
    fn picture(&mut self, stage: &Stage, directory: Option<&Path>) -> Result<([u32; 2], Vec<u8>)> {
        let recipe = recipe(stage, self.scale);
        let size = [recipe.settings.width, recipe.settings.height];
        let place = directory.map(|directory| KeptFile::of(directory, &recipe, &fingerprint(&recipe)));
        if let Some(place) = &place
            && let Ok((found, rgb8)) = read_rgb8(&place.path)
            && found == size
        {
            return Ok((size, rgb8));
        }
        let renderer = match &mut self.renderer {
            Some(renderer) => renderer,
            empty => {
                let options = CpuOptions { threads: Some(1), low_priority: true, ..CpuOptions::default() };
                empty.insert(CpuRenderer::new(options)?)
            }
        };
        let job = recipe.job()?;
        let mut film = job.new_film();
        renderer.accumulate(&job, 0..recipe.samples_per_pixel, &mut film, &AtomicBool::new(false))?;
        self.rendered += 1;
        if let Some(place) = place {
            // A cache that cannot be written costs the same time again, and nothing else.
            let written = fs::create_dir_all(&place.directory).map_err(anyhow::Error::from).and_then(|()| {
                Ok(write_image(&place.path, &film, recipe.rules.transfer, &Description::default())?)
            });
            match written {
                Ok(()) => place.remove_earlier(),
                Err(error) => log::debug!("{} is not kept: {error:#}", place.path.display()),
            }
        }
        Ok((size, film.to_rgb8(recipe.rules.transfer)))
    }
}

/// The small picture of a stage.
fn recipe(stage: &Stage, scale: u32) -> Recipe {
    let mut recipe = stage.recipe();
    let settings = &mut recipe.settings;
    if !is_about_pixels(stage) {
        settings.width = SIZE.x as u32 * scale;
        settings.height = SIZE.y as u32 * scale;
    }
    settings.estimate_error = false;
    recipe.samples_per_pixel = recipe.samples_per_pixel.min(SAMPLES);
    recipe
}

/// Where a small picture is kept. Its name tells everything that it depends on.
struct KeptFile {
    directory: PathBuf,
    path: PathBuf,
    /// The part of the name that the earlier pictures of the same stage and size have, too.
    prefix: String,
}

impl KeptFile {
    fn of(directory: &Path, recipe: &Recipe, fingerprint: &str) -> Self {
        let prefix = format!("{}-{}x{}-", recipe.name, recipe.settings.width, recipe.settings.height);
        let path = directory.join(format!("{prefix}{fingerprint}.png"));
        KeptFile { directory: directory.to_owned(), path, prefix }
    }

    /// Removes the pictures that this one replaces.
    fn remove_earlier(&self) {
        for entry in fs::read_dir(&self.directory).into_iter().flatten().flatten() {
            let is_earlier = entry.file_name().to_string_lossy().starts_with(&self.prefix);
            if is_earlier && entry.path() != self.path {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}
