//! Keeps the film when the window ends by a panic.

use super::model::session::Session;
use super::recovery::write_film;
use super::window::Window;
use crate::job::saved;
use crate::progressive::describe::{counted, describe};
use crate::system::console;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::kept::Kept;
    use crate::app::model::slots::{Slot, SlotNumber};
    use crate::app::recovery::RecoveryFiles;
    use crate::app::tests::{until, window};
    use crate::film::checkpoint::FilmFile;
    use crate::film::{Film, checkpoint, key};
    use crate::job::recipe::{Recipe, file};
    use eframe::egui::Context;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::path::Path;

    /// Seconds that earlier windows have traced, much longer than a test.
    const BEFORE: f64 = 1e6;

    /// A window of this scene file that goes on with an earlier film and has traced some samples itself.
    fn traced(scene: &Path) -> Window {
        std::fs::write(scene, file::to_toml(&Recipe::builtin("three-spheres").unwrap())).unwrap();
        let words =
            format!("weekender --scene {} --size 16x9 --samples 4000000000 --device cpu", scene.display());
        let mut window = window(&words);
        let has_some = |window: &Window| window.status().samples_per_pixel >= 4;
        until(&mut window, &Context::default(), "the samples", has_some);
        window.seconds_before = Some(BEFORE);
        window
    }

    /// Asserts that the film tells the time of all its samples, each counted once.
    fn assert_seconds(read: &FilmFile) {
        let seconds: f64 = read.description.get(key::SECONDS).unwrap().parse().unwrap();
        assert!((BEFORE..1.5 * BEFORE).contains(&seconds), "{seconds}");
    }

    fn panic_with(window: Window) {
        let outcome: std::thread::Result<()> = catch_unwind(AssertUnwindSafe(move || {
            let _window = window;
            panic!("injected fault");
        }));
        assert!(outcome.is_err());
    }

    #[test]
    fn a_panic_leaves_the_film_and_the_kept_pictures_to_the_next_window() {
        let directory = tempfile::tempdir().unwrap();
        let mut window = traced(&directory.path().join("mine.toml"));
        let files = RecoveryFiles::claim(directory.path()).unwrap();
        window.begin_slots(&files, u64::MAX);
        window.recovery.files = Some(files);
        let mut film = Film::new(16, 9, 2);
        film.record(0..2, 0).unwrap();
        let kept = Kept::new(window.document().clone(), film, Default::default(), None);
        let (number, id) = (SlotNumber::ALL[4], kept.id.clone());
        window.model.view.slots.put(number, Slot { name: "my picture".to_owned(), kept: kept.into() });
        (window.model.view.tone.exposure, window.model.is_paused) = (1.5, true);
        panic_with(window);

        let [left] = RecoveryFiles::left_in(directory.path()).try_into().unwrap();
        let read = checkpoint::load(left.film()).unwrap();
        assert!(read.film.sample_count() >= 4 && read.film.width() == 16);
        assert_seconds(&read);
        let note = left.note().unwrap().unwrap();
        assert!(note.has_film);
        let restored = note.restore().unwrap();
        assert_eq!((restored.view.tone.exposure, restored.is_paused), (1.5, true));
        let listing = left.slots().listing().unwrap();
        let [entry] = &listing.entries[..] else { panic!("{listing:?}") };
        assert_eq!((entry.number, &entry.id, entry.name.as_str()), (Some(number), &id, "my picture"));
        assert_eq!(listing.faults, <[String; 0]>::default());
    }
}
