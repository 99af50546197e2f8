//! Slots: places for pictures that are kept, to look at them again and to compare with them.

pub use super::slot_number::SlotNumber;

use super::kept::Kept;
use crate::film::Film;
use crate::system::memory::words;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What the pictures of all slots may take together, bytes.
pub const BYTES_LIMIT: u64 = 4_000_000_000;

/// A slot in use.
#[derive(Clone, Debug)]
pub struct Slot {
    /// The name, which the user can change.
    pub name: String,
    /// The picture.
    pub kept: Arc<Kept>,
}

/// A kept picture that another window has left and that is still being read, as far as it is known before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coming {
    /// The name of the slot.
    pub name: String,
    /// [`Kept::id`].
    pub id: String,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples per pixel.
    pub samples: u64,
    /// The size is the picture's own: [`super::document::Document::has_own_size`].
    pub has_own_size: bool,
}

impl Coming {
    /// The most bytes that its film takes in memory.
    pub fn bytes(&self) -> u64 {
        Film::bytes(self.size[0], self.size[1], 2)
    }
}

/// Which slots are shown and meant by commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Places {
    /// The slot in place of the live picture.
    pub looked: Option<SlotNumber>,
    /// What was looked at before: a slot, or the live picture.
    pub before: Option<SlotNumber>,
    /// The slot that commands without a number are for.
    pub chosen: Option<SlotNumber>,
}

/// The slots, and which of them is looked at.
#[derive(Clone, Debug, Default)]
pub struct Slots {
    slots: [Option<Slot>; 9],
    /// Pictures on their way. Their slots are neither free nor in use.
    coming: [Option<Coming>; 9],
    places: Places,
    /// The pictures that the next window will not have: [`Kept::id`].
    passing: Vec<String>,
    /// The picture that was deleted or replaced last.
    gone: Option<(SlotNumber, Slot)>,
}

impl Slots {
    /// A slot, if it is in use.
    pub fn get(&self, number: SlotNumber) -> Option<&Slot> {
        self.slots[number.index()].as_ref()
    }

    /// The name of a slot, to be changed.
    pub fn name_mut(&mut self, number: SlotNumber) -> Option<&mut String> {
        self.slots[number.index()].as_mut().map(|slot| &mut slot.name)
    }

    /// The number of a slot with its name.
    pub fn title(&self, number: SlotNumber) -> String {
        let name = self.get(number).map_or("empty", |slot| slot.name.as_str());
        format!("slot {number}: {name}")
    }

    /// The slots in use, in order.
    pub fn used(&self) -> impl Iterator<Item = (SlotNumber, &Slot)> {
        SlotNumber::ALL.into_iter().filter_map(|number| Some((number, self.get(number)?)))
    }

    /// Whether a slot is in use.
    pub fn is_used(&self) -> bool {
        self.used().next().is_some()
    }

    /// Whether there is something to list: a slot in use, or a picture on its way.
    pub fn is_listed(&self) -> bool {
        self.is_used() || self.awaited().next().is_some()
    }

    /// The slots that are not in use and not waiting for a picture.
    pub fn free(&self) -> impl Iterator<Item = SlotNumber> {
        let is_free = |number: &SlotNumber| self.get(*number).is_none() && self.coming(*number).is_none();
        SlotNumber::ALL.into_iter().filter(is_free)
    }

    /// The picture that is on its way to a slot.
    pub fn coming(&self, number: SlotNumber) -> Option<&Coming> {
        self.coming[number.index()].as_ref()
    }

    /// The slots that wait for a picture, in order.
    pub fn awaited(&self) -> impl Iterator<Item = (SlotNumber, &Coming)> {
        SlotNumber::ALL.into_iter().filter_map(|number| Some((number, self.coming(number)?)))
    }

    /// Notes that a picture is on its way to a slot, which must be free.
    pub fn expect(&mut self, number: SlotNumber, coming: Coming) {
        debug_assert!(self.get(number).is_none());
        self.coming[number.index()] = Some(coming);
    }

    /// Ends the wait for a picture, which is put into its slot if it could be read. What is looked at, or meant by
    /// commands, stays. Returns its number and what was known of it, if it was awaited.
    pub fn arrive(&mut self, id: &str, kept: Option<Arc<Kept>>) -> Option<(SlotNumber, Coming)> {
        let (number, _) = self.awaited().find(|(_, coming)| coming.id == id)?;
        let coming = self.coming[number.index()].take()?;
        debug_assert!(self.get(number).is_none());
        if let Some(kept) = kept {
            self.slots[number.index()] = Some(Slot { name: coming.name.clone(), kept });
            self.places.chosen = self.places.chosen.or(Some(number));
        }
        Some((number, coming))
    }

    /// Notes whether the next window will have this picture.
    pub fn note_lasting(&mut self, id: &str, is_lasting: bool) {
        self.passing.retain(|other| other != id);
        if !is_lasting {
            self.passing.push(id.to_owned());
        }
    }

    /// Whether it is known that the next window will not have this picture.
    pub fn is_passing(&self, kept: &Kept) -> bool {
        self.passing.contains(&kept.id)
    }

    /// Which slots are shown and meant.
    pub fn places(&self) -> Places {
        self.places
    }

    /// Makes these the slots that are shown and meant, as far as they are in use.
    pub fn set_places(&mut self, places: Places) {
        let in_use = |place: Option<SlotNumber>| place.filter(|number| self.get(*number).is_some());
        let Places { looked, before, chosen } = places;
        let chosen = in_use(chosen).or(self.places.chosen);
        self.places = Places { looked: in_use(looked), before: in_use(before), chosen };
    }

    /// The slot that is looked at, instead of the live picture.
    pub fn looked(&self) -> Option<SlotNumber> {
        self.places.looked
    }

    /// The picture that is looked at, instead of the live one.
    pub fn shown(&self) -> Option<&Arc<Kept>> {
        self.places.looked.and_then(|number| self.get(number)).map(|slot| &slot.kept)
    }

    /// The room in which pictures get the size of the chosen picture, or else of the first one. Only pictures count that had
    /// no size of their own.
    pub fn room(&self) -> Option<[u32; 2]> {
        let of_slot = |number| match (self.get(number), self.coming(number)) {
            (Some(slot), _) => (!slot.kept.document.has_own_size).then(|| slot.kept.size()),
            // The picture would change its size once it is there.
            (None, coming) => coming.filter(|coming| !coming.has_own_size).map(|coming| coming.size),
        };
        let chosen = self.places.chosen.and_then(of_slot);
        let [width, height] = chosen.or_else(|| SlotNumber::ALL.into_iter().find_map(of_slot))?;
        // The height was rounded; with a row less, the width would be smaller.
        Some([width, height + 1])
    }

    /// The slot that commands without a number are for: the one that was looked at, kept or clicked last.
    pub fn chosen(&self) -> Option<SlotNumber> {
        self.places.chosen
    }

    /// Makes commands without a number be for this slot.
    pub fn choose(&mut self, number: SlotNumber) {
        if self.get(number).is_some() {
            self.places.chosen = Some(number);
        }
    }

    /// Looks at a slot in use, or at the live picture.
    pub fn look(&mut self, at: Option<SlotNumber>) {
        if at != self.places.looked && at.is_none_or(|number| self.get(number).is_some()) {
            self.places.before = self.places.looked;
            self.places.looked = at;
        }
        if let Some(number) = at {
            self.choose(number);
        }
    }

    /// What [`Slots::swap`] would look at.
    pub fn other(&self) -> Option<SlotNumber> {
        if self.places.looked.is_some() {
            self.places.before
        } else {
            self.places.before.or(self.places.chosen)
        }
    }

    /// Looks at what was looked at before.
    pub fn swap(&mut self) {
        self.look(self.other());
    }

    /// Puts a picture into a slot that waits for none, which is then the one to swap with. A picture that was there can be brought back, if
    /// there is room for both.
    pub fn put(&mut self, number: SlotNumber, slot: Slot) {
        debug_assert!(self.coming(number).is_none());
        if let Some(earlier) = self.slots[number.index()].replace(slot) {
            self.gone = Some((number, earlier));
        }
        if self.bytes() > BYTES_LIMIT {
            self.gone = None;
        }
        self.places.chosen = Some(number);
        if self.places.looked.is_none() {
            self.places.before = Some(number);
        }
    }

    /// Empties a slot. Its picture can be brought back.
    pub fn delete(&mut self, number: SlotNumber) {
        let Some(slot) = self.slots[number.index()].take() else { return };
        self.gone = Some((number, slot));
        let Places { looked, before, chosen } = &mut self.places;
        for place in [looked, before, chosen] {
            *place = place.filter(|other| *other != number);
        }
        self.places.chosen = self.places.chosen.or_else(|| self.used().last().map(|(other, _)| other));
    }

    /// The slot whose picture was deleted or replaced last.
    pub fn gone(&self) -> Option<SlotNumber> {
        self.gone.as_ref().map(|(number, _)| *number)
    }

    /// Where the picture that was deleted or replaced last can be put back: into its slot, or, while that waits for
    /// another picture, into the first free one.
    pub fn place_back(&self) -> Option<SlotNumber> {
        let number = self.gone()?;
        if self.coming(number).is_none() { Some(number) } else { self.free().next() }
    }

    /// Puts the picture back that was deleted or replaced last, if there is a place for it. What has been put there since
    /// can be brought back.
    pub fn bring_back(&mut self) {
        if let Some(number) = self.place_back()
            && let Some((_, slot)) = self.gone.take()
        {
            self.put(number, slot);
        }
    }

    /// Bytes that all pictures take, with those on their way.
    pub fn bytes(&self) -> u64 {
        let gone = self.gone.iter().map(|(_, slot)| slot.kept.bytes());
        let coming = self.awaited().map(|(_, coming)| coming.bytes());
        self.used().map(|(_, slot)| slot.kept.bytes()).chain(gone).chain(coming).sum()
    }

    /// Makes room for `bytes` more in slot `number`, by forgetting the picture that could be brought back.
    ///
    /// # Errors
    /// If they do not fit within `limit`: how much is needed, how much is there, and what to do.
    pub fn make_room(&mut self, number: SlotNumber, bytes: u64, limit: u64) -> Result<(), String> {
        if self.bytes().saturating_add(bytes) > limit {
            self.gone = None;
        }
        let replaced = self.get(number).map_or(0, |slot| slot.kept.bytes());
        let held = self.bytes();
        if (held - replaced).saturating_add(bytes) <= limit {
            return Ok(());
        }
        Err(format!(
            "the picture takes {} and the slots already take {}, but all together may take {}; delete a slot, or \
             save it as a film and load that as the reference",
            words(bytes),
            words(held - replaced),
            words(limit)
        ))
    }
}

#[cfg(test)]
mod tests;
