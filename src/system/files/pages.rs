//! Web pages that the program writes over its own earlier ones.

use super::replace::{WriteError, check_writable};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// Marks a page as the program's own. It must be within the first 4096 bytes.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"Weekender\">";

/// Bytes of a page that are searched.
const HEAD: u64 = 4096;

/// Checks whether a page can be written to `path` without replacing a foreign file.
///
/// # Errors
/// [`WriteError`] if `path` cannot be written or holds something without [`GENERATOR`].
pub fn check_page(path: &Path) -> Result<(), WriteError> {
    check_writable(path)?;
    let is_own = match head(path) {
        Ok(head) => head.is_empty() || head.windows(GENERATOR.len()).any(|part| part == GENERATOR.as_bytes()),
        Err(error) => error.kind() == ErrorKind::NotFound,
    };
    let other = || io::Error::new(ErrorKind::AlreadyExists, "there is a page that Weekender did not write");
    if is_own { Ok(()) } else { Err(WriteError { path: path.to_owned(), reason: other() }) }
}

fn head(path: &Path) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_own_pages_are_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("index.html");
        check_page(&path).unwrap();
        let nowhere = check_page(&directory.path().join("missing/index.html"));
        assert!(nowhere.unwrap_err().to_string().contains("missing"), "there is no such folder");
        let at_the_end = "x".repeat(HEAD as usize - GENERATOR.len());
        for (page, is_own) in [
            (String::new(), true),
            (format!("<!DOCTYPE html><head>{GENERATOR}<title>T</title>"), true),
            (format!("{at_the_end}{GENERATOR}"), true),
            (format!("{at_the_end}x{GENERATOR}"), false),
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
