//! Checks whether the files of a command conflict, before any of them is written.

use super::error::CliError;
use super::values::JsonTarget;
use crate::files::FileIdentity;
use std::path::{Path, PathBuf};

/// The files that a command reads and writes: those that flags name, each with its flag, and those to which the command
/// gives names of its own.
#[derive(Default)]
pub(super) struct Paths {
    inputs: Vec<Named>,
    outputs: Vec<Named>,
    own: Vec<Own>,
}

/// Finds a file name of the command's own that differs from the given one in letter case at most.
type FindOwn = Box<dyn Fn(&str) -> Option<String>>;

/// Files of the command's own names in a directory.
struct Own {
    /// What they are, in words.
    what: &'static str,
    directory: PathBuf,
    find: FindOwn,
}

impl Own {
    fn is_same_as(&self, named: &Named) -> bool {
        let target = followed(&named.path);
        let Some(name) = target.file_name() else { return false };
        (self.find)(&name.to_string_lossy())
            .is_some_and(|own| Named::new(self.what, &self.directory.join(own)).is_same_as(named))
    }
}

/// The file at the end of a link, whether or not it exists.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    // As many links as systems follow.
    for _ in 0..40 {
        let Ok(target) = path.read_link() else { break };
        path = path.with_file_name(target);
    }
    path
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

    /// Adds files in `directory` that the command reads or writes, and no flag names. They may be very many, so `find` is
    /// asked for the name of one that differs from a given name in letter case at most: the file system decides whether
    /// that is the same file.
    pub fn own(
        mut self,
        what: &'static str,
        directory: &Path,
        find: impl Fn(&str) -> Option<String> + 'static,
    ) -> Self {
        self.own.push(Own { what, directory: directory.to_owned(), find: Box::new(find) });
        self
    }

    /// Returns an error if two outputs are the same file, an output would replace an input, or a file that a flag names is
    /// one of the command's own. `may_replace` lists the outputs that may replace an input, because they continue it.
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
        self.check_own()
    }

    fn check_own(&self) -> Result<(), CliError> {
        let owner = |named: &Named| self.own.iter().find(|own| own.is_same_as(named));
        for output in &self.outputs {
            if let Some(own) = owner(output) {
                let path = output.path.clone();
                return Err(CliError::Overwrites { output: output.flag, path, input: own.what });
            }
        }
        for input in &self.inputs {
            if let Some(own) = owner(input) {
                let path = input.path.clone();
                return Err(CliError::Overwrites { output: own.what, path, input: input.flag });
            }
        }
        Ok(())
    }
}

/// The one of `names` that differs from `name` in letter case at most.
pub(super) fn same_name(name: &str, names: impl IntoIterator<Item = String>) -> Option<String> {
    let folded = name.to_lowercase();
    names.into_iter().find(|own| own.to_lowercase() == folded)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_of_the_command_is_that_file() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        std::fs::create_dir(at("d")).unwrap();
        std::os::unix::fs::symlink("second", at("first")).unwrap();
        std::os::unix::fs::symlink("d/plan.json", at("second")).unwrap();
        std::os::unix::fs::symlink("d", at("e")).unwrap();
        for name in ["d/plan.json", "e/plan.json", "first", "d/../second"] {
            let check = |is_there: bool| {
                let paths = Paths::default().own("a file of the plan", &at("d"), |name| {
                    (name == "plan.json").then(|| name.to_owned())
                });
                let told = paths.write("--json", Some(&at(name))).check(&[]);
                assert!(told.is_err(), "{name}: {is_there}");
            };
            check(false);
            std::fs::write(at("d/plan.json"), "").unwrap();
            check(true);
            std::fs::remove_file(at("d/plan.json")).unwrap();
        }
    }

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
        let own = |paths: Paths| {
            paths.own("a part", directory.path(), |name| same_name(name, ["g.exr".to_owned()]))
        };
        let error =
            own(Paths::default().write("--json", Some(&again))).check(&allowed).unwrap_err().to_string();
        assert!(error.contains("--json") && error.contains("would replace a part;"), "{error}");
        let error = own(resumed()).check(&allowed).unwrap_err().to_string();
        assert!(error.starts_with("a part ") && error.contains("the file that --resume reads"), "{error}");
        for other in ["d/g.exr", "h.exr"].map(|name| directory.path().join(name)) {
            assert!(own(Paths::default().write("--json", Some(&other))).check(&[]).is_ok(), "{other:?}");
        }
        // Whether case matters depends on the file system.
        let upper = directory.path().join("G.EXR");
        let is_same = own(Paths::default().write("--json", Some(&upper))).check(&[]).is_err();
        assert_eq!(is_same, upper.exists());
        let null = Path::new("/dev/null");
        if null.exists() {
            assert!(
                Paths::default().write("--out", Some(null)).write("--json", Some(null)).check(&[]).is_ok()
            );
        }
    }
}
