//! Which file a path leads to, and whether that file has changed.

use super::paths::STANDARD;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The file that a path leads to through any links, whether or not it exists yet.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileIdentity(PathBuf);

impl FileIdentity {
    /// `None` for devices, pipes and standard input or output, which any number of writers may share.
    pub fn of(path: &Path) -> Option<FileIdentity> {
        if path == Path::new(STANDARD)
            || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
        {
            return None;
        }
        Some(FileIdentity(resolved(path).unwrap_or_else(|_| path.to_owned())))
    }
}

/// Resolves the links of a path. Components that do not exist yet stay as they are.
///
/// # Errors
/// If a link cannot be read, or leads back to itself.
pub(super) fn resolved(path: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        // Some drivers of Windows disks cannot tell the whole name of a file.
        Err(_) if cfg!(windows) => return std::path::absolute(path),
        known => return known,
    }
    let parent = match path.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => return std::path::absolute(path),
    };
    // A link that leads back to itself was another error.
    if let Ok(target) = fs::read_link(path) {
        return resolved(&parent.join(target));
    }
    match path.file_name() {
        Some(name) => Ok(resolved(parent)?.join(name)),
        None => std::path::absolute(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: &Path, b: &Path) -> bool {
        FileIdentity::of(a).unwrap() == FileIdentity::of(b).unwrap()
    }

    #[test]
    fn one_file_by_many_names() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("d")).unwrap();
        for is_there in [false, true] {
            assert!(same(&at("new"), &at("./d/../new")) && same(&at("d/x"), &at("d/./x")));
            assert!(same(&at("gone/deeper/x"), &at("./gone/deeper/x")));
            assert!(
                !same(&at("new"), &at("other")) && !same(&at("d/x"), &at("x")) && !same(&at("new"), &at("d"))
            );
            if !is_there {
                fs::write(at("new"), "").unwrap();
            }
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_even_to_nothing() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("d")).unwrap();
        symlink("d/target", at("link")).unwrap();
        symlink(at("link"), at("second")).unwrap();
        symlink("d", at("e")).unwrap();
        for is_there in [false, true] {
            assert!(same(&at("link"), &at("d/target")) && same(&at("second"), &at("e/target")), "{is_there}");
            fs::write(at("d/target"), "").unwrap();
        }
        assert!(FileIdentity::of(Path::new("/dev/null")).is_none());
        symlink("circle", at("circle")).unwrap();
        assert!(resolved(&at("circle")).is_err());
    }
}
