//! The stills of a directory. Each is a PNG that says how it was made, so there is no other file.

use crate::film::{SOFTWARE, key};
use crate::job::recipe::Recipe;
use crate::job::render::RenderSettings;
use crate::job::saved::{Saved, is_whole_frame};
use crate::progressive::describe::{counted, seconds};
use crate::stages::Stage;
use std::collections::BTreeMap;
use std::path::Path;

/// Maximum width of a quick still, pixels.
const QUICK_WIDTH: u32 = 480;

/// Maximum samples per pixel of a quick still.
const QUICK_SAMPLES: u64 = 64;

/// Minimum width of a full still, pixels: almost twice the pixels that most figures are wide.
const FULL_WIDTH: u32 = 800;

/// Samples per pixel of a full still. The estimated error is then at most 0.003, about half an 8-bit step.
const FULL_SAMPLES: u64 = 1024;

/// Stills narrower than this are enlarged.
const FEW_PIXELS: u32 = 100;

/// The error of a still without noise.
pub(super) const NO_NOISE: &str = "no noise";

/// Whether a still of the stage must be enlarged with every pixel a square. (A reduced still must not be shown so: its
/// edges would become jagged.)
pub fn has_few_pixels(stage: &Stage) -> bool {
    stage.setup.width < FEW_PIXELS
}

/// The stage's own recipe with the size and samples of a still.
pub(super) fn recipe(stage: &Stage, is_quick: bool) -> Recipe {
    let mut recipe = stage.recipe();
    if stage.setup.is_about_pixels {
        return recipe;
    }
    let (settings, samples) = (&mut recipe.settings, &mut recipe.samples_per_pixel);
    let width = if is_quick { settings.width.min(QUICK_WIDTH) } else { settings.width.max(FULL_WIDTH) };
    settings.height = (settings.height * width).div_ceil(settings.width);
    settings.width = width;
    // A stage with one sample sends it through the pixel's centre; more would be the same.
    if *samples > 1 {
        *samples = if is_quick { QUICK_SAMPLES.min(*samples) } else { FULL_SAMPLES };
    }
    recipe
}

/// What a still says about itself.
#[derive(Clone, Debug)]
pub struct Still {
    pub settings: RenderSettings,
    samples_per_pixel: u64,
    trace_seconds: f64,
    /// The estimated error, or [`NO_NOISE`].
    error: String,
    /// The backend that rendered it.
    pub backend: String,
}

pub(super) fn file_name(stage: &Stage) -> String {
    format!("{}.png", stage.id)
}

/// Whether the still of `stage` is whole and one of `recipes`, made by this version of the program.
pub(super) fn is_fresh(path: &Path, recipes: &[Recipe]) -> bool {
    Still::read(path).is_some() && recipes.iter().any(|recipe| is_whole_frame(path, recipe, SOFTWARE))
}

impl Still {
    /// Reads a still; `None` if there is none that says how it was made.
    pub fn read(path: &Path) -> Option<Still> {
        let saved = Saved::describe(path).ok()?;
        let text = |key| saved.description.get(key).map(str::to_owned);
        Some(Still {
            settings: saved.recipe().ok()?.settings,
            samples_per_pixel: saved.samples()?,
            trace_seconds: saved.seconds()?,
            error: text(key::ERROR)?,
            backend: text(key::BACKEND).unwrap_or_default(),
        })
    }

    /// The still of `stage` on one line.
    pub(super) fn line(&self, stage: &Stage) -> String {
        let size = format!("{}x{}", self.settings.width, self.settings.height);
        let (id, samples, time) = (stage.id, self.samples_per_pixel, self.time_words());
        format!("{id:<18} {size:>9}, {samples:>4} spp, {time:>15}, {}\n", self.error_words())
    }

    /// Size, samples and rays.
    pub fn settings_words(&self) -> String {
        let samples = match self.samples_per_pixel {
            1 => "1 ray through the centre of each pixel".to_owned(),
            samples => format!("{} per pixel", counted(samples, "sample")),
        };
        let depth = match self.settings.max_depth {
            1 => String::new(),
            depth => format!(", at most {depth} rays per path"),
        };
        format!("{} × {} pixels, {samples}{depth}", self.settings.width, self.settings.height)
    }

    /// The tracing time.
    pub fn time_words(&self) -> String {
        if self.trace_seconds < 0.1 { "less than 0.1 s".to_owned() } else { seconds(self.trace_seconds) }
    }

    pub fn error_words(&self) -> String {
        if self.error == NO_NOISE { self.error.clone() } else { format!("error {}", self.error) }
    }
}

/// The stills of a directory by their stages' ids.
pub type Stills = BTreeMap<&'static str, Still>;

pub fn stills_in(directory: &Path) -> Stills {
    let still = |stage: &'static Stage| {
        let path = directory.join(file_name(stage));
        let is_of_stage = Saved::describe(&path).is_ok_and(|saved| saved.stage() == Some(stage));
        Some((stage.id, Still::read(&path).filter(|_| is_of_stage)?))
    };
    Stage::ALL.iter().filter_map(still).collect()
}

/// Stills of these stages at full quality, not rendered.
#[cfg(test)]
pub fn stills_of(ids: &[&'static str]) -> Stills {
    let still = |id: &&'static str| {
        let Recipe { settings, samples_per_pixel, .. } = recipe(Stage::find(id).unwrap(), false);
        let (error, backend) = (NO_NOISE.to_owned(), "cpu".to_owned());
        (*id, Still { settings, samples_per_pixel, trace_seconds: 0.0, error, backend })
    };
    ids.iter().map(still).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_describes_itself() {
        let stills = stills_of(&["metal", "sky"]);
        let [metal, sky] = ["metal", "sky"].map(|id| &stills[id]);
        let error = "1.2e-3 ± 0.8 %".to_owned();
        let metal = Still { trace_seconds: 8.26, error, ..metal.clone() };
        let line = "metal                800x450, 1024 spp,           8.3 s, error 1.2e-3 ± 0.8 %\n";
        assert_eq!(metal.line(Stage::find("metal").unwrap()), line);
        let settings = "800 × 450 pixels, 1024 samples per pixel, at most 50 rays per path";
        assert_eq!(metal.settings_words(), settings);
        assert_eq!(sky.settings_words(), "800 × 450 pixels, 1 ray through the centre of each pixel");
        assert_eq!((sky.time_words().as_str(), sky.error_words().as_str()), ("less than 0.1 s", "no noise"));
    }

    #[test]
    fn stills_keep_aspect_ratio() {
        for stage in Stage::ALL {
            let own = stage.recipe();
            for is_quick in [true, false] {
                let recipe = super::recipe(stage, is_quick);
                recipe.job().expect(stage.id);
                let [shape, own_shape] = [&recipe.settings, &own.settings]
                    .map(|settings| f64::from(settings.width) / f64::from(settings.height));
                assert!((shape / own_shape - 1.0).abs() < 0.01, "{}: {shape}", stage.id);
                assert_eq!(recipe.samples_per_pixel == 1, own.samples_per_pixel == 1, "{}", stage.id);
                if stage.setup.is_about_pixels {
                    assert_eq!(recipe, own);
                }
            }
        }
        let sizes = |id: &str| {
            [true, false].map(|is_quick| {
                let recipe = super::recipe(Stage::find(id).expect("a stage"), is_quick);
                (recipe.settings.width, recipe.settings.height, recipe.samples_per_pixel)
            })
        };
        assert_eq!(sizes("book"), [(480, 270, 64), (1200, 675, 1024)]);
        assert_eq!(sizes("sky"), [(480, 270, 1), (800, 450, 1)]);
    }
}
