//! The lines that are kept in memory for a report: how the program began, and what it did last.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Number of lines from the start of the program: adapters and backends are among them.
const FIRST: usize = 64;

/// Number of latest lines.
const LATEST: usize = 192;

/// Most bytes of a line.
const LINE_LIMIT: usize = 2000;

/// The lines of this process.
pub(super) static KEPT: Kept =
    Kept(Mutex::new(Lines { first: Vec::new(), latest: VecDeque::new(), left_out: 0 }));

pub(super) struct Kept(Mutex<Lines>);

struct Lines {
    first: Vec<String>,
    latest: VecDeque<String>,
    left_out: usize,
}

impl Lines {
    fn keep(&mut self, mut line: String) {
        line.truncate(line.floor_char_boundary(LINE_LIMIT));
        if self.first.len() < FIRST {
            self.first.push(line);
            return;
        }
        if self.latest.len() == LATEST {
            self.latest.pop_front();
            self.left_out += 1;
        }
        self.latest.push_back(line);
    }

    fn text(&self) -> String {
        let gap = (self.left_out > 0).then(|| format!("... {} lines left out ...", self.left_out));
        let lines: Vec<&str> =
            self.first.iter().chain(&gap).chain(&self.latest).map(String::as_str).collect();
        lines.join("\n")
    }
}

impl Kept {
    pub(super) fn keep(&self, line: String) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).keep(line);
    }

    /// All kept lines.
    pub(super) fn text(&self) -> String {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beginning_and_the_end_stay() {
        let mut lines = Lines { first: Vec::new(), latest: VecDeque::new(), left_out: 0 };
        for number in 0..1000 {
            lines.keep(format!("line {number}"));
        }
        lines.keep("ö".repeat(LINE_LIMIT));
        let text = lines.text();
        assert!(text.starts_with("line 0\nline 1\n") && text.contains("line 63\n... 745 lines left out ..."));
        assert!(text.contains("line 999\nö") && !text.contains("line 64\n"));
        assert_eq!(text.lines().last().unwrap().len(), LINE_LIMIT);
    }

    #[test]
    fn lines_are_counted_from_the_first_that_is_left_out() {
        let mut lines = Lines { first: Vec::new(), latest: VecDeque::new(), left_out: 0 };
        for number in 0..FIRST + LATEST {
            lines.keep(number.to_string());
        }
        let all: Vec<String> = (0..256).map(|number| number.to_string()).collect();
        assert_eq!(lines.text(), all.join("\n"));
        lines.keep("256".to_owned());
        let text = lines.text();
        assert!(
            text.contains("\n63\n... 1 lines left out ...\n65\n") && text.ends_with("\n255\n256"),
            "{text}"
        );
    }
}
