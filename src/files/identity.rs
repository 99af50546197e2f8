//! File identity: which file a path refers to, and whether that file has changed since it was last seen.

use std::ffi::OsString;
use std::fs::{self, Metadata};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The longest chain of symbolic links that is followed.
const LINK_LIMIT: usize = 40;

/// The file that a path refers to, whether or not it exists yet. Two paths refer to the same file if their identities
/// are equal, regardless of links, `./` or letter case.
#[derive(Clone, Debug)]
pub struct FileIdentity {
    /// The file, or the deepest directory on its path that exists.
    base: Node,
    /// The path of `base`.
    place: PathBuf,
    /// The part of the path below `base`, which does not exist yet.
    rest: Vec<OsString>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Node {
    /// Device number and inode number.
    #[cfg(unix)]
    Number(u64, u64),
    /// The canonical path, without links.
    Path(PathBuf),
}

impl Node {
    #[cfg(unix)]
    fn of(_: &Path, found: &Metadata) -> Node {
        use std::os::unix::fs::MetadataExt;
        Node::Number(found.dev(), found.ino())
    }

    #[cfg(not(unix))]
    fn of(path: &Path, _: &Metadata) -> Node {
        Node::Path(fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()))
    }
}

impl FileIdentity {
    /// The file that `path` refers to. `None` for devices and pipes, which any number of writers may share.
    pub fn of(path: &Path) -> Option<FileIdentity> {
        if fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
            return None;
        }
        let followed = follow_links(path).unwrap_or_else(|_| path.to_owned());
        let mut at = std::path::absolute(&followed).unwrap_or(followed);
        let mut rest = Vec::new();
        loop {
            if let Ok(found) = fs::metadata(&at) {
                rest.reverse();
                return Some(FileIdentity { base: Node::of(&at, &found), place: at, rest });
            }
            match (at.file_name().map(ToOwned::to_owned), at.parent()) {
                (Some(name), Some(parent)) => {
                    rest.push(name);
                    at = parent.to_owned();
                }
                _ => {
                    rest.reverse();
                    return Some(FileIdentity { base: Node::Path(at.clone()), place: at, rest });
                }
            }
        }
    }

    /// Whether both refer to the same file. For two files that do not exist yet and differ only in letter case, this
    /// asks the file system.
    pub fn is_same_as(&self, other: &FileIdentity) -> bool {
        if self.base != other.base || self.rest.len() != other.rest.len() {
            return false;
        }
        let folded = |names: &[OsString]| -> Vec<String> {
            names.iter().map(|name| name.to_string_lossy().to_lowercase()).collect()
        };
        self.rest == other.rest || (folded(&self.rest) == folded(&other.rest) && ignores_case(&self.place))
    }
}

/// Whether `directory` treats names that differ only in letter case as the same name.
fn ignores_case(directory: &Path) -> bool {
    let probe = super::leftovers::create_in(directory, &mut tempfile::Builder::new()).ok();
    let name = probe.as_ref().and_then(|probe| probe.path().file_name());
    name.is_some_and(|name| directory.join(name.to_string_lossy().to_uppercase()).exists())
}

/// Follows the links at the end of `path`, even if their target does not exist.
///
/// # Errors
/// If a link cannot be read or the links form a cycle.
pub(super) fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..LINK_LIMIT {
        if !fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink()) {
            return Ok(path);
        }
        let target = fs::read_link(&path)?;
        path = path.parent().unwrap_or(Path::new("")).join(target);
    }
    Err(io::Error::new(ErrorKind::InvalidInput, "it is a link that leads back to itself"))
}

/// Identity, length and modification time. Together they distinguish a file from another one that replaced it, and
/// from the same file with different content.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Stamp {
    node: Node,
    length: u64,
    changed: Option<SystemTime>,
}

impl Stamp {
    /// The stamp of the regular file at `path`; `None` if there is no such file.
    ///
    /// # Errors
    /// If the file cannot be examined.
    pub fn of(path: &Path) -> io::Result<Option<Stamp>> {
        match fs::metadata(path) {
            Ok(found) if found.is_file() => Ok(Some(Stamp::of_metadata(path, &found))),
            Ok(_) => Ok(None),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    fn of_metadata(path: &Path, found: &Metadata) -> Stamp {
        Stamp { node: Node::of(path, found), length: found.len(), changed: found.modified().ok() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(a: &Path, b: &Path) -> bool {
        FileIdentity::of(a).unwrap().is_same_as(&FileIdentity::of(b).unwrap())
    }

    #[test]
    fn one_file_by_many_names() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        fs::create_dir(at("d")).unwrap();
        // Neither exists.
        assert!(same(&at("new"), &at("./d/../new")) && same(&at("d/x"), &at("./d/./x")));
        assert!(same(&at("gone/deeper/x"), &at("./gone/deeper/x")));
        assert!(!same(&at("new"), &at("other")) && !same(&at("d/x"), &at("x")));
        fs::write(at("new"), "").unwrap();
        assert!(same(&at("new"), &at("./d/../new")) && !same(&at("new"), &at("d")));
        // Whether case matters depends on the file system.
        let is_blind = at("NEW").exists();
        assert_eq!(same(&at("new"), &at("NEW")), is_blind);
        assert_eq!(same(&at("unborn"), &at("UNBORN")), is_blind);
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2, "trying out leaves nothing behind");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn where_the_file_system_cannot_be_asked_case_matters() {
        // Nobody can make a file in /proc.
        assert!(!same(Path::new("/proc/unborn"), Path::new("/proc/UNBORN")));
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
        assert!(same(&at("link"), &at("d/target")) && same(&at("second"), &at("e/target")));
        fs::write(at("d/target"), "").unwrap();
        assert!(same(&at("link"), &at("d/target")) && same(&at("second"), &at("e/target")));
        fs::hard_link(at("d/target"), at("hard")).unwrap();
        assert!(same(&at("hard"), &at("link")));
        assert!(FileIdentity::of(Path::new("/dev/null")).is_none());
        symlink("circle", at("circle")).unwrap();
        assert!(follow_links(&at("circle")).is_err());
    }
}
