//! The document, which the user edits and undo restores: the origin of a picture and the changes to it.

use super::{CheckedScene, Origin, Source};
use crate::job::recipe::Recipe;
use crate::job::render::{JobError, RenderJob, RenderSettings, SAMPLE_LIMIT};
use crate::measure::stress::Case;
use crate::progressive::{EndReason, Phase, Status, Stop};
use crate::scene::animation::Keyframe;
use crate::scene::{Camera, Pick, Scene};
use crate::stages::{Rules, Shading, Stage};
use std::path::Path;
use std::sync::Arc;

/// Suffix of the file names of changed scenes.
const CHANGED: &str = "-changed";

const NO_RAYS: &str = "This stage traces no rays: its picture depends only on the position of each pixel";

/// The picture in the window, with the user's changes.
#[derive(Clone, Debug)]
pub struct Document {
    /// Where the picture comes from.
    pub origin: Arc<Origin>,
    /// The scene, as edited.
    pub checked: Arc<CheckedScene>,
    /// The camera, as edited.
    pub camera: Camera,
    /// The bookmarks, in their order.
    pub keyframes: Vec<Keyframe>,
    /// Size, depth, sampler, seed.
    pub settings: RenderSettings,
    /// The size is the picture's own: it follows neither the viewport nor the book.
    pub has_own_size: bool,
    /// When the render ends.
    pub stop: Stop,
}

impl PartialEq for Document {
    /// Origins and scenes are immutable, so comparing their addresses is enough. A size that follows the viewport or
    /// the book is not a change of the user.
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.origin, &other.origin)
            && Arc::ptr_eq(&self.checked, &other.checked)
            && (self.camera, self.stop, self.has_own_size) == (other.camera, other.stop, other.has_own_size)
            && self.chosen_settings() == other.chosen_settings()
            && self.keyframes == other.keyframes
    }
}

/// The name of a changed scene, whose scene file may be named so already.
fn changed(name: &str) -> String {
    if name.ends_with(CHANGED) { name.to_owned() } else { format!("{name}{CHANGED}") }
}

impl Document {
    /// An unchanged document of `origin`.
    pub fn new(origin: Origin) -> Self {
        Document::of(Arc::new(origin))
    }

    /// An unchanged document of `origin`.
    pub fn of(origin: Arc<Origin>) -> Self {
        let Recipe { camera, settings, .. } = origin.recipe;
        Document {
            keyframes: origin.recipe.keyframes.clone(),
            stop: origin.usual_stop(),
            checked: Arc::clone(&origin.scene),
            has_own_size: origin.keeps_size(),
            camera,
            settings,
            origin,
        }
    }

    /// The document of a recipe that a film or picture describes.
    pub fn of_film(recipe: &Recipe, stage: Option<&'static Stage>) -> Self {
        let document = Document::new(Origin::guess(recipe, stage));
        let Recipe { camera, settings, .. } = *recipe;
        let keyframes = recipe.keyframes.clone();
        Document { camera, keyframes, settings, has_own_size: true, ..document }
    }

    /// Resets everything to the origin's values. A size that follows the viewport or the book stays.
    pub fn reset(&mut self) {
        let before = std::mem::replace(self, Document::of(Arc::clone(&self.origin)));
        if !before.has_own_size && !self.has_own_size {
            self.set_size(before.size());
        }
    }

    /// A name for the change from `other`, which was before.
    pub fn difference(&self, other: &Document) -> &'static str {
        let (mine, theirs) = (&self.camera, &other.camera);
        let [settings, of_other] =
            [&self.settings, &other.settings].map(|of| RenderSettings { width: 0, height: 0, ..*of });
        if !Arc::ptr_eq(&self.origin, &other.origin) {
            "change of picture"
        } else if !Arc::ptr_eq(&self.checked, &other.checked) {
            if self.has_changed_scene() { self.checked.change } else { "spheres" }
        } else if mine.vfov_degrees != theirs.vfov_degrees {
            "field of view"
        } else if mine.defocus_angle_degrees != theirs.defocus_angle_degrees {
            "defocus angle"
        } else if mine.focus_distance != theirs.focus_distance {
            "focus distance"
        } else if mine != theirs {
            "camera"
        } else if settings != of_other {
            "tracer"
        } else if self.stop != other.stop {
            "samples"
        } else if self.keyframes != other.keyframes {
            "bookmarks"
        } else {
            "size"
        }
    }

    /// The scene, as edited.
    pub fn scene(&self) -> &Scene {
        self.checked.scene()
    }

    /// Whether the scene is not the origin's.
    pub fn has_changed_scene(&self) -> bool {
        !Arc::ptr_eq(&self.checked, &self.origin.scene)
    }

    /// Whether scene, camera or settings are not the origin's, apart from size, stop and bookmarks.
    pub fn is_changed(&self) -> bool {
        let unchanged = Document::of(Arc::clone(&self.origin));
        !matches!(self.difference(&unchanged), "size" | "samples" | "bookmarks")
    }

    /// What `camera` sees at a place in the picture, `0..=1` from the upper left.
    pub fn pick(&self, camera: &Camera, place: [f64; 2]) -> Option<Pick> {
        self.scene().pick(camera.look_from, camera.direction_through(place, self.aspect()))
    }

    /// The rules of the origin.
    pub fn rules(&self) -> &Rules {
        &self.origin.recipe.rules
    }

    /// Why there are no rays; the camera then has no effect, and no pixel has paths.
    pub fn no_rays(&self) -> Option<&'static str> {
        (self.rules().shading == Shading::ImageGradient).then_some(NO_RAYS)
    }

    /// The stage, if the origin is one.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.origin.stage()
    }

    /// The extreme scene, if the origin is one.
    pub fn case(&self) -> Option<&'static Case> {
        match self.origin.source {
            Source::Extreme(case) => Some(case),
            _ => None,
        }
    }

    /// The name of what is shown, changed or not.
    pub fn heading(&self) -> String {
        match &self.origin.source {
            Source::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Source::Extreme(case) => case.title().to_owned(),
            Source::New => "New scene".to_owned(),
            Source::File(path) => path.file_name().unwrap_or(path.as_os_str()).display().to_string(),
            _ => self.origin.recipe.name.clone(),
        }
    }

    /// The name of the picture in menus and badges.
    pub fn title(&self) -> String {
        let heading = self.heading();
        if self.has_changed_scene() { format!("{heading} (changed)") } else { heading }
    }

    /// A short name for sentences: the section of the book, else the title.
    pub fn place(&self) -> String {
        self.stage().map_or_else(|| self.title(), |stage| stage.section.to_owned())
    }

    /// The name for files: a changed scene of the program has its own, one of a file that of the file.
    pub fn name(&self) -> String {
        let (name, is_file) = (&self.origin.recipe.name, matches!(self.origin.source, Source::File(_)));
        if self.has_changed_scene() && !is_file { changed(name) } else { name.clone() }
    }

    /// The origin of the picture once its scene has been saved in a file.
    pub fn saved_in(&self, path: &Path) -> Origin {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let recipe = Recipe { name, camera: self.camera, ..self.recipe() };
        Origin { recipe, source: Source::File(path), scene: Arc::clone(&self.checked) }
    }

    /// Width divided by height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.settings.width) / f64::from(self.settings.height)
    }

    /// The camera without settings that have no effect: a pinhole camera has no focus distance.
    pub fn acting_camera(&self) -> Camera {
        let is_pinhole = self.camera.defocus_angle_degrees == 0.0;
        Camera { focus_distance: self.camera.focus_distance.filter(|_| !is_pinhole), ..self.camera }
    }

    /// Whether both documents consist of the same samples.
    pub fn has_same_film(&self, other: &Document) -> bool {
        Arc::ptr_eq(&self.checked, &other.checked)
            && self.acting_camera() == other.acting_camera()
            && self.settings == other.settings
    }

    /// The recipe of the picture.
    pub fn recipe(&self) -> Recipe {
        let origin = &self.origin.recipe;
        Recipe {
            name: self.name(),
            scene: Arc::clone(self.checked.scene()),
            camera: self.acting_camera(),
            keyframes: self.keyframes.clone(),
            settings: self.settings,
            samples_per_pixel: self.stop.samples.unwrap_or(origin.samples_per_pixel),
            ..origin.clone()
        }
    }

    /// The job of the picture, with its size divided by `divisor`.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn job(&self, divisor: u32) -> Result<RenderJob, JobError> {
        let RenderSettings { width, height, .. } = self.settings;
        let divisor = divisor.max(1);
        let settings = RenderSettings {
            width: width.div_ceil(divisor),
            height: height.div_ceil(divisor),
            ..self.settings
        };
        self.checked.job(self.acting_camera(), settings)
    }

    /// Whether the picture depends on random numbers.
    pub fn is_random(&self) -> bool {
        self.rules().antialiasing || self.rules().shading == Shading::Path
    }

    /// The next end after the one that a render has reached; `None` while it is rendered, or if more samples would
    /// change nothing.
    pub fn further(&self, status: &Status) -> Option<Stop> {
        let Phase::Done(reason) = status.phase else { return None };
        if !self.is_random() || status.samples_per_pixel >= SAMPLE_LIMIT {
            return None;
        }
        let stop = self.stop;
        match reason {
            // A denoised picture ends with fewer samples than its goal for the raw one needs.
            EndReason::NoiseTarget | EndReason::Samples if stop.noise.is_some() && stop.samples.is_none() => {
                let reached = status.error.map_or(f64::INFINITY, |error| error.rmse).min(stop.noise?);
                let halves = std::iter::successors(stop.noise, |noise| Some(noise / 2.0));
                let next = halves.take_while(|noise| *noise > 1e-6).find(|noise| *noise < 0.55 * reached);
                next.map(|noise| Stop { noise: Some(noise), ..stop })
            }
            EndReason::Samples => {
                let samples = stop.samples?.max(status.samples_per_pixel).saturating_mul(2).min(SAMPLE_LIMIT);
                Some(Stop { samples: Some(samples), ..stop })
            }
            EndReason::TimeLimit => {
                let seconds = 2.0 * stop.seconds?.max(status.elapsed.as_secs_f64().floor());
                Some(Stop { seconds: Some(seconds), ..stop })
            }
            EndReason::NoiseTarget | EndReason::Stopped => None,
        }
    }

    /// The document of what its scene file holds now, seen by the user's camera if that is not the file's.
    pub fn reloaded(&self, recipe: Recipe) -> Document {
        let mut document = Document::new(Origin::new(recipe, self.origin.source.clone()));
        if self.camera != self.origin.recipe.camera {
            document.camera = self.camera;
        }
        document
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;

    #[test]
    fn the_recipe_has_the_samples_at_which_the_render_stops() {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let usual = document.origin.recipe.samples_per_pixel;
        document.stop = Stop::default();
        assert_eq!(document.recipe().samples_per_pixel, usual);
        document.stop = Stop::at_samples(usual + 7);
        assert_eq!(document.recipe().samples_per_pixel, usual + 7);
    }

    fn metal() -> Document {
        Document::new(Origin::of_stage(Stage::find("metal").unwrap()))
    }

    /// The same document with a scene of its own, which is equal.
    fn edited(document: &Document) -> Document {
        let scene = CheckedScene::new(Arc::clone(document.checked.scene()), *document.rules());
        Document { checked: Arc::new(scene), ..document.clone() }
    }

    #[test]
    fn a_changed_scene_has_a_name_of_its_own() {
        let names = |document: &Document| (document.title(), document.name());
        let expected = |title: &str, name: &str| (title.to_owned(), name.to_owned());
        assert_eq!(names(&metal()), expected("10.5 Mirrors", "metal"));
        let changed = edited(&metal());
        assert_eq!(names(&changed), expected("10.5 Mirrors (changed)", "metal-changed"));
        let opened = Document::new(Origin::new(changed.recipe(), Source::File("a.toml".into())));
        assert_eq!(names(&opened), expected("a.toml", "metal-changed"));
        assert_eq!(names(&edited(&opened)), expected("a.toml (changed)", "metal-changed"));
    }

    #[test]
    fn a_preview_is_smaller() {
        let mut document = metal();
        document.give_size([31, 18]);
        let sizes = [1, 2, 4].map(|divisor| {
            let settings = *document.job(divisor).unwrap().settings();
            (settings.width, settings.height)
        });
        assert_eq!(sizes, [(31, 18), (16, 9), (8, 5)]);
        assert_eq!(document.job(0).unwrap(), document.job(1).unwrap());
    }

    #[test]
    fn only_what_the_user_has_chosen_is_a_change() {
        let usual = metal();
        type Change = fn(&mut Document);
        let changes: [(Change, bool); 6] = [
            (|document| document.set_size([33, 22]), false),
            (|document| document.stop = Stop::at_samples(9), false),
            (|document| document.camera.vfov_degrees = 33.0, true),
            (|document| document.settings.seed = 9, true),
            (|document| document.give_size([480, 270]), false),
            (|document| *document = edited(document), true),
        ];
        for (index, (change, is_change)) in changes.into_iter().enumerate() {
            let mut document = usual.clone();
            change(&mut document);
            assert_eq!(document.is_changed(), is_change, "change {index}");
            let size = document.size();
            document.reset();
            assert!(document == usual, "change {index}");
            // A size that followed the viewport stays.
            assert_eq!(document.size(), if index == 0 { size } else { usual.size() });
        }
    }

    #[test]
    fn the_document_of_a_film_is_its_stage_as_the_film_shows_it() {
        let stage = Stage::find("metal").unwrap();
        let mut recipe = stage.recipe();
        recipe.camera.vfov_degrees = 33.0;
        (recipe.settings.width, recipe.settings.height, recipe.settings.seed) = (64, 36, 5);
        let document = Document::of_film(&recipe, Some(stage));
        assert_eq!((document.camera, document.settings), (recipe.camera, recipe.settings));
        assert_eq!((document.stage(), document.has_own_size), (Some(stage), true));
        assert_eq!(document.origin.recipe, stage.recipe());
        assert!(document.is_changed() && !document.has_changed_scene());
    }

    #[test]
    fn changed_samples_need_another_film() {
        let usual = metal();
        type Change = fn(&mut Document);
        // A change, whether the film is still the same, and whether the document is.
        let changes: [(Change, bool, bool); 8] = [
            (|_| {}, true, true),
            (|document| document.camera.look_at.x += 1.0, false, false),
            (|document| document.settings.max_depth = 9, false, false),
            (|document| *document = edited(document), false, false),
            (|document| document.set_size([33, 22]), false, true),
            (|document| document.stop = Stop::at_samples(9), true, false),
            (|document| document.has_own_size = true, true, false),
            (
                |document| {
                    let recipe = document.origin.recipe.clone();
                    document.origin = Arc::new(Origin {
                        recipe,
                        source: Source::Builtin,
                        scene: Arc::clone(&document.origin.scene),
                    });
                },
                true,
                false,
            ),
        ];
        for (index, (change, has_same_film, is_same)) in changes.into_iter().enumerate() {
            let mut document = usual.clone();
            change(&mut document);
            assert_eq!(document.has_same_film(&usual), has_same_film, "change {index}");
            assert_eq!(document == usual, is_same, "change {index}");
        }
    }

    fn done(reason: EndReason, rmse: f64) -> Status {
        Status {
            phase: Phase::Done(reason),
            samples_per_pixel: 100,
            error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        }
    }

    #[test]
    fn a_render_goes_on_to_the_next_end_of_its_kind() {
        let mut document = Document::new(Origin::of_stage(Stage::find("book").unwrap()));
        let further = document.further(&done(EndReason::NoiseTarget, 0.00195)).unwrap();
        assert_eq!(further.noise, Some(0.001));
        document.stop = Stop::at_samples(100);
        let further = document.further(&done(EndReason::Samples, 0.01)).unwrap();
        assert_eq!(further.samples, Some(200));
        document.stop = Stop { seconds: Some(10.0), ..Stop::default() };
        assert_eq!(document.further(&done(EndReason::TimeLimit, 0.01)).unwrap().seconds, Some(20.0));
        // The last pass ended after the limit.
        let elapsed = std::time::Duration::from_secs_f64(12.7);
        let late = Status { elapsed, ..done(EndReason::TimeLimit, 0.01) };
        let further = document.further(&late).unwrap();
        assert_eq!(further.seconds, Some(24.0));
        assert_eq!(document.further(&Status { phase: Phase::Tracing, ..Status::default() }), None);
        let tiny = Document::new(Origin::of_stage(Stage::find("ppm-tiny").unwrap()));
        assert_eq!(tiny.further(&done(EndReason::Samples, 0.0)), None, "nothing in it is random");
    }

    #[test]
    fn the_next_end_lies_beyond_what_was_reached() {
        let samples = Stop::at_samples;
        let noise = |noise: f64| Stop { noise: Some(noise), ..Stop::default() };
        let after = |samples_per_pixel| Status { samples_per_pixel, ..done(EndReason::Samples, 0.01) };
        let unknown = Status { error: None, ..done(EndReason::NoiseTarget, 0.0) };
        for (stop, status, expected) in [
            // The last pass ended after the limit, or a later stop was chosen.
            (samples(60), after(100), Some(samples(200))),
            (samples(300), after(100), Some(samples(600))),
            (samples(SAMPLE_LIMIT - 1), after(SAMPLE_LIMIT - 1), Some(samples(SAMPLE_LIMIT))),
            (samples(SAMPLE_LIMIT), after(SAMPLE_LIMIT), None),
            (noise(0.002), unknown, Some(noise(0.001))),
            (noise(0.002), done(EndReason::NoiseTarget, 0.01), Some(noise(0.001))),
            (noise(0.002), done(EndReason::NoiseTarget, 1e-6), None),
            (samples(100), done(EndReason::Stopped, 0.01), None),
            // That end no longer exists.
            (Stop::default(), after(100), None),
            (Stop::default(), done(EndReason::NoiseTarget, 0.01), None),
            (Stop::default(), done(EndReason::TimeLimit, 0.01), None),
        ] {
            let mut document = Document::new(Origin::of_stage(Stage::find("book").unwrap()));
            document.stop = stop;
            assert_eq!(document.further(&status), expected, "{stop:?} {:?}", status.phase);
        }
    }

    #[test]
    fn the_users_camera_stays_and_the_rest_is_the_files() {
        let recipe = Stage::find("metal").unwrap().recipe();
        let document = Document::new(Origin::new(recipe.clone(), Source::File("a.toml".into())));
        let mut other = recipe;
        Arc::make_mut(&mut other.scene).spheres[0].radius = 7.0;
        other.camera.vfov_degrees = 33.0;
        let reloaded = document.reloaded(other.clone());
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, other.camera));
        let mut moved = document;
        moved.camera.look_from.x += 1.0;
        let reloaded = moved.reloaded(other.clone());
        assert_eq!((reloaded.scene(), reloaded.camera), (&*other.scene, moved.camera));
    }
}
