//! A document whose scene file has been read again.

use super::{Document, Origin};
use crate::job::recipe::Recipe;

impl Document {
    /// The document of what its scene file holds now, seen by the user's camera if that is not the file's.
    pub fn reloaded(&self, recipe: Recipe) -> Document {
        let mut document = Document::new(Origin::new(recipe, self.origin.source.clone()));
        if self.camera != self.origin.recipe.camera {
            document.camera = self.camera;
        }
        document
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Source;
    use crate::stages::Stage;
    use std::sync::Arc;

    #[test]
    fn the_users_camera_stays_and_the_rest_is_the_files() {
        let recipe = Stage::find("metal").unwrap().recipe();
        let document = Document::new(Origin::new(recipe.clone(), Source::File("a.toml".into())));
        let mut other = recipe;
        Arc::make_mut(&mut other.scene).spheres[0].radius = 7.0;
        other.camera.vfov_degrees = 33.0;
        let reloaded = document.reloaded(other.clone());
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, other.camera));
        let mut moved = document;
        moved.camera.look_from.x += 1.0;
        let reloaded = moved.reloaded(other.clone());
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, moved.camera));
    }
}
