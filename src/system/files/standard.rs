//! Files without a name, for what goes through standard input, standard output and pipes but must be read or written in
//! any order.

use super::paths::temporary_directory;
use std::fs::File;
use std::io;

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
