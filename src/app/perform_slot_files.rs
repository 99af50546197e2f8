//! Keeps the pictures in the slots for the next window, and puts those of the last one into slots.

use super::model::slots::{BYTES_LIMIT, Coming, SlotNumber};
use super::recovery::RecoveryFiles;
use super::slot_files::{Arrival, Entry, Keeper, Listing, News};
use super::window::Window;
use crate::progressive::describe::counted;
use eframe::egui::Context;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a window that is closed waits for pictures that the render thread is copying.
const PATIENCE: Duration = Duration::from_secs(5);

impl Window {
    /// Waits for the kept pictures in `files`, and keeps those of this window there from now on. Those of all windows may
    /// take `limit` bytes.
    pub(super) fn begin_slots(&mut self, files: &RecoveryFiles, limit: u64) {
        let Listing { mut entries, faults } = match files.slots().listing() {
            Ok(listing) => listing,
            Err(reason) => match files.set_slots_aside() {
                Ok(path) => {
                    let place = path.display();
                    let words = format!("{reason}; they stay in {place}, and later windows offer them");
                    self.toasts.bad(format!("Kept pictures do not come back: {words}"));
                    Listing::default()
                }
                Err(error) => {
                    let words = format!("{reason}; nor can new ones be kept: {error}");
                    self.toasts.bad(format!("Kept pictures do not come back: {words}"));
                    return;
                }
            },
        };
        let mut keeper = Keeper::new(files.slots().clone(), limit);
        for fault in faults {
            self.toasts.bad(format!("Not all kept pictures come back: {fault}"));
        }
        if entries.is_empty() {
            files.slots().clear();
        }
        // Those that are in no list take what the others leave.
        entries.sort_by_key(|entry| entry.number.is_none());
        for entry in entries {
            match self.place_for(&entry) {
                Some(number) => self.model.view.slots.expect(number, entry.coming()),
                None => {
                    self.toasts.bad(format!("{} stays on disk: all nine slots are in use", entry.name));
                    keeper.spare(entry);
                }
            }
        }
        self.recovery.keeper = Some(keeper);
    }

    /// The slot of a picture: its own, or the first free one.
    fn place_for(&self, entry: &Entry) -> Option<SlotNumber> {
        let slots = &self.model.view.slots;
        let mut free =
            slots.free().filter(|number| !self.slot_actions.is_wanted(*number)).collect::<Vec<_>>();
        free.sort_by_key(|number| Some(*number) != entry.number);
        free.first().copied()
    }

    /// Begins to read the pictures that are waited for, first those that are to be shown.
    pub(super) fn read_slots(&mut self, context: &Context) {
        let slots = &self.model.view.slots;
        let mut awaited: Vec<(SlotNumber, String)> =
            slots.awaited().map(|(number, coming)| (number, coming.id.clone())).collect();
        let needed: Vec<SlotNumber> =
            self.recovery.shown_slots.iter().flat_map(|shown| shown.needed().collect::<Vec<_>>()).collect();
        awaited.sort_by_key(|(number, _)| !needed.contains(number));
        self.read_in_order(context, awaited.into_iter().map(|(_, id)| id).collect());
    }

    fn read_in_order(&mut self, context: &Context, ids: Vec<String>) {
        let Some(keeper) = self.recovery.keeper.as_ref().filter(|_| !ids.is_empty()) else { return };
        let (folder, live) = (keeper.folder().clone(), self.model.document.clone());
        if let Err(error) = self.recovery.reader.read(context, folder, ids, live) {
            self.toasts.bad(format!("Kept pictures stay on disk: no thread could be started ({error})"));
        }
    }

    /// Takes pictures that were read, and what has become of those to be written.
    pub(super) fn receive_slot_files(&mut self) {
        while let Some(Arrival { id, outcome }) = self.recovery.reader.take() {
            match outcome {
                Ok(kept) => _ = self.model.view.slots.arrive(&id, Some(Arc::new(kept))),
                Err(reason) => {
                    if let Some((number, coming)) = self.model.view.slots.arrive(&id, None) {
                        self.leave_out(number, &coming, &reason);
                    }
                }
            }
        }
        while let Some(news) = self.recovery.keeper.as_ref().and_then(Keeper::news) {
            self.take_news(news);
        }
        self.show_slots_again();
    }

    /// Says that a kept picture does not come back, and moves its film to where the next window offers it.
    fn leave_out(&mut self, number: SlotNumber, coming: &Coming, reason: &str) {
        let mut place = String::new();
        if let Some(files) = self.recovery.files.as_ref().filter(|files| files.slots().may_have(&coming.id)) {
            match (files.set_slot_aside(&coming.id), &mut self.recovery.keeper) {
                (Ok(path), _) => place = format!("; it is kept as {}", path.display()),
                (Err(_), Some(keeper)) => keeper.spare(Entry::awaited(number, coming)),
                (Err(_), None) => {}
            }
        }
        self.toasts.bad(format!("Slot {number} ({}) does not come back: {reason}{place}", coming.name));
    }

    fn take_news(&mut self, news: News) {
        let slots = &mut self.model.view.slots;
        match news {
            News::Written(id) => slots.note_lasting(&id, true),
            News::NotWritten { id, words } => {
                if let Some(id) = id {
                    slots.note_lasting(&id, false);
                }
                if let Some(words) = words {
                    self.toasts.bad(words);
                }
            }
        }
    }

    /// Shows the slots that the last window showed, once their pictures are there.
    fn show_slots_again(&mut self) {
        let view = &mut self.model.view;
        let is_coming = |number| view.slots.coming(number).is_some();
        if let Some(shown) = self.recovery.shown_slots.filter(|shown| !shown.needed().any(is_coming)) {
            self.recovery.shown_slots = None;
            shown.show_in(view);
        }
    }

    /// Has the pictures in the slots written, and the others deleted.
    pub(super) fn keep_slots(&mut self, context: &Context) {
        if let Some(keeper) = &mut self.recovery.keeper {
            keeper.follow(context, &self.model.view.slots);
        }
    }

    /// Waits until the pictures in the slots are on disk, also those that are being copied.
    pub(super) fn finish_slots(&mut self) {
        if self.recovery.keeper.is_none() {
            return;
        }
        let begin = Instant::now();
        while self.slot_actions.is_copying() && begin.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(2));
        }
        self.receive_for_slots();
        self.write_slots();
        while let Some(news) = self.recovery.keeper.as_ref().and_then(Keeper::news) {
            self.take_news(news);
        }
    }

    /// Waits until the pictures in the slots are on disk.
    pub(super) fn write_slots(&mut self) {
        if let Some(keeper) = &mut self.recovery.keeper {
            keeper.finish(&self.model.view.slots);
        }
    }

    /// Puts the kept pictures that another window left into free slots.
    pub(super) fn take_left_slots(&mut self, context: &Context, index: usize) {
        if self.recovery.files.is_none() || index >= self.recovery.left.len() {
            return;
        }
        let mut left = self.recovery.left.remove(index);
        let (mut ids, mut stay) = (Vec::new(), None);
        let entries = left.kept().to_vec();
        let count = entries.len();
        for entry in entries {
            let Some(number) = self.place_for(&entry) else {
                stay = Some("all nine slots are in use; delete one and open them again".to_owned());
                break;
            };
            let coming = entry.coming();
            let slots = &mut self.model.view.slots;
            if let Err(reason) = slots.make_room(number, coming.bytes(), BYTES_LIMIT) {
                stay = Some(reason);
                break;
            }
            let taken =
                self.recovery.files.as_ref().map(|own| own.slots().take(left.files.slots(), &entry.id));
            match taken {
                Some(Err(error)) => stay = Some(error.to_string()),
                _ => {
                    slots.expect(number, coming);
                    ids.push(entry.id);
                }
            }
        }
        left.count_kept();
        if let Some(reason) = stay {
            let kept = counted((count - ids.len()) as u64, "kept picture");
            self.toasts.bad(format!("Not opened: {kept}: {reason}"));
        }
        self.recovery.put_back(index, left);
        self.read_in_order(context, ids);
    }
}
