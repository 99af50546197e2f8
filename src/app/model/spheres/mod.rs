//! The spheres of the scene: the selected one, edits, and where the camera is among them.

pub mod grip;
pub mod silhouette;

use crate::app::model::{Body, CheckedScene, Edit, Model};
use crate::job::render::TRACING_BYTES_PER_SPHERE;
use crate::scene::{Camera, Material, Scene, Sphere};
use crate::system::memory;
use std::sync::Arc;

/// Scenes with more spheres than this are not searched in each frame.
pub const MANY: usize = 50_000;

/// A sphere with a radius of this many times the distance to the point looked at is ground.
const GROUND: f64 = 2.0;

/// The selected sphere as the panel and the picture show it.
#[derive(Clone, Debug)]
pub struct Selected {
    /// Its index.
    pub sphere: usize,
    pub body: Body,
    /// The name of its material.
    pub material: String,
}

impl Selected {
    pub fn of(model: &Model) -> Option<Self> {
        let (sphere, scene) = (model.selected?, model.document.scene());
        let body = Body::of(scene, sphere)?;
        let material = scene.materials[scene.spheres[sphere].material].name.clone();
        Some(Selected { sphere, body, material })
    }
}

/// Edits the scene.
///
/// # Errors
/// Why the scene would be invalid; it is then as before.
pub fn edit(model: &mut Model, edit: Edit) -> Result<(), String> {
    let document = &model.document;
    let (scene, recipe) = (document.scene(), &document.origin.recipe);
    let count = scene.spheres.len() as u64 + 1;
    memory::check(
        || format!("a changed copy of {count} spheres"),
        count * (size_of::<Sphere>() as u64 + TRACING_BYTES_PER_SPHERE),
        "save the scene and open it again, which frees the copies that undo keeps",
    )
    .map_err(|error| error.to_string())?;
    let mut scene = scene.clone();
    let selected = edit.apply(&mut scene);
    // A value that was typed or dragged back is not a change.
    let checked = if scene == *recipe.scene {
        Arc::clone(&document.origin.scene)
    } else {
        let mut checked = CheckedScene::new(Arc::new(scene), recipe.rules);
        checked.change = edit.name(document.scene());
        checked.check().map_err(|error| error.to_string())?;
        Arc::new(checked)
    };
    (model.document.checked, model.selected) = (checked, selected);
    Ok(())
}

/// The sphere after or before the selected one, in the order of the scene; the first or last if none is selected.
pub fn neighbour(scene: &Scene, selected: Option<usize>, is_next: bool) -> Option<usize> {
    let count = scene.spheres.len();
    let step = if is_next { 1 } else { count.checked_sub(1)? };
    let from = selected.unwrap_or(if is_next { count.checked_sub(1)? } else { 0 });
    (count > 0).then(|| (from + step) % count)
}

/// The opaque ground below the camera.
pub fn ground<'a>(scene: &'a Scene, camera: &'a Camera) -> impl Iterator<Item = &'a Sphere> {
    let is_opaque = |sphere: &&Sphere| !matches!(scene.material_of(sphere), Material::Dielectric { .. });
    let is_below = |sphere: &&Sphere| is_ground(sphere, camera) && clearance(sphere, camera.look_from) > 0.0;
    scene.spheres.iter().filter(is_below).filter(is_opaque)
}

pub fn is_ground(sphere: &Sphere, camera: &Camera) -> bool {
    sphere.radius >= GROUND * camera.look_from.distance(camera.look_at)
}

/// From the surface of a sphere to the eye; negative inside.
pub fn clearance(sphere: &Sphere, eye: glam::DVec3) -> f64 {
    eye.distance(sphere.center) - sphere.radius.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::window;
    use glam::DVec3;

    #[test]
    fn an_edit_is_made_at_once_or_refused_with_the_scene_as_before() {
        let mut window = window("weekender --scene field:100000 --size 16x9 --samples 1 --device cpu");
        let model = &mut window.model;
        let first = Body::of(model.document.scene(), 1).unwrap();
        let with_radius = |radius| Edit::Change(1, Body { radius, ..first });
        edit(model, with_radius(0.125)).unwrap();
        assert_eq!((model.document.scene().spheres[1].radius, model.selected), (0.125, Some(1)));
        assert!(edit(model, with_radius(0.0)).unwrap_err().contains("radius"));
        assert_eq!(model.document.scene().spheres[1].radius, 0.125);
        edit(model, with_radius(first.radius)).unwrap();
        assert!(!model.document.has_changed_scene(), "a value that is typed back");
    }

    #[test]
    fn all_spheres_are_gone_through_both_ways() {
        let mut scene = Scene::default();
        assert_eq!([true, false].map(|is_next| neighbour(&scene, None, is_next)), [None; 2]);
        (0..3).for_each(|_| scene.add_sphere(DVec3::ZERO, 1.0, 0));
        let walk =
            |is_next| [None, Some(0), Some(1), Some(2)].map(|at| neighbour(&scene, at, is_next).unwrap());
        assert_eq!((walk(true), walk(false)), ([0, 1, 2, 0], [2, 2, 0, 1]));
    }
}
