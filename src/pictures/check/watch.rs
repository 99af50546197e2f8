//! A picture that another program is writing: read when it changes, and never judged in a torn state.

use super::{Finding, Lines, Mine, judged};
use crate::cli::CheckOptions;
use crate::system::interrupt::Interrupt;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

/// How often a file is looked at.
const POLL_INTERVAL: Duration = Duration::from_millis(200);

/// A file that ends early is at its end if nothing is added for so long.
const SETTLED: Duration = Duration::from_secs(3);

/// Least share of the rows that is judged while a picture grows.
const ROWS_LEAST: f64 = 0.4;

/// A file's length and modification time, which change with its content.
type Stamp = Option<(u64, Option<SystemTime>)>;

fn stamp(path: &Path) -> Stamp {
    let found = std::fs::metadata(path).ok()?;
    Some((found.len(), found.modified().ok()))
}

/// A file that is read whenever it has changed.
#[derive(Debug)]
pub struct Watched {
    path: PathBuf,
    /// When the file was first seen as it is now.
    seen: (Stamp, Instant),
    is_told: bool,
    rows: u32,
}

/// What has become of a watched file.
#[derive(Debug)]
pub enum Change {
    /// It has more rows than before, but not all.
    Grown(Mine),
    /// It is written to its end, and right or wrong, or cannot be read.
    Done(Result<Mine>),
}

impl Watched {
    pub fn new(path: &Path) -> Self {
        Watched { path: path.to_owned(), seen: (None, Instant::now()), is_told: false, rows: 0 }
    }

    /// What is new, if the file has rested since the last look. Call it every few tenths of a second.
    pub fn look(&mut self) -> Option<Change> {
        let now = stamp(&self.path);
        if now != self.seen.0 {
            let is_rewritten =
                now.is_none_or(|(length, _)| self.seen.0.is_some_and(|(before, _)| length < before));
            if is_rewritten || self.is_told {
                self.rows = 0;
            }
            (self.seen, self.is_told) = ((now, Instant::now()), false);
            // It may be torn right now, unless it only grows.
            return self.grown();
        }
        if self.is_told {
            return None;
        }
        let read = now.map(|_| Mine::read(&self.path));
        // Changed while it was read.
        if stamp(&self.path) != now {
            return None;
        }
        match read {
            Some(Ok(mine)) => {
                self.is_told = true;
                Some(Change::Done(Ok(mine)))
            }
            _ if self.seen.1.elapsed() < SETTLED => None,
            read => {
                self.is_told = true;
                Some(Change::Done(read.unwrap_or_else(|| Mine::read(&self.path))))
            }
        }
    }

    /// The rows of a picture that grows, if there are enough and more than before.
    fn grown(&mut self) -> Option<Change> {
        let mine = Mine::begun(&self.path)?;
        let least = (ROWS_LEAST * f64::from(mine.height)) as u32;
        // A row that is judged costs as much as the whole picture, so they are judged in few steps.
        if mine.rows < least.max(self.rows + mine.height / 5) {
            return None;
        }
        self.rows = mine.rows;
        Some(Change::Grown(mine))
    }
}

/// Checks pictures after each change, until Ctrl-C.
pub(super) fn run(options: &CheckOptions) -> Result<ExitCode> {
    let interrupt = Interrupt::install()?;
    let mut lines = Lines::new(options);
    let mut watched: Vec<(Watched, Option<Finding>)> =
        options.pictures.iter().map(|path| (Watched::new(path), None)).collect();
    while !interrupt.is_set() {
        for (watched, last) in &mut watched {
            let mine = match watched.look() {
                Some(Change::Done(Ok(mine)) | Change::Grown(mine)) => mine,
                Some(Change::Done(Err(reason))) => {
                    lines.fail(&watched.path, &reason)?;
                    continue;
                }
                None => continue,
            };
            match judged(&mine, options, last.as_ref()) {
                Ok(finding) => {
                    lines.add(&watched.path, &mine, &finding)?;
                    *last = Some(finding);
                }
                Err(reason) => lines.fail(&watched.path, &reason)?,
            }
        }
        sleep(POLL_INTERVAL);
    }
    Ok(interrupt.exit_code())
}
