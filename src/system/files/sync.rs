//! Directories that survive a power cut with the files that were written into them.

use super::paths::ShownPath;
use anyhow::{Context, Result};
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Makes the names in `directory` durable: without this, a crash can undo a rename whose file is already on the disk.
/// Does nothing where directories cannot be opened (Windows, or without the right to list them) or synced.
///
/// # Errors
/// If the disk fails.
pub fn sync_directory(directory: &Path) -> io::Result<()> {
    // The parent of a relative name.
    let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    let Ok(opened) = File::open(directory) else { return Ok(()) };
    match opened.sync_all() {
        Err(error)
            if !matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) && cfg!(unix) =>
        {
            Err(error)
        }
        _ => Ok(()),
    }
}

/// Creates a directory and those above it, if they are missing, and makes the new ones durable.
///
/// # Errors
/// If a directory cannot be created; the message names it and `--out`.
pub fn make_directory(directory: &Path) -> Result<()> {
    let is_new = |at: &&Path| !at.as_os_str().is_empty() && !at.exists();
    let new: Vec<&Path> = directory.ancestors().take_while(is_new).collect();
    // A file's parent may be empty.
    let created = if directory.as_os_str().is_empty() { Ok(()) } else { fs::create_dir_all(directory) };
    let created =
        created.and_then(|()| new.into_iter().filter_map(Path::parent).try_for_each(sync_directory));
    created.with_context(|| {
        format!("cannot create the directory {}; choose another with --out", directory.shown())
    })
}
