//! A stress case: a scene, what makes it hard, and the expected result.

use crate::job::recipe::{Recipe, plain_name};
use crate::scene::{Material, Scene};
use glam::DVec3;
use std::fmt;
use std::sync::Arc;

/// A family of cases.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// First part of the ids of its cases.
    pub id: &'static str,
    /// The subject of its tests, as a heading.
    pub title: &'static str,
    /// What it teaches, in a sentence or two, if the window shows cases of it.
    pub lesson: Option<&'static str>,
    /// Builds its cases.
    pub cases: fn(&'static Family) -> Vec<Case>,
}

/// The result that a case must have. Radiance is linear.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// Every sample has this radiance, RGB: a closed form without noise.
    Every([f64; 3]),
    /// The mean over pixels and channels: a closed form with noise.
    Mean(f64),
    /// Same samples as another scene on the same backend.
    Same(Box<Recipe>),
    /// Same samples as the `f64` reference.
    Reference,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Expected::Every([red, green, blue]) if red == green && green == blue => write!(f, "{red}"),
            Expected::Every([red, green, blue]) => write!(f, "{red} {green} {blue}"),
            Expected::Mean(value) => write!(f, "{value} (mean)"),
            Expected::Same(other) => write!(f, "as {}", other.name),
            Expected::Reference => f.write_str("as f64"),
        }
    }
}

/// How the window presents a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Title in the menu.
    pub title: &'static str,
    /// What to look for, in a sentence or two.
    pub look_for: &'static str,
}

/// Size of a case's picture in the window, pixels.
const SHOWN_SIZE: [u32; 2] = [600, 400];

#[derive(Clone, Debug)]
pub struct Case {
    /// The family's id and a name within the family: `copies/110`.
    pub id: String,
    pub family: &'static Family,
    /// Why the scene is hard, in a sentence.
    pub stiff: String,
    pub recipe: Recipe,
    /// Typical length near the eye, scene units; the distant spheres are a thousand times as far away.
    pub unit: f64,
    pub expected: Expected,
    /// How the expected result is derived, in a sentence.
    pub why: &'static str,
    /// Allowed difference of the mean apart from noise, linear radiance.
    pub tolerance: f64,
    /// How the window shows it; `None` if there is nothing to see.
    pub watch: Option<Watch>,
}

impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Case {}

/// From this many spheres on, every backend builds a hierarchy anyway, so distant ones change nothing.
const HIERARCHY_SPHERES: usize = 24;

impl Case {
    /// Expects the `f64` reference's result unless a builder method below changes that.
    pub fn new(
        family: &'static Family,
        name: impl fmt::Display,
        stiff: impl Into<String>,
        recipe: Recipe,
    ) -> Self {
        let id = format!("{}/{name}", family.id);
        Case {
            recipe: Recipe { name: id.clone(), ..recipe },
            id,
            family,
            stiff: stiff.into(),
            unit: 1.0,
            expected: Expected::Reference,
            why: "f64 has digits to spare at these scales",
            tolerance: 2e-6,
            watch: None,
        }
    }

    #[must_use]
    pub fn expect(self, expected: Expected, why: &'static str, tolerance: f64) -> Self {
        Case { expected, why, tolerance, ..self }
    }

    /// Expects every sample to be this grey.
    #[must_use]
    pub fn every(self, value: f64, why: &'static str) -> Self {
        self.expect(Expected::Every([value; 3]), why, 1e-6)
    }

    /// Shows the case in the window.
    #[must_use]
    pub fn watched(self, title: &'static str, look_for: &'static str) -> Self {
        Case { watch: Some(Watch { title, look_for }), ..self }
    }

    /// Sets the typical length near the eye.
    #[must_use]
    pub fn of_unit(self, unit: f64) -> Self {
        Case { unit, ..self }
    }

    /// The picture at the window's size, with a name that is a valid file name.
    pub fn shown(&self) -> Recipe {
        let mut recipe = Recipe { name: plain_name(&self.id), samples_per_pixel: 256, ..self.recipe.clone() };
        [recipe.settings.width, recipe.settings.height] = SHOWN_SIZE;
        recipe
    }

    /// The menu title, or the id of a case the window does not show.
    pub fn title(&self) -> &str {
        self.watch.map_or(&self.id, |watch| watch.title)
    }

    /// The names and recipes to render: a small scene also with distant spheres, which switch the hierarchy on.
    pub fn forms(&self) -> Vec<(&'static str, Recipe)> {
        let mut forms = vec![("plain", self.recipe.clone())];
        if self.recipe.scene.spheres.len() < HIERARCHY_SPHERES {
            forms.push(("+40", with_far_spheres(&self.recipe, self.unit)));
        }
        forms
    }
}

const FAR_COUNT: usize = 40;

/// Distance from the eye, in the case's units.
const FAR_DISTANCE: f64 = 1000.0;

/// Radius, in the case's units: together they cover a billionth of the sky.
const FAR_RADIUS: f64 = 0.01;

/// Adds forty distant spheres, which switch the hierarchy on and are too small to be visible. They reflect all light,
/// so a closed room stays dark and a white world white.
pub fn with_far_spheres(recipe: &Recipe, unit: f64) -> Recipe {
    let mut scene = Scene::clone(&recipe.scene);
    // No stress scene has a material of this name.
    let material = scene.add_material("far".to_owned(), Material::Lambertian { albedo: DVec3::ONE });
    for index in 0..FAR_COUNT {
        // Evenly distributed directions, by the golden angle.
        let height = 1.0 - (2 * index + 1) as f64 / FAR_COUNT as f64;
        let turn = index as f64 * 2.399_963_229_728_653;
        let across = (1.0 - height * height).sqrt();
        let direction = DVec3::new(across * turn.cos(), height, across * turn.sin());
        let center = recipe.camera.look_from + FAR_DISTANCE * unit * direction;
        scene.add_sphere(center, FAR_RADIUS * unit, material);
    }
    Recipe { scene: Arc::new(scene), ..recipe.clone() }
}

#[cfg(test)]
mod tests {
    use super::super::families::FAMILIES;
    use super::super::families::build::one_ball;
    use super::*;

    #[test]
    fn small_scenes_also_get_hierarchy() {
        for (count, forms) in [(23, &["plain", "+40"][..]), (24, &["plain"][..])] {
            let mut recipe = one_ball();
            let scene = Arc::make_mut(&mut recipe.scene);
            scene.spheres = vec![scene.spheres[0]; count];
            let case = Case::new(&FAMILIES[0], count, "copies", recipe);
            let found = case.forms();
            assert_eq!(found.iter().map(|(form, _)| *form).collect::<Vec<_>>(), forms, "{count}");
            assert_eq!(found[0].1.scene.spheres.len(), count);
        }
    }

    #[test]
    fn far_spheres_are_invisible() {
        let recipe = Recipe::builtin("two-spheres").unwrap();
        let with = with_far_spheres(&recipe, 2.0);
        let added = &with.scene.spheres[recipe.scene.spheres.len()..];
        assert_eq!(added.len(), FAR_COUNT);
        let eye = recipe.camera.look_from;
        let mean = added.iter().map(|s| s.center - eye).sum::<DVec3>() / FAR_COUNT as f64;
        assert!(mean.length() < 0.05 * FAR_DISTANCE * 2.0, "{mean}");
        let share: f64 = added.iter().map(|s| (s.radius / s.center.distance(eye)).powi(2) / 4.0).sum();
        assert!(share < 2e-9, "{share}");
    }
}
