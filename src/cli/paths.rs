//! An output must not be an input of the same command, or another output.

use super::error::CliError;
use super::values::JsonTarget;
use crate::system::files::ShownPath;
use std::path::{Path, PathBuf};

/// The files that a command reads and writes, each with its flag or its role.
#[derive(Default)]
pub struct Paths {
    inputs: Vec<(&'static str, PathBuf)>,
    outputs: Vec<(&'static str, PathBuf)>,
}

impl Paths {
    /// Adds a file to read, if there is one.
    pub fn read(mut self, what: &'static str, path: Option<&Path>) -> Self {
        self.inputs.extend(path.map(|path| (what, path.to_owned())));
        self
    }

    /// Adds a file to write, if there is one.
    pub fn write(mut self, what: &'static str, path: Option<&Path>) -> Self {
        self.outputs.extend(path.map(|path| (what, path.to_owned())));
        self
    }

    /// Adds a JSON file to write, unless it is standard output.
    pub fn write_json(self, target: Option<&JsonTarget>) -> Self {
        match target {
            Some(JsonTarget::File(path)) => self.write("--json", Some(path)),
            _ => self,
        }
    }

    /// Refuses an output that is an input or another output. `may_replace` lists the outputs that may replace an input,
    /// because they continue it.
    ///
    /// # Errors
    /// [`CliError::Refused`].
    pub fn check(&self, may_replace: &[(&str, &str)]) -> Result<(), CliError> {
        let mut seen: Vec<(&str, PathBuf)> =
            self.inputs.iter().filter_map(|(what, path)| Some((*what, place(path)?))).collect();
        for (what, path) in &self.outputs {
            let Some(place) = place(path) else { continue };
            let other = seen.iter().find(|(other, at)| *at == place && !may_replace.contains(&(what, other)));
            if let Some((other, _)) = other {
                let path = path.shown();
                return Err(CliError::Refused(format!(
                    "{what} {path} would replace the file of {other}; give it another name"
                )));
            }
            seen.push((what, place));
        }
        Ok(())
    }
}

/// The file's path without links, whether or not it exists. `None` for devices, which may be shared.
fn place(path: &Path) -> Option<PathBuf> {
    if let Ok(found) = path.metadata() {
        return if found.is_file() { path.canonicalize().ok() } else { None };
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(parent.canonicalize().unwrap_or_else(|_| parent.to_owned()).join(path.file_name()?))
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
        let resumed = || Paths::default().read("--resume", Some(file));
        let allowed = [("--checkpoint", "--resume")];
        assert!(resumed().write("--checkpoint", Some(&again)).check(&allowed).is_ok());
        let error = resumed().write("--json", Some(&again)).check(&allowed).unwrap_err().to_string();
        assert!(error.contains("--json") && error.contains("--resume") && error.contains("g.exr"), "{error}");
        let new = directory.path().join("new.png");
        for path in [&again, &new] {
            let both = Paths::default().write("--out", Some(path)).write("--checkpoint", Some(path));
            assert!(both.check(&allowed).is_err());
        }
        assert!(resumed().write("--json", Some(&new)).check(&[]).is_ok());
        let null = Path::new("/dev/null");
        assert!(
            Paths::default().write("--out", Some(null)).write("--json", Some(null)).check(&[]).is_ok()
                || !null.exists()
        );
    }
}
