//! Extreme scenes, and the switch to the book's arithmetic.

use crate::harness::{has_samples, open, send, until};
use crate::questions::Ask as _;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Partner};
use weekender::measure::stress::shown_cases;

fn make_small(harness: &mut egui_kittest::Harness<'_, weekender::app::Window>) {
    harness.state_mut().document_mut().give_size([30, 20]);
}

#[test]
fn extreme_scenes_say_what_to_watch_and_wipe_against_the_book() {
    let mut harness = open("--stage sky --size 30x20");
    for case in shown_cases() {
        send(&mut harness, Command::Extreme(case));
        make_small(&mut harness);
        until(&mut harness, &case.id, |window| {
            window.shown_document().case() == Some(case) && has_samples(1)(window)
        });
        assert!(harness.query_all_by_label_contains(&case.claim.look_for).next().is_some(), "{}", case.id);
    }
    assert_eq!(harness.state().partner(), Some(Partner::Book));
    send(&mut harness, Command::Wipe);
    assert!(harness.state().is_comparing());
    until(&mut harness, "the book's picture", |window| window.has_other_picture());
    send(&mut harness, Command::Wipe);
    assert!(!harness.state().is_comparing());
}
