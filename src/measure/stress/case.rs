//! A stress case: a scene, what makes it hard, and the result that it must have. `assets/stress.toml` lists all of them
//! and describes its keys.

use crate::job::recipe::{Recipe, file, plain_name};
use crate::scene::{Camera, Material, Scene, Sphere};
use anyhow::{Context, Result};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::{Arc, OnceLock};
use toml::{Table, Value};

macro_rules! files {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!("../../../assets/scenes/stress/", $name, ".toml")))),*]
    };
}

/// Scene files that cases are made of, like the scenes of the list.
const FILES: [(&str, &str); 6] =
    files!("soap-bubbles" "dust" "contact" "planet-coast" "nested" "closed-room");

/// The list of all cases.
#[derive(Deserialize)]
struct List {
    defaults: Table,
    scenes: Table,
    families: Vec<Family>,
}

#[derive(Debug, Deserialize)]
pub struct Family {
    /// First part of the ids of its cases.
    pub id: String,
    /// The subject of its tests, as a heading.
    pub title: String,
    /// What it teaches, if the window shows cases of it.
    #[serde(default)]
    pub lesson: String,
    #[serde(default)]
    common: Table,
    cases: Vec<Table>,
}

/// The result that a case must have. Radiance is linear.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Expected {
    /// Every sample has this radiance: a closed form without noise.
    Every(f64),
    /// The mean over pixels and channels: a closed form with noise.
    Mean(f64),
    /// Same samples as this scene of the list on the same backend.
    Same(String),
    /// Same samples as the `f64` reference.
    Reference,
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Expected::Every(value) => write!(f, "{value}"),
            Expected::Mean(value) => write!(f, "{value} (mean)"),
            Expected::Same(other) => write!(f, "as {other}"),
            Expected::Reference => f.write_str("as f64"),
        }
    }
}

/// What a case says about its scene.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Claim {
    #[serde(default)]
    name: String,
    difficulty: Option<String>,
    pub expected: Expected,
    /// How the expected result is derived.
    pub why: String,
    /// Allowed difference of the mean apart from noise, linear radiance.
    pub tolerance: f64,
    /// Title in the window's menu; `None` if the window does not show it.
    title: Option<String>,
    /// What to look for in the window.
    #[serde(default)]
    pub look_for: String,
}

/// A claim, and how the scene that it is about is made.
#[derive(Deserialize)]
struct Entry {
    #[serde(flatten)]
    claim: Claim,
    scene: Option<String>,
    repeat: u32,
    step: DVec3,
    shrink: f64,
    scale: f64,
    offset: DVec3,
    unit: f64,
    #[serde(flatten)]
    file: Table,
}

impl Entry {
    /// The last of `parts`, on top of all that it builds on.
    fn new(list: &List, parts: &[&Table]) -> Result<Self> {
        let mut table = list.defaults.clone();
        let of = parts.iter().rev().find_map(|part| part.get("of")?.as_str());
        let of = of.and_then(|of| list.scenes.get(of)?.as_table());
        of.into_iter().chain(parts.iter().copied()).for_each(|part| merge(&mut table, part));
        table.remove("of");
        Ok(Entry::deserialize(table)?)
    }

    fn recipe(mut self, name: &str) -> Result<Recipe> {
        // Only the materials that it uses.
        let spheres = self.file.get("spheres").map(Value::to_string).unwrap_or_default();
        if let Some(Value::Table(materials)) = self.file.get_mut("materials") {
            materials.retain(|name, _| spheres.contains(name));
        }
        let mut recipe = file::parse(&self.file.to_string(), name)?;
        let scene = Arc::make_mut(&mut recipe.scene);
        let spheres = std::mem::take(&mut scene.spheres);
        for index in 0..self.repeat {
            let (count, share) = (f64::from(index), f64::from(index) / f64::from(self.repeat));
            scene.spheres.extend(spheres.iter().map(|sphere| Sphere {
                center: sphere.center + count * self.step,
                radius: sphere.radius - share * self.shrink,
                ..*sphere
            }));
        }
        if let Some(builtin) = &self.scene {
            let base = Scene::clone(&Recipe::find(builtin)?.scene);
            let own = std::mem::replace(scene, base);
            let first = scene.materials.len();
            scene.materials.extend(own.materials);
            let spheres = own.spheres.iter().map(|own| Sphere { material: first + own.material, ..*own });
            scene.spheres.extend(spheres);
        }
        Ok(moved(&recipe, self.scale, self.offset))
    }
}

/// Adds the values of `over`, which replace others; tables, except for an expected result, keep their other keys.
fn merge(table: &mut Table, over: &Table) {
    for (key, value) in over {
        match (table.get_mut(key), value) {
            (Some(Value::Table(old)), Value::Table(new)) if key != "expected" => merge(old, new),
            _ => _ = table.insert(key.clone(), value.clone()),
        }
    }
}

/// Everything scaled by `factor`, then moved by `offset`: spheres, eye and focus.
pub fn moved(recipe: &Recipe, factor: f64, offset: DVec3) -> Recipe {
    let place = |point: DVec3| factor * point + offset;
    let mut scene = Scene::clone(&recipe.scene);
    for sphere in &mut scene.spheres {
        sphere.center = place(sphere.center);
        sphere.radius *= factor;
    }
    let camera = Camera {
        look_from: place(recipe.camera.look_from),
        look_at: place(recipe.camera.look_at),
        focus_distance: recipe.camera.focus_distance.map(|distance| factor * distance),
        ..recipe.camera
    };
    Recipe { scene: Arc::new(scene), camera, ..recipe.clone() }
}

#[derive(Clone, Debug)]
pub struct Case {
    /// The family's id and a name within the family: `copies/110`.
    pub id: String,
    pub family: &'static Family,
    pub claim: Claim,
    pub recipe: Recipe,
    /// The scene that must give the same samples, if one must.
    pub twin: Option<Recipe>,
    /// Typical length near the eye, scene units.
    unit: f64,
}

impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Case {}

/// From this many spheres on, every backend builds a hierarchy anyway, so distant ones change nothing.
const HIERARCHY_SPHERES: usize = 24;

/// Size of a case's picture in the window, pixels.
const SHOWN_SIZE: [u32; 2] = [600, 400];

impl Case {
    fn new(list: &'static List, family: &'static Family, own: &Table) -> Result<Self> {
        let entry = Entry::new(list, &[&family.common, own])?;
        let (claim, unit) = (entry.claim.clone(), entry.unit * entry.scale);
        let id = format!("{}/{}", family.id, claim.name);
        let twin = match &claim.expected {
            Expected::Same(name) => {
                let scene = list.scenes.get(name).and_then(Value::as_table).context("no such scene")?;
                Some(Entry::new(list, &[scene])?.recipe(name)?)
            }
            _ => None,
        };
        Ok(Case { recipe: entry.recipe(&id)?, id, family, claim, twin, unit })
    }

    /// The menu title, or the id of a case the window does not show.
    pub fn title(&self) -> &str {
        self.claim.title.as_deref().unwrap_or(&self.id)
    }

    /// Why the scene is hard.
    pub fn difficulty(&self) -> &str {
        self.claim.difficulty.as_deref().unwrap_or(&self.family.title)
    }

    /// The picture at the window's size, with a name that is a valid file name.
    pub fn shown(&self) -> Recipe {
        let mut recipe = Recipe { name: plain_name(&self.id), samples_per_pixel: 256, ..self.recipe.clone() };
        [recipe.settings.width, recipe.settings.height] = SHOWN_SIZE;
        recipe
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

#[expect(clippy::expect_used, reason = "the list is part of the program, and a test reads all of it")]
fn list() -> &'static List {
    static LIST: OnceLock<List> = OnceLock::new();
    LIST.get_or_init(|| {
        let mut list: List = toml::from_str(include_str!("../../../assets/stress.toml")).expect("a list");
        for (name, text) in FILES {
            list.scenes.insert(name.to_owned(), Value::Table(toml::from_str(text).expect("a scene file")));
        }
        list
    })
}

#[expect(clippy::expect_used, reason = "the list is part of the program, and a test reads all of it")]
fn build(families: impl Iterator<Item = &'static Family>, has: fn(&Table) -> bool) -> Vec<Case> {
    let tables = families.flat_map(|family| family.cases.iter().map(move |table| (family, table)));
    let chosen = tables.filter(|(_, table)| has(table));
    chosen.map(|(family, table)| Case::new(list(), family, table).expect("a case")).collect()
}

pub fn families() -> &'static [Family] {
    &list().families
}

/// The cases shown in the window. The others are not built: their largest scenes have a hundred thousand spheres.
pub fn shown_cases() -> &'static [Case] {
    static SHOWN: OnceLock<Vec<Case>> = OnceLock::new();
    SHOWN.get_or_init(|| build(families().iter().rev(), |table| table.contains_key("title")))
}

/// All cases in the table's order.
pub fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| build(families().iter(), |_| true))
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
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_case_is_a_valid_picture_in_each_form() {
        let ids: HashSet<&str> = cases().iter().map(|case| case.id.as_str()).collect();
        assert_eq!(ids.len(), cases().len());
        for case in cases() {
            for recipe in case.forms().into_iter().map(|(_, recipe)| recipe).chain(case.twin.clone()) {
                assert!(recipe.job().is_ok(), "{}: {:?}", case.id, recipe.job().err());
            }
            let is_small = case.recipe.scene.spheres.len() < HIERARCHY_SPHERES;
            assert_eq!(case.forms().len(), 1 + usize::from(is_small), "{}", case.id);
        }
        let shown: Vec<&Case> = cases().iter().filter(|case| case.claim.title.is_some()).collect();
        assert!(shown.iter().all(|case| !case.claim.look_for.is_empty() && !case.family.lesson.is_empty()));
    }
}
