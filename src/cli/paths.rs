//! An output must not be an input of the same command, or another output.

use crate::system::files::{FileIdentity, ShownPath};
use anyhow::{Result, bail};
use std::path::Path;

/// A file with its flag or its role, unless it is not given.
pub type NamedPath<'a> = (&'static str, Option<&'a Path>);

/// Outputs that may replace an input, because they continue it.
const CONTINUED: [(&str, &str); 2] = [("--out", "--resume"), ("--checkpoint", "--resume")];

/// Refuses an output that would replace an input or another output. Devices may be shared.
///
/// # Errors
/// The first such output, with the flag or role of both.
pub fn check_paths(inputs: &[NamedPath], outputs: &[NamedPath]) -> Result<()> {
    let identity = |(what, path): &NamedPath| Some((*what, FileIdentity::of((*path)?)?));
    let mut seen: Vec<_> = inputs.iter().filter_map(identity).collect();
    for output in outputs {
        let (Some((what, file)), Some(path)) = (identity(output), output.1) else { continue };
        let is_lost = |other: &str, at: &FileIdentity| *at == file && !CONTINUED.contains(&(what, other));
        if let Some((other, _)) = seen.iter().find(|(other, at)| is_lost(other, at)) {
            bail!("{what} {} would replace the file of {other}; give it another name", path.shown());
        }
        seen.push((what, file));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_continued_input_may_be_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("g.exr");
        std::fs::write(&file, "").unwrap();
        let (file, again) = (file.as_path(), directory.path().join("./g.exr"));
        let resumed = [("--resume", Some(file))];
        assert!(check_paths(&resumed, &[("--checkpoint", Some(&again)), ("--out", None)]).is_ok());
        let error = check_paths(&resumed, &[("--json", Some(&again))]).unwrap_err().to_string();
        assert!(error.contains("--json") && error.contains("--resume") && error.contains("g.exr"), "{error}");
        let new = directory.path().join("new.png");
        for path in [&again, &new] {
            assert!(check_paths(&[], &[("--out", Some(path)), ("--checkpoint", Some(path))]).is_err());
        }
        assert!(check_paths(&resumed, &[("--json", Some(&new))]).is_ok());
        let null = Path::new("/dev/null");
        assert!(check_paths(&[], &[("--out", Some(null)), ("--json", Some(null))]).is_ok() || !null.exists());
    }
}
