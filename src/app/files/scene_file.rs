//! The scene file of the picture is read again when another program has changed it.

use crate::app::model::{Origin, Source};
use crate::app::toolkit::Answers;
use crate::job::recipe::{Recipe, file};
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Weak};
use std::thread;
use std::time::{Duration, SystemTime};

const LOOKS_APART: Duration = Duration::from_millis(500);

#[derive(Default)]
pub struct SceneFile {
    /// The origin whose file is watched, until the token is dropped.
    watched: Option<(Arc<Origin>, Arc<()>)>,
    pub reread: Answers<Recipe>,
}

impl SceneFile {
    pub fn watch(&mut self, context: &Context, origin: &Arc<Origin>) {
        if self.watched.as_ref().is_some_and(|(watched, _)| Arc::ptr_eq(watched, origin)) {
            return;
        }
        *self = SceneFile::default();
        let Source::File(path) = &origin.source else { return };
        let token = Arc::new(());
        let (path, answer) = (path.clone(), self.reread.answer(context));
        let needed = Arc::downgrade(&token);
        let read = move |path: &Path| {
            let recipe = file::load(path).map_err(|error| error.to_string());
            let recipe = recipe.and_then(|recipe| match recipe.job() {
                Ok(_) => Ok(recipe),
                Err(error) => Err(error.to_string()),
            });
            answer.give(recipe);
        };
        let look = move || look_repeatedly(&path, &needed, read);
        if let Err(error) = thread::Builder::new().name("scene file".to_owned()).spawn(look) {
            log::warn!("changes of the scene file will not be noticed: {error}");
        }
        self.watched = Some((Arc::clone(origin), token));
    }
}

/// A file's length and modification time, which change with its content. None if it is no regular file.
fn stamp_of(path: &Path) -> Option<(u64, Option<SystemTime>)> {
    let found = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    Some((found.len(), found.modified().ok()))
}

/// Reports each change of the file, or of the table of spheres that it names, once it has settled.
fn look_repeatedly(path: &Path, needed: &Weak<()>, report: impl Fn(&Path)) {
    let stamps = |inputs: &[PathBuf]| inputs.iter().map(|path| stamp_of(path)).collect::<Vec<_>>();
    let mut inputs = file::inputs(path);
    let mut known = stamps(&inputs);
    let mut last = known.clone();
    while needed.strong_count() > 0 {
        thread::sleep(LOOKS_APART);
        let now = stamps(&inputs);
        if now == last && now != known && now[0].is_some() {
            inputs = file::inputs(path);
            known = stamps(&inputs);
            report(path);
        }
        last = now;
    }
}
