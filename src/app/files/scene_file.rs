//! The scene file of the picture is read again when another program has changed it.

use crate::app::model::{Origin, Source, stamp_of};
use crate::app::toolkit::answers::Answers;
use crate::app::window::Window;
use crate::job::recipe::{Recipe, file};
use eframe::egui::Context;
use std::path::Path;
use std::sync::{Arc, Weak};
use std::thread;
use std::time::Duration;

const LOOKS_APART: Duration = Duration::from_millis(500);

#[derive(Default)]
pub struct SceneFile {
    /// The origin whose file is watched, until the token is dropped.
    watched: Option<(Arc<Origin>, Arc<()>)>,
    reread: Answers<Recipe>,
}

impl SceneFile {
    fn watch(&mut self, context: &Context, origin: &Arc<Origin>) {
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

/// Reports each change of the file once it has settled.
fn look_repeatedly(path: &Path, needed: &Weak<()>, report: impl Fn(&Path)) {
    let (mut known, mut last) = (stamp_of(path), stamp_of(path));
    while needed.strong_count() > 0 {
        thread::sleep(LOOKS_APART);
        let now = stamp_of(path);
        if now == last && now != known && now.is_some() {
            known.clone_from(&now);
            report(path);
        }
        last = now;
    }
}

impl Window {
    /// Watches the scene file, and takes what was read from it again.
    pub(in crate::app) fn follow_scene_file(&mut self, context: &Context) {
        let origin = Arc::clone(&self.document().origin);
        self.files.scene_file.watch(context, &origin);
        let Source::File(path) = &origin.source else { return };
        let name = path.file_name().unwrap_or(path.as_os_str()).display();
        while let Some(recipe) = self.files.scene_file.reread.take() {
            let is_own = self.document().checked.file().is_some_and(|saved| saved == *path);
            match recipe {
                _ if is_own => {}
                Ok(recipe) => {
                    let reloaded = self.document().reloaded(recipe);
                    self.show_document(reloaded);
                    self.shell.toasts.good(format!("Reloaded {name}; Undo returns"));
                }
                Err(reason) => self.shell.toasts.bad(format!(
                    "Not reloaded: {reason}. The picture shows the last version that could be read"
                )),
            }
        }
    }
}
