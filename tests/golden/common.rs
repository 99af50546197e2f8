//! Runs of the program, and marks for what differs from run to run.

pub use crate::kept::{check, digest, digest_of, fields};

use crate::program_common::{text, weekender};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The results of `each` for all items, in their order. As many run at once as there are cores.
pub fn at_once<T: Sync, R: Send>(items: &[T], each: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut results: Vec<(usize, R)> = std::thread::scope(|scope| {
        let work = || {
            let mut own = Vec::new();
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(index) else { return own };
                own.push((index, each(item)));
            }
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}

/// Runs a command line of the program and tells its exit code, what it printed, and on which stream.
pub fn told(directory: &Path, line: &str) -> String {
    let words = shlex::split(line).unwrap();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mut command = weekender(directory, &words);
    command.env("COLUMNS", "100").env_remove("RUST_LOG").env_remove("NO_COLOR");
    let output = command.output().unwrap();
    let code = output.status.code().map_or_else(|| "a signal".to_owned(), |code| code.to_string());
    let mut told = format!("$ weekender {line}\n");
    if code != "0" {
        told.push_str(&format!("[exit code {code}]\n"));
    }
    told.push_str(&settled(&text(&output.stdout), directory));
    for line in settled(&text(&output.stderr), directory).lines() {
        told.push_str(&format!("! {line}\n"));
    }
    told
}

/// `text` without what differs from run to run or from machine to machine: places, times and versions.
pub fn settled(text: &str, directory: &Path) -> String {
    let places = [
        (env!("CARGO_BIN_EXE_weekender"), "weekender"),
        (directory.to_str().unwrap(), "DIR"),
        (concat!("Weekender ", env!("CARGO_PKG_VERSION")), "Weekender VERSION"),
        (concat!("\"version\": \"", env!("CARGO_PKG_VERSION"), "\""), "\"version\": \"VERSION\""),
    ];
    let text = places.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to));
    text.split_inclusive('\n').map(settled_line).collect()
}

fn settled_line(line: &str) -> String {
    let starts = |parts: &[&str]| parts.iter().any(|part| line.trim_start().starts_with(part));
    let is_time = starts(&["time  ", "speed  "])
        || ["_seconds\":", "_per_second\":", "seconds_", "\"bytes\":"].iter().any(|key| line.contains(key))
        || line.contains(" s of tracing")
        || line.contains("Mpaths/s");
    let is_size = starts(&["film  ", "picture  "]) && line.contains(" bytes");
    if !(is_time || is_size) {
        return line.to_owned();
    }
    let mut settled = String::new();
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let is_alone = !settled.ends_with(|c: char| c.is_alphanumeric() || c == '-' || c == '_');
        if !(character.is_ascii_digit() && is_alone) {
            settled.push(character);
            continue;
        }
        settled.push('#');
        while characters.next_if(|c| c.is_ascii_digit() || *c == '.' || *c == 'e').is_some() {}
    }
    settled
}
