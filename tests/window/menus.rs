//! The menus of a right click on the picture.

use crate::common::{has_samples, middle, open, until};
use eframe::egui::{self, Modifiers, PointerButton};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use weekender::app::Window;

/// Opens the menu in the middle of the picture.
fn open_menu(harness: &mut Harness<'_, Window>) {
    let pos = middle(harness);
    harness.event(egui::Event::PointerMoved(pos));
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(5);
}

/// The entry of the open menu whose text begins so; panels may have a button of the same name.
fn entry<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
    let picture = harness.get_by_label("Picture").rect();
    let mut named = harness.get_all_by_label_contains(name);
    let entry = named.find(|node| {
        node.accesskit_node().role() == egui::Role::Button && picture.contains(node.rect().center())
    });
    entry.unwrap_or_else(|| panic!("no {name} in the menu"))
}

#[test]
fn a_picture_without_rays_offers_nothing_of_what_is_there() {
    let mut harness = open("--stage ppm-tiny");
    until(&mut harness, "a picture", has_samples(1));
    open_menu(&mut harness);
    for name in [
        "Select this",
        "Focus on this",
        "Look at this",
        "List the paths of this pixel",
        "Add a sphere here",
        "Bookmark this camera",
    ] {
        assert!(entry(&harness, name).accesskit_node().is_disabled(), "{name}");
    }
    assert!(!entry(&harness, "Crop…").accesskit_node().is_disabled());
}
