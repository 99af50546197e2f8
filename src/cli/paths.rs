//! Checks whether the files of a command conflict, before any of them is written.

use super::error::CliError;
use super::values::JsonTarget;
use crate::files::FileIdentity;
use std::path::{Path, PathBuf};

/// The files that a command reads and writes, each with its flag.
#[derive(Debug, Default)]
pub(super) struct Paths {
    inputs: Vec<Named>,
    outputs: Vec<Named>,
}

#[derive(Debug)]
struct Named {
    flag: &'static str,
    path: PathBuf,
    identity: Option<FileIdentity>,
}

impl Named {
    fn new(flag: &'static str, path: &Path) -> Named {
        Named { flag, path: path.to_owned(), identity: FileIdentity::of(path) }
    }

    fn is_same_as(&self, other: &Named) -> bool {
        self.identity
            .as_ref()
            .zip(other.identity.as_ref())
            .is_some_and(|(mine, theirs)| mine.is_same_as(theirs))
    }
}

impl Paths {
    /// Adds a file to read, if there is one.
    pub fn read(mut self, flag: &'static str, path: Option<&Path>) -> Self {
        self.inputs.extend(path.map(|path| Named::new(flag, path)));
        self
    }

    /// Adds a file to write, if there is one.
    pub fn write(mut self, flag: &'static str, path: Option<&Path>) -> Self {
        self.outputs.extend(path.map(|path| Named::new(flag, path)));
        self
    }

    /// Adds a JSON file to write, unless it is standard output.
    pub fn write_json(self, target: Option<&JsonTarget>) -> Self {
        let path = match target {
            Some(JsonTarget::File(path)) => Some(path.as_path()),
            _ => None,
        };
        self.write("--json", path)
    }

    /// Returns an error if two outputs are the same file or an output would replace an input. `may_replace` lists the
    /// outputs that may replace an input, because they continue it.
    pub fn check(&self, may_replace: &[(&str, &str)]) -> Result<(), CliError> {
        for (index, second) in self.outputs.iter().enumerate() {
            if let Some(first) = self.outputs[..index].iter().find(|first| first.is_same_as(second)) {
                return Err(CliError::SameFile {
                    first: first.flag,
                    second: second.flag,
                    path: first.path.clone(),
                    other: second.path.clone(),
                });
            }
        }
        for output in &self.outputs {
            let lost = self
                .inputs
                .iter()
                .find(|input| input.is_same_as(output) && !may_replace.contains(&(output.flag, input.flag)));
            if let Some(input) = lost {
                return Err(CliError::Overwrites {
                    output: output.flag,
                    path: output.path.clone(),
                    input: input.flag,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_input_that_lives_on_in_the_output_may_be_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("g.exr");
        std::fs::write(&file, "").unwrap();
        let (file, again) = (file.as_path(), directory.path().join("./g.exr"));
        let resumed = || Paths::default().read("--resume", Some(file));
        let allowed = [("--checkpoint", "--resume")];
        assert!(resumed().write("--checkpoint", Some(&again)).check(&allowed).is_ok());
        let error = resumed().write("--json", Some(&again)).check(&allowed).unwrap_err().to_string();
        assert!(error.contains("--json") && error.contains("--resume") && error.contains("g.exr"), "{error}");
        let both = Paths::default().write("--out", Some(file)).write("--checkpoint", Some(&again));
        assert!(matches!(both.check(&allowed), Err(CliError::SameFile { .. })));
        let null = Path::new("/dev/null");
        if null.exists() {
            assert!(
                Paths::default().write("--out", Some(null)).write("--json", Some(null)).check(&[]).is_ok()
            );
        }
    }
}
