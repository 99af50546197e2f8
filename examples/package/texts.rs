//! Manual pages and completions, made from the command line's own description.

use clap_complete::{Shell, generate_to};
use std::io;
use std::path::Path;

/// The shells that get completions.
pub const SHELLS: [Shell; 5] = [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::PowerShell, Shell::Elvish];

/// Writes `man/weekender.1`, a page for each subcommand, and `completions/` below `directory`.
///
/// # Errors
/// If a file cannot be written.
pub fn write(directory: &Path) -> io::Result<()> {
    let [man, completions] = ["man", "completions"].map(|folder| directory.join(folder));
    for folder in [&man, &completions] {
        std::fs::create_dir_all(folder)?;
    }
    clap_mangen::generate_to(weekender::cli::command(), &man)?;
    for shell in SHELLS {
        generate_to(shell, &mut weekender::cli::command(), "weekender", &completions)?;
    }
    Ok(())
}
