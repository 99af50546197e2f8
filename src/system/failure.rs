//! Failures that end the program early, and their exit codes.

use crate::system::console;
use std::fmt;
use std::process::ExitCode;

/// Exit code for a failure during the run, and for two inputs that differ.
pub const FAILED: u8 = 1;

/// Exit code for a request that cannot be carried out; nothing was started.
pub const BAD_INPUT: u8 = 2;

/// Exit code of a render that stopped early; its files hold the samples so far.
pub const BROKE_OFF: u8 = 3;

/// The exit codes as `--help` explains them.
pub const EXIT_CODES: &str = "\
Exit codes: 0 success; 1 failure during the run (compare: the inputs differ; check: a mistake; merge: a part is missing); 2 the request cannot be carried \
out, nothing was started (compare: it cannot tell); 3 the render failed, but what it had rendered is saved; 128 + N signal N, such as \
130 Ctrl-C and 143 SIGTERM: what had been rendered is saved";

/// Why the program ends without doing what was asked.
#[derive(Debug)]
pub enum Failure {
    /// The command line is invalid, or asks for help.
    CommandLine(clap::Error),
    /// The request cannot be carried out; nothing was started.
    Input(anyhow::Error),
    /// Something failed during the run.
    Run(anyhow::Error),
    /// The render failed, but its files hold the samples so far.
    BrokeOff(anyhow::Error),
}

impl Failure {
    pub fn input(error: impl Into<anyhow::Error>) -> Self {
        Failure::Input(error.into())
    }

    pub fn run(error: impl Into<anyhow::Error>) -> Self {
        Failure::Run(error.into())
    }

    /// Prints the failure to standard error (help goes to standard output) and returns the exit code; see
    /// [`EXIT_CODES`].
    pub fn report(&self) -> ExitCode {
        let code = match self {
            Failure::CommandLine(help) if !help.use_stderr() => {
                let printed = console::print(&help.render().to_string());
                return printed.map_or_else(|error| Failure::Run(error).report(), |()| ExitCode::SUCCESS);
            }
            Failure::CommandLine(_) | Failure::Input(_) => BAD_INPUT,
            Failure::Run(_) => FAILED,
            Failure::BrokeOff(_) => BROKE_OFF,
        };
        let text = self.to_string();
        console::note(&if code == BAD_INPUT { console::brief(&text) } else { text });
        ExitCode::from(code)
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
