//! Directories of the user.

use std::env;
use std::path::PathBuf;

/// The program's directory for state that outlives it, such as rescued films; it may not exist yet.
pub fn state_directory() -> Option<PathBuf> {
    let state = env::var_os("XDG_STATE_HOME").map(PathBuf::from).filter(|state| state.is_absolute());
    Some(state.or_else(|| Some(home_directory()?.join(".local/state")))?.join("weekender"))
}

/// The program's directory for what it can make again, such as small pictures; it may not exist yet.
pub fn cache_directory() -> Option<PathBuf> {
    let cache = env::var_os("XDG_CACHE_HOME").map(PathBuf::from).filter(|cache| cache.is_absolute());
    Some(cache.or_else(|| Some(home_directory()?.join(".cache")))?.join("weekender"))
}

/// The user's home directory.
pub fn home_directory() -> Option<PathBuf> {
    env::home_dir().filter(|home| home.is_absolute())
}
