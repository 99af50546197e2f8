//! An output must not be an input of the same command, or another output.

use crate::system::files::{ShownPath, check_writable, identity};
use anyhow::{Result, ensure};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Refuses an output that would replace an input or another output. Devices may be shared.
///
/// # Errors
/// For the first such output.
pub fn check_paths<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<()> {
    let mut seen: HashSet<PathBuf> = inputs.into_iter().filter_map(identity).collect();
    for path in outputs {
        ensure!(
            identity(path).is_none_or(|file| seen.insert(file)),
            "{} would replace an input or another output of this command; give each file its own name",
            path.shown()
        );
    }
    Ok(())
}

/// As [`check_paths`], and checks that each output can be written.
///
/// # Errors
/// For the first output that cannot be written or would replace an input or another output.
pub fn check_outputs<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path> + Clone,
) -> Result<()> {
    check_paths(inputs, outputs.clone())?;
    Ok(outputs.into_iter().try_for_each(check_writable)?)
}
