//! The screen in many states. The usual one is stored whole, and of the others, what differs from it.

use super::dump::{self, Places};
use super::golden::{Golden, changes};
use super::{Harnessed, STEADY, busy, done, finished, give, known, open, point, press};
use crate::common::{control, middle, opened, until, window, window_of_new_user};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Device, Show, SlotCommand, SlotNumber, Theme, Window};
use weekender::output::OutputFormat;

fn sized(arguments: &str, size: [f32; 2]) -> Harnessed {
    let window = window(arguments);
    let harness = Harness::builder()
        .with_size(size)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, window: &mut Window| window.ui_in(ui), window);
    done(Harnessed(Some(harness)))
}

fn whole(harness: &mut Harnessed) -> String {
    harness.step();
    dump::screen(harness, Places::Yes)
}

fn shown(harness: &mut Harnessed) -> String {
    harness.step();
    dump::screen(harness, Places::No)
}

/// The most lines that are stored of a difference.
const LIMIT: usize = 44;

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn screens_are_as_stored() {
    let mut golden = Golden::open("screens.txt");
    let mut harness = finished("glass-schlick");
    golden.expect("the usual window", || whole(&mut harness));
    let usual = shown(&mut harness);
    for size in [[480.0, 320.0], [800.0, 600.0], [1920.0, 1080.0]] {
        let mut harness = sized(&format!("--stage glass-schlick {STEADY}"), size);
        golden
            .expect(&format!("{} by {}", size[0], size[1]), || changes(&usual, &shown(&mut harness), LIMIT));
    }
    for stage in ["ppm-tiny", "defocus", "book", "red-sphere", "diffuse"] {
        let arguments = format!("--stage {stage} --size 32x18 --samples 1 --isa portable --threads 1");
        let mut harness = open(&arguments);
        until(&mut harness, "the end", |window| window.status().phase.is_over());
        golden.expect(&format!("stage {stage}"), || changes(&usual, &shown(&mut harness), LIMIT));
    }
    for command in [
        Command::Plot,
        Command::Packet,
        Command::Code,
        Command::Controls,
        Command::Info,
        Command::Panels,
        Command::Gizmo,
        Command::Crop,
        Command::WipeDifference,
        Command::Show(Show::Normals),
        Command::Show(Show::Error),
        Command::Show(Show::Luminance),
        Command::Brighter,
        Command::Present,
        Command::ShowMe,
        Command::Palette,
        Command::Help,
        Command::Open,
        Command::Save(OutputFormat::Png),
        Command::LoadReference,
        Command::FirstSteps,
        Command::Stages,
        Command::NextSphere,
        Command::Pause,
        Command::Theme(Theme::Light),
    ] {
        let mut harness = finished("glass-schlick");
        give(&mut harness, command);
        harness.run_steps(4);
        golden.expect(&format!("{command:?}"), || changes(&usual, &shown(&mut harness), LIMIT));
    }
    golden.finish();
}

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn what_is_drawn_is_as_stored() {
    let mut golden = Golden::open("drawn.txt");
    let mut harness = finished("defocus");
    let usual = whole(&mut harness);
    let drawn = |text: &str| -> String {
        text.lines()
            .filter(|line| line.starts_with("over ") || line.starts_with("drawn "))
            .fold(String::new(), |all, line| all + line + "\n")
    };
    let before = drawn(&usual);
    golden.expect("the usual window", || drawn(&whole(&mut harness)));
    for command in [
        Command::Gizmo,
        Command::WipeDifference,
        Command::Show(Show::Luminance),
        Command::Show(Show::Error),
        Command::NextSphere,
        Command::Present,
        Command::ShowMe,
        Command::Packet,
        Command::FirstSteps,
        Command::ActualSize,
        Command::Theme(Theme::Light),
        Command::Theme(Theme::Dark),
    ] {
        let mut harness = finished("defocus");
        give(&mut harness, command);
        harness.run_steps(4);
        golden.expect(&format!("{command:?}"), || changes(&before, &drawn(&whole(&mut harness)), LIMIT));
    }
    golden.finish();
}

/// States that several actions lead to.
#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn further_screens_are_as_stored() {
    let mut golden = Golden::open("further_screens.txt");
    let usual = shown(&mut finished("defocus"));
    let occupied = shown(&mut busy());
    golden.expect("a sphere selected, a slot, two bookmarks", || changes(&usual, &occupied, LIMIT));
    let mut state = |title: &str, mut harness: Harnessed| {
        golden.expect(title, || changes(&occupied, &shown(&mut harness), LIMIT));
    };
    let slot = |command| {
        let mut harness = busy();
        give(&mut harness, Command::Slot(command));
        harness.run_steps(4);
        harness
    };
    let mut harness = finished("lambertian-gamma");
    give(&mut harness, Command::ShowMe);
    state("a sight", harness);
    state("a slot looked at", slot(SlotCommand::Look(SlotNumber::ALL[0])));
    state("a wipe against a slot", slot(SlotCommand::Wipe));
    state("a difference from a slot", slot(SlotCommand::Difference));
    for (side, share) in [("left", 0.1), ("right", 0.9)] {
        let mut harness = slot(SlotCommand::Wipe);
        give(&mut harness, Command::Present);
        harness.run_steps(4);
        let rect = harness.state().picture_rect();
        point(&mut harness, rect.lerp_inside(vec2(share, 0.5)));
        state(&format!("the lens of a presentation at the {side} of a wipe"), harness);
    }
    let mut harness = slot(SlotCommand::Wipe);
    let center = harness.state().document().scene().spheres[1].center;
    harness.state_mut().document_mut().camera.look_from = center;
    state("a wipe from inside a sphere", done(harness));
    state("is it only noise", slot(SlotCommand::OnlyNoise));
    state("a slot deleted", slot(SlotCommand::Delete));
    state("a slot opened", slot(SlotCommand::Open));
    let mut harness = busy();
    let at = middle(&harness);
    point(&mut harness, at + vec2(40.0, 20.0));
    give(&mut harness, Command::ListPaths);
    state("paths are listed", harness);
    let mut harness = busy();
    control(&harness, "Lanes").click();
    harness.run_steps(5);
    control(&harness, "Sampler").click();
    harness.run_steps(5);
    state("a list of samplers", harness);
    for query in ["slot", "exr", "zzz", "5.2"] {
        let mut harness = busy();
        press(&mut harness, Key::P, Modifiers::COMMAND);
        harness.get_by_label("Command").type_text(query);
        harness.run_steps(4);
        state(&format!("the palette asked for {query}"), harness);
    }
    for menu in ["File", "Edit", "Camera", "Spheres", "View", "Slots", "Render", "Extreme scenes", "Help"] {
        let mut harness = busy();
        control(&harness, menu).click();
        harness.run_steps(4);
        state(&format!("the menu {menu}"), harness);
    }
    let mut harness = busy();
    harness.state_mut().document_mut().settings.max_depth = 0;
    harness.run_steps(4);
    state("a depth that cannot be", harness);
    let mut harness = busy();
    harness.state_mut().document_mut().camera.look_at = harness.state().document().camera.look_from;
    harness.run_steps(4);
    state("a camera that cannot be", harness);
    let mut harness = Harnessed(Some(opened(window_of_new_user("--isa portable --threads 1"))));
    give(&mut harness, Command::Pause);
    harness.run_steps(4);
    let known = known(&mut harness);
    golden.expect("what a new user has", || {
        let is_own = |line: &&str| line.contains("remembered") || line.contains("has_");
        known.lines().filter(is_own).fold(String::new(), |all, line| all + line + "\n")
    });
    let mut harness = finished("defocus");
    give(&mut harness, Command::Device(Device::Reference));
    give(&mut harness, Command::Restart);
    let mut harness = done(harness);
    golden.expect("traced by the reference", || changes(&usual, &shown(&mut harness), LIMIT));
    golden.finish();
}
