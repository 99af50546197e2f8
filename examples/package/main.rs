//! Writes the manual pages and the shell completions: `cargo run --release --example package -- DIRECTORY`.

mod texts;

use std::path::PathBuf;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(directory) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("name the directory to write to, for example: --example package -- target/package");
        return ExitCode::from(2);
    };
    match texts::write(&directory) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cannot write to {}: {error}", directory.display());
            ExitCode::FAILURE
        }
    }
}
