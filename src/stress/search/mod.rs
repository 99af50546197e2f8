//! Renders random scenes until the time is up. Each is compared with `f64`, and with changes that must not matter.

mod check;
mod random;
mod shrink;

pub use random::scene as random_scene;

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
    let reference = Backend::new("f64", BackendChoice::Reference { threads: None });
    let search = Search {
        options,
        checker: Checker::new(backends(options), reference),
        display: display(options.progress, time),
        print: &|text| terminal::print_beside(options.json.as_ref(), text),
        interrupt,
    };
    let begin = Instant::now();
    search.among((0..).take_while(|_| begin.elapsed() < time && !interrupt.load(Ordering::Relaxed)))
}

/// A search among random scenes.
struct Search<'a> {
    options: &'a StressOptions,
    checker: Checker,
    display: Display,
    /// Prints a failure, and the count at the end.
    print: &'a dyn Fn(&str) -> Result<()>,
    interrupt: &'a AtomicBool,
}

impl Search<'_> {
    /// Checks the random scenes of these numbers and saves the failures. Returns whether there were none.
    fn among(mut self, numbers: impl Iterator<Item = u32>) -> Result<bool> {
        let seed = self.options.seed;
        let directory = self.options.out.clone().unwrap_or_else(|| PathBuf::from(DIRECTORY));
        let begin = Instant::now();
        let (mut scenes, mut found) = (0, 0);
        let mut printed = Ok(());
        for number in numbers {
            scenes += 1;
            self.display.update(begin.elapsed().as_secs(), || {
                format!("{}, {}", counted(scenes, "scene"), counted(found, "failure"))
            });
            let recipe = random::scene(seed, number);
            let Some((check, reason)) = self.checker.first_failure(&recipe, self.interrupt) else { continue };
            if self.interrupt.load(Ordering::Relaxed) {
                break;
            }
            let (small, reason) = self.shrunk(recipe, check, reason);
            let path = directory.join(format!("found-{seed}-{number}.toml"));
            save(&path, &small, check, &reason, [seed, number])?;
            let spheres = counted(small.scene.spheres.len(), "sphere");
            let text = format!("{} ({spheres}): {}: {reason}\n", path.display(), check.name());
            printed = printed.and(self.display.above(|| (self.print)(&text)));
            found += 1;
        }
        self.display.clear();
        let text = format!(
            "search: {found} of {} failed in {:.0} s\n",
            counted(scenes, "random scene"),
            begin.elapsed().as_secs_f64()
        );
        printed.and((self.print)(&text))?;
        Ok(found == 0)
    }

    /// The scene as small as the failure of `check` allows, and why the check fails then.
    fn shrunk(&mut self, recipe: Recipe, check: Check, reason: String) -> (Recipe, String) {
        let (checker, interrupt) = (&mut self.checker, self.interrupt);
        let until = Instant::now() + SHRINK_TIME;
        let small = shrink::shrink(recipe, |smaller| {
            Instant::now() < until
                && !interrupt.load(Ordering::Relaxed)
                && checker.fails(check, smaller, interrupt).is_some()
        });
        let reason = checker.fails(check, &small, interrupt).unwrap_or(reason);
        (small, reason)
    }
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
    use crate::render_cpu::Isa;
    use crate::stress::families::build::one_ball;
    use std::cell::RefCell;

    /// A backend that does not start fails with every scene.
    #[test]
    fn each_failure_is_made_small_and_saved_and_told() {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().join("found");
        let options = StressOptions {
            filter: String::new(),
            search: None,
            seed: 7,
            levels: Vec::new(),
            adapter: None,
            json: None,
            out: Some(out.clone()),
            progress: ProgressChoice::Off,
        };
        let no_kernel = CpuOptions { isa: Some(Isa::Portable), lanes: Some(3), ..CpuOptions::default() };
        let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
        let (told, go_on) = (RefCell::new(String::new()), AtomicBool::new(false));
        let print = |text: &str| -> Result<()> {
            told.borrow_mut().push_str(text);
            Ok(())
        };
        let search = Search {
            options: &options,
            checker: Checker::new(vec![Backend::new("cpu", BackendChoice::Cpu(no_kernel))], reference),
            display: Display::Off,
            print: &print,
            interrupt: &go_on,
        };
        assert!(!search.among(0..2).unwrap(), "something was found");
        let told = told.borrow();
        for number in 0..2 {
            let path = out.join(format!("found-7-{number}.toml"));
            let line = format!("{} (0 spheres): f32 against f64: cpu: level", path.display());
            assert!(told.contains(&line), "{line} in {told}");
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(text.contains(&format!("seed 7, scene {number},")), "{text}");
            let small = file::load(&path).unwrap();
            assert_eq!((small.scene.spheres.len(), small.settings.max_depth), (0, 1), "{text}");
        }
        assert!(told.contains("\nsearch: 2 of 2 random scenes failed in "), "{told}");
    }

    #[test]
    fn a_search_that_is_interrupted_blames_no_scene() {
        let options = StressOptions {
            filter: String::new(),
            search: None,
            seed: 7,
            levels: vec![Isa::Portable],
            adapter: None,
            json: None,
            out: None,
            progress: ProgressChoice::Off,
        };
        let (told, interrupt) = (RefCell::new(String::new()), AtomicBool::new(true));
        let print = |text: &str| -> Result<()> {
            told.borrow_mut().push_str(text);
            Ok(())
        };
        let no_kernel = CpuOptions { isa: Some(Isa::Portable), lanes: Some(3), ..CpuOptions::default() };
        let broken = Backend::new("cpu", BackendChoice::Cpu(no_kernel));
        let reference = Backend::new("f64", BackendChoice::Reference { threads: Some(1) });
        let search = Search {
            options: &options,
            checker: Checker::new(vec![broken], reference),
            display: Display::Off,
            print: &print,
            interrupt: &interrupt,
        };
        assert!(search.among(0..1).unwrap(), "nothing was found");
        assert!(told.borrow().starts_with("search: 0 of 1 random scene failed in "), "{}", told.borrow());
        let names: Vec<String> = backends(&options).into_iter().map(|backend| backend.name).collect();
        assert_eq!(names, ["portable"]);
    }

    #[test]
    fn what_is_saved_is_a_scene_file_that_says_what_failed() {
        let text = saved_text(&one_ball(), Check::Rounding, "avx2: off by\n+1e-3", [3, 7]);
        assert!(text.contains("seed 3, scene 7") && text.contains("off by +1e-3"), "{text}");
        let read = file::parse(&text, "one-ball").unwrap();
        assert_eq!(read, one_ball());
    }
}
