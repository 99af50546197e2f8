//! Kept pictures on disk: what is written and deleted, and what is said if it cannot be.

use super::*;

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
fn what_does_not_fit_on_disk_is_said_once_and_comes_when_there_is_room() {
    let (state, mut first) = keeping(&[ONE]);
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

#[cfg(unix)]
#[test]
fn a_place_that_cannot_be_written_is_said_and_the_slots_stay() {
    let state = tempfile::tempdir().unwrap();
    let blocked = state.path().join(format!("window-{}-1.slots", std::process::id()));
    block(&blocked);
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
    let (state, first) = keeping(&[ONE, TWO, THREE]);
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
