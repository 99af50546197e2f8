//! The picture of a kept film.

use super::thread::KeptThread;
use crate::app::answers::Answers;
use crate::app::model::kept::Kept;
use crate::app::texture::Texture;
use crate::app::tracer::Shown;
use crate::progressive::View;
use eframe::egui::Context;
use std::sync::{Arc, Weak};

/// Pictures that stay when another one is shown, so that a flip between two does not flicker.
const HELD: usize = 2;

/// A picture that was resolved.
struct Held {
    /// [`Kept::number`].
    number: u64,
    view: View,
    shown: Shown,
}

/// A resolved picture: the kept one, the view, three bytes per pixel.
type Resolved = (Weak<Kept>, View, Vec<u8>);

/// The picture of a kept film, which a thread resolves.
#[derive(Default)]
pub struct KeptPicture {
    thread: KeptThread,
    /// The newest first.
    held: Vec<Held>,
    /// Can be upgraded as long as a picture is being resolved.
    waiting: Weak<()>,
    answers: Answers<Resolved>,
}

impl KeptPicture {
    /// The newest picture of `kept`.
    pub fn shown(&self, kept: &Kept) -> Option<&Shown> {
        self.held.iter().find(|held| held.number == kept.number()).map(|held| &held.shown)
    }

    /// The newest picture of `kept`.
    pub fn shown_mut(&mut self, kept: &Kept) -> Option<&mut Shown> {
        self.held.iter_mut().find(|held| held.number == kept.number()).map(|held| &mut held.shown)
    }

    /// Has `work` done on the thread that resolves the pictures.
    pub fn run(&self, work: impl FnOnce() + Send + 'static) {
        self.thread.run(work);
    }

    /// Takes the picture that was resolved, and has the film resolved in `view` if that is another one.
    pub fn follow(&mut self, context: &Context, kept: &Arc<Kept>, view: &View) {
        while let Some((of, view, rgb8)) = self.answers.take() {
            if let Some(of) = of.upgrade() {
                self.hold(&of, view, &rgb8);
            }
        }
        let place = self.held.iter().position(|held| held.number == kept.number());
        if let Some(place) = place {
            self.held[..=place].rotate_right(1);
        }
        let is_known = place.is_some() && self.held[0].view.is_same(view);
        if is_known || self.waiting.strong_count() > 0 {
            return;
        }
        let question = Arc::new(());
        self.waiting = Arc::downgrade(&question);
        let (kept, view, answer) = (Arc::clone(kept), view.clone(), self.answers.answer(context));
        self.thread.run(move || {
            let rgb8 = view.resolve(&kept.film, kept.document.rules().transfer, None);
            // Dropped first: the answer wakes a frame, which may ask for the next picture.
            drop(question);
            answer.give((Arc::downgrade(&kept), view, rgb8));
        });
    }

    fn hold(&mut self, kept: &Kept, view: View, rgb8: &[u8]) {
        let place = self.held.iter().position(|held| held.number == kept.number());
        let earlier = place.map(|place| self.held.remove(place).shown.texture);
        let texture = Texture::new(kept.size(), rgb8, earlier);
        let (document, run) = (kept.document.clone(), kept.status.run);
        let shown = Shown { texture, samples: kept.samples(), divisor: 1, document, run };
        self.held.insert(0, Held { number: kept.number(), view, shown });
        self.held.truncate(HELD);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::document::Document;
    use crate::app::model::origin::Origin;
    use crate::film::{Film, PixelSum};
    use crate::stages::Stage;

    use std::time::{Duration, Instant};

    /// A kept picture of this grey.
    fn kept(value: u64) -> Arc<Kept> {
        let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let mut film = Film::new(4, 2, 1);
        film.halves_mut()[0].iter_mut().for_each(|sum| *sum = PixelSum([value << 16; 3]));
        film.record(0..1, 0).unwrap();
        Arc::new(Kept::new(document, film, Arc::default(), None))
    }

    /// Waits for a picture, and returns its grey.
    fn grey(picture: &mut KeptPicture, kept: &Arc<Kept>, view: &View) -> u8 {
        let (begin, context) = (Instant::now(), Context::default());
        loop {
            picture.follow(&context, kept, view);
            let newest = picture.held.first();
            if newest.is_some_and(|held| held.number == kept.number() && held.view.is_same(view)) {
                let shown = picture.shown_mut(kept).unwrap();
                assert_eq!((shown.samples, shown.divisor), (1, 1));
                return shown.texture.colour([3, 1]).unwrap()[0];
            }
            assert!(begin.elapsed() < Duration::from_secs(60), "no picture");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn the_last_two_pictures_are_held() {
        let (mut picture, [a, b, c]) = (KeptPicture::default(), [16, 64, 144].map(kept));
        assert!(picture.shown(&a).is_none());
        // Radiances 1/16, 1/4 and 9/16, whose roots are 1/4, 1/2 and 3/4.
        assert_eq!(grey(&mut picture, &a, &View::Picture), 64);
        assert_eq!(grey(&mut picture, &b, &View::Picture), 128);
        assert!(picture.shown(&a).is_some() && picture.shown(&b).is_some());
        picture.follow(&Context::default(), &a, &View::Picture);
        assert_eq!(picture.held[0].number, a.number(), "it is at hand");
        assert_eq!(picture.waiting.strong_count(), 0);
        assert_eq!(grey(&mut picture, &c, &View::Picture), 192);
        assert!(picture.shown(&a).is_some() && picture.shown(&b).is_none(), "the one looked at last stays");
        assert_eq!(grey(&mut picture, &a, &View::Exposed(2.0, None)), 128, "twice as bright twice");
        assert_eq!(picture.held.len(), 2);
    }
}
