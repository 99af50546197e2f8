//! Paths: as text in messages and JSON, what they lead to, and the user's directories.

use crate::system::console::printable;
use std::env;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The path that stands for standard input or output.
pub const STANDARD: &str = "-";

/// How messages show a path.
pub trait ShownPath {
    /// The path as part of one line that cannot control a terminal: see [`printable`]. Bytes that are not UTF-8 become
    /// U+FFFD.
    fn shown(&self) -> String;
}

impl<P: AsRef<OsStr> + ?Sized> ShownPath for P {
    fn shown(&self) -> String {
        printable(&self.as_ref().to_string_lossy()).into_owned()
    }
}

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
        // Some Windows disk drivers cannot report the full name of a file.
        Err(_) if cfg!(windows) => return std::path::absolute(path),
        known => return known,
    }
    match (path.parent(), path.file_name()) {
        (Some(parent), Some(name)) if parent.as_os_str().is_empty() => Ok(fs::canonicalize(".")?.join(name)),
        (Some(parent), Some(name)) => Ok(resolved(parent)?.join(name)),
        _ => std::path::absolute(path),
    }
}

/// The variable that names the directory for state, and its default place in the home directory.
const USUAL: (&str, &str) = if cfg!(windows) {
    ("LOCALAPPDATA", "AppData/Local")
} else if cfg!(target_vendor = "apple") {
    ("XDG_STATE_HOME", "Library/Application Support")
} else {
    ("XDG_STATE_HOME", ".local/state")
};

/// The program's directory for state that outlives it, such as rescued films; it may not exist yet.
pub fn state_directory() -> Option<PathBuf> {
    let (variable, usual) = USUAL;
    own_directory(env::var_os(variable), home_directory(), usual)
}

/// The program's directory inside the one that a variable names or, unless that is absolute, inside `usual` in `home`.
fn own_directory(named: Option<OsString>, home: Option<PathBuf>, usual: &str) -> Option<PathBuf> {
    let named = named.map(PathBuf::from).filter(|directory| directory.is_absolute());
    Some(named.or_else(|| Some(home?.join(usual)))?.join("weekender"))
}

/// The user's pictures, if there is a directory for them.
pub fn pictures_directory() -> Option<PathBuf> {
    #[cfg(windows)]
    let pictures = known_folders::get_known_folder_path(known_folders::KnownFolder::Pictures);
    #[cfg(not(windows))]
    let pictures = home_directory().map(|home| home.join("Pictures"));
    pictures.filter(|pictures| pictures.is_dir())
}

/// The directory for files that last no longer than the program.
pub fn temporary_directory() -> PathBuf {
    // In WebAssembly, `temp_dir` panics.
    if cfg!(target_family = "wasm") { PathBuf::from("/") } else { env::temp_dir() }
}

/// A new empty file without a name. On Linux it is in memory, so no directory needs to be writable.
///
/// # Errors
/// If there is no memory file and the directory for temporary files cannot be used.
pub(super) fn unnamed() -> io::Result<File> {
    #[cfg(target_os = "linux")]
    if let Ok(file) = rustix::fs::memfd_create("weekender", rustix::fs::MemfdFlags::CLOEXEC) {
        return Ok(file.into());
    }
    let directory = temporary_directory();
    tempfile::tempfile_in(&directory).map_err(|error| {
        let text = format!("it needs a temporary file, but {} cannot hold one: {error}", directory.display());
        io::Error::new(error.kind(), text)
    })
}

pub fn home_directory() -> Option<PathBuf> {
    env::home_dir().filter(|home| home.is_absolute())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn only_an_absolute_variable_chooses_the_directory() {
        let here = env::current_dir().unwrap();
        let [state, home] = ["state", "home"].map(|name| here.join(name));
        let found = |named: Option<&OsStr>, home: Option<&PathBuf>| {
            own_directory(named.map(ToOwned::to_owned), home.cloned(), ".local/state")
        };
        let usual = Some(home.join(".local/state/weekender"));
        assert_eq!(found(Some(state.as_os_str()), Some(&home)), Some(state.join("weekender")));
        assert_eq!(found(Some("state".as_ref()), Some(&home)), usual);
        assert_eq!(found(None, Some(&home)), usual);
        assert_eq!(found(Some("state".as_ref()), None), None);
    }

    fn same(a: &Path, b: &Path) -> bool {
        identity(a).unwrap() == identity(b).unwrap()
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
