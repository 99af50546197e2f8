//! Rows of tables as text.

use indicatif::HumanCount;

/// Pads cells to the widths; a negative width aligns left.
pub(super) fn text_row(widths: &[i32], cells: &[impl AsRef<str>]) -> String {
    let mut row = String::new();
    for (cell, width) in cells.iter().map(AsRef::as_ref).zip(widths) {
        let size = width.unsigned_abs() as usize;
        row += &if *width < 0 { format!("{cell:<size$} ") } else { format!("{cell:>size$} ") };
    }
    row.truncate(row.trim_end().len());
    row + "\n"
}

/// The value as text, or a dash.
pub(super) fn or_dash<T>(value: Option<T>, text: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), text)
}

/// A number with its noun: `1 lane`, `8 lanes`, `10,000 shells`.
pub fn counted(number: usize, noun: &str) -> String {
    format!("{} {noun}{}", grouped(number as u64), if number == 1 { "" } else { "s" })
}

/// Digits grouped by commas: `10,000`.
pub fn grouped(number: u64) -> String {
    HumanCount(number).to_string()
}
