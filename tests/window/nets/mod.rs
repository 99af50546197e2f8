//! Wide nets: much of the window as text, compared with stored texts. What changes unasked is seen as a difference.

mod commands;
mod controls;
mod dump;
mod files;
mod gestures;
mod golden;
mod keys;
mod screens;

use crate::common::{has_samples, opened, until, window};
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::cell::RefCell;
use std::ops::{Deref, DerefMut};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};

/// A window whose context, with its fonts, serves the next window of the same test.
struct Harnessed(Option<Harness<'static, Window>>);

thread_local! {
    static FREE: RefCell<Vec<Harness<'static, Window>>> = const { RefCell::new(Vec::new()) };
}

impl Deref for Harnessed {
    type Target = Harness<'static, Window>;

    fn deref(&self) -> &Self::Target {
        self.0.as_ref().unwrap()
    }
}

impl DerefMut for Harnessed {
    fn deref_mut(&mut self) -> &mut Self::Target {
        self.0.as_mut().unwrap()
    }
}

impl Drop for Harnessed {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = FREE.try_with(|free| free.borrow_mut().extend(self.0.take()));
        }
    }
}

/// Opens a window in a context that is free, as if it were new.
fn open(arguments: &str) -> Harnessed {
    let window = window(arguments);
    let Some(mut harness) = FREE.with(|free| free.borrow_mut().pop()) else {
        return Harnessed(Some(opened(window)));
    };
    *harness.state_mut() = window;
    harness.set_size(egui::vec2(1280.0, 1400.0));
    harness.ctx.memory_mut(|memory| *memory = egui::Memory::default());
    harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    harness.event(egui::Event::PointerGone);
    harness.run_steps(3);
    Harnessed(Some(harness))
}

/// A small picture that looks the same on every machine and is soon done.
const STEADY: &str = "--size 32x18 --samples 4 --isa portable --threads 1";

/// A window with the finished picture of a stage.
fn finished(stage: &str) -> Harnessed {
    done(open(&format!("--stage {stage} {STEADY}")))
}

fn done(mut harness: Harnessed) -> Harnessed {
    until(&mut harness, "a finished picture", has_samples(4));
    until(&mut harness, "the end", |window| window.status().phase.is_over());
    harness.ctx.all_styles_mut(|style| style.visuals.text_cursor.blink = false);
    harness.run_steps(3);
    harness
}

/// The same with a sphere selected, a slot kept, a bookmark, another camera and a comparison with the slot in reach.
fn busy() -> Harnessed {
    let mut harness = finished("defocus");
    give(&mut harness, Command::AddBookmark);
    give(&mut harness, Command::Slot(SlotCommand::Keep));
    until(&mut harness, "a slot", |window| window.slot(SlotNumber::ALL[0]).is_some());
    harness.state_mut().document_mut().camera.vfov_degrees = 25.0;
    let mut harness = done(harness);
    give(&mut harness, Command::AddBookmark);
    give(&mut harness, Command::NextSphere);
    give(&mut harness, Command::NextSphere);
    close_messages(&mut harness);
    harness
}

/// Closes the messages, which would go at some time.
fn close_messages(harness: &mut Harnessed) {
    for _ in 0..20 {
        let Some(close) = harness.query_all_by_label("×").next() else { return };
        close.click();
        harness.run_steps(2);
    }
}

fn give(harness: &mut Harnessed, command: Command) {
    harness.state_mut().send(command);
    harness.run_steps(2);
}

/// A frame later: what the window knows, and its messages.
fn known(harness: &mut Harnessed) -> String {
    harness.step();
    format!("{}{}", dump::state(harness.state()), dump::messages(harness.state()))
}

fn press(harness: &mut Harnessed, key: Key, modifiers: Modifiers) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(3);
}

fn point(harness: &mut Harnessed, at: Pos2) {
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
}

fn button(harness: &mut Harnessed, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
    harness.event_modifiers(egui::Event::PointerButton { pos: at, button, pressed, modifiers }, modifiers);
    harness.step();
}

/// A divider goes to where two pictures differ most as soon as both are there, with the samples that they have then.
fn without_divider(known: &str) -> String {
    let is_other = |line: &&str| !line.contains("divider");
    known.lines().filter(is_other).fold(String::new(), |all, line| all + line + "\n")
}
