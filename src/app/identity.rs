//! Whether the film is identical to the film that it is compared with.

use super::answers::Answers;
use super::kept::{FilmId, Subject};
use crate::progressive::ReferenceMeans;
use eframe::egui::Context;
use std::sync::Arc;

/// The comparison of the film with a loaded one, or with one that was kept.
#[derive(Default)]
pub struct Identity {
    /// The other film, and the film and its samples per pixel when it was last compared.
    compared: Option<(Arc<ReferenceMeans>, FilmId, u64)>,
    is_same: bool,
    answers: Answers<bool>,
}

impl Identity {
    /// Whether the film and the other one are the same to the bit, as far as is known.
    pub fn is_same(&self) -> bool {
        self.is_same
    }

    /// Compares the films again after each change, while their difference is shown: `other` is the film that is
    /// subtracted.
    pub fn follow(&mut self, other: Option<&Arc<ReferenceMeans>>, subject: &Subject<'_>, context: &Context) {
        let Some((other, identity)) = other.and_then(|other| Some((other, other.identity?))) else {
            *self = Identity::default();
            return;
        };
        while let Some(is_same) = self.answers.take() {
            self.is_same = is_same;
        }
        let (id, samples) = (subject.film_id(), subject.shown_samples());
        let is_known = |(film, of, count): &(Arc<ReferenceMeans>, FilmId, u64)| {
            Arc::ptr_eq(film, other) && (*of, *count) == (id, samples)
        };
        if self.compared.as_ref().is_some_and(is_known) {
            return;
        }
        // An answer about the film of before is lost with its slot.
        *self = Identity { compared: Some((Arc::clone(other), id, samples)), ..Identity::default() };
        let answer = self.answers.answer(context);
        subject.inspect(move |film| answer.give(identity.is_of(film)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::kept::on_screen::{OnScreen, small_film};

    use crate::progressive::FilmIdentity;

    #[test]
    fn films_are_the_same_if_all_their_sums_are() {
        let (screen, context) = (OnScreen::new(small_film(7, 14.0)), Context::default());
        let other = |samples: u64, sum: f64| {
            let film = small_film(samples, sum);
            let identity = Some(FilmIdentity::of(&film));
            Arc::new(ReferenceMeans { identity, ..ReferenceMeans::of(&film) })
        };
        let same = other(7, 14.0);
        let unknown = Arc::new(ReferenceMeans { identity: None, ..(*same).clone() });
        let mut identity = Identity::default();
        // What is known before the film has answered, and then.
        let mut is_same = |other: Option<&Arc<ReferenceMeans>>| {
            let early = screen.before_answers(|subject| {
                identity.follow(other, subject, &context);
                identity.is_same()
            });
            identity.follow(other, &screen.subject(), &context);
            [early, identity.is_same()]
        };
        assert_eq!(is_same(None), [false, false]);
        assert_eq!(is_same(Some(&same)), [false, true]);
        assert_eq!(is_same(Some(&same)), [true, true]);
        for unlike in [other(7, 13.0), other(6, 14.0), unknown] {
            assert_eq!(is_same(Some(&unlike)), [false, false]);
            assert_eq!(is_same(Some(&same)), [false, true]);
        }
        assert_eq!(is_same(None), [false, false], "nothing is compared");
        screen.before_answers(|subject| {
            for _ in 0..3 {
                identity.follow(Some(&same), subject, &context);
            }
        });
        assert_eq!([identity.answers.take(), identity.answers.take()], [Some(true), None], "once");
        let unlike = other(7, 13.0);
        screen.before_answers(|subject| {
            for other in [&unlike, &same, &unlike] {
                identity.follow(Some(other), subject, &context);
            }
        });
        let late = "an answer about films that are no longer compared is dropped";
        assert_eq!([identity.answers.take(), identity.answers.take()], [Some(false), None], "{late}");
    }
}
