//! Failures that end the program early, their exit codes, and the message after a panic.

use crate::console;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::fmt;
use std::panic::PanicHookInfo;
use std::process::ExitCode;

/// Exit code for a failure on the way, and for two things that differ.
pub const FAILED: u8 = 1;

/// Exit code for what cannot be done, before anything was begun.
pub const BAD_INPUT: u8 = 2;

/// Exit code of a render that broke off, but whose samples up to then are in its files.
pub const BROKE_OFF: u8 = 3;

/// Exit code after Ctrl-C: 128 and the number of SIGINT.
pub const INTERRUPTED: u8 = 130;

/// What `--help` says of them.
pub const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 failed on the way (compare and diff: the two differ); 2 cannot be done, nothing was begun; \
3 the render broke off, what it had rendered is in its files; 130 interrupted, what had been rendered is in its files";

/// Why the program ends without having done what was asked.
#[derive(Debug)]
pub enum Failure {
    /// The command line cannot be understood, or asks for help.
    CommandLine(clap::Error),
    /// What was asked for cannot be done; nothing was begun.
    Input(anyhow::Error),
    /// Something failed on the way.
    Run(anyhow::Error),
    /// The render broke off, but what it had rendered is in its files.
    BrokeOff(anyhow::Error),
}

impl Failure {
    /// A failure before anything was begun.
    pub fn input(error: impl Into<anyhow::Error>) -> Self {
        Failure::Input(error.into())
    }

    /// A failure on the way.
    pub fn run(error: impl Into<anyhow::Error>) -> Self {
        Failure::Run(error.into())
    }

    /// Says it on standard error (help goes to standard output) and returns the exit code: see [`EXIT_CODES`].
    pub fn report(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::CommandLine(error) if error.use_stderr() => {
                console::note(&error.render().to_string());
                u8::try_from(error.exit_code()).unwrap_or(BAD_INPUT)
            }
            Failure::CommandLine(help) => match console::print(&help.render().to_string()) {
                Ok(()) => 0,
                Err(error) => {
                    console::note(&format!("error: {}", output_failure(&error)));
                    FAILED
                }
            },
            Failure::Input(_) => self.say(BAD_INPUT),
            Failure::Run(_) => self.say(FAILED),
            Failure::BrokeOff(_) => self.say(BROKE_OFF),
        })
    }

    fn say(&self, code: u8) -> u8 {
        console::note(&self.to_string());
        code
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::CommandLine(error) => error.fmt(f),
            Failure::Input(error) | Failure::Run(error) | Failure::BrokeOff(error) => {
                write!(f, "error: {error:#}")
            }
        }
    }
}

/// What is said where standard output does not take a result.
pub fn output_failure(error: &std::io::Error) -> String {
    format!("cannot write to standard output: {error}; keep its reader open, or name a place with room")
}

/// Has a panic say what a user can do with it. The hook itself cannot fail, whatever has become of standard error.
pub fn install_panic_hook() {
    std::panic::set_hook(Box::new(|panic| console::note(&fault_words(panic))));
}

fn fault_words(panic: &PanicHookInfo<'_>) -> String {
    let reason = panic.payload_as_str().unwrap_or("no reason was given");
    let place = panic.location().map_or_else(String::new, |place| format!(" ({place})"));
    let thread = std::thread::current();
    let thread = thread.name().unwrap_or("without a name");
    let mut words = format!(
        "a fault of this program, in thread {thread}: {reason}{place}; please report it with the command that led to it"
    );
    let backtrace = Backtrace::capture();
    if backtrace.status() == BacktraceStatus::Captured {
        words.push_str(&format!("\n{backtrace}"));
    }
    words
}
