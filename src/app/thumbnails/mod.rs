//! Small pictures of all stages: rendered on a thread of their own, and kept in the user's cache.

mod make;

pub use make::SIZE;

use super::answers::Answers;
use super::texture::Texture;
use crate::gallery::is_about_pixels;
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

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{RawInput, Shape, vec2};

    fn stage(id: &str) -> &'static Stage {
        Stage::find(id).unwrap()
    }

    #[test]
    fn a_screen_with_many_pixels_gets_large_pictures_but_none_too_large() {
        assert_eq!([0.5, 1.0, 1.25, 2.0, 3.5, 4.0, 7.0].map(scale_for), [1, 1, 2, 2, 4, 4, 4]);
    }

    #[test]
    fn pictures_are_made_from_the_present_stage_on() {
        let indices = |stage| nearest_first(stage).iter().map(|stage| stage.index()).collect::<Vec<_>>();
        assert_eq!(indices(None)[..3], [0, 1, 2]);
        let here = stage("metal").index();
        let found = indices(Some(stage("metal")));
        assert_eq!(found[..5], [here, here - 1, here + 1, here - 2, here + 2]);
        assert_eq!(found.len(), Stage::ALL.len());
    }

    #[test]
    fn pictures_for_another_screen_are_not_taken() {
        let context = Context::default();
        let mut thumbnails = Thumbnails { scale: 2, ..Thumbnails::default() };
        for (scale, count) in [(1, 0), (2, 1), (2, 1)] {
            let made = Thumbnail { stage: stage("metal"), scale, size: [1, 1], rgb8: vec![0; 3] };
            thumbnails.answers.answer(&context).give(made);
            thumbnails.follow(&context, None, true);
            assert_eq!((thumbnails.count(), thumbnails.waiting.is_some()), (count, false), "it is not on");
        }
    }

    #[test]
    fn the_thread_starts_when_pictures_are_wanted_and_once_for_each_screen() {
        let context = Context::default();
        let mut thumbnails = Thumbnails::default();
        thumbnails.switch_on(None);
        thumbnails.follow(&context, None, false);
        assert!(thumbnails.waiting.is_none(), "nobody has asked");
        thumbnails.is_wanted = true;
        thumbnails.follow(&context, None, false);
        assert_eq!(thumbnails.scale, 1);
        let first = Arc::downgrade(thumbnails.waiting.as_ref().unwrap());
        thumbnails.follow(&context, None, true);
        assert!(first.strong_count() > 0, "it goes on");
        thumbnails.scale = 2;
        thumbnails.follow(&context, None, true);
        assert_eq!((first.strong_count(), thumbnails.scale), (0, 1), "another one for another screen");
    }

    #[test]
    fn the_whole_picture_is_drawn_with_its_pixels_where_they_are_the_lesson() {
        for (id, options) in [("ppm-tiny", TextureOptions::NEAREST), ("metal", TextureOptions::LINEAR)] {
            let (context, mut thumbnails) = (Context::default(), Thumbnails::default());
            let rect = Rect::from_min_size(pos2(20.0, 30.0), vec2(80.0, 45.0));
            let input = RawInput { screen_rect: Some(rect.expand(100.0)), ..RawInput::default() };
            let paint = |thumbnails: &mut Thumbnails| {
                context.run_ui(input.clone(), |ui| thumbnails.paint(ui, stage(id), rect))
            };
            let empty = paint(&mut thumbnails);
            assert!(thumbnails.is_wanted);
            let places: Vec<Rect> =
                empty.shapes.iter().map(|clipped| clipped.shape.visual_bounding_rect()).collect();
            assert!(places.contains(&rect), "its place: {places:?}");
            thumbnails.pictures.insert(id, Texture::new([3, 2], &[90; 18], None));
            let output = paint(&mut thumbnails);
            let mut textures = output.textures_delta.set.values().flatten();
            let texture = textures.find(|delta| delta.image.size() == [3, 2]).unwrap();
            assert_eq!(texture.options, options, "{id}");
            let corners = output.shapes.iter().find_map(|clipped| match &clipped.shape {
                Shape::Mesh(mesh) => {
                    Some(mesh.vertices.iter().map(|vertex| (vertex.pos, vertex.uv)).collect::<Vec<_>>())
                }
                _ => None,
            });
            let expected = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
                .map(|[x, y]| (rect.lerp_inside(vec2(x, y)), pos2(x, y)));
            assert_eq!(corners.unwrap(), expected);
        }
    }
}
