//! What the next window has of kept pictures.

use super::*;

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
    let (state, mut first) = keeping(&[TWO]);
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
    let mut other = Window::new(options("", state.path(), LONG)).unwrap();
    other.send(Command::NextStage);
    let mut other = opened(other);
    until_back(&mut other, &[TWO]);
    other.run_steps(5);
    assert!(!other.state().is_comparing());
}

#[test]
fn a_slot_whose_picture_is_still_being_read_says_so() {
    let (state, first) = keeping(&[TWO]);
    close(first);
    for _ in 0..2 {
        // Before its first frame, a window reads nothing.
        let mut next = Window::new(options("", state.path(), LONG)).unwrap();
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
fn kept_pictures_come_back_even_if_the_picture_cannot() {
    let (state, first) = keeping(&[ONE]);
    close(first);
    fs::write(state.path().join("session.json"), "{").unwrap();
    let mut next = window(state.path(), "");
    assert!(told(&next, "What was shown last cannot").is_some());
    until_back(&mut next, &[ONE]);
}

#[test]
fn a_fresh_start_in_the_window_leaves_the_slots() {
    let (_state, mut harness) = keeping(&[ONE]);
    send(&mut harness, Command::Slot(SlotCommand::Look(ONE)));
    send(&mut harness, Command::Fresh);
    assert_eq!((harness.state().slot(ONE).is_some(), harness.state().looked()), (true, None));
}
