//! File access: inputs are checked for kind and length before they are read; outputs are written whole or not at all.

mod lock;
mod paths;
mod read;
mod replace;
mod sync;

pub use lock::{FileLock, LockedError, lock_path};
pub use paths::{
    STANDARD, ShownPath, home_directory, identity, pictures_directory, state_directory, temporary_directory,
};
pub(crate) use read::read_at;
pub use read::{InputError, open, read};
pub use replace::{WriteError, check_replaceable, check_writable, replace_file, write_text};
pub use sync::{make_directory, sync_directory};
