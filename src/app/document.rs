//! What the user edits and undo brings back: where a picture comes from and what was changed in it.

use crate::progressive::Stop;
use crate::recipe::Recipe;
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::{Rules, Shading, Stage, Surface};
use crate::stress::{Case, by_the_book};
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Where a picture comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A stage of the book.
    Stage(&'static Stage),
    /// A built-in scene, which has the recipe's name.
    Builtin,
    /// A scene file.
    File(PathBuf),
    /// An extreme scene.
    Extreme(&'static Case),
    /// Another picture by the book's own arithmetic.
    ByTheBook,
    /// A picture that said how it was made, of a scene that is in no file.
    Embedded,
}

/// A recipe as it was before anyone changed it.
#[derive(Debug)]
pub struct Origin {
    /// The recipe.
    pub recipe: Recipe,
    /// Where it is from.
    pub source: Source,
    /// Its scene under its rules, checked, for any camera and size.
    base: OnceLock<Result<RenderJob, JobError>>,
}

impl Origin {
    /// A recipe from somewhere.
    pub fn new(recipe: Recipe, source: Source) -> Self {
        Origin { recipe, source, base: OnceLock::new() }
    }

    /// A stage's picture.
    pub fn of_stage(stage: &'static Stage) -> Self {
        Origin::new(stage.recipe(), Source::Stage(stage))
    }

    /// An extreme scene's picture.
    pub fn of_case(case: &'static Case) -> Self {
        Origin::new(case.shown(), Source::Extreme(case))
    }

    /// The same picture by the book's own arithmetic.
    pub fn by_the_book(&self) -> Self {
        let recipe = Recipe { name: "The book's arithmetic".to_owned(), ..by_the_book(&self.recipe) };
        Origin::new(recipe, Source::ByTheBook)
    }

    /// Whether the book's own arithmetic would give a picture to hold against this one.
    pub fn is_other_by_the_book(&self) -> bool {
        let rules = &self.recipe.rules;
        rules.surface == Surface::Exact && rules.shading != Shading::ImageGradient
    }

    /// The origin of a recipe from elsewhere, which may have been changed. If a stage or a built-in scene has
    /// the same spheres and rules, it is that one.
    pub fn guess(recipe: &Recipe, stage: Option<&'static Stage>) -> Self {
        let is_same = |other: &Recipe| other.scene == recipe.scene && other.rules == recipe.rules;
        if let Some(stage) = stage.filter(|stage| is_same(&stage.recipe())) {
            return Origin::of_stage(stage);
        }
        match Recipe::builtin(&recipe.name) {
            Some(builtin) if is_same(&builtin) => Origin::new(builtin, Source::Builtin),
            _ => Origin::new(recipe.clone(), Source::Embedded),
        }
    }

    /// When its render ends, unless someone says otherwise: pictures without chance are done with their samples,
    /// others when they are clean.
    pub fn usual_stop(&self) -> Stop {
        let Recipe { rules, settings, samples_per_pixel, .. } = &self.recipe;
        let is_noisy = rules.antialiasing && rules.shading == Shading::Path;
        if is_noisy && settings.estimate_error {
            Stop { noise: Some(Stop::NOISE), ..Stop::default() }
        } else {
            Stop::at_samples(*samples_per_pixel)
        }
    }

    /// The stage.
    pub fn stage(&self) -> Option<&'static Stage> {
        match self.source {
            Source::Stage(stage) => Some(stage),
            _ => None,
        }
    }

    /// The picture that `camera` and `settings` give of it. All that are asked for share one scene.
    fn job(&self, camera: Camera, settings: RenderSettings) -> Result<RenderJob, JobError> {
        let checked = || {
            let (scene, rules) = (self.recipe.scene.clone(), self.recipe.rules);
            RenderJob::new(scene, Camera::BOOK, RenderSettings::default(), rules)
        };
        self.base.get_or_init(checked).clone()?.seen_by(camera, settings)
    }
}

/// What the window shows, as the user has changed it.
#[derive(Clone, Debug)]
pub struct Document {
    /// Where it comes from.
    pub origin: Arc<Origin>,
    /// The camera.
    pub camera: Camera,
    /// Size, depth, sampler, seed, halves.
    pub settings: RenderSettings,
    /// When it ends.
    pub stop: Stop,
}

impl PartialEq for Document {
    /// Origins are never changed, so that it is enough to compare which one it is.
    fn eq(&self, other: &Self) -> bool {
        self.has_same_film(other) && self.camera == other.camera && self.stop == other.stop
    }
}

impl Document {
    /// The origin with nothing changed.
    pub fn new(origin: Origin) -> Self {
        let Recipe { camera, settings, .. } = origin.recipe;
        Document { stop: origin.usual_stop(), camera, settings, origin: Arc::new(origin) }
    }

    /// The scene, which is the origin's.
    pub fn scene(&self) -> &Scene {
        &self.origin.recipe.scene
    }

    /// The rules, which are the origin's.
    pub fn rules(&self) -> &Rules {
        &self.origin.recipe.rules
    }

    /// The stage.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.origin.stage()
    }

    /// The extreme scene.
    pub fn case(&self) -> Option<&'static Case> {
        match self.origin.source {
            Source::Extreme(case) => Some(case),
            _ => None,
        }
    }

    /// What a badge or a menu calls the picture.
    pub fn title(&self) -> String {
        match &self.origin.source {
            Source::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Source::Extreme(case) => case.title().to_owned(),
            _ => self.origin.recipe.name.clone(),
        }
    }

    /// Width by height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.settings.width) / f64::from(self.settings.height)
    }

    /// The camera as far as the picture depends on it: a pinhole has no focus distance of its own.
    pub fn acting_camera(&self) -> Camera {
        let is_pinhole = self.camera.defocus_angle_degrees == 0.0;
        Camera { focus_distance: self.camera.focus_distance.filter(|_| !is_pinhole), ..self.camera }
    }

    /// Whether both are made of the same samples.
    pub fn has_same_film(&self, other: &Document) -> bool {
        Arc::ptr_eq(&self.origin, &other.origin)
            && self.acting_camera() == other.acting_camera()
            && self.settings == other.settings
    }

    /// The recipe of the picture.
    pub fn recipe(&self) -> Recipe {
        let origin = &self.origin.recipe;
        Recipe {
            camera: self.acting_camera(),
            settings: self.settings,
            samples_per_pixel: self.stop.samples.unwrap_or(origin.samples_per_pixel),
            ..origin.clone()
        }
    }

    /// The picture, at a whole fraction of its size.
    ///
    /// # Errors
    /// If a value cannot be.
    pub fn job(&self, divisor: u32) -> Result<RenderJob, JobError> {
        let RenderSettings { width, height, .. } = self.settings;
        let divisor = divisor.max(1);
        let settings = RenderSettings {
            width: width.div_ceil(divisor),
            height: height.div_ceil(divisor),
            // What is shown for a moment needs no error.
            estimate_error: self.settings.estimate_error && divisor == 1,
            ..self.settings
        };
        self.origin.job(self.acting_camera(), settings)
    }

    /// The command line that gives the same picture with `samples` samples per pixel, to the bit on the CPU.
    pub fn command_line(&self, samples: u64, device: &str, adapter: Option<&str>) -> String {
        let origin = &self.origin.recipe;
        let mut line = String::from("weekender --batch");
        // Writing to a string cannot fail.
        let mut add = |flag: &str, value: &dyn std::fmt::Display| {
            let _ = write!(line, " {flag}={}", quoted(&value.to_string()));
        };
        match &self.origin.source {
            Source::Stage(stage) => add("--stage", &stage.id),
            Source::Builtin => add("--scene", &origin.name),
            Source::File(path) => add("--scene", &path.display()),
            Source::Embedded | Source::Extreme(_) | Source::ByTheBook => {
                add("--scene", &format!("{}.toml", origin.name))
            }
        }
        let (mine, theirs) = (&self.settings, &origin.settings);
        if (mine.width, mine.height) != (theirs.width, theirs.height) {
            add("--size", &format!("{}x{}", mine.width, mine.height));
        }
        if mine.max_depth != theirs.max_depth {
            add("--depth", &mine.max_depth);
        }
        if mine.sampler != theirs.sampler {
            add("--sampler", &mine.sampler.name());
        }
        if mine.seed != theirs.seed {
            add("--seed", &mine.seed);
        }
        if mine.estimate_error != theirs.estimate_error {
            add("--estimate-error", &if mine.estimate_error { "on" } else { "off" });
        }
        let (camera, base) = (self.acting_camera(), &origin.camera);
        for (flag, value, default) in [
            ("--look-from", camera.look_from, base.look_from),
            ("--look-at", camera.look_at, base.look_at),
            ("--vup", camera.vup, base.vup),
        ] {
            if value != default {
                add(flag, &format!("{},{},{}", value.x, value.y, value.z));
            }
        }
        if camera.vfov_degrees != base.vfov_degrees {
            add("--vfov", &camera.vfov_degrees);
        }
        if camera.defocus_angle_degrees != base.defocus_angle_degrees {
            add("--defocus-angle", &camera.defocus_angle_degrees);
        }
        // There is no flag that takes a focus distance away, but one that says the same.
        if camera.focus_distance != base.focus_distance {
            add("--focus-distance", &camera.effective_focus_distance());
        }
        add("--samples", &samples);
        if device != "cpu" {
            add("--device", &device);
        }
        if let Some(adapter) = adapter {
            add("--adapter", &adapter);
        }
        add("--out", &format!("{}.png", origin.name));
        line
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,+=".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Request, parse};
    use glam::DVec3;

    fn of_stage(id: &str) -> Document {
        Document::new(Origin::of_stage(Stage::find(id).unwrap()))
    }

    /// What a command line renders.
    fn job_of(line: &str) -> RenderJob {
        match parse(line.split_whitespace().map(Into::into)).unwrap() {
            Request::Batch(options) => options.renders[0].job.clone(),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn the_command_line_gives_the_same_job() {
        for stage in Stage::ALL {
            let mut document = Document::new(Origin::of_stage(stage));
            assert_eq!(
                job_of(&document.command_line(4, "cpu", None)),
                document.job(1).unwrap(),
                "{}",
                stage.id
            );
            document.camera.look_from = DVec3::new(-1.1, 1e-20, 1.0 / 3.0);
            document.camera.look_at = DVec3::new(0.25, -7.0, 1e9);
            document.camera.vup = DVec3::new(0.0, 1.0, -0.5);
            document.camera.vfov_degrees = 33.3;
            document.settings.width = 31;
            document.settings.max_depth = 7;
            document.settings.seed = 9;
            document.settings.sampler = crate::render::SamplerKind::Independent;
            document.settings.estimate_error = false;
            for (defocus, focus) in [(0.0, Some(3.0)), (2.5, Some(3.0)), (2.5, None)] {
                document.camera.defocus_angle_degrees = defocus;
                document.camera.focus_distance = focus;
                let line = document.command_line(4, "cpu", None);
                let (theirs, mine) = (job_of(&line), document.job(1).unwrap());
                let same_focus =
                    |a: &Camera| Camera { focus_distance: Some(a.effective_focus_distance()), ..*a };
                assert_eq!(same_focus(theirs.camera()), same_focus(mine.camera()), "{line}");
                assert_eq!((theirs.settings(), theirs.rules()), (mine.settings(), mine.rules()), "{line}");
            }
        }
    }

    #[test]
    fn names_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("a-b.toml"), "a-b.toml");
        assert_eq!(quoted("my scene's.toml"), r"'my scene'\''s.toml'");
    }

    #[test]
    fn a_recipe_of_a_stage_is_known_again() {
        let stage = Stage::find("defocus").unwrap();
        let mut recipe = stage.recipe();
        recipe.camera.vfov_degrees = 50.0;
        assert_eq!(Origin::guess(&recipe, Some(stage)).source, Source::Stage(stage));
        std::sync::Arc::make_mut(&mut recipe.scene).sky.top = DVec3::ZERO;
        assert_eq!(Origin::guess(&recipe, Some(stage)).source, Source::Embedded);
        let builtin = Recipe::builtin("book").unwrap();
        assert_eq!(Origin::guess(&builtin, None).source, Source::Builtin);
    }

    #[test]
    fn a_pinhole_has_no_focus() {
        let mut document = of_stage("metal");
        let before = document.clone();
        document.camera.focus_distance = Some(2.0);
        assert!(document.has_same_film(&before));
        document.camera.defocus_angle_degrees = 1.0;
        assert!(!document.has_same_film(&before));
    }

    #[test]
    fn pictures_without_chance_end_with_their_samples() {
        assert_eq!(of_stage("ppm-tiny").stop.samples, Some(1));
        assert_eq!(of_stage("book").stop, Stop { samples: None, seconds: None, noise: Some(Stop::NOISE) });
    }
}
