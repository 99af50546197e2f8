//! A window without a display, and helpers to use it.

use crate::questions::Ask as _;
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use weekender::app::{Command, Sizing, Window};
use weekender::cli::{self, Request};

/// Longer than a slow, busy machine takes.
const PATIENCE: Duration = Duration::from_secs(180);

/// The usual small picture.
pub const SMALL: &str = "--stage glass-schlick --size 32x18";

/// A window in which pictures have the size that they have in the book, so that they do not depend on the viewport.
pub fn window(arguments: &str) -> Window {
    let mut window = window_of_new_user(arguments);
    window.remembered_mut().sizing = Sizing::Book;
    window
}

/// A window with the settings that it has when it is opened for the first time.
pub fn window_of_new_user(arguments: &str) -> Window {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    match cli::parse(words.map(Into::into)).unwrap() {
        Request::Window(options) => Window::new(*options).unwrap(),
        other => panic!("{arguments}: {other:?}"),
    }
}

pub fn open_sized(arguments: &str, size: [f32; 2]) -> Harness<'static, Window> {
    sized(window(arguments), size)
}

/// A window of this size in points.
pub fn sized(window: Window, size: [f32; 2]) -> Harness<'static, Window> {
    scaled(window, size, 1.0)
}

/// A window of this size in points, each of which has `scale` pixels.
pub fn scaled(window: Window, size: [f32; 2], scale: f32) -> Harness<'static, Window> {
    Harness::builder()
        .with_size(size)
        .with_pixels_per_point(scale)
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, window: &mut Window| window.ui_in(ui), window)
}

pub fn open(arguments: &str) -> Harness<'static, Window> {
    opened(window(arguments))
}

/// A window after its first frames.
pub fn opened(window: Window) -> Harness<'static, Window> {
    let mut harness = sized(window, [1280.0, 1400.0]);
    harness.run_steps(2);
    harness
}

/// Draws frames until the condition holds.
pub fn until(harness: &mut Harness<'_, Window>, what: &str, is_so: impl Fn(&Window) -> bool) {
    let begin = Instant::now();
    while !is_so(harness.state()) {
        let state = harness.state();
        let (status, shown) = (state.status(), state.shown());
        let known = (status.run, &status.phase, status.samples_per_pixel, shown, state.listed_paths());
        assert!(begin.elapsed() < PATIENCE, "never: {what}; {known:?}; {:?}", state.messages());
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
}

/// Draws frames until there is a label that contains this text.
pub fn until_seen(harness: &mut Harness<'_, Window>, text: &str) {
    let begin = Instant::now();
    while harness.query_all_by_label_contains(text).next().is_none() {
        assert!(begin.elapsed() < PATIENCE, "never seen: {text}; {:?}", harness.state().messages());
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
}

/// The mean of a pixel, which the pointer asks for.
pub fn mean(harness: &mut Harness<'_, Window>, at: [u32; 2]) -> [f64; 3] {
    let (rect, size) = (harness.state().picture_rect(), harness.state().shown_document().size());
    let share = |axis: usize| (at[axis] as f32 + 0.5) / size[axis] as f32;
    harness.hover_at(rect.lerp_inside(vec2(share(0), share(1))));
    until(harness, "the pixel's value", |window| window.inspected().is_some_and(|(pixel, _)| pixel == at));
    for _ in 0..20 {
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
    harness.state().inspected().unwrap().1
}

/// The picture that a command for the clipboard holds, after at most this many frames.
pub fn copied(harness: &mut Harness<'_, Window>, patience: Duration) -> Option<egui::ColorImage> {
    let begin = Instant::now();
    while begin.elapsed() < patience {
        for command in &harness.output().platform_output.commands {
            if let egui::OutputCommand::CopyImage(image) = command {
                return Some(image.clone());
            }
        }
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
    None
}

/// Whether the screen shows the document's picture at full size with at least this many samples per pixel. After a change
/// that was undone this is still the picture of before, which says nothing about the new render.
pub fn has_samples(at_least: u64) -> impl Fn(&Window) -> bool {
    move |window| {
        let is_enough = |(samples, divisor)| samples >= at_least && divisor == 1;
        window.is_up_to_date() && window.shown().is_some_and(is_enough)
    }
}

/// Presses or releases the primary button at this point.
pub fn hold(harness: &mut Harness<'_, Window>, pos: Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    harness.event(egui::Event::PointerMoved(pos));
    harness.step();
    harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
    harness.step();
}

/// Gives a command that asks for a file, and types its path.
pub fn name_file(harness: &mut Harness<'_, Window>, command: Command, path: &Path) {
    send(harness, command);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.step();
    let is_saving = command == Command::Save;
    let field = if is_saving { "Name" } else { "File name" };
    control(harness, field).type_text(path.to_str().unwrap());
    harness.run_steps(2);
    harness.key_press(Key::Enter);
}

/// Saves with the dialog and waits for the file. The ending of its name chooses what is saved.
pub fn save(harness: &mut Harness<'_, Window>, command: Command, path: &Path) {
    name_file(harness, command, path);
    let saved = format!("Saved {}", path.file_name().unwrap().display());
    until(harness, &saved, says(&saved));
}

/// Chooses an entry of the menu of a right click at this point.
pub fn choose_from_menu(harness: &mut Harness<'_, Window>, at: Pos2, name: &str) {
    harness.event(egui::Event::PointerMoved(at));
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(5);
    harness.get_by_label_contains(name).click();
    harness.run_steps(5);
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

/// Drops a file on the window.
pub fn drop_file(harness: &mut Harness<'_, Window>, path: &Path) {
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
}

/// Whether a message of the window contains these words.
pub fn says(words: &str) -> impl Fn(&Window) -> bool {
    move |window| window.messages().iter().any(|message| message.contains(words))
}

pub fn send(harness: &mut Harness<'_, Window>, command: Command) {
    harness.state_mut().send(command);
    harness.run_steps(2);
}

/// The control with this name, not a text that contains the name.
pub fn control<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> Node<'h> {
    let mut named = harness.get_all_by_label(name);
    named
        .find(|node| node.accesskit_node().role() != egui::Role::Label)
        .unwrap_or_else(|| panic!("no control {name}"))
}

pub fn middle(harness: &Harness<'_, Window>) -> Pos2 {
    harness.get_by_label("Picture").rect().center()
}

/// Drags with the primary button in small steps.
pub fn drag_from(harness: &mut Harness<'_, Window>, from: Pos2, by: egui::Vec2) {
    hold(harness, from, true);
    for step in 1..=10 {
        harness.event(egui::Event::PointerMoved(from + by * (step as f32 / 10.0)));
        harness.step();
    }
    hold(harness, from + by, false);
}

pub fn drag(harness: &mut Harness<'_, Window>, button: PointerButton, modifiers: Modifiers) {
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

pub fn scroll(harness: &mut Harness<'_, Window>, at: Pos2, lines: f32) {
    harness.event(egui::Event::PointerMoved(at));
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, lines),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run_steps(25);
}
