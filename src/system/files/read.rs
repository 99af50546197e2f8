//! Input files: their kind and length are checked before anything is read.

use super::paths::{STANDARD, ShownPath, unnamed};
use super::replace::is_pipe;
use crate::system::memory::words;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Display;
use std::fs::{self, File};
use std::io::{self, IsTerminal, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A file that cannot be read or is not a sensible input.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("{0}")]
pub struct InputError(String);

impl InputError {
    pub(crate) fn unreadable(path: &Path, reason: impl Display) -> Self {
        if path == Path::new(STANDARD) {
            return InputError(format!(
                "cannot read standard input: {reason}; pipe a file into it, or name the file"
            ));
        }
        let path = path.shown();
        InputError(format!("cannot read {path}: {reason}; check its name and its permissions"))
    }
}

/// Opens a file and returns it with its length in bytes. For a pipe or standard input (`-`), opens a copy.
///
/// # Errors
/// [`InputError`]. Anything but files and pipes is refused: some devices never end, and some block forever.
pub fn open(path: &Path) -> Result<(File, u64), InputError> {
    let unreadable = |reason: io::Error| InputError::unreadable(path, reason);
    let file = if path == Path::new(STANDARD) {
        copied(path).map_err(unreadable)?
    } else {
        let found = fs::metadata(path).map_err(unreadable)?;
        let is_pipe = is_pipe(&found);
        if !found.is_file() && !is_pipe {
            let kind = if found.is_dir() { "a directory" } else { "a device or a socket" };
            let path = path.shown();
            return Err(InputError(format!("{path} is {kind}, but a file is needed; name a regular file")));
        }
        if is_pipe { copied(path) } else { File::open(path) }.map_err(unreadable)?
    };
    let length = file.metadata().map_err(unreadable)?.len();
    Ok((file, length))
}

/// Longest content of a pipe, bytes.
const PIPE_LIMIT: u64 = 16 << 30;

/// The content of pipes, in files without names: each can be read only once, but may be needed several times.
static COPIED: Mutex<BTreeMap<PathBuf, File>> = Mutex::new(BTreeMap::new());

fn copied(path: &Path) -> io::Result<File> {
    let mut all = COPIED.lock().unwrap_or_else(PoisonError::into_inner);
    let copy = match all.entry(path.to_owned()) {
        Entry::Occupied(known) => known.into_mut(),
        Entry::Vacant(new) => new.insert(copy_of(path)?),
    };
    let mut file = copy.try_clone()?;
    file.rewind()?;
    Ok(file)
}

fn copy_of(path: &Path) -> io::Result<File> {
    let mut copy = unnamed()?;
    let length = if path != Path::new(STANDARD) {
        io::copy(&mut File::open(path)?.take(PIPE_LIMIT), &mut copy)?
    } else if io::stdin().is_terminal() {
        return Err(io::Error::other("it is a terminal, but a file is needed"));
    } else {
        io::copy(&mut io::stdin().take(PIPE_LIMIT), &mut copy)?
    };
    if length == PIPE_LIMIT {
        return Err(io::Error::other(format!("it delivers more than {}", words(PIPE_LIMIT))));
    }
    Ok(copy)
}

/// Reads at a position in a file. On systems without such reads, this moves the file's own position.
pub(crate) fn read_at(file: &File, bytes: &mut [u8], place: u64) -> io::Result<usize> {
    #[cfg(unix)]
    return std::os::unix::fs::FileExt::read_at(file, bytes, place);
    #[cfg(windows)]
    return std::os::windows::fs::FileExt::seek_read(file, bytes, place);
    #[cfg(not(any(unix, windows)))]
    {
        let mut file = file;
        file.seek(io::SeekFrom::Start(place))?;
        file.read(bytes)
    }
}

/// Reads a file of at most `limit` bytes. `what` names the expected kind, such as "a scene file".
///
/// # Errors
/// [`InputError`].
pub fn read(path: &Path, what: &'static str, limit: u64) -> Result<Vec<u8>, InputError> {
    let (file, length) = open(path)?;
    let too_long = |bytes| {
        let (path, bytes, limit) = (path.shown(), words(bytes), words(limit));
        InputError(format!(
            "{path} has {bytes}, but {what} may have at most {limit}; check that it is the right file"
        ))
    };
    if length > limit {
        return Err(too_long(length));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length as usize).map_err(|error| InputError::unreadable(path, error))?;
    // Some files report a length of 0 but have content; others grow while they are read.
    file.take(limit + 1).read_to_end(&mut bytes).map_err(|error| InputError::unreadable(path, error))?;
    if bytes.len() as u64 > limit {
        return Err(too_long(bytes.len() as u64));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("ten");
        fs::write(&path, [7; 10]).unwrap();
        assert_eq!(read(&path, "a list", 10).unwrap(), [7; 10]);
        let message = read(&path, "a list", 9).unwrap_err().to_string();
        assert!(message.contains("10 B") && message.contains("9 B"), "{message}");
        assert!(read(&directory.path().join("x"), "a list", 1).is_err());
    }

    /// The system reports a length of 0 for this file.
    #[cfg(target_os = "linux")]
    #[test]
    fn file_longer_than_reported_is_read_whole_or_refused() {
        let path = Path::new("/proc/version");
        let whole = fs::read(path).unwrap();
        let length = whole.len() as u64;
        assert_eq!(read(path, "a list", length).unwrap(), whole);
        assert!(read(path, "a list", length - 1).unwrap_err().to_string().contains("may have at most"));
    }
}
