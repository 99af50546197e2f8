//! What ends the program early, and its exit code.

use std::fmt;
use std::process::ExitCode;

/// Exit code after Ctrl-C: 128 and the number of SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Why the program ends without having done what it was asked for.
#[derive(Debug)]
pub enum Failure {
    /// The command line cannot be understood, or asks for help.
    CommandLine(clap::Error),
    /// What was asked for cannot be done; nothing was begun.
    Input(anyhow::Error),
    /// Something failed on the way.
    Run(anyhow::Error),
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

    /// Says it on standard error (help goes to standard output) and returns the exit code: 2 for bad input, 1
    /// for other failures, 0 for help.
    pub fn report(&self) -> ExitCode {
        match self {
            // Nothing is left to be done if even the message cannot be written.
            Failure::CommandLine(error) => {
                let _ = error.print();
                ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2))
            }
            Failure::Input(_) => {
                eprintln!("{self}");
                ExitCode::from(2)
            }
            Failure::Run(_) => {
                eprintln!("{self}");
                ExitCode::FAILURE
            }
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::CommandLine(error) => error.fmt(f),
            Failure::Input(error) | Failure::Run(error) => write!(f, "error: {error:#}"),
        }
    }
}
