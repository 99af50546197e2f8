//! Paths as text: in messages, and in JSON.

use crate::console::printable;
use serde::{Serialize, Serializer};
use std::ffi::OsStr;
use std::path::PathBuf;

/// How messages show a path.
pub trait ShownPath {
    /// The path as a piece of one line that cannot control a terminal: see [`printable`]. Bytes that are not UTF-8
    /// become U+FFFD.
    fn shown(&self) -> String;
}

impl<P: AsRef<OsStr> + ?Sized> ShownPath for P {
    fn shown(&self) -> String {
        printable(&self.as_ref().to_string_lossy()).into_owned()
    }
}

/// A path that can be written as JSON, which holds only Unicode: bytes that are not UTF-8 become U+FFFD there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JsonPath(pub PathBuf);

impl From<PathBuf> for JsonPath {
    fn from(path: PathBuf) -> Self {
        JsonPath(path)
    }
}

impl Serialize for JsonPath {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0.to_string_lossy())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_path_is_a_piece_of_one_line() {
        assert_eq!(Path::new("a\nb\u{1b}[31m\u{202e}c.png").shown(), "a\\nb\\u{1b}[31m\\u{202e}c.png");
        assert_eq!(Path::new("Köln/it's a.png").shown(), "Köln/it's a.png");
    }

    #[cfg(unix)]
    #[test]
    fn what_is_not_unicode_is_replaced_in_messages_and_in_json() {
        use std::os::unix::ffi::OsStrExt;
        let path = PathBuf::from(OsStr::from_bytes(b"d\xff/a\n.png"));
        assert_eq!(path.shown(), "d\u{fffd}/a\\n.png");
        let json = serde_json::to_value(JsonPath(path)).unwrap();
        assert_eq!(json, "d\u{fffd}/a\n.png");
    }
}
