//! Keeps the film when the window ends by a panic.

use super::window::Window;
use crate::console;
use crate::describe::describe;
use crate::saved;

impl Drop for Window {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.rescue();
        }
    }
}

impl Window {
    fn rescue(&mut self) {
        let document = self.document().clone();
        if !self.main.has_samples(&document) {
            return;
        }
        let status = self.main.status().clone();
        let Some(film) = self.main.take_film().filter(|film| film.sample_count() > 0) else { return };
        let mut recipe = document.recipe();
        recipe.samples_per_pixel = film.sample_count();
        let description = describe(&recipe, document.stage(), &film, &status, self.seconds_before);
        console::note(&match saved::rescue(&[], &recipe.name, &film, &description) {
            Ok(path) => format!(
                "the picture's {} samples per pixel were saved; continue with --resume {}",
                film.sample_count(),
                path.display()
            ),
            Err(lost) => lost,
        });
    }
}
