//! The shell around the picture: dialogs, messages, and keyboard focus.

use crate::app::dialogs::Dialogs;
use crate::app::toolkit::Toasts;
use crate::system::interrupt::Interrupt;
use std::sync::Arc;

#[derive(Default)]
pub struct Shell {
    pub dialogs: Dialogs,
    pub toasts: Toasts,
    /// The command that was carried out last.
    pub performed: Option<crate::app::commands::Command>,
    /// Something had the keyboard's focus, a popup or a dialog was open, in the frame before.
    pub had_focus: bool,
    /// The panel that F6 goes to: the bar, the left or the right one.
    pub panel: usize,
    pub is_dressed: bool,
    /// The window closes as soon as everything is saved.
    pub leaves_when_saved: bool,
    pub interrupt: Option<Arc<Interrupt>>,
}

impl Shell {
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.as_ref().is_some_and(|interrupt| interrupt.is_set())
    }
}
