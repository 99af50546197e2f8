//! Keeps the picture as large as the viewport, unless that would throw away a picture that took long.

use super::model::{Document, Sizing};
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// A new size counts once it has stayed the same for so long: a window that is resized has many sizes.
const SETTLE: Duration = Duration::from_millis(250);

/// A picture that was traced for longer than this many seconds is kept.
const LONG_SECONDS: f64 = 10.0;

/// Follows the size of the viewport.
#[derive(Default)]
pub struct Sizer {
    /// The size that fits, and since when.
    fitting: Option<([u32; 2], Instant)>,
    is_asked: bool,
    /// A large size that the user wants.
    pub accepted: Option<[u32; 2]>,
    /// The size at which the picture could be rendered anew, if it is only scaled.
    pub offer: Option<[u32; 2]>,
}

impl Sizer {
    /// The user wants the size that the picture should have, whatever is lost.
    pub fn ask(&mut self) {
        self.is_asked = true;
    }

    /// Changes the size of the document if it should have another one. `room` is the room for the picture, pixels of
    /// the screen; `lost` is how many seconds the document's own picture was traced, if there is one.
    pub fn follow(
        &mut self,
        context: &Context,
        document: &mut Document,
        (sizing, room): (Sizing, [u32; 2]),
        lost: Option<f64>,
    ) {
        let is_asked = std::mem::take(&mut self.is_asked);
        self.offer = None;
        let Some(wanted) = document.fitting_size(sizing, room) else { return };
        let now = Instant::now();
        let since = match self.fitting {
            Some((fitting, since)) if fitting == wanted => since,
            _ => now,
        };
        self.fitting = Some((wanted, since));
        if wanted == document.size() {
            return;
        }
        // The book's size changes only when the user chooses it or another picture.
        let Some(seconds) = lost.filter(|_| !is_asked && sizing != Sizing::Book) else {
            document.set_size(wanted);
            return;
        };
        let settled = now.duration_since(since);
        if settled < SETTLE {
            context.request_repaint_after(SETTLE - settled);
        } else if seconds > LONG_SECONDS {
            // Also while a button of the mouse is down, which may be pressing the offer.
            self.offer = Some(wanted);
        } else if context.input(|input| input.pointer.any_down()) {
            context.request_repaint_after(SETTLE);
        } else {
            document.set_size(wanted);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::model::Origin;

    use crate::stages::Stage;

    const YOUNG: Option<f64> = Some(2.0);

    fn ago(seconds: u64) -> Instant {
        Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap()
    }

    /// The size after a frame with a room of 320 by 9000 pixels, of a picture that has had another size.
    fn followed(sizer: &mut Sizer, sizing: Sizing, lost: Option<f64>) -> [u32; 2] {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.set_size([160, 90]);
        sizer.follow(&Context::default(), &mut document, (sizing, [320, 9000]), lost);
        document.size()
    }

    #[test]
    fn a_size_is_followed_once_it_has_stayed_the_same() {
        let settled = |size| Sizer { fitting: Some((size, ago(1))), ..Sizer::default() };
        for (size, expected) in [([320, 180], [320, 180]), ([300, 169], [160, 90])] {
            let mut sizer = settled(size);
            assert_eq!(followed(&mut sizer, Sizing::Viewport, YOUNG), expected, "{size:?} has fitted");
            assert_eq!(sizer.fitting.unwrap().0, [320, 180]);
            assert_eq!(sizer.offer, None);
        }
        let mut sizer = settled([320, 180]);
        sizer.offer = Some([1, 1]);
        let old = Some(99.0);
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [160, 90]);
        assert_eq!(sizer.offer, Some([320, 180]));
        sizer.ask();
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [320, 180], "whatever is lost");
        assert_eq!(sizer.offer, None);
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [160, 90], "once");
    }
}
