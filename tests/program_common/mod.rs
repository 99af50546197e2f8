//! The program, run in a directory of its own.
#![allow(dead_code, reason = "each test uses some of it")]

use std::path::Path;
use std::process::{Command, Stdio};

pub fn weekender(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
    // If a command that should be refused is accepted, it must not open a window.
    for display in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(display);
    }
    command.current_dir(directory).args(arguments).stdin(Stdio::null());
    #[cfg(unix)]
    restore_signals();
    command
}

/// Gives programs that are started from now on the default action of Ctrl-C and the like, which a shell disables for
/// what it runs in the background. A program inherits that a signal is ignored, but no handler.
#[cfg(unix)]
pub fn restore_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::flag;
    use std::sync::Arc;
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        for signal in [SIGINT, SIGTERM] {
            flag::register_conditional_default(signal, Arc::new(true.into())).unwrap();
        }
        // Tests under nohup still survive the end of their terminal.
        flag::register(SIGHUP, Arc::new(false.into())).unwrap();
    });
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The names of the files in a directory, in order.
pub fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
