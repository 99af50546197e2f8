//! File access: inputs are checked for kind and length before they are read; outputs are written whole or not at all.

mod identity;
mod leftovers;
mod lock;
mod names;
mod pages;
mod places;
mod read;
mod replace;
mod shown;

pub use identity::FileIdentity;
pub(crate) use identity::Stamp;
pub use lock::{FileLock, LockedError, lock_path};
pub use names::{NAME_LIMIT, free_name};
pub use pages::{GENERATOR, check_page};
pub use places::{cache_directory, home_directory, state_directory};
pub use read::{InputError, open, read};
pub use replace::{WriteError, check_replaceable, check_writable, replace_file, write_text};
pub use shown::{JsonPath, ShownPath};
