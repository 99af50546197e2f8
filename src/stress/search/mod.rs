//! Renders random scenes until the time is up. Each is compared with `f64`, and with changes that must not matter.

mod check;
mod random;
mod shrink;

use super::backend::Backend;
use super::families::build::counted;
use crate::backends::BackendChoice;
use crate::cli::{ProgressChoice, StressOptions};
use crate::files::write_text;
use crate::recipe::{Recipe, file};
use crate::render_cpu::CpuOptions;
use crate::terminal::{self, Display};
use anyhow::Result;
use check::{Check, Checker};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Where failures are saved unless `--out` says otherwise.
const DIRECTORY: &str = "stress";

/// Interval of progress lines without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Time limit for shrinking one scene.
const SHRINK_TIME: Duration = Duration::from_secs(20);

/// Searches for `time` and saves the failures. Returns whether there were none.
///
/// # Errors
/// If a file cannot be written.
pub fn run(options: &StressOptions, time: Duration, interrupt: &AtomicBool) -> Result<bool> {
    let directory = options.out.clone().unwrap_or_else(|| PathBuf::from(DIRECTORY));
    let mut checker =
        Checker::new(backends(options), Backend::new("f64", BackendChoice::Reference { threads: None }));
    let mut display = display(options.progress, time);
    let begin = Instant::now();
    let (mut scenes, mut found) = (0_u32, Vec::new());
    let mut printed = Ok(());
    let is_over = || begin.elapsed() >= time || interrupt.load(Ordering::Relaxed);
    while !is_over() {
        let recipe = random::scene(options.seed, scenes);
        scenes += 1;
        display.update(begin.elapsed().as_secs(), || {
            format!("{}, {}", counted(scenes as usize, "scene"), counted(found.len(), "failure"))
        });
        let Some((check, reason)) = checker.first_failure(&recipe, interrupt) else { continue };
        if interrupt.load(Ordering::Relaxed) {
            break;
        }
        let until = Instant::now() + SHRINK_TIME;
        let small = shrink::shrink(recipe, |smaller| {
            Instant::now() < until
                && !interrupt.load(Ordering::Relaxed)
                && checker.fails(check, smaller, interrupt).is_some()
        });
        let reason = checker.fails(check, &small, interrupt).unwrap_or(reason);
        let path = directory.join(format!("found-{}-{}.toml", options.seed, scenes - 1));
        save(&path, &small, check, &reason, [options.seed, scenes - 1])?;
        printed = printed.and(display.above(|| {
            let spheres = counted(small.scene.spheres.len(), "sphere");
            let text = format!("{} ({spheres}): {}: {reason}\n", path.display(), check.name());
            terminal::print_beside(options.json.as_ref(), &text)
        }));
        found.push(path);
    }
    display.clear();
    let text = format!(
        "search: {} of {} failed in {:.0} s\n",
        found.len(),
        counted(scenes as usize, "random scene"),
        begin.elapsed().as_secs_f64()
    );
    printed.and(terminal::print_beside(options.json.as_ref(), &text))?;
    Ok(found.is_empty())
}

fn display(choice: ProgressChoice, time: Duration) -> Display {
    Display::new(choice, time.as_secs().max(1), "[{bar:24}] {wide_msg}", "", LINE_INTERVAL)
}

fn backends(options: &StressOptions) -> Vec<Backend> {
    let cpu = |isa| BackendChoice::Cpu(CpuOptions { isa: Some(isa), ..CpuOptions::default() });
    options.levels.iter().map(|isa| Backend::new(isa.name(), cpu(*isa))).collect()
}

fn save(path: &Path, recipe: &Recipe, check: Check, reason: &str, [seed, number]: [u32; 2]) -> Result<()> {
    if let Some(directory) = path.parent() {
        std::fs::create_dir_all(directory)?;
    }
    Ok(write_text(path, &saved_text(recipe, check, reason, [seed, number]))?)
}

fn saved_text(recipe: &Recipe, check: Check, reason: &str, [seed, number]: [u32; 2]) -> String {
    format!(
        "# Found by weekender stress --search, seed {seed}, scene {number}, shrunk as far as the failure allows.\n\
         # What failed: {}: {}\n\n{}",
        check.name(),
        reason.replace('\n', " "),
        file::to_toml(recipe)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::families::build::one_ball;

    #[test]
    fn what_is_saved_is_a_scene_file_that_says_what_failed() {
        let text = saved_text(&one_ball(), Check::Rounding, "avx2: off by\n+1e-3", [3, 7]);
        assert!(text.contains("seed 3, scene 7") && text.contains("off by +1e-3"), "{text}");
        let read = file::parse(&text, "one-ball").unwrap();
        assert_eq!(read, one_ball());
    }
}
