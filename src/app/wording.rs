//! Words of messages. Those of other rooms are put in the words of the window, which has controls instead of flags and keys
//! of scene files.

use super::model::device::Device;

/// The names of the camera's values in scene files, and those of their controls.
const CONTROLS: [(&str, &str); 7] = [
    ("look_from", "Look from"),
    ("look_at", "Look at"),
    ("vup", "Up"),
    ("vfov", "Field of view"),
    ("defocus_angle", "Defocus angle"),
    ("focus_distance", "Focus distance"),
    ("max_depth", "Depth"),
];

/// The message with the names that the window's controls have.
pub fn in_window_words(message: &str) -> String {
    let device = format!("choose the device {}", Device::Reference.label());
    let message = message.replace("render with --device reference", &device);
    let is_in_name = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut words = String::with_capacity(message.len());
    for piece in message.split_inclusive(|c: char| !is_in_name(c)) {
        let name = piece.trim_end_matches(|c: char| !is_in_name(c));
        let control = CONTROLS.iter().find(|(key, _)| *key == name).map_or(name, |(_, control)| *control);
        words.push_str(control);
        words.push_str(&piece[name.len()..]);
    }
    words
}

/// The text with a small first letter, to follow a colon.
pub fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_goes_on_in_the_middle_of_a_sentence() {
        assert_eq!(["Nothing yet", "Über", "a", ""].map(lower_first), ["nothing yet", "über", "a", ""]);
    }

    #[test]
    fn flags_and_keys_become_controls() {
        for (message, expected) in [
            ("vup is [0, 0, 0], which has no direction", "Up is [0, 0, 0], which has no direction"),
            ("look_from and look_at are both 0; move one", "Look from and Look at are both 0; move one"),
            (
                "make it thicker, or render with --device reference",
                "make it thicker, or choose the device f64",
            ),
            ("(focus_distance)", "(Focus distance)"),
            ("vfov is 0 and defocus_angle is -1", "Field of view is 0 and Defocus angle is -1"),
            ("max_depth is 0; vfov2 and max_depths", "Depth is 0; vfov2 and max_depths"),
            ("\"my_vup.exr\" cannot be read", "\"my_vup.exr\" cannot be read"),
            ("größer als vup", "größer als Up"),
            ("", ""),
        ] {
            assert_eq!(in_window_words(message), expected);
        }
    }
}
