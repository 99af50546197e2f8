//! Keeps the film when the window ends by a panic.

use super::model::session::Session;
use super::recovery::write_film;
use super::window::Window;
use crate::console;
use crate::describe::{counted, describe};
use crate::saved;

impl Drop for Window {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.rescue();
        }
    }
}

impl Window {
    /// Writes the film where the next window looks for it, otherwise wherever there is room.
    fn rescue(&mut self) {
        self.recovery.autosave.finish();
        self.write_slots();
        let document = self.document().clone();
        if !self.main.has_samples(&document) {
            return;
        }
        let status = self.main.status().clone();
        let Some(film) = self.main.take_film().filter(|film| film.sample_count() > 0) else { return };
        let words = format!("the picture's {} per pixel were saved", counted(film.sample_count(), "sample"));
        let kept = self.recovery.files.as_ref().map(|files| {
            write_film(files.film(), &film, (&document, &status), self.seconds_before)?;
            // The film says what it is a picture of; the note adds the view.
            let session = Session::of(&document, &self.model.view, self.model.is_paused);
            let _ = files.write_note(&session.with_film(true));
            Ok::<_, String>(files.film().to_owned())
        });
        if let Some(Ok(path)) = kept {
            let path = path.display();
            console::note(&format!("{words}; the next window offers them, or continue with --resume {path}"));
            return;
        }
        let mut recipe = document.recipe();
        recipe.samples_per_pixel = film.sample_count();
        let description = describe(&recipe, document.stage(), &film, &status, self.seconds_before);
        console::note(&match saved::rescue(&[], &recipe.name, &film, &description) {
            Ok(path) => format!("{words}; continue with --resume {}", path.display()),
            Err(lost) => lost,
        });
    }
}
