//! Web pages that the program writes over its own earlier ones.

use super::replace::{WriteError, check_writable};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

/// Marks a page as the program's own.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"Weekender\">";

/// Checks whether a page can be written to `path` without replacing a foreign file.
///
/// # Errors
/// [`WriteError`] if `path` cannot be written or holds something without [`GENERATOR`].
pub fn check_page(path: &Path) -> Result<(), WriteError> {
    check_writable(path)?;
    let is_own = match fs::read(path) {
        Ok(page) => page.is_empty() || page.windows(GENERATOR.len()).any(|part| part == GENERATOR.as_bytes()),
        Err(error) => error.kind() == ErrorKind::NotFound,
    };
    let other = || io::Error::new(ErrorKind::AlreadyExists, "there is a page that Weekender did not write");
    if is_own { Ok(()) } else { Err(WriteError { path: path.to_owned(), reason: other() }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_own_page_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("index.html");
        check_page(&path).unwrap();
        let nowhere = check_page(&directory.path().join("missing/index.html"));
        assert!(nowhere.unwrap_err().to_string().contains("missing"), "there is no such folder");
        for (page, is_own) in [
            (String::new(), true),
            (format!("<!DOCTYPE html><head>{GENERATOR}<title>T</title>"), true),
            ("<title>My own pictures, rendered by Weekender</title>".to_owned(), false),
        ] {
            std::fs::write(&path, &page).unwrap();
            let checked = check_page(&path).map_err(|error| error.to_string());
            assert_eq!(checked.is_ok(), is_own, "{checked:?}");
            if let Err(message) = checked {
                assert!(
                    message.contains("index.html: there is a page that Weekender did not write; move it"),
                    "{message}"
                );
            }
            assert_eq!(std::fs::read_to_string(&path).unwrap(), page);
        }
    }
}
