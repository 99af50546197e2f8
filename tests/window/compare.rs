//! One picture, traced by two devices.

use crate::common::gpu::has_adapter;
use crate::harness::{has_samples, open_sized, send, sized, until, window_of_new_user};
use crate::questions::Ask as _;
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Device, Partner, Window};

const ARGUMENTS: &str = "--stage glass-schlick --size 64x36 --device cpu";

/// The first number after these words, in a text of the window.
fn number_after(harness: &Harness<'_, Window>, words: &str) -> Option<f64> {
    let texts = harness.query_all_by_label_contains(words);
    let text = texts.filter_map(|node| node.accesskit_node().value()).next()?;
    let (_, after) = text.split_once(words)?;
    after.trim().split(' ').next()?.parse().ok()
}

/// Both have ended with the same samples; the one that was ahead sets their number.
fn are_both_over(window: &Window) -> bool {
    let (status, Some(other)) = (window.status(), window.other_status()) else { return false };
    let are_equal = status.samples_per_pixel == other.samples_per_pixel;
    are_equal && other.phase.is_over() && status.phase.is_over() && window.has_other_picture()
}

/// The figures in the window are those of the renderers, with two digits.
fn check_figures(harness: &mut Harness<'_, Window>, [mine, other]: [&str; 2]) {
    until(harness, "both ends", are_both_over);
    // A verdict on fewer samples goes first.
    harness.run_steps(3);
    until(harness, "a verdict", |window| window.verdict().is_some());
    let state = harness.state();
    let (status, of_other) = (state.status().clone(), state.other_status().unwrap());
    assert_eq!((status.contributions.len(), of_other.contributions.len()), (1, 1));
    let speeds = [status.rays_per_second(), of_other.rays_per_second()];
    for (name, speed) in [(mine, speeds[0]), (other, speeds[1])] {
        let shown =
            number_after(harness, &format!("{name}:")).unwrap_or_else(|| panic!("no speed of {name}"));
        assert!((1e6 * shown / speed - 1.0).abs() < 0.06, "{name}: {shown} {speed}");
    }
    let faster = if speeds[0] >= speeds[1] { mine } else { other };
    let factor = number_after(harness, &format!("{faster} is")).unwrap();
    let expected = speeds[0].max(speeds[1]) / speeds[0].min(speeds[1]);
    assert!((factor / expected - 1.0).abs() < 0.06, "{factor} {expected}");
    let (is_equal, words) = harness.state().verdict().unwrap();
    assert!(is_equal && ["Equal to the bit.", "Only rounding."].contains(&words), "{words}");
}

#[test]
fn two_devices_are_compared_in_numbers() {
    for (goal, other) in [("--samples 32", Device::Reference), ("--noise-target 0.02", Device::Gpu)] {
        if other == Device::Gpu && !has_adapter() {
            continue;
        }
        let mut harness = open_sized(&format!("{ARGUMENTS} {goal}"), [1280.0, 800.0]);
        until(&mut harness, "a picture", has_samples(1));
        match other {
            Device::Gpu => {
                harness.key_press_modifiers(eframe::egui::Modifiers::SHIFT, Key::C);
                harness.run_steps(3);
            }
            _ => send(&mut harness, Command::CompareWith(Partner::Device(other))),
        }
        let label = if other == Device::Gpu { "GPU" } else { "Reference" };
        check_figures(&mut harness, ["CPU", label]);
        // The other one continues to the next goal, and both again have the same samples.
        let before = harness.state().status().samples_per_pixel;
        send(&mut harness, Command::Pause);
        until(&mut harness, "more samples", |window| window.status().samples_per_pixel > before);
        check_figures(&mut harness, ["CPU", label]);
    }
}

/// The dock that opens takes room from the picture, but not its samples.
#[test]
fn the_film_stays_when_devices_are_compared() {
    let window = window_of_new_user("--stage glass-schlick --device cpu --samples 32");
    let mut harness = sized(window, [1000.0, 700.0]);
    until(&mut harness, "the end", |window| window.status().phase.is_over() && has_samples(32)(window));
    harness.run_steps(3);
    let run = harness.state().status().run;
    send(&mut harness, Command::CompareWith(Partner::Device(Device::Reference)));
    harness.run_steps(60);
    until(&mut harness, "both ends", are_both_over);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn a_switch_of_the_device_swaps_the_sides() {
    let mut harness = open_sized(&format!("{ARGUMENTS} --samples 32"), [1280.0, 800.0]);
    send(&mut harness, Command::CompareWith(Partner::Device(Device::Reference)));
    send(&mut harness, Command::Reference);
    assert_eq!(harness.state().partner(), Some(Partner::Device(Device::Cpu)));
    until(&mut harness, "both ends", are_both_over);
    let other = harness.state().other_status().unwrap();
    assert_eq!(other.contributions[0].backend.name, "cpu");
}

#[test]
fn another_stage_brings_its_own_partner() {
    let mut harness = open_sized(ARGUMENTS, [1280.0, 800.0]);
    let usual = harness.state().partner();
    send(&mut harness, Command::CompareWith(Partner::Device(Device::Reference)));
    send(&mut harness, Command::PreviousStage);
    assert_eq!(
        harness.state().partner(),
        Some(Partner::Device(Device::Reference)),
        "while it is compared with"
    );
    send(&mut harness, Command::Wipe);
    send(&mut harness, Command::NextStage);
    assert_eq!(harness.state().partner(), usual);
}
