//! Renders small pictures, or reads them from the cache.

use crate::app::answers::Answer;
use crate::film::Description;
use crate::gallery::{fingerprint, is_about_pixels};
use crate::output::{read_rgb8, write_image};
use crate::recipe::Recipe;
use crate::render::Renderer;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answers::Answers;
    use eframe::egui::Context;
    use std::collections::BTreeSet;
    use std::sync::Arc;
    use std::time::SystemTime;

    fn stage(id: &str) -> &'static Stage {
        Stage::find(id).unwrap()
    }

    fn names(directory: &Path) -> BTreeSet<String> {
        fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn small_pictures_have_few_samples_and_the_pixels_of_the_screen() {
        let of = |id, scale| {
            let recipe = recipe(stage(id), scale);
            assert!(!recipe.settings.estimate_error);
            ([recipe.settings.width, recipe.settings.height], recipe.samples_per_pixel)
        };
        assert_eq!([of("book", 1), of("book", 3)], [([80, 45], 32), ([240, 135], 32)]);
        assert_eq!([of("ppm-tiny", 1), of("ppm-tiny", 3)], [([16, 9], 1); 2]);
    }

    #[test]
    fn what_is_in_the_cache_is_not_rendered_again() {
        let directory = tempfile::tempdir().unwrap();
        let mut first = Maker::new(1);
        for id in ["ppm-tiny", "metal", "book"] {
            first.picture(stage(id), Some(directory.path())).unwrap();
        }
        assert_eq!(first.rendered, 3);
        let mut second = Maker::new(1);
        for id in ["ppm-tiny", "metal", "book"] {
            let alone = Maker::new(1).picture(stage(id), None).unwrap();
            assert!(alone.1.chunks_exact(3).any(|pixel| *pixel != alone.1[..3]), "{id} has one colour");
            assert!(second.picture(stage(id), Some(directory.path())).unwrap() == alone, "{id}");
        }
        assert_eq!(second.rendered, 0);
        assert_eq!(
            Maker::new(2).picture(stage("metal"), Some(directory.path())).unwrap().0,
            [160, 90]
        );
        assert_eq!(names(directory.path()).len(), 4, "each size is kept");
    }

    #[test]
    fn a_picture_of_another_recipe_or_tracer_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let mut maker = Maker::new(1);
        let metal = recipe(stage("metal"), 1);
        let stale = KeptFile::of(directory.path(), &metal, "0123456789abcdef");
        fs::write(&stale.path, "of an earlier tracer").unwrap();
        let other = KeptFile::of(directory.path(), &recipe(stage("metal-fuzzy"), 1), "0123456789abcdef");
        fs::write(&other.path, "of another stage").unwrap();
        let (_, rgb8) = maker.picture(stage("metal"), Some(directory.path())).unwrap();
        assert_eq!((maker.rendered, rgb8.len()), (1, 80 * 45 * 3));
        assert!(!stale.path.exists() && other.path.exists());
        // So does every change of the recipe, because the name tells it.
        let mut changed = metal.clone();
        changed.camera.vfov_degrees += 1.0;
        assert_ne!(fingerprint(&metal), fingerprint(&changed));
    }

    #[test]
    fn a_damaged_picture_is_rendered_again() {
        let directory = tempfile::tempdir().unwrap();
        let mut maker = Maker::new(1);
        let whole = maker.picture(stage("sky"), Some(directory.path())).unwrap();
        let name = names(directory.path()).pop_first().unwrap();
        let path = directory.path().join(&name);
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        assert!(maker.picture(stage("sky"), Some(directory.path())).unwrap() == whole);
        assert_eq!((maker.rendered, names(directory.path())), (2, BTreeSet::from([name])));
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }

    #[test]
    fn a_cache_that_cannot_be_written_is_no_error() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("file");
        fs::write(&file, "").unwrap();
        let before: SystemTime = fs::metadata(&file).unwrap().modified().unwrap();
        let mut maker = Maker::new(1);
        for _ in 0..2 {
            maker.picture(stage("sky"), Some(&file.join("thumbnails"))).unwrap();
        }
        assert_eq!((maker.rendered, fs::metadata(&file).unwrap().modified().unwrap()), (2, before));
    }

    #[test]
    fn pictures_are_given_in_the_order_of_the_request_while_somebody_waits() {
        let (context, directory) = (Context::default(), tempfile::tempdir().unwrap());
        let alive = Arc::new(());
        for (waits, expected) in [(true, vec!["sky", "ppm-tiny"]), (false, Vec::new())] {
            let made = Answers::default();
            let answers = ["sky", "ppm-tiny"].map(|id| (stage(id), made.answer(&context))).into();
            let alive = if waits { Arc::downgrade(&alive) } else { Weak::new() };
            let directory = Some(directory.path().to_owned());
            work(Request { answers, scale: 1, directory, alive }).unwrap();
            let mut ids = Vec::new();
            while let Some(Thumbnail { stage, scale, size, rgb8 }) = made.take() {
                let recipe = recipe(stage, 1);
                assert_eq!((scale, size), (1, [recipe.settings.width, recipe.settings.height]));
                assert_eq!(rgb8.len() as u32, 3 * size[0] * size[1]);
                ids.push(stage.id);
            }
            assert_eq!(ids, expected);
        }
        assert_eq!(names(&directory.path().join("thumbnails")).len(), 2, "they are kept");
    }
}
