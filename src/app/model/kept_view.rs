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
