//! Every control of the panels: what it changes, and its tip.

use super::golden::{Golden, changes};
use super::{Harnessed, busy, finished, known, point, without_divider};
use eframe::egui::{self, Role};
use egui_kittest::kittest::{NodeT, Queryable};

/// The controls on the screen: their names, their roles, and the number among those of the same name and role.
fn controls(harness: &Harnessed) -> Vec<(String, Role, usize)> {
    let mut found: Vec<(String, Role, usize)> = Vec::new();
    for node in harness.root().children_recursive() {
        let node = node.accesskit_node();
        let role = node.role();
        let is_control = matches!(
            role,
            Role::Button
                | Role::Slider
                | Role::SpinButton
                | Role::CheckBox
                | Role::ComboBox
                | Role::RadioButton
        );
        // Messages come and go.
        let is_of_message = node.label().is_some_and(|label| label == "×");
        if is_control && !is_of_message {
            let name = node.label().unwrap_or_default();
            let same = found.iter().filter(|(other, of, _)| (other, *of) == (&name, role)).count();
            found.push((name, role, same));
        }
    }
    found
}

fn find<'h>(
    harness: &'h Harnessed,
    (name, role, place): &(String, Role, usize),
) -> Option<egui_kittest::Node<'h>> {
    let is_it = |node: &egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        node.role() == *role && node.label().unwrap_or_default() == *name
    };
    harness.root().children_recursive().filter(is_it).nth(*place)
}

fn title((name, role, place): &(String, Role, usize)) -> String {
    if *place == 0 { format!("{role:?} {name}") } else { format!("{role:?} {name}, no. {}", place + 1) }
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn controls_change_what_is_stored() {
    let mut golden = Golden::open("controls.txt");
    let before = without_divider(&known(&mut busy()));
    for named in controls(&busy()) {
        // Other devices depend on the machine.
        if named.0.contains("GPU") || ["Both", "Device"].contains(&named.0.as_str()) {
            continue;
        }
        let mut harness = busy();
        let Some(node) = find(&harness, &named) else { continue };
        if node.accesskit_node().is_disabled() {
            continue;
        }
        match named.1 {
            Role::Slider | Role::SpinButton => {
                let value = node.accesskit_node().numeric_value().unwrap_or_default();
                node.set_value_accesskit(value + 1.0);
            }
            _ => node.click_accesskit(),
        }
        harness.run_steps(3);
        golden.expect(&title(&named), || changes(&before, &without_divider(&known(&mut harness)), 8));
    }
    golden.finish();
}

/// The text of the tip that is shown.
fn tip(harness: &Harnessed) -> String {
    let words = |node: egui_kittest::Node<'_>| {
        node.children_recursive().filter_map(|node| node.value()).collect::<Vec<_>>().join(" | ")
    };
    let tips: Vec<String> = harness.query_all_by_role(egui::Role::Tooltip).map(words).collect();
    tips.join(" && ").replace('\n', "|")
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn tips_say_what_is_stored() {
    let mut golden = Golden::open("tips.txt");
    for (state, mut harness) in [("busy", busy()), ("no rays", finished("ppm-tiny"))] {
        harness.ctx.all_styles_mut(|style| {
            style.interaction.tooltip_delay = 0.0;
            style.interaction.tooltip_grace_time = 0.0;
        });
        harness.run_steps(10);
        let mut all = String::new();
        for named in controls(&harness) {
            let Some(node) = find(&harness, &named) else { continue };
            let at = node.rect().center();
            if !harness.ctx.content_rect().contains(at) || named.0.contains("GPU") {
                continue;
            }
            point(&mut harness, at);
            harness.run_steps(9);
            all += &super::dump::steady(&format!("{}: {}", title(&named), tip(&harness)));
            all.push('\n');
        }
        golden.expect(state, || all.clone());
    }
    golden.finish();
}
