//! The window, driven through its real state as by a person: every command, key and control.
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use weekender::app::{Command, Device, Show, Theme, Window};
use weekender::cli::{self, Request};
use weekender::output::{OutputFormat, read_description};
use weekender::progressive::{Plan, Progressive, Work};
use weekender::recipe::file;
use weekender::stages::Stage;

const PATIENCE: Duration = Duration::from_secs(60);

fn window(arguments: &str) -> Window {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    match cli::parse(words.map(Into::into)).unwrap() {
        Request::Window(options) => Window::new(*options, None).unwrap(),
        other => panic!("{arguments}: {other:?}"),
    }
}

fn open_sized(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    Harness::builder()
        .with_size(size)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, window: &mut Window| window.ui_in(ui), window(arguments))
}

fn open(arguments: &str) -> Harness<'static, Window> {
    let mut harness = open_sized(arguments, [1280.0, 1400.0]);
    harness.run_steps(2);
    harness
}

/// Draws frames until it is so.
fn until(harness: &mut Harness<'_, Window>, what: &str, is_so: impl Fn(&Window) -> bool) {
    let begin = Instant::now();
    while !is_so(harness.state()) {
        let state = harness.state();
        let phase = &state.status().phase;
        assert!(begin.elapsed() < PATIENCE, "never: {what}; {phase:?}; {:?}", state.messages());
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
}

fn has_samples(at_least: u64) -> impl Fn(&Window) -> bool {
    move |window| window.shown().is_some_and(|(samples, divisor)| samples >= at_least && divisor == 1)
}

fn send(harness: &mut Harness<'_, Window>, command: Command) {
    harness.state_mut().send(command);
    harness.run_steps(2);
}

/// The control of this name, not the text that says the name.
fn control<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
    let mut named = harness.get_all_by_label(name);
    named
        .find(|node| node.accesskit_node().role() != egui::Role::Label)
        .unwrap_or_else(|| panic!("no control {name}"))
}

const SMALL: &str = "--stage glass-schlick --size 32x18";

#[test]
fn every_command_is_carried_out_or_says_why_not() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        let useless = harness.state().useless(command);
        send(&mut harness, command);
        assert_eq!(harness.state().performed(), Some(command));
        let told = harness.state().messages();
        if let Some(reason) = useless {
            let end = &reason[1..];
            assert!(told.iter().any(|text| text.ends_with(end)), "{command:?}: {reason}; {told:?}");
        }
        harness.key_press(Key::Escape);
        harness.run_steps(2);
        assert!(!harness.state().has_dialog(), "{command:?}");
    }
}

#[test]
fn every_shortcut_reaches_its_command() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        let Some(shortcut) = command.shortcut() else { continue };
        harness.key_press_modifiers(shortcut.modifiers, shortcut.logical_key);
        harness.run_steps(2);
        assert_eq!(harness.state().performed(), Some(command), "{shortcut:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
}

#[test]
fn every_command_is_found_in_the_palette() {
    let mut harness = open(SMALL);
    for command in Command::all() {
        let is_useless = harness.state().useless(command).is_some();
        if command == Command::Palette || is_useless {
            continue;
        }
        harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
        harness.run_steps(3);
        harness.get_by_label("Command").type_text(&command.name());
        harness.run_steps(2);
        harness.key_press(Key::Enter);
        harness.run_steps(2);
        assert_eq!(harness.state().performed(), Some(command));
        harness.key_press(Key::Escape);
        harness.run_steps(2);
    }
}

#[test]
fn every_menu_lists_its_commands() {
    let mut harness = open(SMALL);
    for menu in ["File", "Edit", "View", "Render", "Help"] {
        control(&harness, menu).click();
        harness.run_steps(3);
        for command in Command::all().into_iter().filter(|command| command.group().name() == menu) {
            let name = command.name();
            assert!(harness.query_all_by_label_contains(&name).next().is_some(), "{menu}: {name}");
        }
        harness.key_press(Key::Escape);
        harness.run_steps(3);
    }
}

#[test]
fn every_stage_is_shown_with_its_text() {
    let mut harness = open("--stage ppm-tiny");
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        until(&mut harness, stage.id, |window| {
            window.document().stage() == Some(stage) && has_samples(1)(window)
        });
        assert!(harness.query_by_label(stage.what_is_new).is_some(), "{}", stage.id);
        assert!(harness.query_by_label(stage.look_for).is_some(), "{}", stage.id);
    }
    harness.key_press(Key::PageUp);
    harness.run_steps(2);
    assert_eq!(harness.state().document().stage(), Stage::ALL.iter().rev().nth(1));
}

#[test]
fn every_stage_is_compared_with_another() {
    let mut harness = open("--stage sky --size 32x18");
    harness.key_press(Key::C);
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        harness.state_mut().document_mut().settings.width = 32;
        harness.state_mut().document_mut().settings.height = 18;
        until(&mut harness, stage.id, |window| window.has_other_picture());
        assert!(harness.state().is_comparing());
    }
    harness.key_press(Key::X);
    harness.run_steps(5);
    harness.key_press(Key::X);
    harness.run_steps(2);
    assert!(!harness.state().is_comparing());
}

#[test]
fn sliders_change_the_picture_and_reset_brings_it_back() {
    let mut harness = open("--stage defocus --size 32x18");
    let before = harness.state().document().clone();
    control(&harness, "Field of view").set_value_accesskit(50.0);
    control(&harness, "Defocus angle").set_value_accesskit(3.0);
    control(&harness, "Focus distance").set_value_accesskit(2.0);
    harness.run_steps(2);
    let camera = harness.state().document().camera;
    assert_eq!(
        (camera.vfov_degrees, camera.defocus_angle_degrees, camera.focus_distance),
        (50.0, 3.0, Some(2.0))
    );
    for label in ["Look from x", "Look at y", "Up z", "Width", "Height", "Depth", "Seed"] {
        let value = control(&harness, label).accesskit_node().numeric_value().unwrap();
        control(&harness, label).set_value_accesskit(value + 1.0);
        harness.run_steps(2);
    }
    let document = harness.state().document();
    assert_eq!(document.camera.look_from.x, before.camera.look_from.x + 1.0);
    assert_eq!(document.camera.look_at.y, before.camera.look_at.y + 1.0);
    assert_eq!(document.camera.vup.z, before.camera.vup.z + 1.0);
    assert_eq!((document.settings.width, document.settings.height), (33, 19));
    assert_eq!(document.settings.max_depth, before.settings.max_depth + 1);
    assert_eq!(document.settings.seed, before.settings.seed + 1);
    for group in ["camera", "lens", "render"] {
        harness.get_by_label(&format!("Reset {group}")).click();
        harness.run_steps(2);
    }
    let origin = &harness.state().document().origin;
    assert_eq!(harness.state().document().camera, origin.recipe.camera);
    assert_eq!(harness.state().document().settings, origin.recipe.settings);
}

#[test]
fn check_boxes_and_lists_do_what_they_say() {
    let mut harness = open("--stage defocus --size 32x18");
    harness.get_by_label("Estimate error").click();
    harness.run_steps(2);
    assert!(!harness.state().document().settings.estimate_error);
    harness.get_by_label("Estimate error").click();
    harness.get_by_label("Focus on Look at").click();
    harness.run_steps(2);
    assert_eq!(harness.state().document().camera.focus_distance, None);
    for (label, choice) in [("Sampler", "independent"), ("Lanes", "1"), ("Threads", "1"), ("Device", "f64")] {
        control(&harness, label).click();
        harness.run_steps(3);
        harness.get_all_by_label(choice).last().unwrap().click();
        harness.run_steps(3);
    }
    assert_eq!(harness.state().document().settings.sampler.name(), "independent");
    let remembered = harness.state_mut().remembered_mut();
    assert_eq!(
        (remembered.lanes, remembered.threads, remembered.device),
        (Some(1), Some(1), Device::Reference)
    );
    for label in ["Samples", "Time", "Error"] {
        control(&harness, label).click();
        harness.run_steps(2);
    }
    let stop = harness.state().document().stop;
    assert!(stop.samples.is_some() && stop.seconds.is_some() && stop.noise.is_none(), "{stop:?}");
    harness.get_by_label("Reset stop").click();
    harness.run_steps(2);
    assert!(harness.state().document().stop.noise.is_some());
}

#[test]
fn what_has_no_effect_is_disabled() {
    let harness = open("--stage ppm-tiny");
    for label in ["Field of view", "Defocus angle", "Focus distance", "Depth", "Sampler", "Seed"] {
        assert!(control(&harness, label).accesskit_node().is_disabled(), "{label}");
    }
    let harness = open("--stage glass-schlick --size 32x18");
    assert!(control(&harness, "Focus distance").accesskit_node().is_disabled());
    assert!(!control(&harness, "Field of view").accesskit_node().is_disabled());
    for device in Device::ALL {
        let is_disabled =
            harness.get_by_label(&Command::Device(device).name()).accesskit_node().is_disabled();
        assert_eq!(is_disabled, device.unavailable().is_some(), "{device:?}");
    }
}

#[test]
fn another_device_goes_on_with_the_same_film() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    let (run, before) = (harness.state().status().run, harness.state().status().samples_per_pixel);
    send(&mut harness, Command::Device(Device::Reference));
    until(&mut harness, "two contributions", |window| window.status().contributions.len() == 2);
    let status = harness.state().status();
    assert_eq!(status.run, run);
    assert!(status.samples_per_pixel > before);
    let parts: u64 = status.contributions.iter().map(|part| part.samples_per_pixel).sum();
    assert_eq!(parts, status.samples_per_pixel);
    harness.state_mut().remembered_mut().lanes = Some(1);
    send(&mut harness, Command::Device(Device::Cpu));
    until(&mut harness, "three contributions", |window| window.status().contributions.len() == 3);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn a_pause_loses_nothing() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(8));
    harness.key_press(Key::Space);
    until(&mut harness, "a pause", |window| window.status().phase == weekender::progressive::Phase::Paused);
    let (run, samples) = (harness.state().status().run, harness.state().status().samples_per_pixel);
    std::thread::sleep(Duration::from_millis(60));
    harness.run_steps(3);
    assert_eq!(harness.state().status().samples_per_pixel, samples);
    harness.key_press(Key::Space);
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > samples);
    assert_eq!(harness.state().status().run, run);
}

fn middle(harness: &Harness<'_, Window>) -> Pos2 {
    harness.get_by_label("Picture").rect().center()
}

fn drag(harness: &mut Harness<'_, Window>, button: PointerButton, modifiers: Modifiers) {
    let start = middle(harness);
    let press = |pos: Pos2, pressed| egui::Event::PointerButton { pos, button, pressed, modifiers };
    harness.event(egui::Event::PointerMoved(start));
    harness.step();
    harness.event_modifiers(press(start, true), modifiers);
    harness.step();
    for step in 1..=10 {
        harness.event_modifiers(
            egui::Event::PointerMoved(start + egui::vec2(6.0, 3.0) * step as f32),
            modifiers,
        );
        harness.step();
    }
    harness.event_modifiers(press(start + egui::vec2(60.0, 30.0), false), modifiers);
    harness.step();
}

#[test]
fn drags_move_the_camera_and_undo_brings_it_back() {
    let mut harness = open("--stage view-distant");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    // The state has to stand still for a moment to be one that undo comes back to.
    harness.run_steps(90);

    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let orbited = harness.state().document().camera;
    assert_eq!(orbited.look_at, before.look_at);
    assert_ne!(orbited.look_from, before.look_from);
    until(&mut harness, "the full size", has_samples(1));

    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE);
    let looked = harness.state().document().camera;
    assert_eq!(looked.look_from, orbited.look_from);
    assert_ne!(looked.look_at, orbited.look_at);

    harness.key_press(Key::Home);
    harness.run_steps(2);
    assert_eq!(harness.state().document().camera, before);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera, before);

    let camera = harness.state().document().camera;
    drag(&mut harness, PointerButton::Primary, Modifiers::SHIFT);
    assert_eq!(harness.state().document().camera, camera, "the picture moves, not the camera");
}

#[test]
fn the_wheel_and_keys_move_and_clicks_aim() {
    let mut harness = open("--stage defocus");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    let at = middle(&harness);
    harness.event(egui::Event::PointerMoved(at));
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: egui::vec2(0.0, 2.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(20);
    let closer = harness.state().document().camera;
    assert!(closer.look_from.distance(closer.look_at) < before.look_from.distance(before.look_at));

    harness.key_down(Key::W);
    harness.run_steps(3);
    harness.key_up(Key::W);
    harness.run_steps(2);
    let flown = harness.state().document().camera;
    assert_ne!(flown.look_at, closer.look_at);

    let click = |harness: &mut Harness<'_, Window>, modifiers| {
        for pressed in [true, false] {
            let button = PointerButton::Primary;
            harness.event_modifiers(
                egui::Event::PointerButton { pos: at, button, pressed, modifiers },
                modifiers,
            );
            harness.step();
        }
    };
    click(&mut harness, Modifiers::NONE);
    let focused = harness.state().document().camera;
    assert_eq!(focused.look_at, flown.look_at);
    assert_ne!(focused.focus_distance, flown.focus_distance);
    click(&mut harness, Modifiers::NONE);
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera.look_at, focused.look_at, "a second click at once centres");

    harness.run_steps(60);
    click(&mut harness, Modifiers::ALT);
    until(&mut harness, "sixteen paths", |window| window.listed_paths() == 16);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Paths of pixel").is_some());
    let is_open = |harness: &Harness<'_, Window>, index: usize| {
        let header = control(harness, &format!("Path of sample {index}")).rect();
        let next = control(harness, &format!("Path of sample {}", index + 1)).rect();
        next.top() - header.bottom() > 40.0
    };
    harness.run_steps(30);
    assert!(is_open(&harness, 0) && !is_open(&harness, 1));
    harness.get_by_label("Path of the sample after").click();
    harness.run_steps(30);
    assert!(is_open(&harness, 1) && !is_open(&harness, 0));
    control(&harness, "Path of sample 3").click();
    harness.run_steps(30);
    assert!(is_open(&harness, 3) && !is_open(&harness, 1));
    control(&harness, "Paths listed").set_value_accesskit(64.0);
    until(&mut harness, "sixty-four paths", |window| window.listed_paths() == 64);
    control(&harness, "Paths listed").set_value_accesskit(1000.0);
    harness.run_steps(3);
    assert_eq!(harness.state().listed_paths(), 64, "no more than that");
    harness.state_mut().document_mut().settings.seed += 1;
    until(&mut harness, "the paths of another seed", |window| window.listed_paths() == 64);
    // The list may still change, and with it the button's place.
    harness.get_by_label("Clear paths").click_accesskit();
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("Paths of pixel").is_none());
}

/// Saves through the path box and waits for the file.
fn save(harness: &mut Harness<'_, Window>, format: OutputFormat, path: &Path) {
    send(harness, Command::Save(format));
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_label("File name").type_text(path.to_str().unwrap());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    let saved = format!("Saved {}", path.display());
    until(harness, &saved, |window| window.messages().contains(&saved));
}

/// The bytes of the picture that a file's recipe gives with as many samples as it says.
fn rendered_again(path: &Path) -> Vec<u8> {
    let description = read_description(path).unwrap();
    let recipe = file::parse(description.recipe(), "again").unwrap();
    let samples = description.get("Samples").unwrap().parse().unwrap();
    let mut progressive = Progressive::spawn().unwrap();
    let job = recipe.job().unwrap();
    let backend = weekender::backends::BackendChoice::fallback();
    progressive.start(Work::new(job, backend, Plan::samples(samples)));
    progressive.wait_until_over();
    progressive.finish().unwrap().to_rgb8(recipe.rules.transfer)
}

#[test]
fn what_is_saved_is_the_film_and_can_be_opened_again() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open("--stage defocus --size 48x27 --samples 40");
    harness.state_mut().document_mut().camera.vfov_degrees = 31.0;
    harness.run_steps(2);
    until(&mut harness, "the end", has_samples(40));
    let shown = harness.state().document().clone();
    for format in OutputFormat::ALL {
        let path = directory.path().join(format!("saved{}", format.ending()));
        save(&mut harness, format, &path);
        if format != OutputFormat::Exr {
            let pixels = image::open(&path).unwrap().to_rgb8().into_raw();
            assert!(pixels == rendered_again(&path), "{format:?} differs from a render of its recipe");
        }
        send(&mut harness, Command::Stage(&Stage::ALL[0]));
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
        let opened = format!("Opened {}", path.display());
        until(&mut harness, &opened, |window| window.messages().contains(&opened));
        let document = harness.state().document();
        assert_eq!(document.stage(), shown.stage());
        assert_eq!((document.camera, document.settings), (shown.camera, shown.settings));
        until(&mut harness, "forty samples", has_samples(40));
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn failures_are_told_in_words() {
    let directory = tempfile::tempdir().unwrap();
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    for (name, content, told) in [
        ("missing.png", None, "cannot read"),
        ("broken.png", Some("nothing of the kind"), "does not say how it was made"),
        ("broken.toml", Some("[camera"), "broken.toml"),
        ("broken.exr", Some("nothing"), "is no EXR file"),
    ] {
        let path = directory.path().join(name);
        if let Some(content) = content {
            std::fs::write(&path, content).unwrap();
        }
        harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
        until(&mut harness, told, |window| window.messages().iter().any(|text| text.contains(told)));
    }
    let document = harness.state().document();
    assert_eq!(document.stage().unwrap().id, "glass-schlick", "what was shown stays");

    send(&mut harness, Command::Save(OutputFormat::Png));
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    harness.get_by_label("File name").type_text(directory.path().join("no/such/place.png").to_str().unwrap());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    until(&mut harness, "refused", |window| {
        window.messages().iter().any(|text| text.starts_with("Not saved"))
    });
}

#[test]
fn the_command_is_copied() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    harness.state_mut().send(Command::CopyCommand);
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.unwrap();
    assert!(
        copied.starts_with("weekender --batch --stage=glass-schlick --size=32x18 --samples="),
        "{copied}"
    );
}

#[test]
fn bookmarks_bring_the_camera_back() {
    let mut harness = open(SMALL);
    let before = harness.state().document().camera;
    send(&mut harness, Command::AddBookmark);
    harness.state_mut().document_mut().camera.vfov_degrees = 12.0;
    harness.run_steps(2);
    harness.get_by_label("Go to").click();
    harness.run_steps(3);
    harness.get_by_label("glass-schlick 1").click();
    harness.run_steps(2);
    assert_eq!(harness.state().document().camera, before);
}

#[test]
fn tab_hides_the_panels_and_they_fold_one_by_one() {
    let mut harness = open(SMALL);
    assert!(harness.query_all_by_label("Field of view").next().is_some());
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(
        harness.query_all_by_label("Field of view").next().is_none()
            && harness.query_by_label("File").is_none()
    );
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(harness.query_all_by_label("Field of view").next().is_some());
    harness.key_press(Key::L);
    harness.run_steps(3);
    assert!(
        harness.query_all_by_label("Field of view").next().is_none()
            && harness.query_by_label("Pixel").is_some()
    );
    harness.key_press(Key::I);
    harness.run_steps(3);
    assert!(harness.query_by_label("Pixel").is_none());
}

/// A picture of the whole window. Figures that change from run to run are covered.
fn snapshot(name: &str, theme: Theme, size: [f32; 2], scale: f32) {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_pixels_per_point(scale)
        .with_step_dt(1.0 / 60.0)
        .wgpu()
        .build_ui_state(
            |ui, window: &mut Window| window.ui_in(ui),
            window("--stage glass-schlick --size 240x135 --samples 64"),
        );
    send(&mut harness, Command::Theme(theme));
    until(&mut harness, "the end", has_samples(64));
    until(&mut harness, "the stop", |window| {
        matches!(window.status().phase, weekender::progressive::Phase::Done(_))
    });
    harness.run_steps(10);
    let status_height = if size[0] < 900.0 { 74.0 } else { 33.0 };
    let status =
        egui::Rect::from_min_max(egui::pos2(0.0, size[1] - status_height), egui::pos2(size[0], size[1]));
    harness.mask(status);
    // Fonts and edges differ a little from adapter to adapter.
    let options = egui_kittest::SnapshotOptions::new().threshold(2.0).max_failed_pixels(400_usize);
    harness.snapshot_options(name, &options);
}

#[test]
fn the_dark_window_looks_as_it_did() {
    snapshot("window_dark", Theme::Dark, [1280.0, 800.0], 1.0);
}

#[test]
fn the_light_window_looks_as_it_did() {
    snapshot("window_light", Theme::Light, [1280.0, 800.0], 1.0);
}

#[test]
fn at_twice_the_font_size_it_looks_as_it_did() {
    snapshot("window_twice_the_font", Theme::Dark, [640.0, 400.0], 2.0);
}

/// Everything that a command or a control can change.
fn state_of(harness: &mut Harness<'_, Window>) -> String {
    let nodes: Vec<_> =
        harness.root().children_recursive().map(|node| node.accesskit_node().toggled()).collect();
    let window = harness.state_mut();
    let remembered = format!("{:?}", window.remembered_mut());
    let document = window.document();
    let stage = document.stage().map(|stage| stage.id);
    format!(
        "{stage:?} {:?} {:?} {:?} {remembered} {:?} {:?} {:?} {:?} {nodes:?}",
        document.camera,
        document.settings,
        document.stop,
        window.show(),
        window.is_comparing(),
        window.is_paused(),
        window.has_dialog(),
    )
}

#[test]
fn every_control_changes_something() {
    use egui::accesskit::Role;
    let opened = || {
        let mut harness = open("--stage defocus --size 32x18 --samples 4000000000");
        until(&mut harness, "a picture", has_samples(1));
        harness.run_steps(3);
        harness
    };
    let is_control = |role| {
        matches!(role, Role::Button | Role::Slider | Role::SpinButton | Role::CheckBox | Role::ComboBox)
    };
    let harness = opened();
    let controls: Vec<(String, Role)> = harness
        .root()
        .children_recursive()
        .map(|node| node.accesskit_node())
        .filter(|node| is_control(node.role()) && !node.is_disabled())
        .map(|node| (node.label().unwrap_or_default(), node.role()))
        .collect();
    assert!(controls.len() > 45, "{controls:?}");
    let mut harness = opened();
    for (name, role) in controls {
        assert!(!name.is_empty(), "a {role:?} without a name");
        // What says which of several is chosen changes nothing when it is the chosen one.
        if name == Command::Device(Device::Cpu).name() {
            continue;
        }
        // What only writes to the clipboard or the disk is tried elsewhere.
        if name == "Copy as command" {
            continue;
        }
        let before = state_of(&mut harness);
        let is_it = |node: &Node<'_>| {
            let node = node.accesskit_node();
            node.role() == role && node.label().unwrap_or_default() == name
        };
        let node =
            harness.root().children_recursive().find(is_it).unwrap_or_else(|| panic!("{name} has gone"));
        match role {
            Role::Slider | Role::SpinButton => {
                let value = node.accesskit_node().numeric_value().unwrap_or_default();
                node.set_value_accesskit(value + 1.0);
            }
            _ => node.click_accesskit(),
        }
        harness.run_steps(4);
        assert_ne!(state_of(&mut harness), before, "{role:?} {name}");
        harness = opened();
    }
}

/// What a command has to have changed, given the window as it was.
fn is_done(command: Command, before: &weekender::app::Document, harness: &mut Harness<'_, Window>) -> bool {
    let copied =
        harness.output().platform_output.commands.iter().any(
            |output| matches!(output, egui::OutputCommand::CopyText(text) if text.starts_with("weekender")),
        );
    let window = harness.state_mut();
    let remembered = window.remembered_mut().clone();
    let document = window.document();
    match command {
        Command::Open
        | Command::Save(_)
        | Command::SaveScene
        | Command::LoadReference
        | Command::Palette
        | Command::Help => window.has_dialog(),
        Command::CopyCommand => copied || window.messages().iter().any(|text| text.starts_with("Copied")),
        Command::Undo | Command::Redo | Command::Home | Command::ResetAll => {
            document.camera != before.camera || document.settings != before.settings
        }
        Command::AddBookmark => remembered.bookmarks.len() == 1,
        Command::Show(show) => window.show() == show,
        Command::Wipe | Command::WipeDifference => window.is_comparing(),
        Command::Panels => !remembered.has_panels,
        Command::Controls => !remembered.has_controls,
        Command::Info => !remembered.has_info,
        Command::Plot => remembered.has_plot,
        Command::Theme(theme) => remembered.theme == theme,
        Command::Pause => window.is_paused(),
        Command::Restart => window.status().run > 1,
        Command::SwitchDevice => remembered.device == Device::Gpu,
        Command::Device(device) => remembered.device == device,
        Command::PreviousStage => document.stage() == before.stage().and_then(|stage| stage.previous()),
        Command::NextStage => document.stage() == before.stage().and_then(|stage| stage.next()),
        Command::Stage(stage) => document.stage() == Some(stage),
        // The next two are the window system's, the others the viewport's, which has tests of its own.
        Command::Quit | Command::Book | Command::FullScreen => true,
        Command::Fit | Command::ActualSize | Command::ZoomIn | Command::ZoomOut => true,
    }
}

#[test]
fn every_command_does_what_it_says() {
    for command in Command::all() {
        let mut harness = open(SMALL);
        until(&mut harness, "a picture", has_samples(1));
        // Something to take back, and something to make again.
        if matches!(command, Command::Undo | Command::Redo | Command::Home | Command::ResetAll) {
            harness.run_steps(90);
            harness.state_mut().document_mut().camera.vfov_degrees = 33.0;
            harness.run_steps(90);
        }
        if command == Command::Redo {
            send(&mut harness, Command::Undo);
        }
        if harness.state().useless(command).is_some() {
            continue;
        }
        let before = harness.state().document().clone();
        harness.state_mut().send(command);
        harness.step();
        assert!(is_done(command, &before, &mut harness), "{command:?}");
    }
}

#[test]
fn zoom_commands_change_what_is_seen_and_not_the_picture() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    let (fitting, run) = (harness.state().picture_rect(), harness.state().status().run);
    send(&mut harness, Command::ActualSize);
    let actual = harness.state().picture_rect();
    assert_eq!(actual.size(), egui::vec2(32.0, 18.0));
    send(&mut harness, Command::ZoomIn);
    assert_eq!(harness.state().picture_rect().size(), actual.size() * 1.25);
    send(&mut harness, Command::ZoomOut);
    assert!((harness.state().picture_rect().width() - actual.width()).abs() < 1e-3);
    send(&mut harness, Command::Fit);
    assert_eq!(harness.state().picture_rect(), fitting);
    assert_eq!(harness.state().status().run, run);
}

#[test]
fn views_are_shown_and_follow_the_camera() {
    let mut harness = open("--stage defocus --size 64x36");
    until(&mut harness, "a picture", has_samples(2));
    for show in [Show::Normals, Show::Albedo, Show::Bounces] {
        send(&mut harness, Command::Show(show));
        until(&mut harness, "sixteen samples", |window| window.layer_samples() == 16);
        harness.state_mut().document_mut().camera.vfov_degrees += 1.0;
        harness.run_steps(2);
        until(&mut harness, "the moved layer", |window| window.layer_samples() == 16);
        assert_eq!(harness.state().show(), show);
    }
    for show in [Show::Occupancy, Show::Error] {
        send(&mut harness, Command::Show(show));
        assert_eq!((harness.state().show(), harness.state().layer_samples()), (show, 0));
    }
    // A stage that sends no rays has no such views: it says so and shows its picture.
    send(&mut harness, Command::Show(Show::Albedo));
    send(&mut harness, Command::Stage(&Stage::ALL[0]));
    harness.run_steps(2);
    assert_eq!(harness.state().show(), Show::Picture);
    assert!(harness.state().messages().iter().any(|text| text.starts_with("No albedo here")));
    send(&mut harness, Command::Show(Show::Bounces));
    assert_eq!(harness.state().show(), Show::Picture);
}

#[test]
fn a_pause_outlasts_a_move_of_the_camera() {
    let mut harness = open("--stage glass-schlick --size 64x36 --samples 4000000000");
    until(&mut harness, "samples", has_samples(16));
    harness.key_press(Key::Space);
    until(&mut harness, "a pause", |window| window.status().phase == weekender::progressive::Phase::Paused);
    let run = harness.state().status().run;
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    until(&mut harness, "the moved picture", |window| {
        window.status().run > run && window.shown() == Some((8, 1)) && window.status().phase.is_over()
    });
    std::thread::sleep(Duration::from_millis(60));
    harness.run_steps(5);
    assert!(harness.state().is_paused());
    assert_eq!(harness.state().status().samples_per_pixel, 8, "it waits");
    let run = harness.state().status().run;
    harness.key_press(Key::Space);
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > 8);
    assert_eq!(harness.state().status().run, run, "the same film goes on");
}

#[test]
fn controls_take_no_value_that_cannot_be() {
    let mut harness = open("--stage defocus --size 32x18");
    let values = [0.0, -1.0, 1e-300, 180.0, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let names =
        ["Field of view", "Defocus angle", "Focus distance", "Look from x", "Up y", "Width", "Depth", "Seed"];
    for name in names {
        for value in values {
            control(&harness, name).set_value_accesskit(value);
            harness.run_steps(2);
            let document = harness.state().document();
            let outcome = document.job(1);
            assert!(outcome.is_ok(), "{name} {value}: {}", outcome.unwrap_err());
        }
    }
    for name in ["Samples", "Time"] {
        control(&harness, name).click();
        harness.run_steps(2);
    }
    for name in ["Samples limit", "Time limit", "Error limit"] {
        for value in values {
            control(&harness, name).set_value_accesskit(value);
            harness.run_steps(2);
            let stop = harness.state().document().stop;
            assert!(stop.samples.is_none_or(|samples| samples >= 1), "{name} {value}: {stop:?}");
            assert!(
                stop.seconds.is_none_or(|seconds| (0.1..=1e6).contains(&seconds)),
                "{name} {value}: {stop:?}"
            );
            assert!(stop.noise.is_none_or(|noise| (1e-6..=1.0).contains(&noise)), "{name} {value}: {stop:?}");
        }
    }
}

/// What eframe keeps in a file.
#[derive(Default)]
struct Storage(std::collections::HashMap<String, String>);

impl eframe::Storage for Storage {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn settings_are_remembered() {
    let options = |arguments: &str| match cli::parse(arguments.split_whitespace().map(Into::into)).unwrap() {
        Request::Window(options) => *options,
        other => panic!("{other:?}"),
    };
    let mut harness = open(SMALL);
    for command in [
        Command::Theme(Theme::Light),
        Command::Plot,
        Command::Info,
        Command::Device(Device::Reference),
        Command::AddBookmark,
    ] {
        send(&mut harness, command);
    }
    harness.state_mut().remembered_mut().threads = Some(1);
    let mut storage = Storage::default();
    eframe::App::save(harness.state_mut(), &mut storage);
    let kept = harness.state_mut().remembered_mut().clone();

    let mut again = Window::new(options("weekender --stage metal"), Some(&storage)).unwrap();
    assert_eq!(*again.remembered_mut(), kept);
    assert_eq!((kept.theme, kept.has_plot, kept.has_info), (Theme::Light, true, false));
    assert_eq!((kept.device, kept.bookmarks.len(), kept.threads), (Device::Reference, 1, Some(1)));
    // What the command line says goes before what is remembered.
    let mut told = Window::new(options("weekender --stage metal --device cpu"), Some(&storage)).unwrap();
    assert_eq!(told.remembered_mut().device, Device::Cpu);
    // What cannot be read is as if there were nothing.
    storage.0.values_mut().for_each(|value| *value = "(theme: Purple)".to_owned());
    let mut fresh = Window::new(options("weekender --stage metal"), Some(&storage)).unwrap();
    assert_eq!(fresh.remembered_mut().theme, Theme::System);
}

#[test]
fn escape_leaves_a_control_before_tab_hides_the_panels() {
    let mut harness = open(SMALL);
    control(&harness, "Seed").focus();
    harness.run_steps(2);
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert!(harness.state_mut().remembered_mut().has_panels, "Tab goes to the next control");
    send(&mut harness, Command::FullScreen);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(harness.state().performed(), Some(Command::FullScreen));
    assert!(harness.state().is_full_screen(), "the first Escape leaves the control");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().is_full_screen());
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    assert!(!harness.state_mut().remembered_mut().has_panels);
}
