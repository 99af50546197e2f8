//! Which file a path leads to, and whether that file has changed.

use super::paths::STANDARD;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The file that a path leads to through any links, whether or not it exists yet. `None` for devices, pipes and standard
/// input or output, which any number of writers may share.
pub fn identity(path: &Path) -> Option<PathBuf> {
    let is_device = || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
    if path == Path::new(STANDARD) || is_device() {
        return None;
    }
    Some(resolved(path).unwrap_or_else(|_| path.to_owned()))
}

/// Resolves the links of a path. Components that do not exist yet stay as they are.
///
/// # Errors
/// If a link leads back to itself.
pub(super) fn resolved(path: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        // Some drivers of Windows disks cannot tell the whole name of a file.
        Err(_) if cfg!(windows) => return std::path::absolute(path),
        known => return known,
    }
    match (path.parent(), path.file_name()) {
        (Some(parent), Some(name)) if parent.as_os_str().is_empty() => Ok(fs::canonicalize(".")?.join(name)),
        (Some(parent), Some(name)) => Ok(resolved(parent)?.join(name)),
        _ => std::path::absolute(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: &Path, b: &Path) -> bool {
        identity(a).unwrap() == identity(b).unwrap()
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
    fn links_are_followed() {
        use std::os::unix::fs::symlink;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("d")).unwrap();
        symlink("d/target", at("link")).unwrap();
        symlink(at("link"), at("second")).unwrap();
        symlink("d", at("e")).unwrap();
        assert!(same(&at("e/new"), &at("d/new")));
        fs::write(at("d/target"), "").unwrap();
        assert!(same(&at("link"), &at("d/target")) && same(&at("second"), &at("e/target")));
        assert!(identity(Path::new("/dev/null")).is_none());
        symlink("circle", at("circle")).unwrap();
        assert!(resolved(&at("circle")).is_err());
    }
}
