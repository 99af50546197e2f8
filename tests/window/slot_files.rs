//! Kept pictures on disk: what the next window has of them, and what becomes of them if something fails.

use crate::common::{has_samples, opened, save, send, until};
use crate::session::{close, files, options, until_offered};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;
use weekender::app::{Command, SlotCommand, SlotNumber, Window};
use weekender::film::{FilmFile, checkpoint};
use weekender::output::OutputFormat;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];
const THREE: SlotNumber = SlotNumber::ALL[2];
const LONG: Duration = Duration::from_secs(3600);
const PICTURE: &str = "--stage glass-schlick --size 32x18 --samples 4 --device cpu";

/// A window of a user who knows the first steps, in which kept pictures may take `limit` bytes on disk.
fn limited(state: &Path, arguments: &str, limit: Option<u64>) -> Harness<'static, Window> {
    let mut options = options(arguments, state, LONG);
    options.kept_limit = limit;
    let mut window = Window::new(options, None).unwrap();
    window.remembered_mut().first_steps.is_over = true;
    window.remembered_mut().sizing = weekender::app::Sizing::Book;
    opened(window)
}

fn window(state: &Path, arguments: &str) -> Harness<'static, Window> {
    limited(state, arguments, None)
}

/// A window with a finished picture.
fn finished(state: &Path) -> Harness<'static, Window> {
    let mut harness = window(state, PICTURE);
    until(&mut harness, "the end", is_done);
    harness
}

fn is_done(window: &Window) -> bool {
    window.status().phase.is_over() && has_samples(1)(window)
}

fn keep_in(harness: &mut Harness<'_, Window>, number: SlotNumber) {
    send(harness, Command::Slot(SlotCommand::KeepIn(number)));
    until(harness, "a kept picture", |window| window.slot(number).is_some());
}

/// Renders the picture with another field of view.
fn change(harness: &mut Harness<'_, Window>, vfov: f64) {
    harness.state_mut().document_mut().camera.vfov_degrees = vfov;
    harness.run_steps(2);
    until(harness, "the changed picture", is_done);
}

/// The only folder with kept pictures.
fn folder(state: &Path) -> PathBuf {
    let [folder] = files(state, "slots").try_into().unwrap();
    folder
}

/// The films in all folders.
fn films(state: &Path) -> Vec<PathBuf> {
    files(state, "slots").iter().flat_map(|folder| files(folder, "exr")).collect()
}

/// Draws frames until there are this many films, all of them listed.
fn until_written(harness: &mut Harness<'_, Window>, state: &Path, count: usize) {
    until(harness, "films of kept pictures", |_| {
        let films = films(state);
        let lists = files(state, "slots").into_iter().map(|folder| folder.join("slots.json"));
        let listed: String = lists.filter_map(|list| fs::read_to_string(list).ok()).collect();
        let is_listed = |film: &PathBuf| listed.contains(film.file_stem().unwrap().to_str().unwrap());
        films.len() == count && films.iter().all(is_listed)
    });
}

/// The film of a slot with its description, as the window saves it.
fn saved(harness: &mut Harness<'_, Window>, number: SlotNumber, path: &Path) -> FilmFile {
    send(harness, Command::Slot(SlotCommand::Look(number)));
    save(harness, Command::Save(OutputFormat::Exr), path);
    checkpoint::load(path).unwrap()
}

fn until_back(harness: &mut Harness<'_, Window>, numbers: &[SlotNumber]) {
    until(harness, "the slots", |window| numbers.iter().all(|number| window.slot(*number).is_some()));
}

fn told(harness: &Harness<'_, Window>, part: &str) -> Option<String> {
    harness.state().messages().into_iter().find(|text| text.contains(part))
}

#[test]
fn kept_pictures_come_back_with_all_that_they_hold() {
    let [state, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    first.run_steps(2);
    first.get_by_label("Name of slot 1").focus();
    first.run_steps(2);
    first.event(eframe::egui::Event::Text("my ".to_owned()));
    first.run_steps(2);
    first.key_press(Key::Escape);
    first.run_steps(2);
    change(&mut first, 25.0);
    first.state_mut().document_mut().settings.estimate_error = false;
    first.run_steps(2);
    until(&mut first, "a film of one half", is_done);
    keep_in(&mut first, THREE);
    let at = |name: &str| other.path().join(name);
    let mine = [(ONE, "1.exr"), (THREE, "3.exr")].map(|(number, name)| {
        let name_of = first.state().slot(number).unwrap().0.to_owned();
        (number, name_of, saved(&mut first, number, &at(name)))
    });
    assert!(mine[0].1.contains("my "), "{}", mine[0].1);
    let live = first.state().document().camera;
    close(first);
    assert_eq!(folder(state.path()), state.path().join("session.slots"));
    assert_eq!(films(state.path()).len(), 2);

    let mut next = window(state.path(), "");
    until_back(&mut next, &[ONE, THREE]);
    next.run_steps(3);
    assert_eq!(next.state().looked(), Some(THREE), "it was shown last");
    for (number, name, film) in &mine {
        assert_eq!(next.state().slot(*number), Some((name.as_str(), 4)));
        let found = saved(&mut next, *number, &at(&format!("again-{number}.exr")));
        assert!(found.film == film.film, "{number}");
        assert_eq!(found.description, film.description, "{number}");
    }
    assert!(next.state().slot(TWO).is_none());
    assert_eq!(next.state().document().camera, live);
    assert!(told(&next, "not").is_none(), "{:?}", next.state().messages());
    // They are still there when this window is closed.
    close(next);
    let mut last = window(state.path(), "");
    until_back(&mut last, &[ONE, THREE]);
    // The same picture is known as such.
    send(&mut last, Command::Slot(SlotCommand::Look(THREE)));
    send(&mut last, Command::Slot(SlotCommand::LookLive));
    until(&mut last, "the live picture", is_done);
    send(&mut last, Command::Slot(SlotCommand::OnlyNoise));
    until(&mut last, "a verdict", |window| window.only_noise().is_some());
    assert_eq!(last.state().only_noise().unwrap().unwrap().0, "Identical to the bit");
    send(&mut last, Command::Slot(SlotCommand::Open));
    let same = "The live picture is this one, and it has no fewer samples";
    until(&mut last, same, |window| window.messages().iter().any(|text| text == same));
}

#[test]
fn a_comparison_with_a_slot_comes_back() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, TWO);
    change(&mut first, 25.0);
    send(&mut first, Command::Slot(SlotCommand::Difference));
    assert!(first.state().is_comparing());
    close(first);
    let mut next = window(state.path(), "");
    until(&mut next, "the comparison", Window::is_comparing);
    until(&mut next, "the other picture", Window::has_other_picture);
    assert_eq!(next.state().looked(), None);
    // What the user looks at by now stays.
    close(next);
    let mut other = Window::new(options("", state.path(), LONG), None).unwrap();
    other.send(Command::NextStage);
    let mut other = opened(other);
    until_back(&mut other, &[TWO]);
    other.run_steps(5);
    assert!(!other.state().is_comparing());
}

#[test]
fn a_slot_whose_picture_is_still_being_read_says_so() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, TWO);
    close(first);
    for _ in 0..2 {
        // Before its first frame, a window reads nothing.
        let mut next = Window::new(options("", state.path(), LONG), None).unwrap();
        for command in [SlotCommand::Look(TWO), SlotCommand::KeepIn(TWO)] {
            let reason = next.disabled_reason(Command::Slot(command)).unwrap();
            assert!(reason.starts_with("Slot 2 is still being read"), "{reason}");
        }
        // A window that is closed before it has read them leaves them as they are.
        next.end_in_order();
    }
    let mut last = window(state.path(), "");
    for number in [ONE, THREE] {
        // Nothing else is kept where it belongs.
        send(&mut last, Command::Slot(SlotCommand::Keep));
        until(&mut last, "another slot", |window| window.slot(number).is_some());
    }
    until_back(&mut last, &[TWO]);
}

#[test]
fn only_what_changes_is_written_and_what_is_gone_is_deleted() {
    let state = tempfile::tempdir().unwrap();
    let mut harness = finished(state.path());
    assert_eq!(files(state.path(), "slots"), <[PathBuf; 0]>::default());
    keep_in(&mut harness, ONE);
    until_written(&mut harness, state.path(), 1);
    let [film] = films(state.path()).try_into().unwrap();
    let written = fs::metadata(&film).unwrap().modified().unwrap();
    keep_in(&mut harness, TWO);
    until_written(&mut harness, state.path(), 2);
    // A name changes the list alone.
    harness.get_by_label("Name of slot 1").focus();
    harness.run_steps(2);
    harness.event(eframe::egui::Event::Text("renamed".to_owned()));
    harness.run_steps(2);
    let list = folder(state.path()).join("slots.json");
    until(&mut harness, "the new name", |_| fs::read_to_string(&list).unwrap().contains("renamed"));
    assert_eq!(fs::metadata(&film).unwrap().modified().unwrap(), written);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    // Another picture in its place.
    change(&mut harness, 25.0);
    send(&mut harness, Command::Slot(SlotCommand::KeepIn(ONE)));
    until(&mut harness, "the old film to be gone", |_| !film.exists());
    until_written(&mut harness, state.path(), 2);
    send(&mut harness, Command::Slot(SlotCommand::BringBack));
    until(&mut harness, "the old film again", |_| film.exists());
    until_written(&mut harness, state.path(), 2);
    for number in [ONE, TWO] {
        send(&mut harness, Command::Slot(SlotCommand::Look(number)));
        send(&mut harness, Command::Slot(SlotCommand::Delete));
    }
    until(&mut harness, "no folder", |_| files(state.path(), "slots").is_empty());
    send(&mut harness, Command::Slot(SlotCommand::BringBack));
    close(harness);
    let mut next = window(state.path(), "");
    until_back(&mut next, &[TWO]);
    assert!(next.state().slot(ONE).is_none() && !next.state().is_coming(ONE));
}

#[test]
fn a_window_that_is_closed_at_once_keeps_what_was_kept_last() {
    let state = tempfile::tempdir().unwrap();
    // Copies wait for the end of a pass.
    let mut harness =
        window(state.path(), "--stage glass-schlick --size 320x180 --samples 4000000000 --device cpu");
    until(&mut harness, "samples", has_samples(1));
    for number in SlotNumber::ALL {
        harness.state_mut().send(Command::Slot(SlotCommand::KeepIn(number)));
    }
    // One frame, in which the copies are asked for.
    harness.step();
    close(harness);
    let mut next = window(state.path(), "");
    until_back(&mut next, &SlotNumber::ALL);
}

#[test]
fn what_does_not_fit_on_disk_is_said_once_and_comes_when_there_is_room() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    until_written(&mut first, state.path(), 1);
    let size = |path: &PathBuf| fs::metadata(path).unwrap().len();
    let whole: u64 =
        fs::read_dir(folder(state.path())).unwrap().map(|entry| size(&entry.unwrap().path())).sum();
    close(first);
    let mut next = limited(state.path(), "", Some(whole + whole / 2));
    until_back(&mut next, &[ONE]);
    until(&mut next, "the end", is_done);
    keep_in(&mut next, TWO);
    let part = "will not come back in the next window";
    until(&mut next, part, |window| window.messages().iter().any(|text| text.contains(part)));
    let words = told(&next, part).unwrap();
    assert!(words.starts_with("Slot 2 (") && words.contains("delete a slot"), "{words}");
    assert!(words.contains(&format!("may take {} bytes", whole + whole / 2)), "{words}");
    next.run_steps(3);
    assert!(next.query_by_label("this window only").is_some());
    let count = |harness: &Harness<'_, Window>| {
        harness.state().messages().iter().filter(|text| text.contains(part)).count()
    };
    keep_in(&mut next, THREE);
    until(&mut next, "the other", |window| {
        window.messages().iter().any(|text| text.starts_with("Slot 3") && text.contains(part))
    });
    assert_eq!((count(&next), films(state.path()).len()), (2, 1), "each is told of once");
    send(&mut next, Command::Slot(SlotCommand::Look(ONE)));
    send(&mut next, Command::Slot(SlotCommand::Delete));
    until_written(&mut next, state.path(), 1);
    next.run_steps(3);
    close(next);
    let mut last = window(state.path(), "");
    until_back(&mut last, &[TWO]);
    assert!(last.state().slot(ONE).is_none() && last.state().slot(THREE).is_none());
}

#[test]
fn a_place_that_cannot_be_written_is_said_and_the_slots_stay() {
    let state = tempfile::tempdir().unwrap();
    let blocked = state.path().join(format!("window-{}-1.slots", std::process::id()));
    fs::write(&blocked, "").unwrap();
    let mut harness = finished(state.path());
    keep_in(&mut harness, ONE);
    let part = "will not come back in the next window: cannot write to";
    until(&mut harness, part, |window| window.messages().iter().any(|text| text.contains(part)));
    let words = told(&harness, part).unwrap();
    assert!(words.starts_with("Slot 1 (") && words.contains(blocked.to_str().unwrap()), "{words}");
    keep_in(&mut harness, TWO);
    harness.run_steps(20);
    assert_eq!(harness.state().messages().iter().filter(|text| text.contains(part)).count(), 1);
    assert!(harness.state().slot(ONE).is_some(), "it stays in memory");
    change(&mut harness, 25.0);
    // It is tried again.
    fs::remove_file(&blocked).unwrap();
    keep_in(&mut harness, THREE);
    until_written(&mut harness, state.path(), 3);
}

#[test]
fn a_damaged_film_is_named_and_the_others_come() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    for number in [ONE, TWO, THREE] {
        keep_in(&mut first, number);
    }
    close(first);
    let films = films(state.path());
    let list = fs::read_to_string(folder(state.path()).join("slots.json")).unwrap();
    let id_of = |number: &str| {
        let entry = &list[list.find(&format!("\"number\": {number}")).unwrap()..];
        entry.split('"').nth(5).unwrap().to_owned()
    };
    let film_of =
        |number: &str| films.iter().find(|film| film.to_str().unwrap().contains(&id_of(number))).unwrap();
    let damaged = film_of("2");
    let mut bytes = fs::read(damaged).unwrap();
    let last = bytes.len() - 100;
    bytes[last] ^= 1;
    fs::write(damaged, bytes).unwrap();
    fs::remove_file(film_of("3")).unwrap();
    let mut next = window(state.path(), "");
    until_back(&mut next, &[ONE]);
    until(&mut next, "the fault", |window| {
        window
            .messages()
            .iter()
            .any(|text| text.starts_with("Slot 2 (") && text.contains("does not come back"))
    });
    let words = told(&next, "does not come back").unwrap();
    assert!(words.contains("is damaged") && words.contains("it is kept as"), "{words}");
    let words = told(&next, "Not all kept pictures come back").unwrap();
    assert!(words.contains("of slot 3") && words.contains(&id_of("3")), "{words}");
    assert!(next.state().slot(TWO).is_none() && !next.state().is_coming(TWO));
    assert!(!damaged.exists() && files(state.path(), "exr").len() == 1, "it is set aside");
    close(next);
    let mut last = window(state.path(), "");
    until_back(&mut last, &[ONE]);
    assert!(told(&last, "come back").is_none(), "{:?}", last.state().messages());
    until_offered(&mut last);
}

#[test]
fn the_kept_pictures_of_a_window_that_is_gone_are_offered() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    keep_in(&mut first, TWO);
    until_written(&mut first, state.path(), 2);
    // While it runs, nobody else touches them.
    let mut beside = finished(state.path());
    beside.run_steps(20);
    assert!(!beside.state().has_offer() && !beside.state().is_coming(ONE));
    keep_in(&mut beside, ONE);
    until_written(&mut beside, state.path(), 3);
    close(beside);
    assert_eq!(films(state.path()).len(), 3);
    // The window does not end in order.
    drop(first);
    let mut next = window(state.path(), "");
    until_back(&mut next, &[ONE]);
    until_offered(&mut next);
    assert!(next.state().slot(TWO).is_none(), "nothing is opened unasked");
    let before = films(state.path());
    next.get_by_label_contains("Open 2 kept pictures").click();
    next.run_steps(2);
    until_back(&mut next, &[ONE, TWO, THREE]);
    next.run_steps(3);
    assert!(!next.state().has_offer());
    until_written(&mut next, state.path(), 3);
    assert_eq!(files(state.path(), "slots").len(), 1);
    let names =
        |films: &[PathBuf]| films.iter().map(|film| film.file_name().unwrap().to_owned()).collect::<Vec<_>>();
    let (mut before, mut after) = (names(&before), names(&films(state.path())));
    before.sort();
    after.sort();
    assert_eq!(before, after, "they were renamed, not written again");
    close(next);
    let mut last = window(state.path(), "");
    until_back(&mut last, &[ONE, TWO, THREE]);
}

#[test]
fn kept_pictures_that_are_discarded_are_deleted() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    until_written(&mut first, state.path(), 1);
    drop(first);
    let mut next = window(state.path(), "");
    until_offered(&mut next);
    for (word, count) in [("Discard", 1), ("Discard for good", 0)] {
        next.get_by_label_contains(&format!("{word}: 1 kept picture")).click();
        next.run_steps(3);
        assert_eq!(films(state.path()).len(), count);
    }
    assert!(!next.state().has_offer());
}

#[test]
fn who_asks_for_another_picture_finds_the_kept_ones_later() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    close(first);
    for arguments in ["--fresh", "--stage metal --size 32x18"] {
        let other = window(state.path(), arguments);
        assert!(!other.state().is_coming(ONE) && other.state().slot(ONE).is_none(), "{arguments}");
        assert_eq!(folder(state.path()), state.path().join("session.slots"), "{arguments}");
    }
    close(window(state.path(), "--fresh"));
    let mut next = window(state.path(), "");
    until_offered(&mut next);
    assert!(next.query_all_by_label_contains("Open 1 kept picture").next().is_some());
    assert!(next.state().slot(ONE).is_none());
}

#[test]
fn kept_pictures_come_back_even_if_the_picture_cannot() {
    let state = tempfile::tempdir().unwrap();
    let mut first = finished(state.path());
    keep_in(&mut first, ONE);
    close(first);
    fs::write(state.path().join("session.json"), "{").unwrap();
    let mut next = window(state.path(), "");
    assert!(told(&next, "What was shown last cannot").is_some());
    until_back(&mut next, &[ONE]);
}

#[test]
fn a_fresh_start_in_the_window_leaves_the_slots() {
    let state = tempfile::tempdir().unwrap();
    let mut harness = finished(state.path());
    keep_in(&mut harness, ONE);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    send(&mut harness, Command::Fresh);
    assert_eq!((harness.state().slot(ONE).is_some(), harness.state().looked()), (true, None));
}
