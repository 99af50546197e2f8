//! A document whose scene file has been read again.

use super::{Document, Origin};
use crate::job::recipe::Recipe;
use crate::job::render::RenderSettings;

impl Document {
    /// The document of what its scene file holds now. Camera, settings, size and stop conditions that differ from those of
    /// the file as it was stay; changed spheres do not.
    pub fn reloaded(&self, recipe: Recipe) -> Document {
        let before = &self.origin;
        let mut document = Document::new(Origin::new(recipe, before.source.clone()));
        if self.camera != before.recipe.camera {
            document.camera = self.camera;
        }
        let size = document.size();
        let [mine, theirs] =
            [&self.settings, &before.recipe.settings].map(|of| RenderSettings { width: 0, height: 0, ..*of });
        if mine != theirs {
            document.settings = self.settings;
        }
        document.has_own_size = self.has_own_size;
        let is_files = self.has_own_size && self.size() == before.size();
        document.set_size(if is_files { size } else { self.size() });
        if self.stop != before.usual_stop() {
            document.stop = self.stop;
        }
        document
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Source;
    use crate::progressive::Stop;
    use crate::stages::Stage;
    use std::sync::Arc;

    #[test]
    fn what_the_user_has_changed_stays_and_the_rest_is_the_files() {
        let recipe = Stage::find("metal").unwrap().recipe();
        let document = Document::new(Origin::new(recipe.clone(), Source::File("a.toml".into())));
        let mut other = recipe.clone();
        Arc::make_mut(&mut other.scene).spheres[0].radius = 7.0;
        other.camera.vfov_degrees = 33.0;
        (other.settings.width, other.settings.height, other.settings.seed) = (64, 36, 5);

        let reloaded = document.reloaded(other.clone());
        assert_eq!(reloaded.origin.source, Source::File("a.toml".into()));
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, other.camera));
        assert_eq!(reloaded.settings, other.settings);
        assert!(!reloaded.is_changed());

        let mut moved = document.clone();
        moved.camera.look_from.x += 1.0;
        moved.settings.max_depth = 7;
        moved.give_size([32, 20]);
        moved.stop = Stop::at_samples(9);
        let reloaded = moved.reloaded(other.clone());
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, moved.camera));
        assert_eq!((reloaded.settings, reloaded.size()), (moved.settings, [32, 20]));
        assert_eq!(reloaded.stop, Stop::at_samples(9));

        let mut moved = document;
        moved.settings.max_depth = 7;
        let reloaded = moved.reloaded(other);
        assert_eq!((reloaded.settings.max_depth, reloaded.size()), (7, [64, 36]), "the size was not changed");
    }
}
