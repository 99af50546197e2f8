//! Small pictures of all stages: rendered on a thread of their own, and kept in the user's cache.

mod make;

pub use make::SIZE;

use super::answers::Answers;
use super::texture::Texture;
use crate::page::gallery::is_about_pixels;
use crate::stages::Stage;
use eframe::egui::{Color32, Context, Rect, TextureOptions, Ui, pos2};
use make::{Request, Thumbnail};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// The largest number of pixels per point that small pictures are rendered for.
const LARGEST_SCALE: u32 = 4;

/// The small pictures.
#[derive(Default)]
pub struct Thumbnails {
    /// Without being switched on, none are rendered.
    is_on: bool,
    /// Where they are kept.
    directory: Option<PathBuf>,
    /// Pixels per point of the pictures at hand or being made; 0 before the first.
    scale: u32,
    pictures: HashMap<&'static str, Texture>,
    answers: Answers<Thumbnail>,
    /// The thread stops once this is dropped.
    waiting: Option<Arc<()>>,
    /// The pictures were drawn, or would have been.
    is_wanted: bool,
}

impl Thumbnails {
    /// Allows the thread to start. It keeps the pictures in `directory`, if there is one.
    pub fn switch_on(&mut self, directory: Option<PathBuf>) {
        self.is_on = true;
        self.directory = directory;
    }

    /// How many pictures are at hand.
    pub fn count(&self) -> usize {
        self.pictures.len()
    }

    /// Takes new pictures. Starts the thread if pictures are wanted, or if the program has nothing else to do; it begins
    /// with the stages next to `stage`.
    pub fn follow(&mut self, context: &Context, stage: Option<&Stage>, is_idle: bool) {
        while let Some(made) = self.answers.take() {
            if made.scale == self.scale {
                let earlier = self.pictures.remove(made.stage.id);
                self.pictures.insert(made.stage.id, Texture::new(made.size, &made.rgb8, earlier));
            }
        }
        let scale = scale_for(context.pixels_per_point());
        let is_begun = self.waiting.is_some() && scale == self.scale;
        if !self.is_on || is_begun || !(self.is_wanted || is_idle) {
            return;
        }
        self.scale = scale;
        let waiting = Arc::new(());
        let answers =
            nearest_first(stage).into_iter().map(|stage| (stage, self.answers.answer(context))).collect();
        let request =
            Request { answers, scale, directory: self.directory.clone(), alive: Arc::downgrade(&waiting) };
        self.waiting = Some(waiting);
        // Without a thread the list has no pictures, but everything else works.
        if let Err(error) = make::begin(request) {
            log::info!("no small pictures of the stages: {error}");
        }
    }

    /// Draws the picture of a stage, or its place while there is none.
    pub fn paint(&mut self, ui: &Ui, stage: &Stage, rect: Rect) {
        self.is_wanted = true;
        let painter = ui.painter();
        match self.pictures.get_mut(stage.id) {
            Some(texture) => {
                let options =
                    if is_about_pixels(stage) { TextureOptions::NEAREST } else { TextureOptions::LINEAR };
                let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                painter.image(texture.id(ui.ctx(), options), rect, whole, Color32::WHITE);
            }
            None => _ = painter.rect_filled(rect, 0.0, ui.visuals().faint_bg_color),
        }
    }
}

/// Pixels per point of the small pictures on a screen with so many.
fn scale_for(pixels_per_point: f32) -> u32 {
    (pixels_per_point.ceil() as u32).clamp(1, LARGEST_SCALE)
}

/// All stages, those next to `stage` first.
fn nearest_first(stage: Option<&Stage>) -> Vec<&'static Stage> {
    let here = stage.map_or(0, Stage::index);
    let mut stages: Vec<&'static Stage> = Stage::ALL.iter().collect();
    stages.sort_by_key(|stage| stage.index().abs_diff(here));
    stages
}
