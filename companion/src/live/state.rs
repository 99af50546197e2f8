//! A stage's state in words and in links: labels that name its numbers, and settings that change them.

use super::sliders::{Slider, sliders};
use anyhow::{Context, Result, ensure};
use std::sync::Arc;
use weekender::job::recipe::Recipe;
use weekender::scene::Material;
use weekender::stages::Stage;

/// The sliders of a recipe; which spheres they change does not matter here.
fn of(recipe: &Recipe) -> Result<Vec<Slider>> {
    let job = recipe.job()?;
    let every: Vec<u32> = (0..job.scene().spheres.len() as u32).collect();
    Ok(sliders(&job, recipe.samples_per_pixel, &every))
}

fn find<'a>(sliders: &'a [Slider], wanted: &str) -> Result<&'a Slider> {
    let found = sliders.iter().find(|slider| slider.is_called(wanted));
    found.with_context(|| format!("the stage has no slider {wanted:?}"))
}

/// A label such as `{samples} samples per pixel` with the stage's own numbers.
///
/// # Errors
/// If it names an unknown slider, or has a number of its own where there are sliders.
pub fn filled(stage: &Stage, label: &str) -> Result<String> {
    let sliders = of(&stage.recipe())?;
    let mut said = String::new();
    for (place, part) in label.split(['{', '}']).enumerate() {
        if place % 2 == 1 {
            said += &find(&sliders, part)?.value.to_string();
            continue;
        }
        let is_fixed = part.contains(|c: char| c.is_ascii_digit()) && !sliders.is_empty();
        ensure!(
            !is_fixed,
            "{label:?} has a number that a slider may change; write it as {{SLIDER}}, or in words"
        );
        said += part;
    }
    Ok(said)
}

/// Changes a recipe as a link of the text asks, such as `fuzz.left=0&bounces=1`.
pub fn set(recipe: &mut Recipe, settings: &str) -> Result<()> {
    for setting in settings.split('&') {
        let (wanted, value) =
            setting.split_once('=').with_context(|| format!("{setting:?} is not SLIDER=VALUE"))?;
        let value: f64 = value.parse().with_context(|| format!("{value:?} is not a number"))?;
        let slider = find(&of(recipe)?, wanted)?.clone();
        let camera = &mut recipe.camera;
        match slider.key {
            "vfov" => camera.vfov_degrees = value,
            "defocus" => camera.defocus_angle_degrees = value,
            "focus" => camera.focus_distance = Some(value),
            "bounces" => recipe.settings.max_depth = value as u32 + 1,
            "samples" => recipe.samples_per_pixel = value as u64,
            _ => {
                for named in &mut Arc::make_mut(&mut recipe.scene).materials {
                    match &mut named.material {
                        Material::Metal { fuzz, .. } if wanted == "fuzz" || named.name == slider.name => {
                            *fuzz = value
                        }
                        Material::Dielectric { refraction_index: index } if slider.key == "index" => {
                            *index = if *index == slider.value { value } else { 1.0 / value };
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_follow_state() {
        let label = |id: &str, label: &str| {
            filled(Stage::find(id).unwrap(), label).map_err(|error| error.to_string())
        };
        assert_eq!(label("antialiased", "{samples} samples per pixel").unwrap(), "64 samples per pixel");
        assert_eq!(label("metal-fuzzy", "Fuzz {fuzz.left} and {fuzz.right}").unwrap(), "Fuzz 0.3 and 1");
        // Nothing changes a picture of bytes.
        assert_eq!(label("ppm-tiny", "16 by 9 pixels").unwrap(), "16 by 9 pixels");
        for wrong in ["64 samples per pixel", "{sample}"] {
            assert!(label("antialiased", wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn links_change_recipes() {
        let changed = |id: &str, settings: &str| {
            let mut recipe = Stage::find(id).unwrap().recipe();
            set(&mut recipe, settings).map(|()| recipe)
        };
        let recipe = changed("hollow-glass", "index=1.25&bounces=3&vfov=40").unwrap();
        assert_eq!((recipe.settings.max_depth, recipe.camera.vfov_degrees), (4, 40.0));
        let indices: Vec<f64> = recipe
            .scene
            .materials
            .iter()
            .filter_map(|named| match named.material {
                Material::Dielectric { refraction_index } => Some(refraction_index),
                _ => None,
            })
            .collect();
        assert_eq!(indices, [1.25, 0.8]);
        assert!(changed("diffuse", "fuzz=1").is_err() && changed("diffuse", "vfov").is_err());
    }
}
