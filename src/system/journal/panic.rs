//! Handles panics. If a tracer panics, only its pass ends and another backend continues, with a message and a line in
//! the log. A panic that ends the program or its render also leaves a report in a file.

use super::kept_text;
use crate::system::console;
use crate::system::failure::FAILED;
use crate::system::files::{state_directory, write_text};
use crate::system::shell;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::env;
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Version, commit and target in one line, for the report.
static VERSION: OnceLock<String> = OnceLock::new();

/// Whether a panic on the main thread would be another program's fault, and is reported by whoever catches it.
static IS_EXPECTED: AtomicBool = AtomicBool::new(false);

/// Sets whether a panic on the main thread is only logged, because it is caught and reported in other words. Returns
/// the previous value.
pub fn expect_panics(is_expected: bool) -> bool {
    IS_EXPECTED.swap(is_expected, Ordering::SeqCst)
}

/// Message of the latest panic on any thread.
static LATEST: Mutex<Option<String>> = Mutex::new(None);

pub(super) fn version() -> &'static str {
    VERSION.get().map_or("version unknown", String::as_str)
}

/// Runs `program`; if it panics, writes a report and prints its path.
pub fn watched(version: String, program: impl FnOnce() -> ExitCode) -> ExitCode {
    VERSION.get_or_init(|| version);
    std::panic::set_hook(Box::new(note));
    catch_unwind(AssertUnwindSafe(program)).unwrap_or_else(|_| {
        write_report();
        ExitCode::from(FAILED)
    })
}

/// Writes a report on the latest panic to a file and prints its path to standard error. Does nothing without a panic.
pub fn write_report() {
    let Some(message) = LATEST.lock().unwrap_or_else(PoisonError::into_inner).take() else { return };
    let text = report(version(), &shell::line(env::args_os()), &message, &kept_text());
    let name = format!("weekender-report-{}.txt", std::process::id());
    let state = state_directory().filter(|state| std::fs::create_dir_all(state).is_ok());
    let places = [Some(env::temp_dir()), state, Some(PathBuf::from("."))];
    let mut paths = places.iter().flatten().map(|place| place.join(&name));
    match paths.find(|path| write_text(path, &text).is_ok()) {
        Some(path) => console::note(&format!(
            "a report is in {}: read it, then send it, with the scene file if you used one",
            path.display()
        )),
        None => console::note(&format!("no report could be written to any of {places:?}")),
    }
}

fn report(version: &str, command: &str, message: &str, log: &str) -> String {
    let directory = env::current_dir().map_or_else(|error| error.to_string(), |at| at.display().to_string());
    let log = if log.is_empty() { "(empty)" } else { log };
    format!(
        "Weekender stopped because of an internal error. This file tells its developers what happened. It contains only \
         the following; remove anything private.\n\nversion    {version}\ncommand    {command}\ndirectory  \
         {directory}\n\n{message}\n\nLog (seconds since the start):\n{log}\n"
    )
}

/// The panic hook. It cannot fail, even if standard error is closed.
fn note(panic: &PanicHookInfo<'_>) {
    let reason = panic.payload_as_str().unwrap_or("no reason given");
    let place = panic.location().map_or_else(String::new, |place| format!(" ({place})"));
    let thread = std::thread::current();
    let thread = thread.name().unwrap_or("(unnamed)");
    let message = format!("internal error in thread {thread}: {reason}{place}");
    log::error!("{message}");
    if thread == "main" && IS_EXPECTED.load(Ordering::SeqCst) {
        return;
    }
    console::note(&format!("{message}; please report it with the command that led to it"));
    let backtrace = Backtrace::capture();
    let mut whole = message;
    if backtrace.status() == BacktraceStatus::Captured {
        console::note(&backtrace.to_string());
        whole.push_str(&format!("\n\n{backtrace}"));
    }
    *LATEST.lock().unwrap_or_else(PoisonError::into_inner) = Some(whole);
}
