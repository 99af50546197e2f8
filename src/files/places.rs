//! Directories of the user.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;

/// The program's directory for state that outlives it, such as rescued films; it may not exist yet.
pub fn state_directory() -> Option<PathBuf> {
    own_directory(env::var_os("XDG_STATE_HOME"), home_directory(), ".local/state")
}

/// The program's directory for what it can make again, such as small pictures; it may not exist yet.
pub fn cache_directory() -> Option<PathBuf> {
    own_directory(env::var_os("XDG_CACHE_HOME"), home_directory(), ".cache")
}

/// The program's directory in the one that a variable names or, if that is not absolute, in the usual one at `home`.
fn own_directory(named: Option<OsString>, home: Option<PathBuf>, usual: &str) -> Option<PathBuf> {
    let named = named.map(PathBuf::from).filter(|directory| directory.is_absolute());
    Some(named.or_else(|| Some(home?.join(usual)))?.join("weekender"))
}

/// The user's home directory.
pub fn home_directory() -> Option<PathBuf> {
    env::home_dir().filter(|home| home.is_absolute())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variable_chooses_the_directory_only_if_it_is_absolute() {
        let here = env::current_dir().unwrap();
        let [state, home] = ["state", "home"].map(|name| here.join(name));
        let usual = Some(home.join(".local/state/weekender"));
        for (named, home, expected) in [
            (Some(state.as_os_str()), Some(&home), Some(state.join("weekender"))),
            (Some(state.as_os_str()), None, Some(state.join("weekender"))),
            (Some("state".as_ref()), Some(&home), usual.clone()),
            (Some("".as_ref()), Some(&home), usual.clone()),
            (None, Some(&home), usual),
            (Some("state".as_ref()), None, None),
            (None, None, None),
        ] {
            let found = own_directory(named.map(ToOwned::to_owned), home.cloned(), ".local/state");
            assert_eq!(found, expected, "{named:?}");
        }
    }
}
