//! What surrounds the picture: dialogs, messages, the presentation, keyboard focus, and the log of frames.

use super::dialogs::Dialogs;
use super::frame_log::{FrameLog, FrameTimes};
use super::toasts::Toasts;
use crate::system::interrupt::Interrupt;
use anyhow::{Context as _, Result};
use std::path::Path;
use std::sync::Arc;

pub struct Shell {
    pub dialogs: Dialogs,
    pub toasts: Toasts,
    pub frame_log: Option<FrameLog>,
    pub frame_times: FrameTimes,
    /// The command that was carried out last.
    pub performed: Option<super::command::Command>,
    /// Something had the keyboard's focus, a popup or a dialog was open, in the frame before.
    pub had_focus: bool,
    pub is_dressed: bool,
    /// Samples per pixel at which the program panics (fault injection).
    pub crashes_at: Option<u64>,
    pub interrupt: Option<Arc<Interrupt>>,
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
            frame_log: frame_log.map(create).transpose()?,
            frame_times: FrameTimes::default(),
            performed: None,
            had_focus: false,
            is_dressed: false,
            crashes_at,
            interrupt: None,
        })
    }

    pub fn is_interrupted(&self) -> bool {
        self.interrupt.as_ref().is_some_and(|interrupt| interrupt.is_set())
    }
}
