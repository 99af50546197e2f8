//! The paths of one pixel: recorded, gone through ray by ray in the dock, and drawn over the picture.

mod paint;
mod side;
mod tab;

use crate::app::model::{Document, at_other, best_isa};
use crate::app::toolkit::Query;
use crate::backends::explain::{Step, steps};
use crate::render_cpu::PathRecorder;
use eframe::egui;

/// The largest number of paths that are recorded.
const COUNT_LIMIT: u64 = 256;

/// Each ray of a path, and what happens at its end, in words.
type Path = Vec<(Step, String)>;

/// Paths of a pixel, recorded by a background thread.
struct Listed {
    pixel: [u32; 2],
    /// The document when they were recorded.
    document: Document,
    /// The paths of samples 0, 1, 2 and so on.
    paths: Vec<Path>,
}

/// The paths that are shown, if any.
#[derive(Default)]
pub struct Paths {
    query: Query<(), Listed>,
    /// The path that is shown.
    selected: usize,
    /// The point of it that is explained: 0 at the camera, then the ends of its rays.
    point: usize,
}

impl Paths {
    /// Lists the paths of a pixel. A background thread records them.
    pub fn list(&mut self, document: &Document, pixel: [u32; 2], context: &egui::Context) {
        // An invalid document is reported elsewhere.
        let Ok(job) = document.job(1) else { return };
        if self.query.answer.as_ref().is_none_or(|listed| listed.pixel != pixel) {
            self.selected = 0;
        }
        // Those of before stay until the new ones are there; a late answer is lost with its slot.
        self.query = Query { answer: self.query.answer.take(), ..Query::default() };
        let Some(answer) = self.query.ask(context, ()) else { return };
        let (count, document) = (count_in(document), document.clone());
        answer.give_from("paths", move || {
            let recorder = PathRecorder::new(&job, best_isa(), None);
            let path = |sample| {
                let record = recorder.record(pixel, sample);
                let steps = steps(&job, pixel, sample, &record).into_iter();
                steps.map(|step| (step.sentence(&job), step)).map(|(words, step)| (step, words)).collect()
            };
            Ok(Listed { pixel, document, paths: (0..count).map(path).collect() })
        });
    }

    fn learn(&mut self) {
        if self.query.follow() {
            self.select(self.selected);
        } else if self.query.fault.is_some() {
            self.query.answer = None;
        }
    }

    /// Removes the paths from the picture.
    pub fn forget(&mut self) {
        *self = Paths::default();
    }

    /// Takes recorded paths. Lists them again if a change affects the random numbers or how many samples the picture has;
    /// after a change of the camera, the paths stay those of the pixel as it was.
    pub fn follow(&mut self, document: &Document, context: &egui::Context) {
        self.learn();
        let Some(listed) = &self.query.answer else { return };
        // Undo may have led to a stage without rays.
        if document.no_rays().is_some() {
            return self.forget();
        }
        let is_same = std::sync::Arc::ptr_eq(&listed.document.checked, &document.checked)
            && listed.paths.len() as u64 == count_in(document)
            && listed.document.settings == document.settings;
        if !self.query.answers.is_open() && !is_same {
            let pixel = at_other(listed.pixel, listed.document.size(), document.size());
            let before = Document { camera: listed.document.camera, ..document.clone() };
            match pixel {
                Some(pixel) => self.list(&before, pixel, context),
                None => self.forget(),
            }
        }
    }

    /// The number of listed paths.
    pub fn len(&self) -> usize {
        self.query.answer.as_ref().map_or(0, |listed| listed.paths.len())
    }

    fn path(&self) -> Option<&Path> {
        self.query.answer.as_ref()?.paths.get(self.selected)
    }

    /// Shows a path, from its first hit on.
    fn select(&mut self, path: usize) {
        self.selected = path.min(self.len().saturating_sub(1));
        self.point = self.path().map_or(0, |path| path.len().min(1));
    }

    /// Explains the next or the previous point of the path.
    pub fn step(&mut self, is_forward: bool) {
        let last = self.path().map_or(0, Vec::len);
        self.point = if is_forward { (self.point + 1).min(last) } else { self.point.saturating_sub(1) };
    }

    /// The path and the point of it that are explained, and the number of points; all counted from 1.
    pub fn position(&self) -> Option<[usize; 3]> {
        self.path().map(|path| [self.selected + 1, self.point + 1, path.len() + 1])
    }
}

/// The number of paths that are listed: as many as the picture has samples per pixel when it ends, if that is known.
fn count_in(document: &Document) -> u64 {
    document.stop.samples.unwrap_or(COUNT_LIMIT).clamp(1, COUNT_LIMIT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::stages::Stage;

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
    fn take(paths: &mut Paths) {
        paths.query.answer = paths.query.answers.wait().and_then(Result::ok);
        paths.select(paths.selected);
    }

    #[test]
    fn a_fault_is_shown_and_not_tried_again() {
        let (document, mut paths) = listed("metal", [16, 9]);
        let context = egui::Context::default();
        paths.query = Query::default();
        paths.query.ask(&context, ()).unwrap().give(Err("on purpose".to_owned()));
        paths.follow(&document, &context);
        assert_eq!(
            (paths.query.answers.is_open(), paths.len(), paths.query.fault.as_deref()),
            (false, 0, Some("on purpose"))
        );
        paths.list(&document, [3, 2], &context);
        take(&mut paths);
        assert!(paths.len() > 0 && paths.query.fault.is_none());
    }

    #[test]
    fn points_are_gone_through_from_end_to_end() {
        let (_, mut paths) = listed("metal", [16, 9]);
        let [path, point, count] = paths.position().unwrap();
        assert!(path == 1 && point == 2 && count > 2, "{point} of {count}");
        for (is_forward, end) in [(false, 1), (true, count)] {
            (0..2 * count).for_each(|_| paths.step(is_forward));
            assert_eq!(paths.position(), Some([1, end, count]));
        }
        paths.select(3);
        assert_eq!(paths.position().map(|[path, point, _]| [path, point]), Some([4, 2]));
    }

    #[test]
    fn paths_are_listed_again_when_their_random_numbers_change() {
        let (mut document, mut paths) = listed("metal", [16, 9]);
        let context = egui::Context::default();
        document.camera.vfov_degrees += 1.0;
        paths.follow(&document, &context);
        assert!(
            !paths.query.answers.is_open(),
            "the camera has moved, but the paths are still those of the pixel"
        );
        document.settings.seed += 1;
        paths.follow(&document, &context);
        assert!(paths.query.answers.is_open());
        take(&mut paths);
        let listed = paths.query.answer.as_ref().unwrap();
        assert_eq!(listed.document.settings.seed, document.settings.seed);
        assert_ne!(listed.document.camera, document.camera, "the camera is still the one of the pixel");
        document.set_size([64, 36]);
        paths.follow(&document, &context);
        take(&mut paths);
        assert_eq!(paths.query.answer.as_ref().map(|listed| listed.pixel), Some([33, 19]));
        paths.follow(&document, &context);
        assert!(!paths.query.answers.is_open(), "nothing has changed");
        let no_rays = Document::new(Origin::of_stage(Stage::find("ppm-gradient").unwrap()));
        paths.follow(&no_rays, &context);
        assert_eq!((paths.len(), paths.query.answers.is_open()), (0, false), "this picture has none");
    }
}
