//! Files that are written whole or not at all: beside their place, then renamed.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that cannot be written. What was there before is as it was.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {reason}; {}", path.display(), remedy(reason))]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// What the system said.
    pub reason: io::Error,
}

fn remedy(reason: &io::Error) -> &'static str {
    match reason.kind() {
        ErrorKind::NotFound => "create its directory first, or choose another place",
        ErrorKind::NotADirectory => "what stands in its directory's place is a file: choose another place",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "choose a place where you may write, or allow it"
        }
        ErrorKind::IsADirectory => "name a file in that directory",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            "free some space or choose another place; the file that was there is as it was"
        }
        ErrorKind::InvalidFilename | ErrorKind::InvalidInput => "choose another name",
        _ => "choose another place",
    }
}

/// Writes `path` by `write`: to a new file in the same directory, which then takes the old one's place. If
/// anything fails, the old file is as it was and the new one is gone. A link is followed; a device or a pipe is
/// written to directly. The file has the usual permissions, or those of the file that it replaces.
///
/// # Errors
/// [`WriteError`], be it from `write` or from the file system.
pub fn replace_file(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
) -> Result<(), WriteError> {
    try_replace(path, write).map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// Writes a text in place of `path`, as [`replace_file`] does.
///
/// # Errors
/// [`WriteError`].
pub fn write_text(path: &Path, text: &str) -> Result<(), WriteError> {
    replace_file(path, |writer| writer.write_all(text.as_bytes()))
}

/// Finds out whether [`replace_file`] could write `path`. It leaves nothing behind, and a file that is there as
/// it is.
///
/// # Errors
/// [`WriteError`]: no such directory, a directory of that name, no permission, a file marked read-only, a name
/// that the file system does not take.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let check = || match Target::find(path)? {
        Target::Device(path) => OpenOptions::new().write(true).open(path).map(drop),
        Target::File { directory, old, .. } => new_file_in(&directory, old.as_ref())?.close(),
    };
    check().map_err(|reason| WriteError { path: path.to_owned(), reason })
}

enum Target {
    File { path: PathBuf, directory: PathBuf, old: Option<Metadata> },
    Device(PathBuf),
}

impl Target {
    fn find(path: &Path) -> io::Result<Target> {
        let path = match fs::symlink_metadata(path) {
            Ok(found) if found.is_symlink() => fs::canonicalize(path)?,
            _ => path.to_owned(),
        };
        let old = match fs::metadata(&path) {
            Ok(old) => Some(old),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        match &old {
            Some(old) if old.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Some(old) if !old.is_file() => return Ok(Target::Device(path)),
            // A rename would replace it all the same, but whoever marked it did not want that.
            Some(old) if old.permissions().readonly() => {
                return Err(io::Error::new(ErrorKind::PermissionDenied, "the file is marked read-only"));
            }
            _ => {}
        }
        let directory = match path.parent() {
            Some(parent) if parent.as_os_str().is_empty() => PathBuf::from("."),
            Some(parent) => parent.to_owned(),
            None => return Err(ErrorKind::InvalidFilename.into()),
        };
        if path.file_name().is_none() {
            return Err(ErrorKind::InvalidFilename.into());
        }
        if !fs::metadata(&directory)?.is_dir() {
            return Err(ErrorKind::NotADirectory.into());
        }
        Ok(Target::File { path, directory, old })
    }
}

fn new_file_in(directory: &Path, old: Option<&Metadata>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".weekender-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let file = builder.tempfile_in(directory)?;
    if let Some(old) = old {
        file.as_file().set_permissions(old.permissions())?;
    }
    Ok(file)
}

fn try_replace(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let fill = |file: &File| {
        let mut writer = BufWriter::with_capacity(1 << 16, file);
        write(&mut writer)?;
        writer.flush()
    };
    match Target::find(path)? {
        Target::Device(path) => fill(&OpenOptions::new().write(true).open(path)?),
        Target::File { path, directory, old } => {
            let new = new_file_in(&directory, old.as_ref())?;
            fill(new.as_file())?;
            // Without it, a machine that stops after the rename may come back with an empty file.
            new.as_file().sync_data()?;
            new.persist(path).map(drop).map_err(|error| error.error)
        }
    }
}
