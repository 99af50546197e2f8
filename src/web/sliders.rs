//! The numbers of a stage that a reader can change.

use crate::render::RenderJob;
use crate::scene::{Material, Sphere};
use crate::stages::Shading;
use serde::Serialize;

/// A slider: what it changes, its label and its range. The range of `samples` is that of the logarithm to base 2.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Slider {
    /// What it changes: a number of the camera, `depth`, `samples`, or the material number `fuzz` or `index`.
    key: &'static str,
    label: String,
    unit: &'static str,
    min: f64,
    max: f64,
    step: f64,
    value: f64,
    /// The shading records that get the value.
    rows: Vec<usize>,
    /// The shading records that get its inverse: bubbles of air in glass.
    inverse_rows: Vec<usize>,
}

impl Slider {
    fn new(key: &'static str, label: &str, [min, max, step]: [f64; 3], value: f64) -> Self {
        let label = label.to_owned();
        Slider { key, label, unit: "", min, max, step, value, rows: Vec::new(), inverse_rows: Vec::new() }
    }

    fn degrees(self) -> Self {
        Slider { unit: "°", ..self }
    }
}

/// Most metals that have sliders of their own.
const METAL_LIMIT: usize = 2;

/// The sliders of a stage. `scene_index` is the index in the scene of each shading record's sphere.
///
/// Their ranges keep the features of the kernel: no index is steep, no path longer than the book's.
pub(super) fn sliders(job: &RenderJob, samples: u64, scene_index: &[u32]) -> Vec<Slider> {
    let shading = job.rules().shading;
    let mut sliders = Vec::new();
    if shading != Shading::ImageGradient {
        let camera = job.camera();
        sliders.push(Slider::new("vfov", "Field of view", [5.0, 120.0, 1.0], camera.vfov_degrees).degrees());
        // With one sample per pixel, a lens would only make noise.
        if samples > 1 {
            let focus = camera.effective_focus_distance();
            let angle = camera.defocus_angle_degrees;
            let range = [focus / 5.0, focus * 3.0, focus / 50.0];
            sliders.push(Slider::new("defocus", "Defocus angle", [0.0, 20.0, 0.1], angle).degrees());
            sliders.push(Slider::new("focus", "Focus distance", range, focus));
        }
    }
    if shading == Shading::Path && !job.scene().spheres.is_empty() {
        sliders.extend(fuzz(job, scene_index));
        sliders.extend(index(job, scene_index));
        let depth = f64::from(job.settings().max_depth);
        sliders.push(Slider::new("depth", "Rays per path", [1.0, 50.0, 1.0], depth));
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

/// A slider for each metal, or for the metal of the largest sphere if there are many.
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
