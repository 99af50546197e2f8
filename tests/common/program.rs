//! The program, run in a directory of its own.
#![allow(
    dead_code,
    clippy::panic,
    reason = "each test uses some of it; a helper of a test may fail like the test"
)]

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};
use weekender::film::{Film, checkpoint};

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_weekender");

/// Longer than a slow, busy machine takes.
pub const PATIENCE: Duration = Duration::from_secs(120);

pub fn weekender(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    // If a command that should be refused is accepted, it must not open a window.
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "RUST_LOG"] {
        command.env_remove(name);
    }
    // Without it, graphics libraries complain on standard error.
    command.env("XDG_RUNTIME_DIR", directory);
    command.current_dir(directory).args(arguments).stdin(Stdio::null());
    #[cfg(unix)]
    restore_signals();
    command
}

/// Gives programs that are started from now on the default action of Ctrl-C and similar signals, which a shell disables
/// for background jobs. A program inherits ignored signals, but no handlers.
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

/// Exit code (`None` after a signal), standard output and standard error.
pub fn outcome(output: &Output) -> (Option<i32>, String, String) {
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// Runs a command that must end with `code`. Returns standard output and standard error.
pub fn ends(directory: &Path, code: i32, arguments: &[&str]) -> (String, String) {
    let (found, out, message) = outcome(&weekender(directory, arguments).output().unwrap());
    assert_eq!(found, Some(code), "{arguments:?}: {out}{message}");
    (out, message)
}

/// Runs a command that must succeed. Returns standard output.
pub fn succeeds(directory: &Path, arguments: &[&str]) -> String {
    ends(directory, 0, arguments).0
}

/// Runs a command that must succeed and print JSON.
pub fn json(directory: &Path, arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&succeeds(directory, arguments)).unwrap()
}

pub fn json_file(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Bad input: exit code 2, a message with all of `parts`, no result and no new file.
pub fn refused(directory: &Path, arguments: &[&str], parts: &[&str]) {
    let before = names(directory);
    let (out, message) = ends(directory, 2, arguments);
    for part in parts {
        assert!(message.contains(part), "{arguments:?} should say {part:?}: {message}");
    }
    assert_eq!(out, "", "{arguments:?}");
    assert_eq!(names(directory), before, "{arguments:?} left something behind");
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

pub fn film(path: &Path) -> Film {
    checkpoint::load(path).unwrap().film
}

/// Sends a program the signal of this name. A small system has no program `kill`, but its shell has.
#[cfg(unix)]
pub fn signal(child: &Child, name: &str) {
    let kill = format!("kill -s {name} {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success(), "{kill}");
}

/// Waits for the end of a program. Ends it if it runs for too long.
pub fn wait(child: &mut Child) -> ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begin.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("it does not end");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Waits until `is_so` returns true.
pub fn until(what: &str, is_so: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_so() {
        assert!(begin.elapsed() < PATIENCE, "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}
