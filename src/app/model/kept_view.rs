//! A view as text, for the next window.

use super::crop::Crop;
use super::show::Show;
use super::slots::{Places, SlotNumber};
use super::tone::Tone;
use super::view::{Mode, ViewState, With};
use serde::{Deserialize, Serialize};

/// A [`ViewState`] as text.
#[derive(Debug, Serialize, Deserialize)]
#[serde(default)]
pub struct KeptView {
    show: Show,
    mode: Option<Mode>,
    is_by_book: bool,
    is_with_next: bool,
    divider: f32,
    exposure: f64,
    range: [f64; 2],
    /// First column and row, width and height.
    crop: Option<[[u32; 2]; 2]>,
    slots: ShownSlots,
}

/// Which slots a view shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ShownSlots {
    places: Places,
    /// How the picture is compared with a slot, if it is, and where the divider is.
    compared: Option<(Mode, SlotNumber)>,
    divider: f32,
}

impl ShownSlots {
    /// The slots whose pictures the view needs.
    pub fn needed(&self) -> impl Iterator<Item = SlotNumber> {
        let Places { looked, before, chosen } = self.places;
        let compared = self.compared.map(|(_, number)| number);
        [looked, compared, before, chosen].into_iter().flatten()
    }

    /// Shows these slots, as far as they are in use, unless something else is shown by now.
    pub fn show_in(&self, view: &mut ViewState) {
        if view.mode().is_some() || view.slots.looked().is_some() {
            return;
        }
        view.slots.set_places(self.places);
        if let Some((mode, number)) = self.compared.filter(|(_, number)| view.slots.get(*number).is_some()) {
            view.toggle(mode, With::Slot(number));
            if (0.0..=1.0).contains(&self.divider) {
                (view.divider, view.is_divider_unplaced) = (self.divider, false);
            }
        }
    }
}

impl Default for KeptView {
    fn default() -> Self {
        KeptView::of(&ViewState::default())
    }
}

impl KeptView {
    /// What is kept of a view.
    pub fn of(view: &ViewState) -> Self {
        KeptView {
            // The film of a difference is not kept.
            show: if view.show() == Show::Difference { Show::Picture } else { view.show() },
            // A picture in a slot comes later.
            mode: view.mode().filter(|_| view.compared_slot().is_none()),
            is_by_book: view.with() == With::Book,
            is_with_next: view.is_with_next,
            divider: view.divider,
            exposure: view.tone.exposure,
            range: view.tone.range,
            crop: view.crop.flatten().map(|crop| [crop.first, crop.size]),
            slots: ShownSlots {
                places: view.slots.places(),
                compared: view.mode().zip(view.compared_slot()),
                divider: view.divider,
            },
        }
    }

    /// The slots that the view showed.
    pub fn slots(&self) -> ShownSlots {
        self.slots
    }

    /// The view of a picture of `size` pixels.
    pub fn view(self, size: [u32; 2]) -> ViewState {
        let mut view = ViewState::default();
        match self.mode {
            Some(mode) => view.toggle(mode, if self.is_by_book { With::Book } else { With::Stage }),
            None => view.choose(self.show),
        }
        view.is_with_next = self.is_with_next;
        if (0.0..=1.0).contains(&self.divider) {
            (view.divider, view.is_divider_unplaced) = (self.divider, false);
        }
        if self.exposure.is_finite() {
            view.tone.expose(self.exposure);
        }
        let [low, high] = self.range;
        if low < high && self.range.iter().all(|end| Tone::RANGES.contains(end)) {
            view.tone.range = self.range;
        }
        let crop = self.crop.map(|[first, size]| Crop { first, size });
        let is_whole = |crop: &Crop| crop.size != [0, 0] && crop.within(size) == Some(*crop);
        view.crop = crop.filter(is_whole).map(Some);
        view
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::document::Document;
    use crate::app::model::kept::Kept;
    use crate::app::model::origin::Origin;
    use crate::app::model::slots::Slot;
    use crate::film::Film;
    use std::sync::Arc;

    #[test]
    fn a_crop_comes_back_if_the_picture_has_all_of_it() {
        let mut view = ViewState::default();
        let crop = Crop { first: [2, 3], size: [4, 7] };
        view.crop = Some(Some(crop));
        let found = |size| KeptView::of(&view).view(size).crop;
        assert_eq!((found([32, 18]), found([6, 10])), (Some(Some(crop)), Some(Some(crop))));
        assert_eq!((found([5, 18]), found([2, 2])), (None, None));
    }

    #[test]
    fn only_what_a_view_can_show_comes_back() {
        let usual = ViewState::default();
        let view = |kept: KeptView| kept.view([32, 18]);
        for (range, comes_back) in [
            ([-20.0, 7.0], true),
            ([-20.5, 7.0], false),
            ([-20.0, 7.5], false),
            ([2.0, 2.5], true),
            ([2.0, 2.0], false),
            ([3.0, 2.0], false),
            ([f64::NAN, 2.0], false),
        ] {
            let found = view(KeptView { range, ..KeptView::default() }).tone.range;
            assert_eq!(found, if comes_back { range } else { usual.tone.range }, "{range:?}");
        }
        for (divider, comes_back) in [(0.0, true), (1.0, true), (0.25, true), (-0.1, false), (1.1, false)] {
            let found = view(KeptView { divider, mode: Some(Mode::Wipe), ..KeptView::default() });
            let expected = if comes_back { (divider, false) } else { (0.5, true) };
            assert_eq!((found.divider, found.is_divider_unplaced), expected);
        }
        for (exposure, expected) in [(1.5, 1.5), (f64::NAN, 0.0), (f64::INFINITY, 0.0), (99.0, 12.0)] {
            assert_eq!(view(KeptView { exposure, ..KeptView::default() }).tone.exposure, expected);
        }
        let empty = KeptView { crop: Some([[2, 3], [0, 0]]), ..KeptView::default() };
        assert_eq!(view(empty).crop, None);
    }

    #[test]
    fn a_difference_from_a_loaded_film_comes_back_as_the_picture() {
        let again = |show| {
            let mut view = ViewState::default();
            view.choose(show);
            KeptView::of(&view).view([32, 18]).show()
        };
        assert_eq!([Show::Difference, Show::Normals].map(again), [Show::Picture, Show::Normals]);
    }

    #[test]
    fn slots_are_shown_again_unless_something_else_is_shown() {
        let [one, two, ..] = SlotNumber::ALL;
        let places = Places { looked: None, before: Some(one), chosen: Some(two) };
        let shown = ShownSlots { places, compared: Some((Mode::Wipe, two)), divider: 0.25 };
        assert_eq!(shown.needed().collect::<Vec<_>>(), [two, one, two]);
        let kept = || {
            let mut view = ViewState::default();
            [one, two].into_iter().for_each(|number| view.slots.put(number, slot()));
            view
        };
        let mut view = kept();
        shown.show_in(&mut view);
        assert_eq!(
            (view.mode(), view.compared_slot(), view.slots.places()),
            (Some(Mode::Wipe), Some(two), places)
        );
        assert_eq!((view.divider, view.is_divider_unplaced), (0.25, false));
        let mut view = kept();
        ShownSlots { divider: 1.5, ..shown }.show_in(&mut view);
        assert_eq!((view.divider, view.is_divider_unplaced), (0.5, true));
        let mut view = kept();
        view.slots.delete(two);
        shown.show_in(&mut view);
        assert_eq!((view.mode(), view.slots.places().before), (None, Some(one)), "it is gone");
        let others: [fn(&mut ViewState); 2] =
            [|view| view.toggle(Mode::Difference, With::Stage), |view| view.look(Some(SlotNumber::ALL[0]))];
        for other in others {
            let mut view = kept();
            other(&mut view);
            let before = (view.mode(), view.slots.places());
            shown.show_in(&mut view);
            assert_eq!((view.mode(), view.slots.places()), before);
        }
    }

    fn slot() -> Slot {
        let mut film = Film::new(4, 2, 1);
        film.record(0..1, 0).unwrap();
        let kept = Kept::new(Document::new(Origin::usual()), film, Arc::default(), None);
        Slot { name: String::new(), kept: Arc::new(kept) }
    }
}
