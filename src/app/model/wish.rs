//! Something to do with a picture as soon as it has samples.

use super::Document;

/// A wish and its picture; the last one counts.
pub struct Wish<T>(Option<(Document, T)>);

impl<T> Default for Wish<T> {
    fn default() -> Self {
        Wish(None)
    }
}

impl<T> Wish<T> {
    pub fn make(&mut self, document: &Document, wish: T) {
        self.0 = Some((document.clone(), wish));
    }

    pub fn open(&self) -> Option<&T> {
        self.0.as_ref().map(|(_, wish)| wish)
    }

    /// Takes the wish once it can be fulfilled: `document` is its picture, and has samples. Takes it also, with its picture,
    /// if that is no longer the one of the window.
    pub fn take(&mut self, document: &Document, has_samples: bool) -> Option<Result<T, (Document, T)>> {
        let is_of_it = self.0.as_ref().is_some_and(|(of, _)| of.has_same_film(document));
        let (of, wish) = self.0.take_if(|_| has_samples || !is_of_it)?;
        Some(if is_of_it { Ok(wish) } else { Err((of, wish)) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;

    #[test]
    fn a_wish_is_fulfilled_for_its_own_picture() {
        let (document, mut wish) = (Document::new(Origin::usual()), Wish::default());
        let mut other = document.clone();
        other.camera.vfov_degrees += 1.0;
        for (shown, has_samples, expected) in [
            (&document, false, None),
            (&document, true, Some(true)),
            (&other, false, Some(false)),
            (&other, true, Some(false)),
        ] {
            wish.make(&document, ());
            let taken = wish.take(shown, has_samples);
            assert_eq!(taken.map(|taken| taken.is_ok()), expected);
            assert_eq!(wish.open().is_some(), expected.is_none());
        }
    }
}
