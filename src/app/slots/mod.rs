//! Keeps pictures in slots, shows them, and compares them. What is kept is in the model.

mod strip;
mod verdict;

pub use strip::Strip;
pub use verdict::Verdict;

use super::answers::Answers;
use super::kept::{KeptPicture, KeptThread};
use super::model::document::Document;
use super::model::kept::Kept;
use super::model::slots::SlotNumber;
use super::tracer::Tracer;
use crate::film::Film;
use eframe::egui::Context;
use std::sync::{Arc, Weak};

/// A picture for a slot.
pub struct Copied {
    /// The slot.
    pub number: SlotNumber,
    /// The picture.
    pub kept: Kept,
}

/// A kept picture to go on from.
pub struct Reopened {
    /// What it shows.
    pub document: Document,
    /// A copy of its film.
    pub film: Film,
    /// Tracing time of its samples, if known.
    pub seconds: Option<f64>,
}

/// Requests about slots, and their answers.
#[derive(Default)]
pub struct SlotActions {
    /// Reads kept films.
    pub thread: KeptThread,
    /// The picture of the slot that is shown.
    pub picture: KeptPicture,
    /// Whether two pictures differ only by noise.
    pub verdict: Verdict,
    /// The strip of all slots.
    pub strip: Strip,
    /// Pictures that were copied, or why they could not be.
    pub copied: Answers<Result<Copied, String>>,
    /// Kept pictures to go on from, or why they could not be copied.
    pub reopened: Answers<Result<Reopened, String>>,
    /// The slots in which the live picture is to be kept once it has samples.
    wanted: Vec<SlotNumber>,
    /// The slots for which a copy is being made. Each can be upgraded as long as the request is open.
    awaited: Vec<(SlotNumber, Weak<()>)>,
}

impl SlotActions {
    /// Has the live picture kept as soon as it has samples.
    pub fn want(&mut self, number: SlotNumber) {
        if !self.is_wanted(number) {
            self.wanted.push(number);
        }
    }

    /// Whether a picture is on its way to this slot.
    pub fn is_wanted(&self, number: SlotNumber) -> bool {
        let is_it = |(of, request): &(SlotNumber, Weak<()>)| *of == number && request.strong_count() > 0;
        self.wanted.contains(&number) || self.awaited.iter().any(is_it)
    }

    /// Whether the render thread is making a copy.
    pub fn is_copying(&self) -> bool {
        self.awaited.iter().any(|(_, request)| request.strong_count() > 0)
    }

    /// Takes the slots that wait for a picture.
    pub fn take_wanted(&mut self) -> Vec<SlotNumber> {
        std::mem::take(&mut self.wanted)
    }

    /// Copies the film of `document` on the render thread. `seconds_before` is the tracing time of its samples from before
    /// this render, if known.
    pub fn copy(
        &mut self,
        context: &Context,
        number: SlotNumber,
        (document, main): (&Document, &Tracer),
        seconds_before: Option<f64>,
    ) {
        let request = Arc::new(());
        self.awaited.retain(|(_, request)| request.strong_count() > 0);
        self.awaited.push((number, Arc::downgrade(&request)));
        let (document, status) = (document.clone(), Arc::clone(main.status()));
        let answer = self.copied.answer_or(context, Err);
        main.inspect(move |film| {
            answer.give(match film.try_copy() {
                Ok(film) => Ok(Copied { number, kept: Kept::new(document, film, status, seconds_before) }),
                Err(error) => Err(error.to_string()),
            });
            drop(request);
        });
    }

    /// Copies a kept film to go on with.
    pub fn reopen(&self, context: &Context, kept: &Arc<Kept>) {
        let (kept, answer) = (Arc::clone(kept), self.reopened.answer_or(context, Err));
        self.thread.run(move || {
            let seconds = kept.seconds_before.map(|before| before + kept.status.trace.as_secs_f64());
            let document = kept.document.clone();
            let copy = kept.film.try_copy().map_err(|error| error.to_string());
            answer.give(copy.map(|film| Reopened { document, film, seconds }));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::progressive::Status;
    use std::time::Duration;

    #[test]
    fn a_film_goes_on_with_the_seconds_of_all_its_samples() {
        for (before, seconds) in [(Some(5.0), Some(7.0)), (Some(0.0), Some(2.0)), (None, None)] {
            let status = Status { trace: Duration::from_secs(2), ..Status::default() };
            let (document, mut film) = (Document::new(Origin::usual()), Film::new(4, 2, 1));
            film.record(0..7, 0).unwrap();
            let kept = Arc::new(Kept::new(document, film, Arc::new(status), before));
            let actions = SlotActions::default();
            actions.reopen(&Context::default(), &kept);
            let reopened = actions.reopened.wait().unwrap().unwrap();
            assert_eq!((reopened.film.sample_count(), reopened.seconds), (7, seconds));
            assert!(reopened.document == kept.document);
        }
    }
}
