//! The stills of a directory. Each is a PNG that says how it was made, so there is no other file.

use crate::film::{SOFTWARE, key};
use crate::job::recipe::Recipe;
use crate::job::saved::{Saved, is_whole_frame};
use crate::progressive::describe::{counted, seconds};
use crate::stages::Stage;
use std::path::Path;

/// The error of a still without noise.
pub(super) const NO_NOISE: &str = "no noise";

/// What a still says about itself.
#[derive(Clone, Debug)]
pub struct Still {
    pub width: u32,
    pub height: u32,
    max_depth: u32,
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
        let settings = saved.recipe().ok()?.settings;
        let text = |key| saved.description.get(key).map(str::to_owned);
        Some(Still {
            width: settings.width,
            height: settings.height,
            max_depth: settings.max_depth,
            samples_per_pixel: saved.samples()?,
            trace_seconds: saved.seconds()?,
            error: text(key::ERROR)?,
            backend: text(key::BACKEND).unwrap_or_default(),
        })
    }

    /// The still of `stage` on one line.
    pub(super) fn line(&self, stage: &Stage) -> String {
        let size = format!("{}x{}", self.width, self.height);
        let (id, samples, time) = (stage.id, self.samples_per_pixel, self.time_words());
        format!("{id:<18} {size:>9}, {samples:>4} spp, {time:>15}, {}\n", self.error_words())
    }

    /// Size, samples and rays.
    pub fn settings_words(&self) -> String {
        let samples = match self.samples_per_pixel {
            1 => "1 ray through the centre of each pixel".to_owned(),
            samples => format!("{} per pixel", counted(samples, "sample")),
        };
        let depth = match self.max_depth {
            1 => String::new(),
            depth => format!(", at most {depth} rays per path"),
        };
        format!("{} × {} pixels, {samples}{depth}", self.width, self.height)
    }

    /// The tracing time.
    pub fn time_words(&self) -> String {
        if self.trace_seconds < 0.1 { "less than 0.1 s".to_owned() } else { seconds(self.trace_seconds) }
    }

    pub fn error_words(&self) -> String {
        if self.error == NO_NOISE { self.error.clone() } else { format!("error {}", self.error) }
    }
}

/// The stills of a directory, in the book's order.
#[derive(Clone, Debug, Default)]
pub struct Stills(Vec<(&'static Stage, Still)>);

impl Stills {
    pub fn read(directory: &Path) -> Stills {
        let still = |stage: &'static Stage| {
            let path = directory.join(file_name(stage));
            let is_of_stage = Saved::describe(&path).is_ok_and(|saved| saved.stage() == Some(stage));
            Some((stage, Still::read(&path).filter(|_| is_of_stage)?))
        };
        Stills(Stage::ALL.iter().filter_map(still).collect())
    }

    pub fn all(&self) -> impl Iterator<Item = &Still> {
        self.0.iter().map(|(_, still)| still)
    }

    pub fn of(&self, stage: &Stage) -> Option<&Still> {
        self.0.iter().find(|(of, _)| of.id == stage.id).map(|(_, still)| still)
    }
}

#[cfg(test)]
impl Stills {
    /// Stills of these stages at full quality, not rendered.
    pub fn of_stages(ids: &[&str]) -> Self {
        let still = |id: &&str| {
            let stage = Stage::find(id).unwrap();
            let Recipe { settings, samples_per_pixel, .. } = super::Quality::Full.recipe(stage);
            let still = Still {
                width: settings.width,
                height: settings.height,
                max_depth: settings.max_depth,
                samples_per_pixel,
                trace_seconds: 0.0,
                error: NO_NOISE.to_owned(),
                backend: "cpu".to_owned(),
            };
            (stage, still)
        };
        Stills(ids.iter().map(still).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_still_describes_itself() {
        let stills = Stills::of_stages(&["metal", "sky"]);
        let [metal, sky] = ["metal", "sky"].map(|id| stills.of(Stage::find(id).unwrap()).unwrap());
        let error = "1.2e-3 ± 0.8 %".to_owned();
        let metal = Still { trace_seconds: 8.26, error, ..metal.clone() };
        let line = "metal                800x450, 1024 spp,           8.3 s, error 1.2e-3 ± 0.8 %\n";
        assert_eq!(metal.line(Stage::find("metal").unwrap()), line);
        let settings = "800 × 450 pixels, 1024 samples per pixel, at most 50 rays per path";
        assert_eq!(metal.settings_words(), settings);
        assert_eq!(sky.settings_words(), "800 × 450 pixels, 1 ray through the centre of each pixel");
        assert_eq!((sky.time_words().as_str(), sky.error_words().as_str()), ("less than 0.1 s", "no noise"));
    }
}
