//! Keeps the pictures in the slots for the next window, and puts those of the last one into slots.

use super::model::slots::{BYTES_LIMIT, Coming, SlotNumber};
use super::recovery::RecoveryFiles;
use super::slot_files::{Arrival, Entry, Keeper, News};
use super::window::Window;
use crate::describe::counted;
use eframe::egui::Context;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a window that is closed waits for pictures that the render thread is copying.
const PATIENCE: Duration = Duration::from_secs(5);

impl Window {
    /// Waits for the kept pictures in `files`, and keeps those of this window there from now on. Those of all windows may
    /// take `limit` bytes.
    pub(super) fn begin_slots(&mut self, files: &RecoveryFiles, limit: u64) {
        let mut keeper = Keeper::new(files.slots().clone(), limit);
        let (mut entries, faults) = files.slots().entries();
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
        if let Some(files) =
            self.recovery.files.as_ref().filter(|files| files.slots().film(&coming.id).exists())
        {
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
        for entry in left.kept().to_vec() {
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
            let kept = counted(left.kept().len() as u64, "kept picture");
            self.toasts.bad(format!("Not opened: {kept}: {reason}"));
        }
        self.recovery.put_back(index, left);
        self.read_in_order(context, ids);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::kept::Kept;
    use crate::app::model::kept_view::{KeptView, ShownSlots};
    use crate::app::model::slots::Slot;
    use crate::app::model::view::ViewState;
    use crate::app::recovery::Left;
    use crate::app::tests::window;
    use crate::film::Film;
    use std::path::Path;

    const STAGE: &str = "weekender --stage normals --size 16x9 --samples 1";

    fn entry(number: Option<SlotNumber>, id: &str, size: [u32; 2]) -> Entry {
        let (id, name) = (id.to_owned(), format!("picture {id}"));
        Entry { number, id, name, size, samples: 1, has_own_size: true }
    }

    /// Files in the directory with these kept pictures.
    fn holding(directory: &Path, entries: &[Entry]) -> RecoveryFiles {
        let files = RecoveryFiles::claim(directory).unwrap();
        files.slots().write_list(entries).unwrap();
        for entry in entries {
            std::fs::write(files.slots().film(&entry.id), "a film").unwrap();
        }
        files
    }

    #[test]
    fn a_tenth_picture_stays_on_disk_under_its_name() {
        let directory = tempfile::tempdir().unwrap();
        let of_slot = |number: SlotNumber| entry(Some(number), &number.to_string(), [4, 2]);
        let mut entries: Vec<Entry> = SlotNumber::ALL.into_iter().map(of_slot).collect();
        entries.push(entry(None, "tenth", [4, 2]));
        let files = holding(directory.path(), &entries);
        let mut window = window(STAGE);
        window.begin_slots(&files, u64::MAX);
        assert_eq!(window.messages(), ["picture tenth stays on disk: all nine slots are in use"]);
        window.finish_slots();
        assert_eq!(files.slots().entries(), (entries, vec![]), "the next window may have room for it");
    }

    #[test]
    fn a_picture_that_could_not_be_written_lasts_once_it_is() {
        let mut window = window(STAGE);
        let kept = kept(&window);
        let mut is_passing_after = |news| {
            window.take_news(news);
            window.model.view.slots.is_passing(&kept)
        };
        let id = || kept.id.clone();
        assert!(is_passing_after(News::NotWritten { id: Some(id()), words: None }));
        assert!(!is_passing_after(News::Written(id())));
    }

    #[test]
    fn what_another_window_left_stays_there_if_there_is_no_room() {
        for (free, size, reason) in [
            (0, [4, 2], "all nine slots are in use; delete one and open them again"),
            (1, [20_000, 10_000], "the picture takes "),
        ] {
            let directory = tempfile::tempdir().unwrap();
            drop(holding(directory.path(), &[entry(None, "left", size)]));
            let mut window = window(STAGE);
            window.recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
            window.recovery.left = Left::all_in(directory.path());
            for number in &SlotNumber::ALL[free..] {
                let coming = entry(Some(*number), &number.to_string(), [4, 2]).coming();
                window.model.view.slots.expect(*number, coming);
            }
            window.take_left_slots(&Context::default(), 0);
            let [told] = window.messages().try_into().unwrap();
            assert!(told.starts_with(&format!("Not opened: 1 kept picture: {reason}")), "{told}");
            assert_eq!(window.recovery.left[0].kept().len(), 1);
            assert_eq!(window.model.view.slots.free().count(), free);
        }
    }

    #[test]
    fn a_list_of_pictures_that_are_gone_is_told_of_once() {
        let directory = tempfile::tempdir().unwrap();
        let files = holding(directory.path(), &[entry(Some(SlotNumber::ALL[2]), "gone", [4, 2])]);
        std::fs::remove_file(files.slots().film("gone")).unwrap();
        let mut window = window(STAGE);
        window.begin_slots(&files, u64::MAX);
        let told = window.messages();
        let begin = "Not all kept pictures come back: the film of slot 3, picture gone, is missing";
        assert!(told.len() == 1 && told[0].starts_with(begin), "{told:?}");
        assert!(!files.slots().path().exists());
    }

    #[test]
    fn a_picture_goes_to_its_own_slot_and_what_is_in_no_list_takes_what_is_left() {
        let directory = tempfile::tempdir().unwrap();
        let [one, two, three, ..] = SlotNumber::ALL;
        let listed = [entry(Some(three), "c", [4, 2]), entry(Some(one), "a", [4, 2])];
        let files = holding(directory.path(), &listed);
        std::fs::write(files.slots().film("b"), "a film").unwrap();
        let mut window = window(STAGE);
        window.begin_slots(&files, u64::MAX);
        let slots = &window.model.view.slots;
        let awaited: Vec<_> = slots.awaited().map(|(number, coming)| (number, coming.id.as_str())).collect();
        assert_eq!(awaited, [(one, "a"), (two, "b"), (three, "c")]);
        assert!(window.messages().is_empty(), "{:?}", window.messages());
    }

    /// What a window remembers that showed this slot.
    fn shown(number: SlotNumber, kept: &Arc<Kept>) -> ShownSlots {
        let mut view = ViewState::default();
        view.slots.put(number, Slot { name: String::new(), kept: Arc::clone(kept) });
        view.look(Some(number));
        KeptView::of(&view).slots()
    }

    fn kept(window: &Window) -> Arc<Kept> {
        let mut film = Film::new(4, 2, 1);
        film.record(0..1, 0).unwrap();
        Arc::new(Kept::new(window.document().clone(), film, Arc::default(), None))
    }

    #[test]
    fn the_picture_that_is_to_be_shown_is_read_first() {
        let directory = tempfile::tempdir().unwrap();
        let [one, two, three, ..] = SlotNumber::ALL;
        let entries = [one, two, three].map(|number| entry(Some(number), &number.to_string(), [4, 2]));
        let files = holding(directory.path(), &entries);
        let mut window = window(STAGE);
        window.begin_slots(&files, u64::MAX);
        window.recovery.shown_slots = Some(shown(three, &kept(&window)));
        window.read_slots(&Context::default());
        let (begin, mut read) = (Instant::now(), Vec::new());
        while read.len() < 3 {
            assert!(begin.elapsed() < Duration::from_secs(60), "only {read:?}");
            std::thread::sleep(Duration::from_millis(1));
            read.extend(window.recovery.reader.take().map(|arrival| arrival.id));
        }
        assert_eq!(read, ["3", "1", "2"]);
    }

    #[test]
    fn slots_are_shown_again_once_their_pictures_are_there() {
        let mut window = window(STAGE);
        let (one, kept) = (SlotNumber::ALL[0], kept(&window));
        window.model.view.slots.expect(one, entry(Some(one), "1", [4, 2]).coming());
        window.recovery.shown_slots = Some(shown(one, &kept));
        window.show_slots_again();
        assert!(window.looked().is_none() && window.recovery.shown_slots.is_some());
        window.model.view.slots.arrive("1", Some(kept));
        window.show_slots_again();
        assert_eq!(window.looked(), Some(one));
        assert!(window.recovery.shown_slots.is_none(), "once");
    }

    #[test]
    fn a_picture_that_cannot_be_read_is_kept_under_another_name() {
        let directory = tempfile::tempdir().unwrap();
        let three = SlotNumber::ALL[2];
        let entry = entry(Some(three), "c", [4, 2]);
        let mut window = window(STAGE);
        window.recovery.files = Some(holding(directory.path(), std::slice::from_ref(&entry)));
        let mut told = || {
            window.leave_out(three, &entry.coming(), "it is damaged");
            window.messages().pop().unwrap()
        };
        let first = told();
        let begin = "Slot 3 (picture c) does not come back: it is damaged";
        let aside =
            first.strip_prefix(&format!("{begin}; it is kept as ")).unwrap_or_else(|| panic!("{first}"));
        assert_eq!(std::fs::read_to_string(aside).unwrap(), "a film");
        assert_eq!(told(), begin, "it is gone from its place");
    }

    #[test]
    fn it_is_said_why_a_picture_is_not_written() {
        let mut window = window(STAGE);
        window.take_news(News::NotWritten { id: None, words: Some("the disk is full".to_owned()) });
        assert_eq!(window.messages(), ["the disk is full"]);
    }
}
