//! Fuzz tests of all parsers. An input may be refused, but there must be no panic, no endless loop, and no memory use
//! that
//! the length of the input does not explain.
//!
//! A short run is part of the tests. For a long run:
//! `WEEKENDER_FUZZ_SECONDS=600 cargo test --release --test fuzz -- --nocapture`, with `WEEKENDER_FUZZ_SEED=N` for other
//! inputs and `WEEKENDER_FUZZ_ONLY=NAME` for a single parser. Inputs that break a parser are saved in
//! `tests/fuzz/finds/NAME/`, and every run starts with them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a helper of a test may fail like the test")]

mod mutate;
mod parsers;
mod seeds;

use mutate::{Draws, mutate};
use parsers::{Outcome, Parser};
use peak_alloc::PeakAlloc;
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Number of inputs for each parser in a short run.
const SHORT_RUN: u64 = 2000;

/// An input that takes longer counts as an endless loop.
const PATIENCE: Duration = Duration::from_secs(60);

/// Largest number of inputs that are kept because they were refused or accepted in a new way.
const KEPT_LIMIT: usize = 4000;

fn number(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

fn finds(parser: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/finds").join(parser)
}

/// The input that is being parsed, for the thread that watches for endless loops.
type Current = Arc<Mutex<Option<(Instant, &'static str, Vec<u8>)>>>;

fn watch(current: Current) {
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let current = current.lock().unwrap();
            if let Some((since, parser, input)) = &*current
                && since.elapsed() > PATIENCE
            {
                let path = keep(parser, "hang", input);
                eprintln!("{parser} does not end: {}", path.display());
                std::process::abort();
            }
        }
    });
}

/// Saves an input with which later runs start.
fn keep(parser: &str, kind: &str, input: &[u8]) -> PathBuf {
    let directory = finds(parser);
    std::fs::create_dir_all(&directory).unwrap();
    let sum = input.iter().fold(0_u64, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3));
    let path = directory.join(format!("{kind}-{sum:016x}"));
    std::fs::write(&path, input).unwrap();
    path
}

/// Parses an input; `Err` says what went wrong.
fn attempt(parser: &Parser, input: &[u8], current: &Current) -> Result<Outcome, String> {
    *current.lock().unwrap() = Some((Instant::now(), parser.name, input.to_vec()));
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let outcome = catch_unwind(AssertUnwindSafe(|| (parser.parse)(input)));
    let peak = MEMORY.peak_usage().saturating_sub(before);
    *current.lock().unwrap() = None;
    let outcome = outcome
        .map_err(|_| format!("{} panics: {}", parser.name, keep(parser.name, "panic", input).display()))?;
    let limit = (4 << 20) + parser.bytes_per_byte * input.len() + outcome.allowance;
    if peak > limit {
        let path = keep(parser.name, "memory", input);
        return Err(format!("{} takes {peak} bytes, more than {limit}: {}", parser.name, path.display()));
    }
    Ok(outcome)
}

/// The outcome without its numbers, so that equal kinds of outcomes are equal.
fn kind(outcome: &Outcome) -> String {
    let told: String = outcome.told.chars().filter(|c| !c.is_ascii_digit()).take(160).collect();
    // Quoted input has endless variations.
    told.split('"').step_by(2).collect()
}

#[test]
fn no_input_breaks_a_parser() {
    let seed = number("WEEKENDER_FUZZ_SEED").unwrap_or(1);
    let only = std::env::var("WEEKENDER_FUZZ_ONLY").ok();
    let parsers: Vec<Parser> = parsers::all()
        .into_iter()
        .filter(|parser| only.as_deref().is_none_or(|only| only == parser.name))
        .collect();
    let seconds = number("WEEKENDER_FUZZ_SECONDS").map(|seconds| seconds as f64 / parsers.len() as f64);
    let current = Current::default();
    watch(Arc::clone(&current));
    let mut faults = Vec::new();
    for parser in &parsers {
        let mut kept = parser.seeds.clone();
        let found = std::fs::read_dir(finds(parser.name)).into_iter().flatten();
        kept.extend(found.map(|entry| std::fs::read(entry.unwrap().path()).unwrap()));
        let (begin, mut inputs, mut taken, mut slowest) = (Instant::now(), 0_u64, 0_u64, Duration::ZERO);
        let mut kinds = HashSet::new();
        for seed in &kept {
            match attempt(parser, seed, &current) {
                Ok(outcome) => drop(kinds.insert(kind(&outcome))),
                Err(fault) => faults.push(fault),
            }
        }
        let mut draws = Draws::new(seed);
        let more =
            |inputs| seconds.map_or(inputs < SHORT_RUN, |seconds| begin.elapsed().as_secs_f64() < seconds);
        let faults_before = faults.len();
        while more(inputs) && faults.len() < faults_before + 10 {
            let mut input = mutate(&mut draws, &kept, parser.words);
            if let Some(seal) = parser.seal
                && draws.below(2) == 0
            {
                seal(&mut input);
            }
            inputs += 1;
            let start = Instant::now();
            match attempt(parser, &input, &current) {
                Ok(outcome) => {
                    taken += u64::from(outcome.is_taken);
                    if kinds.insert(kind(&outcome)) && kept.len() < KEPT_LIMIT {
                        kept.push(input);
                    }
                }
                Err(fault) => faults.push(fault),
            }
            slowest = slowest.max(start.elapsed());
        }
        println!(
            "{:<12} {inputs:>9} inputs, {:>8.0} a second, {taken:>8} taken, {:>5} kinds of answers, slowest {:.1} ms",
            parser.name,
            inputs as f64 / begin.elapsed().as_secs_f64(),
            kinds.len(),
            1e3 * slowest.as_secs_f64()
        );
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
