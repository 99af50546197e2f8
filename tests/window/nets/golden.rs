//! Stored texts in `tests/snapshots/window`. `UPDATE_SNAPSHOTS=1` writes them anew.

use similar::{ChangeTag, TextDiff};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// How long all texts of a file may take together to become the stored ones.
const PATIENCE: Duration = Duration::from_secs(20);

/// How long one text may take, if `PATIENCE` is not used up.
const PATIENCE_OF_ONE: Duration = Duration::from_secs(6);

/// How long it may take then.
const LEAST: Duration = Duration::from_millis(150);

/// How long a text must stay as it is before it is stored.
const REST: Duration = Duration::from_millis(150);

/// A file of titled texts.
pub struct Golden {
    path: PathBuf,
    stored: Vec<(String, String)>,
    seen: Vec<(String, String)>,
    is_updating: bool,
    waited: Duration,
    faults: String,
}

impl Golden {
    pub fn open(name: &str) -> Self {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots/window").join(name);
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let stored = text
            .split("\n== ")
            .skip(1)
            .map(|section| section.split_once('\n').unwrap_or((section, "")))
            .map(|(title, text)| (title.to_owned(), text.to_owned()))
            .collect();
        let is_updating = std::env::var_os("UPDATE_SNAPSHOTS").is_some();
        Golden { path, stored, seen: Vec::new(), is_updating, waited: Duration::ZERO, faults: String::new() }
    }

    /// Waits until `text`, which may draw frames, is the stored one of this title.
    pub fn expect(&mut self, title: &str, mut text: impl FnMut() -> String) {
        let title = title.replace('\n', " ");
        let mut found = text();
        if self.is_updating {
            let mut since = Instant::now();
            while since.elapsed() < REST {
                std::thread::sleep(Duration::from_millis(5));
                let next = text();
                if next != found {
                    (found, since) = (next, Instant::now());
                }
            }
            self.seen.push((title, found));
            return;
        }
        let stored = self.stored.iter().find(|(other, _)| *other == title).map(|(_, text)| text.as_str());
        let begin = Instant::now();
        let patience = PATIENCE.saturating_sub(self.waited).clamp(LEAST, PATIENCE_OF_ONE);
        while stored.is_some_and(|stored| stored != found) && begin.elapsed() < patience {
            std::thread::sleep(Duration::from_millis(2));
            found = text();
        }
        if stored != Some(found.as_str()) {
            self.waited += begin.elapsed();
            let diff = TextDiff::from_lines(stored.unwrap_or_default(), &found);
            let _ = writeln!(self.faults, "== {title}\n{}", diff.unified_diff().context_radius(1));
        }
        self.seen.push((title, String::new()));
    }

    /// Fails if a text is not the stored one, or a stored one was not asked for.
    pub fn finish(mut self) {
        if self.is_updating {
            let mut text =
                "Written by UPDATE_SNAPSHOTS=1 cargo test --release --test window nets\n".to_owned();
            for (title, section) in &self.seen {
                let _ = write!(text, "\n== {title}\n{section}");
            }
            std::fs::write(&self.path, text).unwrap();
            return;
        }
        for (title, _) in &self.stored {
            if !self.seen.iter().any(|(seen, _)| seen == title) {
                let _ = writeln!(self.faults, "== {title}\nis stored, but no longer there");
            }
        }
        assert!(
            self.faults.is_empty(),
            "{}: - is stored, + is now; if that is meant, UPDATE_SNAPSHOTS=1 stores it\n{}",
            self.path.display(),
            self.faults
        );
    }
}

/// The lines that have gone and those that are new, no more than `limit` of them.
pub fn changes(before: &str, after: &str, limit: usize) -> String {
    let diff = TextDiff::from_lines(before, after);
    let changed: Vec<String> = diff
        .iter_all_changes()
        .filter(|change| change.tag() != ChangeTag::Equal)
        .map(|change| format!("{} {}", change.tag(), change.value()))
        .collect();
    let mut text: String = changes_in_order(&changed, limit);
    if changed.len() > limit {
        let _ = writeln!(text, "  and {} more", changed.len() - limit);
    }
    text
}

fn changes_in_order(changed: &[String], limit: usize) -> String {
    changed.iter().take(limit).map(String::as_str).collect()
}
