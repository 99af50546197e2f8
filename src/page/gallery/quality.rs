//! Size and sample count of stills.

use crate::job::recipe::Recipe;
use crate::stages::Stage;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Small and visibly noisy, for a first look.
    Quick,
    /// For pages: almost twice the pixels that most figures are wide, and hardly any noise.
    Full,
}

/// Maximum width of a quick still, pixels.
const QUICK_WIDTH: u32 = 480;

/// Maximum samples per pixel of a quick still.
const QUICK_SAMPLES: u64 = 64;

/// Minimum width of a full still, pixels.
const FULL_WIDTH: u32 = 800;

/// Samples per pixel of a full still. The estimated error is then at most 0.003, about half an 8-bit step.
const FULL_SAMPLES: u64 = 1024;

/// Stages about single pixels, whose size and samples must not change.
const PIXELS: [&str; 3] = ["ppm-tiny", "aliased", "antialiased"];

/// Stills narrower than this are enlarged.
const FEW_PIXELS: u32 = 100;

/// Whether a still of the stage must be enlarged with every pixel a square. (A reduced still must not be shown so: its
/// edges would become jagged.)
pub fn is_about_pixels(stage: &Stage) -> bool {
    stage.setup.width < FEW_PIXELS
}

impl Quality {
    pub fn new(is_quick: bool) -> Self {
        if is_quick { Quality::Quick } else { Quality::Full }
    }

    /// The stage's own recipe with this quality's size and samples.
    pub fn recipe(self, stage: &Stage) -> Recipe {
        let mut recipe = stage.recipe();
        if PIXELS.contains(&stage.id) {
            return recipe;
        }
        let settings = &mut recipe.settings;
        let width = match self {
            Quality::Quick => settings.width.min(QUICK_WIDTH),
            Quality::Full => settings.width.max(FULL_WIDTH),
        };
        settings.height = (settings.height * width).div_ceil(settings.width);
        settings.width = width;
        // A stage with one sample sends it through the pixel's centre; more would be the same.
        recipe.samples_per_pixel = match (self, recipe.samples_per_pixel) {
            (_, 1) => 1,
            (Quality::Quick, samples) => samples.min(QUICK_SAMPLES),
            (Quality::Full, _) => FULL_SAMPLES,
        };
        recipe
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stills_keep_aspect_ratio() {
        for stage in Stage::ALL {
            let own = stage.recipe();
            for quality in [Quality::Quick, Quality::Full] {
                let recipe = quality.recipe(stage);
                recipe.job().expect(stage.id);
                let [shape, own_shape] = [&recipe.settings, &own.settings]
                    .map(|settings| f64::from(settings.width) / f64::from(settings.height));
                assert!((shape / own_shape - 1.0).abs() < 0.01, "{}: {shape}", stage.id);
                assert_eq!(recipe.samples_per_pixel == 1, own.samples_per_pixel == 1, "{}", stage.id);
                if PIXELS.contains(&stage.id) {
                    assert_eq!(recipe, own);
                }
            }
        }
        let sizes = |id: &str| {
            [Quality::Quick, Quality::Full].map(|quality| {
                let recipe = quality.recipe(Stage::find(id).expect("a stage"));
                (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel)
            })
        };
        assert_eq!(sizes("book"), [(480, 270, 64), (1200, 675, 1024)]);
        assert_eq!(sizes("sky"), [(480, 270, 1), (800, 450, 1)]);
    }
}
