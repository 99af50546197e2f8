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
        (self.compared, self.is_same) = (Some((Arc::clone(other), id, samples)), false);
        let answer = self.answers.answer(context);
        subject.inspect(move |film| answer.give(identity.is_of(film)));
    }
}
