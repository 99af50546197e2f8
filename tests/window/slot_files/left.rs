//! Kept pictures that a window left which did not end in order, or that the next one was not to show.

use super::*;

#[test]
fn the_kept_pictures_of_a_window_that_is_gone_are_offered() {
    let (state, mut first) = keeping(&[ONE, TWO]);
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
    let (state, mut first) = keeping(&[ONE]);
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
    let (state, first) = keeping(&[ONE]);
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

#[cfg(unix)]
#[test]
fn kept_pictures_that_cannot_be_moved_are_offered_where_they_are() {
    let (state, first) = keeping(&[ONE]);
    close(first);
    fs::write(state.path().join("session.json"), "{").unwrap();
    // What cannot be shown stays under the window's first name, and this is in the way under its second one.
    block(&state.path().join(format!("window-{}-2.slots", std::process::id())));
    let mut next = window(state.path(), "");
    let words = next.state().messages();
    assert!(told(&next, "Kept pictures stay where they are: ").is_some(), "{words:?}");
    assert!(!next.state().is_coming(ONE));
    until_offered(&mut next);
    assert!(next.query_all_by_label_contains("Open 1 kept picture").next().is_some());
}
