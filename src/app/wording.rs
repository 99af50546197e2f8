//! Words of messages. Those of other rooms are put in the words of the window, which has controls instead of flags and keys
//! of scene files.

/// The names of the camera's values in scene files, and those of their controls.
const CONTROLS: [(&str, &str); 7] = [
    ("look_from", "Look from"),
    ("look_at", "Look at"),
    ("vup", "Up"),
    ("vfov", "Field of view"),
    ("defocus_angle", "Defocus angle"),
    ("focus_distance", "Focus distance"),
    ("max_depth", "Rays per path, at most"),
];

/// The message with the names that the window's controls have.
pub fn in_window_words(message: &str) -> String {
    let message = message.replace("render with --device reference", "choose Reference (f64) in Render");
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

/// The number with thin spaces between its thousands: `10 040`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}
