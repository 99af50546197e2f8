//! Output files written whole or not at all: first beside their destination, then renamed.

use super::lock::{FileLock, hidden, is_busy, lock_path, patiently};
use super::paths::{STANDARD, ShownPath, resolved, unnamed};
use super::sync::sync_directory;
use std::fs::{self, File, Metadata, OpenOptions, Permissions};
use std::io::{self, BufWriter, ErrorKind, Seek, Write};
use std::path::{Component, Path, PathBuf, Prefix};
use std::time::Duration;
use tempfile::{NamedTempFile, TempPath};

/// Whether files have permissions. Those in the memory of a page have none, which reads as read-only.
const HAVE_PERMISSIONS: bool = !cfg!(target_family = "wasm");

/// A failed write. The previous file is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {reason}; {}", named(path), remedy(path, reason))]
pub struct WriteError {
    pub path: PathBuf,
    pub reason: io::Error,
}

/// How messages name an output.
fn named(path: &Path) -> String {
    if path == Path::new(STANDARD) { "standard output".to_owned() } else { path.shown() }
}

fn remedy(path: &Path, reason: &io::Error) -> &'static str {
    match reason.kind() {
        _ if path == Path::new(STANDARD) => "write to a file, or to a program that reads all of it",
        ErrorKind::NotFound => "create its directory first, or choose another place",
        ErrorKind::IsADirectory => "name a file in that directory",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space, or choose another place; an existing file is left unchanged"
        }
        ErrorKind::FileTooLarge => "allow larger files (ulimit -f); an existing file is left unchanged",
        ErrorKind::ResourceBusy => "close it there, wait for its end, or choose another place",
        ErrorKind::AlreadyExists => "move it away, or choose another place",
        ErrorKind::InvalidFilename | ErrorKind::InvalidInput => "choose another name",
        _ => "choose another place",
    }
}

/// Writes a new file in the directory of `path` with `write`, then renames it over the old one. On failure the old file
/// is unchanged and the new one is deleted. Links are followed; devices and pipes are written directly, and `-` is
/// standard output. The file gets the usual permissions, or those of the file it replaces.
///
/// # Errors
/// [`WriteError`], from `write` or from the file system.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    try_write(path, write).map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// Replaces `path` with `text`: see [`replace_file`].
///
/// # Errors
/// [`WriteError`].
pub fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    replace_file(path, |writer| writer.write_all(text.as_bytes()))
}

/// Checks whether [`replace_file`] could write `path`, without changing an existing file or leaving a new one.
///
/// # Errors
/// [`WriteError`]: the directory does not exist, a directory has that name, permission is missing, the file is marked
/// read-only or, on Windows, open in another program, or the file system does not accept the name.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let check = || match Target::find(path)? {
        Target::StandardOutput => unnamed().map(drop),
        // Opening a pipe would wait for its reader, and closing it would end the reader's input.
        Target::Device { is_pipe: true } => Ok(()),
        Target::Device { .. } => OpenOptions::new().write(true).open(path).map(drop),
        Target::File { path, old, .. } => {
            let is_there = old.is_some();
            new_file_for(&path, old)?.close()?;
            if is_there { once_closed(|| can_be_replaced(&path)) } else { Ok(()) }
        }
    };
    check().map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// Like [`check_writable`], for a film, which is not written sequentially.
///
/// # Errors
/// Those of [`check_writable`], and an error for pipes.
pub fn check_replaceable(path: &Path) -> Result<(), WriteError> {
    if fs::metadata(path).is_ok_and(|found| is_pipe(&found)) {
        let reason = io::Error::new(ErrorKind::NotSeekable, "a film cannot go through a pipe");
        return Err(WriteError { path: path.to_owned(), reason });
    }
    check_writable(path)
}

enum Target {
    StandardOutput,
    File { path: PathBuf, directory: PathBuf, old: Option<Permissions> },
    Device { is_pipe: bool },
}

impl Target {
    fn find(named: &Path) -> io::Result<Target> {
        if named == Path::new(STANDARD) {
            return Ok(Target::StandardOutput);
        }
        if let Some(reason) = refusal_of_windows(named).filter(|_| cfg!(windows)) {
            return Err(io::Error::new(ErrorKind::InvalidFilename, reason));
        }
        let old = match fs::metadata(named) {
            Ok(found) if found.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => return Ok(Target::Device { is_pipe: is_pipe(&found) }),
            // A rename would replace a read-only file anyway, but the user marked it to prevent that.
            Ok(found) if HAVE_PERMISSIONS && found.permissions().readonly() => {
                return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is marked read-only"));
            }
            Ok(found) => Some(found.permissions()),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if old.is_none() && fs::symlink_metadata(named).is_ok() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "it is a link to a missing file"));
        }
        let text = named.to_string_lossy();
        if text.strip_suffix('.').unwrap_or(&text).ends_with(std::path::is_separator) {
            return Err(io::Error::new(ErrorKind::InvalidFilename, "it names a directory"));
        }
        let path = resolved(named)?;
        let (Some(directory), Some(_)) = (path.parent(), path.file_name()) else {
            return Err(ErrorKind::InvalidFilename.into());
        };
        if !fs::metadata(directory)?.is_dir() {
            return Err(ErrorKind::NotADirectory.into());
        }
        Ok(Target::File { directory: directory.to_owned(), path, old })
    }
}

/// Why Windows would not write to a file of this name. A canonical path bypasses its checks.
fn refusal_of_windows(path: &Path) -> Option<&'static str> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if is_device(path) {
        Some("Windows reserves this name for a device")
    } else if name.contains(['<', '>', ':', '"', '|', '?', '*']) {
        Some("Windows allows none of < > : \" | ? * in a name")
    } else if name.ends_with(['.', ' ']) {
        Some("Windows drops dots and spaces at the end of a name")
    } else {
        None
    }
}

/// Whether Windows takes a path for a device, as it does `NUL` and, before version 11, `aux.png`.
fn is_device(path: &Path) -> bool {
    let whole = std::path::absolute(path).unwrap_or_default();
    matches!(whole.components().next(), Some(Component::Prefix(prefix)) if matches!(prefix.kind(), Prefix::DeviceNS(_)))
}

/// Waits for another program to close the file that is to be replaced. Some programs briefly open each new file.
fn once_closed<T>(attempt: impl FnMut() -> io::Result<T>) -> io::Result<T> {
    patiently(FileLock::PATIENCE, attempt).map_err(|error| match is_busy(&error) {
        true => io::Error::new(ErrorKind::ResourceBusy, "another program has it open"),
        false => error,
    })
}

/// On Windows, a file that another program has open can be replaced only if that program allows it.
#[cfg(windows)]
fn can_be_replaced(path: &Path) -> io::Result<()> {
    use std::os::windows::fs::OpenOptionsExt;
    const DELETE: u32 = 0x0001_0000;
    OpenOptions::new().access_mode(DELETE).open(path).map(drop)
}

#[cfg(not(windows))]
fn can_be_replaced(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(unix)]
pub(super) fn is_pipe(found: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type())
}

#[cfg(not(unix))]
pub(super) fn is_pipe(_: &Metadata) -> bool {
    false
}

/// An empty file beside `path`, locked so that no other run writes it, too. Dropping it deletes the file.
fn new_file_for(path: &Path, old: Option<Permissions>) -> io::Result<NamedTempFile> {
    let part = hidden(path, ".part")?;
    if fs::symlink_metadata(&part).is_ok_and(|found| !found.is_file()) {
        return Err(io::Error::new(ErrorKind::AlreadyExists, format!("{} is in the way", part.shown())));
    }
    let emptied = || {
        let file = lock_path(&part, Duration::ZERO)?;
        file.set_len(0).map(|()| file)
    };
    let file = once_closed(emptied).or_else(|error| match error.kind() {
        ErrorKind::ResourceBusy => Err(error),
        // Where the file system has no locks, runs are not kept apart.
        _ => File::create(&part),
    })?;
    let file = NamedTempFile::from_parts(file, TempPath::try_from_path(part)?);
    if let Some(old) = old.filter(|_| HAVE_PERMISSIONS) {
        file.as_file().set_permissions(old)?;
    }
    Ok(file)
}

fn try_write(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let fill = |file: &File| {
        let mut writer = BufWriter::with_capacity(1 << 16, file);
        write(&mut writer)?;
        writer.flush()
    };
    match Target::find(path)? {
        Target::StandardOutput => {
            // Some formats are not written sequentially.
            let mut file = unnamed()?;
            fill(&file)?;
            file.rewind()?;
            io::copy(&mut file, &mut io::stdout().lock()).map(drop)
        }
        Target::Device { .. } => fill(&OpenOptions::new().write(true).open(path)?),
        Target::File { path, directory, old } => {
            let new = new_file_for(&path, old)?;
            fill(new.as_file())?;
            // Without this, the file could be empty after a crash that follows the rename.
            new.as_file().sync_data()?;
            let mut new = Some(new);
            once_closed(|| match new.take().map(|new| new.persist(&path)) {
                Some(Err(refused)) => {
                    new = Some(refused.file);
                    Err(refused.error)
                }
                _ => Ok(()),
            })?;
            sync_directory(&directory)
        }
    }
}

#[cfg(all(test, windows))]
mod tests {
    use super::*;
    use std::os::windows::fs::OpenOptionsExt;

    #[test]
    fn files_open_elsewhere_are_not_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("film.exr");
        fs::write(&path, "old").unwrap();
        let read_only = 1;
        let held = OpenOptions::new().read(true).share_mode(read_only).open(&path).unwrap();
        for refused in [check_writable(&path), write_text(&path, "new")] {
            let message = refused.unwrap_err().to_string();
            assert!(message.contains("another program has it open; close it there"), "{message}");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        let waiting = std::thread::spawn(move || write_text(&path, "new").is_ok());
        drop(held);
        assert!(waiting.join().unwrap(), "it is closed in time");
        assert_eq!(fs::read_dir(&directory).unwrap().count(), 1);
    }

    #[test]
    fn names_that_windows_would_change_are_refused() {
        let refused = |name: &str| refusal_of_windows(Path::new(name)).is_some();
        for name in ["a.exr:b.exr", "a?.exr", "C:\\films\\a.exr.", "a.exr "] {
            assert!(refused(name), "{name}");
        }
        assert!(!refused("C:a.exr") && !refused("C:\\films\\Köln 1.exr") && !refused(".\\..\\a.exr"));
    }

    #[test]
    fn device_names_are_refused() {
        for name in ["NUL", "con", "C:\\a folder\\com1"] {
            assert!(is_device(Path::new(name)), "{name}");
        }
        for name in ["nul-", "film.exr", "C:\\a folder\\console"] {
            assert!(!is_device(Path::new(name)), "{name}");
        }
    }
}

#[cfg(test)]
mod tests_of_parts {
    use super::*;

    /// The file beside the output has a name that follows from it, so nothing has to be searched for.
    #[test]
    fn the_next_write_takes_over_what_a_killed_one_left() {
        let directory = tempfile::tempdir().unwrap();
        let (path, part) = (directory.path().join("g.png"), directory.path().join(".weekender-g.png.part"));
        fs::write(&part, "half a picture, longer than a whole one").unwrap();
        write_text(&path, "whole").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
        assert!(!part.exists());
        let used = new_file_for(&path, None).unwrap();
        let message = write_text(&path, "second").unwrap_err().to_string();
        assert!(message.contains("another program has it open"), "{message}");
        drop(used);
        let long = directory.path().join(format!("{}.png", "ö".repeat(120)));
        write_text(&long, "long").unwrap();
        assert_eq!(fs::read_to_string(&long).unwrap(), "long");
        fs::create_dir(&part).unwrap();
        assert!(check_writable(&path).unwrap_err().to_string().contains("in the way"));
    }

    #[test]
    fn writers_of_one_file_take_turns() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("g.png");
        std::thread::scope(|scope| {
            for text in ["a", "bb", "ccc"] {
                let path = &path;
                scope.spawn(move || (0..20).for_each(|_| write_text(path, text).unwrap()));
            }
        });
        assert!(["a", "bb", "ccc"].contains(&fs::read_to_string(&path).unwrap().as_str()));
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }
}
