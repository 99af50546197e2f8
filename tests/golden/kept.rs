//! Kept texts, and numbers and structures as text.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    dead_code,
    reason = "a helper of tests, each of which uses some of it"
)]

use std::fmt::Debug;
use std::path::{Path, PathBuf};

/// Lines of a difference that are shown.
const SHOWN: usize = 40;

/// Compares `actual` with the kept text `name`.
pub fn check(name: &str, actual: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.txt"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, actual).unwrap();
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    if kept == actual {
        return;
    }
    let new = option_env!("CARGO_TARGET_TMPDIR")
        .map_or_else(std::env::temp_dir, PathBuf::from)
        .join(format!("{name}.txt"));
    std::fs::create_dir_all(new.parent().unwrap()).unwrap();
    std::fs::write(&new, actual).unwrap();
    panic!(
        "{name} is not as kept; if it should be, run again with UPDATE_SNAPSHOTS=1; all of it is in {}\n{}",
        new.display(),
        difference(&kept, actual)
    );
}

/// The lines between the first and the last that differ.
fn difference(kept: &str, actual: &str) -> String {
    let [kept, actual] = [kept, actual].map(|text| text.lines().collect::<Vec<_>>());
    let start = kept.iter().zip(&actual).take_while(|(a, b)| a == b).count();
    let ends = kept[start..].iter().rev().zip(actual[start..].iter().rev());
    let end = ends.take_while(|(a, b)| a == b).count();
    let part = |sign: char, lines: &[&str]| -> String {
        let middle = &lines[start..lines.len() - end];
        let more = middle.len().saturating_sub(SHOWN);
        let shown: String = middle.iter().take(SHOWN).map(|line| format!("{sign} {line}\n")).collect();
        if more > 0 { format!("{shown}{sign} and {more} lines more\n") } else { shown }
    };
    let context: String =
        kept[start.saturating_sub(3)..start].iter().map(|line| format!("  {line}\n")).collect();
    format!("{context}{}{}", part('-', &kept), part('+', &actual))
}

/// The fields of `value`, one a line, each with the fields that it is in.
pub fn fields(value: &impl Debug) -> Vec<(String, String)> {
    let text = format!("{value:#?}");
    let mut path: Vec<(String, usize)> = Vec::new();
    let mut fields = Vec::new();
    for line in text.lines() {
        let line = line.trim().trim_end_matches(',');
        let is_end = matches!(line, "}" | ")" | "]" | "})" | "])");
        if is_end {
            path.pop();
            continue;
        }
        let (name, rest) = match line.split_once(": ") {
            Some((name, rest)) if name.chars().all(|c| c.is_alphanumeric() || c == '_') => {
                (name.to_owned(), rest)
            }
            _ => {
                let index = path.last_mut().map_or(0, |(_, count)| std::mem::replace(count, *count + 1));
                (index.to_string(), line)
            }
        };
        let place: Vec<&str> = path.iter().map(|(name, _)| name.as_str()).chain([name.as_str()]).collect();
        let place = place.join(".");
        if rest.ends_with(['{', '(', '[']) && !rest.starts_with('"') {
            fields.push((place, rest.trim_end_matches(['{', '(', '[', ' ']).to_owned()));
            path.push((name, 0));
        } else {
            fields.push((place, rest.to_owned()));
        }
    }
    fields
}

/// FNV-1a of numbers, in 16 digits.
pub fn digest(numbers: impl IntoIterator<Item = u64>) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for byte in numbers.into_iter().flat_map(u64::to_le_bytes) {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    format!("{hash:016x}")
}

/// The digest of a text or of a file.
pub fn digest_of(bytes: &[u8]) -> String {
    digest(bytes.iter().map(|byte| u64::from(*byte)))
}
