//! The paths of one pixel: listed, gone through ray by ray, and drawn over the picture.

mod list;
mod paint;

use super::answers::Answers;
use super::model::document::Document;
use crate::backends::explain::{Step, steps};
use crate::render_cpu::{Isa, PathRecord, PathRecorder};
use eframe::egui;

/// The largest number of paths in the list.
const COUNT_LIMIT: u64 = 64;

/// A recorded path and its explanation, ray by ray.
struct Path {
    record: PathRecord,
    /// What each ray does, and the same in words.
    steps: Vec<(Step, String)>,
}

/// Paths of a pixel, recorded by a background thread.
pub struct Listed {
    number: u64,
    pixel: [u32; 2],
    /// The document when they were recorded.
    document: Document,
    /// The paths of samples 0, 1, 2 and so on.
    paths: Vec<Path>,
}

/// Why the paths that a query asked for are not listed.
struct NotListed {
    number: u64,
    reason: String,
}

/// The list of paths.
pub struct Paths {
    count: u64,
    /// The number of the newest query.
    number: u64,
    is_waiting: bool,
    listed: Option<Listed>,
    /// Why the paths that were asked for last could not be recorded, if so.
    fault: Option<String>,
    /// The sample whose path is highlighted.
    selected: Option<usize>,
    /// The ray of that path that is explained.
    ray: usize,
    /// The list is new and the panel should scroll to it.
    is_new: bool,
    answers: Answers<Result<Listed, NotListed>>,
}

impl Default for Paths {
    fn default() -> Self {
        Paths {
            count: 16,
            number: 0,
            is_waiting: false,
            listed: None,
            fault: None,
            selected: None,
            ray: 0,
            is_new: false,
            answers: Answers::default(),
        }
    }
}

impl Paths {
    /// The number of paths to list: no more than the picture has samples per pixel when it ends.
    fn count_in(&self, document: &Document) -> u64 {
        self.count.min(most(document))
    }

    /// Lists the paths of a pixel. A background thread records them.
    pub fn list(&mut self, document: &Document, pixel: [u32; 2], context: &egui::Context) {
        // An invalid document is reported elsewhere.
        let Ok(job) = document.job(1) else { return };
        self.number += 1;
        let (number, count, document) = (self.number, self.count_in(document), document.clone());
        let record = move || {
            let isa = Isa::available().into_iter().max().unwrap_or(Isa::Portable);
            let recorder = PathRecorder::new(&job, isa, None);
            let path = |sample| {
                let record = recorder.record(pixel, sample);
                let told = |step: Step| {
                    let sentence = step.sentence(&job);
                    (step, sentence)
                };
                let steps = steps(&job, pixel, sample, &record).into_iter().map(told).collect();
                Path { record, steps }
            };
            Ok(Listed { number, pixel, document, paths: (0..count).map(path).collect() })
        };
        let substitute = move |reason: String| Err(NotListed { number, reason });
        self.answers.ask("paths", context, record, substitute);
        (self.is_waiting, self.fault) = (true, None);
    }

    /// Takes recorded paths.
    fn learn(&mut self, outcome: Result<Listed, NotListed>) {
        match outcome {
            Ok(listed) if listed.number == self.number => {
                self.is_waiting = false;
                self.is_new = self.listed.as_ref().is_none_or(|old| old.pixel != listed.pixel);
                let last = listed.paths.len().saturating_sub(1);
                self.selected =
                    if self.is_new { Some(0) } else { self.selected.map(|index| index.min(last)) };
                self.ray = 0;
                self.listed = Some(listed);
            }
            Err(NotListed { number, reason }) if number == self.number => {
                // Those that were listed before would be asked for again and again.
                self.forget();
                self.fault = Some(reason);
            }
            Ok(_) | Err(_) => {}
        }
    }

    /// Removes the paths from the picture.
    pub fn forget(&mut self) {
        self.number += 1;
        (self.listed, self.is_waiting, self.fault) = (None, false, None);
    }

    /// Takes recorded paths. Lists them again if a change affects the random numbers or how many samples the picture has;
    /// if only the camera moves, the existing paths stay. In a picture of another size they are those of the pixel at the same place. A picture without
    /// rays has none.
    pub fn follow(&mut self, document: &Document, context: &egui::Context) {
        while let Some(outcome) = self.answers.take() {
            self.learn(outcome);
        }
        let Some(listed) = &self.listed else { return };
        // Undo may have led to a stage without rays.
        if document.no_rays().is_some() {
            self.forget();
            return;
        }
        let is_same_scene = std::sync::Arc::ptr_eq(&listed.document.checked, &document.checked);
        let is_same_count = listed.paths.len() as u64 == self.count_in(document);
        if self.is_waiting
            || (is_same_scene && is_same_count && listed.document.settings == document.settings)
        {
            return;
        }
        let (pixel, sizes) = (listed.pixel, [listed.document.size(), document.size()]);
        let before = Document { camera: listed.document.camera, ..document.clone() };
        self.list(&before, at_same_place(pixel, sizes), context);
    }

    /// The number of listed paths.
    pub fn len(&self) -> usize {
        self.listed.as_ref().map_or(0, |listed| listed.paths.len())
    }

    /// The path that is highlighted.
    fn selected(&self) -> Option<&Path> {
        self.listed.as_ref()?.paths.get(self.selected?)
    }

    /// Highlights the path of a sample, or none.
    fn select(&mut self, sample: Option<usize>) {
        if sample != self.selected {
            (self.selected, self.ray) = (sample, 0);
        }
    }

    /// Explains the next or the previous ray of the highlighted path; of the first path if none is highlighted.
    pub fn step(&mut self, is_forward: bool) {
        if self.selected().is_none() {
            self.select(Some(0));
            return;
        }
        let last = self.selected().map_or(0, |path| path.steps.len().saturating_sub(1));
        self.ray = if is_forward { (self.ray + 1).min(last) } else { self.ray.saturating_sub(1) };
    }

    /// The explained ray, counted from 1, and the number of rays of its path.
    pub fn position(&self) -> Option<[usize; 2]> {
        self.selected().map(|path| [self.ray + 1, path.steps.len()])
    }
}

/// The largest number of paths that can be listed: the samples per pixel of the picture when it ends, if that is known.
fn most(document: &Document) -> u64 {
    document.stop.samples.unwrap_or(COUNT_LIMIT).clamp(1, COUNT_LIMIT)
}

/// The pixel of a picture of another size that contains the middle of this one.
fn at_same_place(pixel: [u32; 2], [before, after]: [[u32; 2]; 2]) -> [u32; 2] {
    [0, 1].map(|axis| {
        let middle = 2 * u64::from(pixel[axis]) + 1;
        let place = middle * u64::from(after[axis]) / (2 * u64::from(before[axis]).max(1));
        u32::try_from(place).unwrap_or(u32::MAX).min(after[axis].saturating_sub(1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::stages::Stage;

    #[test]
    fn paths_that_were_forgotten_meanwhile_are_not_listed() {
        let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut paths = Paths::default();
        for is_forgotten in [true, false] {
            paths.list(&document, [3, 2], &egui::Context::default());
            if is_forgotten {
                paths.forget();
            }
            let listed = paths.answers.wait().unwrap();
            paths.learn(listed);
            assert_eq!(paths.len(), if is_forgotten { 0 } else { 16 });
        }
    }

    #[test]
    fn paths_that_cannot_be_recorded_are_told_of_and_not_waited_for() {
        let (document, mut paths) = listed("metal", [16, 9]);
        let context = egui::Context::default();
        paths.list(&document, [3, 2], &context);
        let (_, number) = (paths.answers.wait(), paths.number);
        let reason = "the program failed (on purpose)".to_owned();
        paths.answers.answer(&context).give(Err(NotListed { number: number - 1, reason: "late".to_owned() }));
        paths.answers.answer(&context).give(Err(NotListed { number, reason: reason.clone() }));
        paths.follow(&document, &context);
        assert_eq!((paths.is_waiting, paths.len(), paths.fault.as_ref()), (false, 0, Some(&reason)));
        let number = paths.number;
        paths.follow(&document, &context);
        assert_eq!(paths.number, number, "it is not tried again and again");
        paths.list(&document, [3, 2], &context);
        take(&mut paths);
        assert_eq!((paths.len(), paths.fault.as_ref()), (16, None));
    }

    /// A small picture of a stage with the paths of one of its pixels.
    pub(super) fn listed(stage: &str, pixel: [u32; 2]) -> (Document, Paths) {
        let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
        document.set_size([32, 18]);
        let mut paths = Paths::default();
        paths.list(&document, pixel, &egui::Context::default());
        take(&mut paths);
        (document, paths)
    }

    /// Waits for the paths that have been asked for.
    pub(super) fn take(paths: &mut Paths) {
        let listed = paths.answers.wait().unwrap();
        paths.learn(listed);
    }

    #[test]
    fn rays_are_gone_through_from_end_to_end() {
        let (_, mut paths) = listed("metal", [16, 9]);
        let [first, count] = paths.position().unwrap();
        assert!(first == 1 && count > 1, "{count}");
        let at = |paths: &Paths| paths.position().map(|[at, _]| at);
        paths.step(false);
        assert_eq!(at(&paths), Some(1), "there is none before");
        for expected in (2..=count).chain([count]) {
            paths.step(true);
            assert_eq!(at(&paths), Some(expected));
        }
        paths.step(false);
        assert_eq!(at(&paths), Some(count - 1));
        paths.select(Some(3));
        assert_eq!((paths.selected, at(&paths)), (Some(3), Some(1)), "another path begins at its first ray");
        paths.step(true);
        paths.select(Some(3));
        assert_eq!(at(&paths), Some(2), "the same path goes on");
        paths.select(None);
        assert_eq!(paths.position(), None);
        paths.step(true);
        assert_eq!((paths.selected, at(&paths)), (Some(0), Some(1)));
    }

    #[test]
    fn paths_are_listed_again_when_their_random_numbers_change() {
        let (mut document, mut paths) = listed("metal", [16, 9]);
        let context = egui::Context::default();
        paths.follow(&document, &context);
        document.camera.vfov_degrees += 1.0;
        paths.follow(&document, &context);
        assert!(!paths.is_waiting, "the camera has moved, but the paths are still those of the pixel");
        document.settings.seed += 1;
        paths.follow(&document, &context);
        assert!(paths.is_waiting);
        take(&mut paths);
        let listed = paths.listed.as_ref().unwrap();
        assert_eq!(listed.document.settings.seed, document.settings.seed);
        assert_ne!(listed.document.camera, document.camera, "the camera is still the one of the pixel");
        document.set_size([64, 36]);
        paths.follow(&document, &context);
        take(&mut paths);
        assert_eq!(paths.listed.as_ref().map(|listed| listed.pixel), Some([33, 19]));
        let before = paths.number;
        paths.follow(&document, &context);
        assert_eq!((paths.number, paths.is_waiting), (before, false), "nothing has changed");
        let no_rays = Document::new(Origin::of_stage(Stage::find("ppm-gradient").unwrap()));
        paths.follow(&no_rays, &context);
        assert_eq!((paths.len(), paths.is_waiting), (0, false), "this picture has none");
    }
}
