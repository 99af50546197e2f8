//! Numbers of a scene file that no type of the program holds, such as `1e400`.

use super::error::FileError;
use std::ops::Range;

/// What the TOML parser says of such a number.
const MESSAGES: [&str; 2] = ["floating-point number overflowed", "integer number overflowed"];

/// Whether this message of the TOML parser is about a number that is too large for it.
pub(super) fn is_meant(message: &str) -> bool {
    MESSAGES.contains(&message)
}

/// Explains the error about the number at `place` in `text`: by what `read` says if the largest number of the same sign
/// is in its place, because this names the key, its limits and a remedy.
pub(super) fn explained(
    error: FileError,
    text: &str,
    place: Range<usize>,
    read: impl FnOnce(&str) -> Result<(), FileError>,
) -> FileError {
    let (name, line, column, message) = match error {
        FileError::Malformed { name, line, column, message } => (name, line, column, message),
        other => return other,
    };
    let (Some(before), Some(number), Some(after)) =
        (text.get(..place.start), text.get(place.clone()), text.get(place.end..))
    else {
        return FileError::Malformed { name, line, column, message };
    };
    let largest = format!("{:?}", if number.starts_with('-') { f64::MIN } else { f64::MAX });
    let with_largest = read(&format!("{before}{largest}{after}"));
    match with_largest {
        Err(FileError::Refused { line, column, reason, .. }) if reason.to_string().contains(&largest) => {
            let message = reason.to_string().replace(&largest, number);
            FileError::Malformed { name, line, column, message }
        }
        _ => {
            let limit = f64::MAX;
            let message =
                format!("{number} is too large for a number, whose limit is {limit:.1e}; use a smaller one");
            FileError::Malformed { name, line, column, message }
        }
    }
}
