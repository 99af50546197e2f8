//! How large stills are and how many samples they get.

use crate::job::recipe::Recipe;
use crate::stages::Stage;

/// The effort for a still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Small and with visible noise, for a first look.
    Quick,
    /// For pages: almost twice as many pixels across as most figures are wide, and hardly any noise.
    Full,
}

/// Largest width of a quick still, pixels.
const QUICK_WIDTH: u32 = 480;

/// Most samples per pixel of a quick still.
const QUICK_SAMPLES: u64 = 64;

/// Least width of a full still, pixels.
const FULL_WIDTH: u32 = 880;

/// Samples per pixel of a full still: the estimated error is then 0.003 or less, about half a step of 8 bits.
const FULL_SAMPLES: u64 = 1024;

/// Stages about single pixels; neither their size nor their samples may change.
const PIXELS: [&str; 3] = ["ppm-tiny", "aliased", "antialiased"];

/// A still of fewer pixels across is enlarged.
const FEW_PIXELS: u32 = 100;

/// Whether a still of the stage has so few pixels that it must be enlarged, with every pixel a square. (Stills that are
/// reduced must not be shown so: their edges would become steps.)
pub fn is_about_pixels(stage: &Stage) -> bool {
    stage.setup.width < FEW_PIXELS
}

impl Quality {
    pub fn new(is_quick: bool) -> Self {
        if is_quick { Quality::Quick } else { Quality::Full }
    }

    /// The picture of `stage`: its own recipe in the size and with the samples of this quality.
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
        // A stage with one sample sends it through the centre of the pixel; more would be the same.
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
    fn stills_keep_the_shape_of_their_stage() {
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
        assert_eq!(sizes("sky"), [(480, 270, 1), (880, 495, 1)]);
    }
}
