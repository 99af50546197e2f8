//! The log, and the report after a panic.
//!
//! Rooms write to the log through the crate `log`, as wgpu does. It is off by default: then only a few lines of
//! importance are kept in memory, for the report after a panic. Nothing is logged within a pass of the CPU.

mod kept;
mod panic;

pub use panic::{watched, write_report};

use crate::console;
use env_filter::Filter;
use kept::KEPT;
use log::{Level, LevelFilter, Log, Metadata, Record};
use std::env::{self, VarError};
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The variable that chooses what is logged.
pub const VARIABLE: &str = "RUST_LOG";

/// What `--log` writes without [`VARIABLE`].
const FILTER_OF_FILE: &str = "warn,weekender=debug";

/// Why the log cannot be started.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The filter is not valid.
    #[error(
        "{VARIABLE} is {value:?}, which is not a log filter ({reason}); write a level such as info, or a level for each \
         module such as warn,weekender=debug; levels are error, warn, info, debug, trace and off"
    )]
    Filter {
        /// The value of the variable.
        value: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The file cannot be written.
    #[error("--log {}: {source}; choose a file in a directory that you can write to", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
}

/// Where lines go.
enum Target {
    Nowhere,
    StandardError,
    File(Mutex<File>),
}

struct Journal {
    filter: Filter,
    target: Target,
    began: Instant,
}

/// Starts the log: to `file`, or to standard error if [`VARIABLE`] is set. A second call does nothing.
///
/// # Errors
/// [`JournalError`]; nothing is logged then.
pub fn start(file: Option<&Path>) -> Result<(), JournalError> {
    let value = match env::var(VARIABLE) {
        Ok(value) => Some(value),
        Err(VarError::NotPresent) => None,
        Err(VarError::NotUnicode(value)) => {
            let value = value.to_string_lossy().into_owned();
            return Err(JournalError::Filter { value, reason: "not UTF-8".to_owned() });
        }
    };
    let wish = wish_of(value.as_deref(), file.is_some());
    let filter = filter_of(wish.unwrap_or("off"))?;
    let target = match (file, wish) {
        (Some(path), _) => {
            let file =
                File::create(path).map_err(|source| JournalError::File { path: path.to_owned(), source })?;
            Target::File(Mutex::new(file))
        }
        (None, Some(_)) => Target::StandardError,
        (None, None) => Target::Nowhere,
    };
    let most = filter.filter().max(LevelFilter::Info);
    let journal = Journal { filter, target, began: Instant::now() };
    if log::set_boxed_logger(Box::new(journal)).is_ok() {
        log::set_max_level(most);
    }
    Ok(())
}

/// What is to be logged if [`VARIABLE`] has this value; `None` if nothing is.
fn wish_of(value: Option<&str>, has_file: bool) -> Option<&str> {
    let given = value.map(str::trim).filter(|value| !value.is_empty());
    given.or(has_file.then_some(FILTER_OF_FILE))
}

fn filter_of(words: &str) -> Result<Filter, JournalError> {
    let mut builder = env_filter::Builder::new();
    let parsed = builder.try_parse(words);
    parsed
        .map(env_filter::Builder::build)
        .map_err(|error| JournalError::Filter { value: words.to_owned(), reason: error.to_string() })
}

/// Whether a line is kept for a report: what the program itself did, and the warnings of others.
fn is_kept(metadata: &Metadata<'_>) -> bool {
    let is_own = metadata.target().starts_with("weekender");
    metadata.level() <= if is_own { Level::Info } else { Level::Warn }
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
        if is_wanted {
            match &self.target {
                Target::Nowhere => {}
                Target::StandardError => console::note(&line),
                Target::File(file) => {
                    let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                    // A full disk must not end a render.
                    let _ = writeln!(file, "{}", console::printable(&line));
                }
            }
        }
        if is_kept {
            KEPT.keep(line);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_chooses_by_module_and_level_and_what_is_wrong_with_it_is_told() {
        let filter = filter_of("warn,weekender=debug").unwrap();
        let is_on = |level, target| filter.enabled(&Metadata::builder().level(level).target(target).build());
        assert!(is_on(Level::Debug, "weekender::render_gpu") && is_on(Level::Warn, "wgpu_core"));
        assert!(!is_on(Level::Trace, "weekender::render_gpu") && !is_on(Level::Info, "wgpu_core"));
        let told = filter_of("weekender=loud").err().unwrap().to_string();
        assert!(told.contains("weekender=loud") && told.contains("levels are error"), "{told}");
    }

    #[test]
    fn own_steps_and_foreign_warnings_are_kept() {
        let kept = |level, target| is_kept(&Metadata::builder().level(level).target(target).build());
        assert!(kept(Level::Info, "weekender::backends") && kept(Level::Warn, "wgpu_hal"));
        assert!(!kept(Level::Debug, "weekender::backends") && !kept(Level::Info, "wgpu_hal"));
    }

    #[test]
    fn a_file_has_a_filter_of_its_own_unless_the_variable_has_one() {
        for (value, has_file, expected) in [
            (None, false, None),
            (Some("  "), false, None),
            (None, true, Some("warn,weekender=debug")),
            (Some(""), true, Some("warn,weekender=debug")),
            (Some(" info "), false, Some("info")),
            (Some("info"), true, Some("info")),
        ] {
            assert_eq!(wish_of(value, has_file), expected, "{value:?}, {has_file}");
        }
    }

    #[test]
    fn a_file_gets_what_the_filter_lets_through() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run.log");
        let journal = |words: &str| Journal {
            filter: filter_of(words).unwrap(),
            target: Target::File(Mutex::new(File::create(&path).unwrap())),
            began: Instant::now(),
        };
        let logged = |words: &str| -> Vec<String> {
            let journal = journal(words);
            for (level, target) in
                [(Level::Debug, "weekender::a"), (Level::Info, "weekender::b"), (Level::Debug, "wgpu_core")]
            {
                journal.log(
                    &Record::builder().level(level).target(target).args(format_args!("x\u{1b}")).build(),
                );
            }
            let text = std::fs::read_to_string(&path).unwrap();
            text.lines().map(|line| line.split_once(" s ").unwrap().1.to_owned()).collect()
        };
        assert_eq!(logged(FILTER_OF_FILE), ["DEBUG weekender::a: x\\u{1b}", "INFO  weekender::b: x\\u{1b}"]);
        assert_eq!(logged("wgpu_core=trace"), ["DEBUG wgpu_core: x\\u{1b}"]);
        assert_eq!(logged("off"), [""; 0]);
    }
}
