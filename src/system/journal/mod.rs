//! The log, and the report after a panic.
//!
//! Modules log through the crate `log`, as wgpu does. The log is off by default: then only the latest important lines
//! are kept in memory for a panic report. Nothing is logged within a CPU pass.

mod panic;

pub use panic::{expect_panics, watched, write_report};

use crate::system::console;
use anyhow::{Context, Result, anyhow};
use env_filter::Filter;
use log::{Level, LevelFilter, Log, Metadata, Record};
use std::collections::VecDeque;
use std::env;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The environment variable that filters the log.
pub const VARIABLE: &str = "RUST_LOG";

/// What `--log` writes without [`VARIABLE`].
const FILTER_OF_FILE: &str = "warn,weekender=debug";

/// Lines kept for a report.
const KEPT_LINES: usize = 256;

static KEPT: Mutex<VecDeque<String>> = Mutex::new(VecDeque::new());

struct Journal {
    filter: Filter,
    /// `None` for standard error.
    file: Option<Mutex<File>>,
    began: Instant,
}

/// Starts the log: to `file`, or to standard error if [`VARIABLE`] is set. A second call does nothing.
///
/// # Errors
/// If the variable is not a filter or the file cannot be created; nothing is logged then.
pub fn start(file: Option<&Path>) -> Result<()> {
    let value = env::var_os(VARIABLE).map(|value| value.to_string_lossy().trim().to_owned());
    let default = if file.is_some() { FILTER_OF_FILE } else { "off" };
    let filter = filter_of(value.as_deref().filter(|value| !value.is_empty()).unwrap_or(default))?;
    let failed = "cannot be created; choose a file in a directory that you can write to";
    let create =
        |path: &Path| File::create(path).with_context(|| format!("--log {} {failed}", path.display()));
    let file = file.map(create).transpose()?.map(Mutex::new);
    let most = filter.filter().max(LevelFilter::Info);
    if log::set_boxed_logger(Box::new(Journal { filter, file, began: Instant::now() })).is_ok() {
        log::set_max_level(most);
        log::info!("{}", panic::version());
    }
    Ok(())
}

fn filter_of(filter: &str) -> Result<Filter> {
    let mut builder = env_filter::Builder::new();
    let parsed = builder.try_parse(filter).map_err(|reason| {
        anyhow!(
            "{VARIABLE} is {filter:?}, which is not a log filter ({reason}); write a level such as info, or a level for \
             each module such as warn,weekender=debug; levels are error, warn, info, debug, trace and off"
        )
    })?;
    Ok(parsed.build())
}

/// Whether to keep a line for a report: the program's own steps and the warnings of others.
fn is_kept(metadata: &Metadata<'_>) -> bool {
    let is_own = metadata.target().starts_with("weekender");
    metadata.level() <= if is_own { Level::Info } else { Level::Warn }
}

fn keep(line: String) {
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.len() == KEPT_LINES {
        kept.pop_front();
    }
    kept.push_back(line);
}

/// The kept lines, oldest first.
pub fn kept_text() -> String {
    let kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    kept.iter().map(String::as_str).collect::<Vec<_>>().join("\n")
}

impl Log for Journal {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        is_kept(metadata) || self.filter.enabled(metadata)
    }

    fn log(&self, record: &Record<'_>) {
        let (is_kept, is_wanted) = (is_kept(record.metadata()), self.filter.matches(record));
        if !is_kept && !is_wanted {
            return;
        }
        let (seconds, level, target) = (self.began.elapsed().as_secs_f64(), record.level(), record.target());
        let line = format!("{seconds:9.3} s {level:5} {target}: {}", record.args());
        match &self.file {
            Some(file) if is_wanted => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                // A full disk must not end a render.
                let _ = writeln!(file, "{}", console::printable(&line));
            }
            None if is_wanted => console::note(&line),
            _ => {}
        }
        if is_kept {
            keep(line);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(level: Level, target: &str) -> Metadata<'_> {
        Metadata::builder().level(level).target(target).build()
    }

    #[test]
    fn own_steps_and_foreign_warnings_are_kept_for_a_report() {
        let kept = |level, target| is_kept(&metadata(level, target));
        assert!(kept(Level::Info, "weekender::backends") && kept(Level::Warn, "wgpu_hal"));
        assert!(!kept(Level::Debug, "weekender::backends") && !kept(Level::Info, "wgpu_hal"));
        (0..=KEPT_LINES).for_each(|number| keep(format!("line {number}")));
        let text = kept_text();
        assert_eq!(text.lines().count(), KEPT_LINES);
        assert!(text.ends_with(&format!("line {KEPT_LINES}")), "{text}");
    }
}
