//! The menu of a right click on the picture.

use crate::common::{has_samples, middle, open, until};
use eframe::egui::{self, Modifiers, PointerButton};
use egui_kittest::kittest::Queryable;

#[test]
fn the_menu_offers_what_is_there() {
    for (arguments, has_sphere) in [("--stage ppm-tiny", false), ("--stage metal --size 32x18", true)] {
        let mut harness = open(arguments);
        until(&mut harness, "a picture", has_samples(1));
        let pos = middle(&harness);
        harness.event(egui::Event::PointerMoved(pos));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
            harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
            harness.step();
        }
        harness.run_steps(5);
        assert!(harness.query_by_label_contains("Copy picture").is_some(), "{arguments}");
        assert_eq!(harness.query_by_label_contains("Focus on it").is_some(), has_sphere, "{arguments}");
    }
}
