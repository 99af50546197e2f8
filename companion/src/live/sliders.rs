//! The numbers of a stage that a reader can change.

use serde::Serialize;
use weekender::job::render::RenderJob;
use weekender::scene::{Material, Sphere};
use weekender::stages::Shading;

/// A slider. The range of `samples` is that of its base-2 logarithm.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Slider {
    /// What it changes: a number of the camera, `bounces`, `samples`, or the material number `fuzz` or `index`.
    pub(super) key: &'static str,
    /// The material that it changes, if a stage has several.
    pub(super) name: String,
    label: String,
    unit: &'static str,
    min: f64,
    max: f64,
    step: f64,
    pub(super) value: f64,
    /// The shading records that get the value.
    rows: Vec<usize>,
    /// The shading records that get its inverse: air bubbles in glass.
    inverse_rows: Vec<usize>,
}

impl Slider {
    fn new(key: &'static str, label: &str, [min, max, step]: [f64; 3], value: f64) -> Self {
        let label = label.to_owned();
        let unit = if ["vfov", "defocus"].contains(&key) { "°" } else { "" };
        let (name, rows, inverse_rows) = Default::default();
        Slider { key, name, label, unit, min, max, step, value, rows, inverse_rows }
    }

    /// Whether texts call it so: `fuzz` or, to tell one of several, `fuzz.left`.
    pub(super) fn is_called(&self, wanted: &str) -> bool {
        let rest = wanted.strip_prefix(self.key);
        rest.is_some_and(|rest| rest.is_empty() || rest.strip_prefix('.') == Some(&self.name))
    }
}

/// Most metals with sliders of their own.
const METAL_LIMIT: usize = 2;

/// The sliders of a stage. `scene_index` maps each shading record to its sphere's index in the scene.
///
/// Their ranges keep the kernel's features: no index is steep, no path longer than the book's.
pub(super) fn sliders(job: &RenderJob, samples: u64, scene_index: &[u32]) -> Vec<Slider> {
    let shading = job.rules().shading;
    let mut sliders = Vec::new();
    if shading != Shading::ImageGradient {
        let camera = job.camera();
        sliders.push(Slider::new("vfov", "Field of view", [5.0, 120.0, 1.0], camera.vfov_degrees));
        // With one sample per pixel, a lens would only add noise.
        if samples > 1 {
            let focus = camera.effective_focus_distance();
            let angle = camera.defocus_angle_degrees;
            let range = [focus / 5.0, focus * 3.0, focus / 50.0];
            sliders.push(Slider::new("defocus", "Defocus angle", [0.0, 20.0, 0.1], angle));
            sliders.push(Slider::new("focus", "Focus distance", range, focus));
        }
    }
    if shading == Shading::Path && !job.scene().spheres.is_empty() {
        sliders.extend(fuzz(job, scene_index));
        sliders.extend(index(job, scene_index));
        let bounces = f64::from(job.settings().max_depth) - 1.0;
        sliders.push(Slider::new("bounces", "Bounces", [0.0, 49.0, 1.0], bounces));
    }
    if samples > 1 {
        sliders.push(Slider::new("samples", "Samples per pixel", [0.0, 12.0, 1.0], samples as f64));
    }
    sliders
}

/// The shading records whose sphere satisfies `is_such`.
fn rows_of(job: &RenderJob, scene_index: &[u32], is_such: impl Fn(&Sphere) -> bool) -> Vec<usize> {
    let spheres = scene_index.iter().map(|index| &job.scene().spheres[*index as usize]);
    spheres.enumerate().filter(|(_, sphere)| is_such(sphere)).map(|(row, _)| row).collect()
}

/// A slider for each metal or, if there are many, for the largest sphere's.
fn fuzz(job: &RenderJob, scene_index: &[u32]) -> Vec<Slider> {
    let scene = job.scene();
    let radius = |material: usize| {
        let spheres = scene.spheres.iter().filter(|sphere| sphere.material == material);
        spheres.map(|sphere| sphere.radius).fold(0.0, f64::max)
    };
    let is_metal = |material: &usize| matches!(scene.materials[*material].material, Material::Metal { .. });
    let mut metals: Vec<usize> = (0..scene.materials.len()).filter(is_metal).collect();
    if metals.len() > METAL_LIMIT {
        metals.sort_by(|a, b| radius(*b).total_cmp(&radius(*a)));
        metals.truncate(1);
    }
    let slider = |material: usize| {
        let named = &scene.materials[material];
        let label = format!("Fuzz ({})", named.name);
        Slider {
            name: named.name.clone(),
            rows: rows_of(job, scene_index, |sphere| sphere.material == material),
            ..Slider::new("fuzz", &label, [0.0, 1.0, 0.01], named.material.effective_fuzz())
        }
    };
    metals.into_iter().map(slider).collect()
}

/// One slider for all glass of the first index, and for the bubbles in it.
fn index(job: &RenderJob, scene_index: &[u32]) -> Option<Slider> {
    let index_of = |material: &Material| match *material {
        Material::Dielectric { refraction_index } => Some(refraction_index),
        _ => None,
    };
    let value = job.scene().materials.iter().find_map(|named| index_of(&named.material))?;
    let rows = |wanted: f64| {
        rows_of(job, scene_index, |sphere| index_of(job.scene().material_of(sphere)) == Some(wanted))
    };
    Some(Slider {
        rows: rows(value),
        inverse_rows: if value == 1.0 { Vec::new() } else { rows(1.0 / value) },
        ..Slider::new("index", "Index of refraction", [0.5, 2.5, 0.01], value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use weekender::job::recipe::Recipe;
    use weekender::scene::Scene;
    use weekender::scene::builtin::{LeftSphere, metals, three_spheres};
    use weekender::stages::Stage;

    /// The sliders of a scene whose records list its spheres from last to first.
    fn sliders_of(scene: Scene, samples: u64) -> Vec<Slider> {
        let count = scene.spheres.len() as u32;
        let recipe = Recipe::find("three-spheres").unwrap();
        let job = RenderJob::new(scene, recipe.camera, recipe.settings, recipe.rules).unwrap();
        sliders(&job, samples, &(0..count).rev().collect::<Vec<u32>>())
    }

    /// The sliders with this key: label, value, rows and inverse rows.
    fn with_key<'a>(sliders: &'a [Slider], key: &str) -> Vec<(&'a str, f64, &'a [usize], &'a [usize])> {
        let found = sliders.iter().filter(|slider| slider.key == key);
        found.map(|s| (s.label.as_str(), s.value, s.rows.as_slice(), s.inverse_rows.as_slice())).collect()
    }

    /// The spheres are the ground, the middle one, the glass, the bubble in it, and the metal.
    #[test]
    fn sliders_cover_material_and_bubble() {
        let hollow = sliders_of(three_spheres(LeftSphere::HollowGlass), 64);
        assert_eq!(with_key(&hollow, "index"), [("Index of refraction", 1.5, &[2][..], &[1][..])]);
        assert_eq!(with_key(&hollow, "fuzz"), [("Fuzz (right)", 1.0, &[0][..], &[][..])]);
        // An air bubble under water is alone.
        let bubble = sliders_of(three_spheres(LeftSphere::Glass(1.0 / 1.33)), 64);
        assert_eq!(with_key(&bubble, "index"), [("Index of refraction", 1.0 / 1.33, &[1][..], &[][..])]);
        // An index of 1 is its own inverse, and is written once.
        let air = sliders_of(three_spheres(LeftSphere::Glass(1.0)), 64);
        assert_eq!(with_key(&air, "index"), [("Index of refraction", 1.0, &[1][..], &[][..])]);
        let metals = sliders_of(metals(0.3, 1.0), 64);
        assert_eq!(
            with_key(&metals, "fuzz"),
            [("Fuzz (left)", 0.3, &[1][..], &[][..]), ("Fuzz (right)", 1.0, &[0][..], &[][..])]
        );
        assert!(with_key(&metals, "index").is_empty());
    }

    #[test]
    fn largest_of_many_metals_has_slider() {
        let mut scene = Scene::default();
        for (name, fuzz, radii) in
            [("small", 0.1, &[0.1, 0.2][..]), ("large", 2.5, &[0.3, 0.7]), ("middle", 0.4, &[0.6])]
        {
            let material = scene.add_material(name, Material::Metal { albedo: DVec3::ONE, fuzz });
            for radius in radii {
                scene.add_sphere(DVec3::X * (scene.spheres.len() as f64 * 3.0), *radius, material);
            }
        }
        // A fuzz above 1 counts as 1.
        assert_eq!(with_key(&sliders_of(scene, 64), "fuzz"), [("Fuzz (large)", 1.0, &[1, 2][..], &[][..])]);
    }

    #[test]
    fn slider_ranges_contain_stage_values() {
        for stage in Stage::ALL {
            let (recipe, id) = (stage.recipe(), stage.id);
            let job = recipe.job().unwrap();
            let scene_index: Vec<u32> = (0..job.scene().spheres.len() as u32).collect();
            for slider in sliders(&job, recipe.samples_per_pixel, &scene_index) {
                let Slider { key, min, max, step, .. } = slider;
                let value = if key == "samples" { slider.value.log2() } else { slider.value };
                assert!(min <= value && value <= max, "{id}, {key}: {value}");
                assert!(step > 0.0 && 10.0 * step <= max - min, "{id}, {key}: {step}");
            }
            let keys = |samples: u64| {
                sliders(&job, samples, &scene_index)
                    .iter()
                    .filter(|slider| ["defocus", "focus", "samples"].contains(&slider.key))
                    .count()
            };
            let lens = if job.rules().has_rays() { 2 } else { 0 };
            assert_eq!(
                [keys(1), keys(2)],
                [0, 1 + lens],
                "{id}: a lens and samples need more than one sample"
            );
        }
    }
}
