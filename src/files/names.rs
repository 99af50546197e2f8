//! Free names for files that must replace no other.

use std::path::PathBuf;

/// The number of names that are tried.
pub const NAME_LIMIT: u32 = 1000;

/// The first of the paths `name(1)`, `name(2)` and so on where nothing exists, not even a link. `None` if all
/// [`NAME_LIMIT`] of them are taken.
pub fn free_name(name: impl Fn(u32) -> PathBuf) -> Option<PathBuf> {
    (1..=NAME_LIMIT).map(name).find(|path| path.symlink_metadata().is_err())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_first_free_name_is_taken_and_none_if_there_is_none() {
        let directory = tempfile::tempdir().unwrap();
        let name = |number: u32| directory.path().join(number.to_string());
        assert_eq!(free_name(name), Some(name(1)));
        fs::write(name(1), "").unwrap();
        fs::create_dir(name(2)).unwrap();
        fs::write(name(4), "").unwrap();
        assert_eq!(free_name(name), Some(name(3)));
        assert_eq!(free_name(|_| name(1)), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_nothing_has_its_name() {
        let directory = tempfile::tempdir().unwrap();
        let name = |number: u32| directory.path().join(number.to_string());
        std::os::unix::fs::symlink("missing", name(1)).unwrap();
        assert_eq!(free_name(name), Some(name(2)));
    }
}
