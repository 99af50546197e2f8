//! Output files that are written whole or not at all: first beside their destination, then renamed.

use super::leftovers;
use super::paths::ShownPath;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that could not be written. The previous file is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {reason}; {}", path.shown(), remedy(reason))]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// The system's error.
    pub reason: io::Error,
}

fn remedy(reason: &io::Error) -> &'static str {
    match reason.kind() {
        ErrorKind::NotFound => "create its directory first, or choose another place",
        ErrorKind::IsADirectory => "name a file in that directory",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space, or choose another place; an existing file is left unchanged"
        }
        ErrorKind::FileTooLarge => "allow larger files (ulimit -f); an existing file is left unchanged",
        ErrorKind::AlreadyExists => "move it away, or choose another place",
        ErrorKind::InvalidFilename | ErrorKind::InvalidInput => "choose another name",
        _ => "choose another place",
    }
}

/// Writes `path` with `write`: to a new file in the same directory, which then replaces the old one. If anything
/// fails, the old file is unchanged and the new one is deleted. Links are followed. Devices and pipes are written
/// directly. The file gets the usual permissions, or those of the file it replaces.
///
/// # Errors
/// [`WriteError`], from `write` or from the file system.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    NewFile::write(path, write)?.put()
}

/// Replaces `path` with a text, as [`replace_file`] does.
///
/// # Errors
/// [`WriteError`].
pub fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    replace_file(path, |writer| writer.write_all(text.as_bytes()))
}

/// Checks whether [`replace_file`] could write `path`. The check creates nothing that stays and does not change an
/// existing file. It removes unfinished files that killed runs left in the directory.
///
/// # Errors
/// [`WriteError`]: the directory does not exist, a directory has that name, permission is missing, the file is marked
/// read-only, or the file system does not accept the name.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let check = || match Target::find(path)? {
        // Opening a pipe would wait for its reader, and closing it would end the reader's input.
        Target::Device { is_pipe: true, .. } => Ok(()),
        Target::Device { path, .. } => OpenOptions::new().write(true).open(path).map(drop),
        Target::File { directory, old, .. } => {
            leftovers::remove_from(&directory);
            new_file_in(&directory, old.as_ref())?.close()
        }
    };
    check().map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// A file that is written but not yet at its destination. Dropping it deletes the file.
pub(crate) struct NewFile {
    named: PathBuf,
    /// The file and its destination; `None` if it was written directly, to a device.
    pending: Option<(NamedTempFile, PathBuf)>,
}

impl NewFile {
    /// Writes the file beside its destination.
    pub fn write(
        path: &Path,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
    ) -> Result<NewFile, WriteError> {
        match try_write(path, write) {
            Ok(pending) => Ok(NewFile { named: path.to_owned(), pending }),
            Err(reason) => Err(WriteError { path: path.to_owned(), reason }),
        }
    }

    /// The file's path before it is put in place. On Unix, renaming keeps the same file and modification time.
    pub fn pending_path(&self) -> Option<&Path> {
        self.pending.as_ref().map(|(file, _)| file.path())
    }

    /// Moves the file to its destination.
    pub fn put(self) -> Result<(), WriteError> {
        let Some((file, place)) = self.pending else { return Ok(()) };
        file.persist(place).map(drop).map_err(|error| WriteError { path: self.named, reason: error.error })
    }

    /// Moves the file to its destination if nothing exists there. Returns whether it was moved.
    pub fn put_new(self) -> Result<bool, WriteError> {
        let Some((file, place)) = self.pending else { return Ok(true) };
        match file.persist_noclobber(place) {
            Ok(_) => Ok(true),
            Err(error) if error.error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(WriteError { path: self.named, reason: error.error }),
        }
    }
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
    File { path: PathBuf, directory: PathBuf, old: Option<Metadata> },
    Device { path: PathBuf, is_pipe: bool },
}

impl Target {
    fn find(named: &Path) -> io::Result<Target> {
        let old = match fs::metadata(named) {
            Ok(found) if found.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(found) if !found.is_file() => {
                return Ok(Target::Device { path: named.to_owned(), is_pipe: is_pipe(&found) });
            }
            // A rename would replace a read-only file anyway, but the user marked it to prevent that.
            Ok(found) if found.permissions().readonly() => {
                return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is marked read-only"));
            }
            Ok(found) => Some(found),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if old.is_none() && fs::symlink_metadata(named).is_ok() {
            return Err(io::Error::new(ErrorKind::InvalidInput, "it is a link to a file that is not there"));
        }
        let text = named.to_string_lossy();
        if text.strip_suffix('.').unwrap_or(&text).ends_with(std::path::is_separator) {
            return Err(io::Error::new(ErrorKind::InvalidFilename, "its end stands for a directory"));
        }
        let path = if old.is_some() { fs::canonicalize(named)? } else { named.to_owned() };
        let directory = match path.parent() {
            Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
            Some(parent) if path.file_name().is_some() => parent.to_owned(),
            _ => return Err(ErrorKind::InvalidFilename.into()),
        };
        match fs::metadata(&directory) {
            Ok(found) if found.is_dir() => Ok(Target::File { path, directory, old }),
            Ok(_) => Err(ErrorKind::NotADirectory.into()),
            Err(error) => Err(error),
        }
    }
}

#[cfg(unix)]
fn is_pipe(found: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type())
}

#[cfg(not(unix))]
fn is_pipe(_: &Metadata) -> bool {
    false
}

fn new_file_in(directory: &Path, old: Option<&Metadata>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = leftovers::create_in(directory, &mut builder)?;
    if let Some(old) = old {
        file.as_file().set_permissions(old.permissions())?;
    }
    Ok(file)
}

fn try_write(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> io::Result<Option<(NamedTempFile, PathBuf)>> {
    let fill = |file: &File| {
        let mut writer = BufWriter::with_capacity(1 << 16, file);
        write(&mut writer)?;
        writer.flush()
    };
    match Target::find(path)? {
        Target::Device { path, .. } => {
            fill(&OpenOptions::new().write(true).open(path)?)?;
            Ok(None)
        }
        Target::File { path, directory, old } => {
            let new = new_file_in(&directory, old.as_ref())?;
            fill(new.as_file())?;
            // Without this, a system that crashes after the rename may come back with an empty file.
            new.as_file().sync_data()?;
            Ok(Some((new, path)))
        }
    }
}
