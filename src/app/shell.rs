//! What surrounds the picture: dialogs, messages, the presentation, keyboard focus, and the log of frames.

use super::dialogs::Dialogs;
use super::frame_log::{FrameLog, FrameTimes};
use super::places::Place;
use super::present::Presenter;
use super::toasts::Toasts;
use crate::system::interrupt::Interrupt;
use anyhow::{Context as _, Result};
use eframe::egui::{self, Event, Vec2};
use std::path::Path;
use std::sync::Arc;

/// How many frames wait for the system to say how large the screen is.
const FRAMES_TO_FIT: u8 = 120;

pub struct Shell {
    pub dialogs: Dialogs,
    pub toasts: Toasts,
    pub presenter: Presenter,
    pub frame_log: Option<FrameLog>,
    pub frame_times: FrameTimes,
    /// The command that was carried out last.
    pub performed: Option<super::command::Command>,
    /// Something had the keyboard's focus, a popup or a dialog was open, in the frame before.
    pub had_focus: bool,
    /// Events that wait for a frame of their own.
    pub late_events: Vec<Event>,
    /// The part of the window that F6 has chosen.
    pub panel: Option<Place>,
    pub is_dressed: bool,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
    pub interrupt: Option<Arc<Interrupt>>,
    frames_to_fit: u8,
}

impl Shell {
    /// # Errors
    /// If the frame log cannot be written.
    pub fn new(frame_log: Option<&Path>, crashes_at: Option<u64>) -> Result<Self> {
        let create =
            |path: &Path| FrameLog::create(path).with_context(|| format!("cannot write {}", path.display()));
        Ok(Shell {
            dialogs: Dialogs::default(),
            toasts: Toasts::default(),
            presenter: Presenter::default(),
            frame_log: frame_log.map(create).transpose()?,
            frame_times: FrameTimes::default(),
            performed: None,
            had_focus: false,
            late_events: Vec::new(),
            panel: None,
            is_dressed: false,
            crashes_at,
            interrupt: None,
            frames_to_fit: FRAMES_TO_FIT,
        })
    }

    pub fn is_interrupted(&self) -> bool {
        self.interrupt.as_ref().is_some_and(|interrupt| interrupt.is_set())
    }

    /// Makes a window smaller that does not fit on the screen.
    pub fn fit_on_screen(&mut self, context: &egui::Context) {
        if self.frames_to_fit == 0 {
            return;
        }
        self.frames_to_fit -= 1;
        let smaller = context.input(|input| {
            let viewport = input.viewport();
            fitting(viewport.inner_rect?.size(), viewport.outer_rect?.size(), viewport.monitor_size?)
        });
        if let Some(size) = smaller {
            self.frames_to_fit = 0;
            context.send_viewport_cmd(egui::ViewportCommand::InnerSize(size));
        }
    }
}

/// The inner size with which a window fits on the screen, if it does not.
fn fitting(inner: Vec2, outer: Vec2, screen: Vec2) -> Option<Vec2> {
    let excess = (outer - screen).max(Vec2::ZERO);
    (excess != Vec2::ZERO && screen.min_elem() > 0.0).then(|| inner - excess)
}
