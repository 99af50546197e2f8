//! Watches a picture that another program writes: judged after each change, and never while a row is half written.

use super::{Finding, Lines, Mine, judged};
use crate::cli::CheckOptions;
use crate::system::interrupt::Interrupt;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

/// Interval between looks at a file.
pub const POLL_INTERVAL: Duration = Duration::from_millis(200);

/// A file that ends early counts as truncated after this long without a change.
const SETTLED: Duration = Duration::from_secs(3);

/// Share of the rows that a growing picture needs before it is judged.
const ROWS_LEAST: f64 = 0.4;

/// A file's length and modification time, and what changes even if a copy keeps both: the file itself and the time of
/// its last change of any kind. (notify's poll watcher compares only modification times.)
type Stamp = Option<(u64, Option<SystemTime>, [u64; 3])>;

fn stamp(path: &Path) -> Stamp {
    let found = std::fs::metadata(path).ok()?;
    #[cfg(unix)]
    let own = {
        use std::os::unix::fs::MetadataExt;
        [found.ino(), found.ctime() as u64, found.ctime_nsec() as u64]
    };
    #[cfg(not(unix))]
    let own = [0; 3];
    Some((found.len(), found.modified().ok(), own))
}

/// A picture that is judged whenever its file changes.
#[derive(Debug)]
pub struct Watched {
    path: PathBuf,
    /// When the file was first seen as it is now.
    seen: (Stamp, Instant),
    is_told: bool,
    rows: u32,
}

impl Watched {
    pub fn new(path: &Path) -> Self {
        Watched { path: path.to_owned(), seen: (None, Instant::now()), is_told: false, rows: 0 }
    }

    /// The picture and the finding of `judge`; `None` if nothing is new. Call it every [`POLL_INTERVAL`].
    pub fn judged(
        &mut self,
        judge: impl FnOnce(&Mine) -> Result<Finding>,
    ) -> Option<Result<(Mine, Finding)>> {
        Some(self.look()?.and_then(|mine| judge(&mine).map(|finding| (mine, finding))))
    }

    /// The changed picture, possibly with only some of its rows, or why it cannot be read; `None` if nothing is new.
    fn look(&mut self) -> Option<Result<Mine>> {
        let now = stamp(&self.path);
        let has_changed = now != self.seen.0;
        if has_changed {
            let is_rewritten =
                now.is_none_or(|(length, ..)| self.seen.0.is_some_and(|(before, ..)| length < before));
            if is_rewritten || self.is_told {
                self.rows = 0;
            }
            (self.seen, self.is_told) = ((now, Instant::now()), false);
        }
        if self.is_told {
            return None;
        }
        let age = now.and_then(|(_, modified, _)| modified?.elapsed().ok()).unwrap_or_default();
        let is_settled = age.max(self.seen.1.elapsed()) >= SETTLED;
        if has_changed && !is_settled {
            // It may be torn right now, unless it only grows.
            return self.grown().map(Ok);
        }
        let read = Mine::read(&self.path);
        // It changed while it was read.
        if stamp(&self.path) != now || read.is_err() && !is_settled {
            return None;
        }
        self.is_told = true;
        Some(read)
    }

    /// The rows of a picture that grows, if there are enough and more than before.
    fn grown(&mut self) -> Option<Mine> {
        let mine = Mine::begun(&self.path)?;
        let least = (ROWS_LEAST * f64::from(mine.height)) as u32;
        // Judging a few rows costs as much as judging the whole picture, so a picture grows in few steps.
        if mine.rows < least.max(self.rows + mine.height / 5) {
            return None;
        }
        self.rows = mine.rows;
        Some(mine)
    }
}

/// Checks pictures after each change, until Ctrl-C.
pub(super) fn run(options: &CheckOptions) -> Result<ExitCode> {
    let interrupt = Interrupt::install()?;
    let mut lines = Lines::new(options);
    let mut watched: Vec<Watched> = options.pictures.iter().map(|path| Watched::new(path)).collect();
    while !interrupt.is_set() {
        for watched in &mut watched {
            if let Some(judged) = watched.judged(|mine| judged(mine, options, interrupt.flag())) {
                lines.add(&watched.path, &judged)?;
            }
        }
        sleep(POLL_INTERVAL);
    }
    Ok(interrupt.exit_code())
}
