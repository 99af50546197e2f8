//! Output files written whole or not at all: first beside their destination, then renamed.

use super::identity::resolved;
use super::leftovers;
use super::paths::{STANDARD, ShownPath};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A failed write. The previous file is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {reason}; {}", path.shown(), remedy(reason))]
pub struct WriteError {
    pub path: PathBuf,
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

/// Checks whether [`replace_file`] could write `path`, without changing an existing file or leaving a new one. Also
/// removes unfinished files that killed runs left in the directory.
///
/// # Errors
/// [`WriteError`]: the directory does not exist, a directory has that name, permission is missing, the file is marked
/// read-only, or the file system does not accept the name.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    let check = || match Target::find(path)? {
        // Opening a pipe would wait for its reader, and closing it would end the reader's input.
        Target::StandardOutput | Target::Device { is_pipe: true, .. } => Ok(()),
        Target::Device { path, .. } => OpenOptions::new().write(true).open(path).map(drop),
        Target::File { directory, old, .. } => {
            leftovers::remove_from(&directory);
            new_file_in(&directory, old.as_ref())?.close()
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
    File { path: PathBuf, directory: PathBuf, old: Option<Metadata> },
    Device { path: PathBuf, is_pipe: bool },
}

impl Target {
    fn find(named: &Path) -> io::Result<Target> {
        if named == Path::new(STANDARD) {
            return Ok(Target::StandardOutput);
        }
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
        let path = resolved(named)?;
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
pub(super) fn is_pipe(found: &Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&found.file_type())
}

#[cfg(not(unix))]
pub(super) fn is_pipe(_: &Metadata) -> bool {
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

fn try_write(path: &Path, write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>) -> io::Result<()> {
    let fill = |file: &File| {
        let mut writer = BufWriter::with_capacity(1 << 16, file);
        write(&mut writer)?;
        writer.flush()
    };
    match Target::find(path)? {
        Target::StandardOutput => {
            // Some formats are not written from start to end.
            let mut file = tempfile::tempfile()?;
            fill(&file)?;
            file.rewind()?;
            io::copy(&mut file, &mut io::stdout().lock()).map(drop)
        }
        Target::Device { path, .. } => fill(&OpenOptions::new().write(true).open(path)?),
        Target::File { path, directory, old } => {
            let new = new_file_in(&directory, old.as_ref())?;
            fill(new.as_file())?;
            // Without this, the file could be empty after a crash that follows the rename.
            new.as_file().sync_data()?;
            new.persist(path).map(drop).map_err(|error| error.error)
        }
    }
}
