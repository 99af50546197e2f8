//! Edits of a scene's spheres.

use crate::scene::{Material, NamedMaterial, Scene, Sky, Sphere};
use glam::DVec3;

/// A sphere with its material, as the user edits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Centre, scene units.
    pub center: DVec3,
    /// Radius, scene units.
    pub radius: f64,
    /// How its surface scatters.
    pub material: Material,
}

impl Body {
    /// A sphere of the scene; `None` if there is none of this index.
    pub fn of(scene: &Scene, sphere: usize) -> Option<Self> {
        let Sphere { center, radius, material } = *scene.spheres.get(sphere)?;
        Some(Body { center, radius, material: scene.materials.get(material)?.material })
    }
}

/// A change to the spheres of a scene. Spheres are given by their index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edit {
    /// Gives a sphere this place, size and material. Other spheres keep their material.
    Change(usize, Body),
    /// Adds a sphere.
    Add(Body),
    /// Removes a sphere.
    Delete(usize),
    /// Gives the sky these colours.
    Sky(Sky),
}

/// A kind of material as the panel calls it.
pub fn kind_word(material: &Material) -> &'static str {
    match material {
        Material::Lambertian { .. } => "matte",
        Material::Metal { .. } => "metal",
        Material::Dielectric { .. } => "glass",
    }
}

/// The name of the material of a sphere that was added.
const ADDED: &str = "added";

impl Edit {
    /// What it changes in a scene, in words.
    pub fn name(&self, scene: &Scene) -> &'static str {
        match *self {
            Edit::Change(index, body) => match Body::of(scene, index) {
                Some(before) if before.material != body.material => "material",
                Some(before) if before.radius != body.radius => "radius",
                _ => "place of the sphere",
            },
            Edit::Add(_) => "added sphere",
            Edit::Delete(_) => "deleted sphere",
            Edit::Sky(_) => "sky",
        }
    }

    /// Edits `scene`. Returns the sphere that is selected then. An edit of a sphere that does not exist changes nothing.
    pub fn apply(&self, scene: &mut Scene) -> Option<usize> {
        match *self {
            Edit::Change(index, body) => return change(scene, index, body).map(|()| index),
            Edit::Add(Body { center, radius, material }) => {
                let known = scene.materials.iter().position(|named| named.material == material);
                let own = |scene: &mut Scene| scene.add_material(free_name(scene, ADDED), material);
                let material = known.unwrap_or_else(|| own(scene));
                scene.add_sphere(center, radius, material);
                return Some(scene.spheres.len() - 1);
            }
            Edit::Delete(index) => delete(scene, index),
            Edit::Sky(sky) => scene.sky = sky,
        }
        None
    }
}

fn change(scene: &mut Scene, index: usize, body: Body) -> Option<()> {
    let place = scene.spheres.get(index)?.material;
    let NamedMaterial { name, material } = scene.materials.get(place)?.clone();
    if material != body.material {
        // A name that tells another kind would be a strange one.
        let is_of_kind =
            kind_word(&material) != kind_word(&body.material) && name.starts_with(kind_word(&material));
        let name = if is_of_kind { free_name(scene, kind_word(&body.material)) } else { name };
        if is_shared(scene, place) {
            let name = free_name(scene, &name);
            scene.spheres[index].material = scene.add_material(name, body.material);
        } else {
            scene.materials[place] = NamedMaterial { name, material: body.material };
        }
    }
    let sphere = &mut scene.spheres[index];
    (sphere.center, sphere.radius) = (body.center, body.radius);
    Some(())
}

/// Removes the sphere, and its material if no other sphere has it.
fn delete(scene: &mut Scene, index: usize) {
    if index >= scene.spheres.len() {
        return;
    }
    let place = scene.spheres[index].material;
    let is_shared = is_shared(scene, place);
    scene.spheres.remove(index);
    if !is_shared && place < scene.materials.len() {
        scene.materials.remove(place);
        for sphere in scene.spheres.iter_mut().filter(|sphere| sphere.material > place) {
            sphere.material -= 1;
        }
    }
}

/// Whether several spheres have this material.
fn is_shared(scene: &Scene, material: usize) -> bool {
    scene.spheres.iter().filter(|sphere| sphere.material == material).nth(1).is_some()
}

/// `name`, or the first of `name-2`, `name-3` and so on that no material has.
fn free_name(scene: &Scene, name: &str) -> String {
    let is_free = |name: &str| scene.materials.iter().all(|named| named.name != name);
    if is_free(name) {
        return name.to_owned();
    }
    let stem = match name.rsplit_once('-') {
        Some((stem, number)) if number.parse::<u32>().is_ok() => stem,
        _ => name,
    };
    let numbered = (2_u32..).map(|number| format!("{stem}-{number}"));
    numbered.into_iter().find(|name| is_free(name)).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::recipe::Recipe;

    fn scene() -> Scene {
        let mut scene = Scene::default();
        let grey = scene.add_material("grey", Material::Lambertian { albedo: DVec3::splat(0.5) });
        let glass = scene.add_material("glass", Material::Dielectric { refraction_index: 1.5 });
        scene.add_sphere(DVec3::ZERO, 1.0, grey);
        scene.add_sphere(DVec3::X, 1.0, glass);
        scene.add_sphere(DVec3::Y, 1.0, glass);
        scene
    }

    /// The edited scene, and the sphere that is selected then.
    fn applied(edit: Edit, scene: &Scene) -> (Scene, Option<usize>) {
        let mut scene = scene.clone();
        let selected = edit.apply(&mut scene);
        (scene, selected)
    }

    const METAL: Material = Material::Metal { albedo: DVec3::ONE, fuzz: 0.5 };

    #[test]
    fn a_change_concerns_one_sphere() {
        let before = scene();
        let denser = Material::Dielectric { refraction_index: 2.4 };
        let body = Body { material: denser, ..Body::of(&before, 1).unwrap() };
        let (after, selected) = applied(Edit::Change(1, body), &before);
        after.validate().unwrap();
        assert_eq!((selected, Body::of(&after, 1)), (Some(1), Some(body)));
        assert_eq!(Body::of(&after, 2), Body::of(&before, 2), "shares its material with the other");
        assert_eq!(after.materials[2].name, "glass-2");
        // Now the sphere has its own material, so no more are added.
        let (again, _) = applied(Edit::Change(1, Body { material: METAL, ..body }), &after);
        assert_eq!((again.materials.len(), again.materials[2].name.as_str()), (3, "metal"));
    }

    #[test]
    fn spheres_are_added_and_deleted() {
        let before = scene();
        let body = Body { center: DVec3::Z, radius: 0.25, material: METAL };
        let (more, selected) = applied(Edit::Add(body), &before);
        assert_eq!((selected, Body::of(&more, 3)), (Some(3), Some(body)));
        let (twice, _) = applied(Edit::Add(body), &more);
        twice.validate().unwrap();
        assert_eq!((twice.spheres.len(), twice.materials.len()), (5, 3), "the same material has one name");
        let (fewer, selected) = applied(Edit::Delete(0), &before);
        fewer.validate().unwrap();
        assert_eq!((selected, fewer.materials.len()), (None, 1));
        assert_eq!(Body::of(&fewer, 0), Body::of(&before, 1));
        for beyond in [3, 9] {
            assert_eq!(applied(Edit::Delete(beyond), &before), (before.clone(), None));
        }
        assert_eq!(applied(Edit::Change(9, body), &before), (before, None));
    }

    #[test]
    fn every_sphere_of_a_built_in_scene_can_be_deleted() {
        let mut scene = (*Recipe::builtin("book").unwrap().scene).clone();
        while !scene.spheres.is_empty() {
            scene = applied(Edit::Delete(scene.spheres.len() / 2), &scene).0;
            scene.validate().unwrap();
        }
        assert!(scene.materials.is_empty());
    }

    #[test]
    fn a_material_of_one_sphere_is_changed_in_its_place() {
        let before = scene();
        let green = Material::Lambertian { albedo: DVec3::new(0.0, 0.75, 0.0) };
        let names = |scene: &Scene| -> Vec<String> {
            scene.materials.iter().map(|named| named.name.clone()).collect()
        };
        // A move changes no material, also where two spheres share one.
        for index in 0..3 {
            let old = Body::of(&before, index).unwrap();
            let body = Body { center: DVec3::new(1.0, 2.0, 3.0), radius: 0.25, ..old };
            let (after, _) = applied(Edit::Change(index, body), &before);
            assert_eq!((Body::of(&after, index), &after.materials), (Some(body), &before.materials));
        }
        let body = Body { material: green, ..Body::of(&before, 0).unwrap() };
        let (after, _) = applied(Edit::Change(0, body), &before);
        assert_eq!((Body::of(&after, 0), names(&after)), (Some(body), names(&before)));
        // A shared material stays as it is; the name of another kind is new.
        let mut taken = before.clone();
        taken.add_material("metal", METAL);
        let body = Body { material: METAL, ..Body::of(&before, 2).unwrap() };
        let (after, _) = applied(Edit::Change(2, body), &taken);
        after.validate().unwrap();
        assert_eq!((Body::of(&after, 2), Body::of(&after, 1)), (Some(body), Body::of(&before, 1)));
        assert_eq!(names(&after), ["grey", "glass", "metal", "metal-2"]);
        // A name that says nothing of the kind stays.
        let body = Body { material: METAL, ..Body::of(&before, 0).unwrap() };
        assert_eq!(names(&applied(Edit::Change(0, body), &before).0), ["grey", "glass"]);
    }
}
