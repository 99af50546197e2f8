//! Tests of kept pictures that come and go with windows.

use super::*;
use crate::app::model::kept::Kept;
use crate::app::model::kept_view::{KeptView, ShownSlots};
use crate::app::model::slots::Slot;
use crate::app::model::view::ViewState;
use crate::app::recovery::Left;
#[cfg(unix)]
use crate::app::tests::unreadable;
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
    let listing = Listing { entries, faults: vec![] };
    assert_eq!(files.slots().listing(), Ok(listing), "the next window may have room for it");
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

#[cfg(unix)]
#[test]
fn kept_pictures_that_cannot_be_listed_are_left_to_later_windows() {
    let directory = tempfile::tempdir().unwrap();
    let files = RecoveryFiles::claim(directory.path()).unwrap();
    let _elsewhere = unreadable(files.slots().path());
    let mut window = window(STAGE);
    window.begin_slots(&files, u64::MAX);
    let [told] = window.messages().try_into().unwrap();
    let begin = format!("Kept pictures do not come back: cannot list {}: ", files.slots().path().display());
    assert!(told.starts_with(&begin) && told.ends_with(", and later windows offer them"), "{told}");
    assert!(!files.slots().exists() && window.recovery.keeper.is_some(), "new ones are kept");
    drop((window, files));
    let [left] = Left::all_in(directory.path()).try_into().ok().unwrap();
    assert!(left.files.slots().path().is_symlink());
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
    let aside = first.strip_prefix(&format!("{begin}; it is kept as ")).unwrap_or_else(|| panic!("{first}"));
    assert_eq!(std::fs::read_to_string(aside).unwrap(), "a film");
    assert_eq!(told(), begin, "it is gone from its place");
}

#[test]
fn it_is_said_why_a_picture_is_not_written() {
    let mut window = window(STAGE);
    window.take_news(News::NotWritten { id: None, words: Some("the disk is full".to_owned()) });
    assert_eq!(window.messages(), ["the disk is full"]);
}

#[test]
fn of_what_another_window_left_as_many_come_as_there_is_room_for() {
    let directory = tempfile::tempdir().unwrap();
    let [one, two, ..] = SlotNumber::ALL;
    drop(holding(directory.path(), &[entry(Some(one), "a", [4, 2]), entry(Some(two), "b", [4, 2])]));
    let mut window = window(STAGE);
    window.recovery.files = Some(RecoveryFiles::claim(directory.path()).unwrap());
    window.recovery.left = Left::all_in(directory.path());
    // Its second slot is free.
    for number in SlotNumber::ALL.into_iter().filter(|number| *number != two) {
        let coming = entry(Some(number), &number.to_string(), [4, 2]).coming();
        window.model.view.slots.expect(number, coming);
    }
    window.take_left_slots(&Context::default(), 0);
    let told = "Not opened: 1 kept picture: all nine slots are in use; delete one and open them again";
    assert_eq!(window.messages(), [told]);
    assert_eq!(window.model.view.slots.coming(two).map(|coming| coming.id.as_str()), Some("a"));
    let own = window.recovery.files.as_ref().unwrap().slots();
    assert_eq!([own.may_have("a"), own.may_have("b")], [true, false]);
    let stays: Vec<&str> = window.recovery.left[0].kept().iter().map(|entry| entry.id.as_str()).collect();
    assert_eq!(stays, ["b"]);
}
