//! Progress on standard error: a bar on a terminal, otherwise a line from time to time, or nothing.

use crate::cli::ProgressChoice;
use crate::console;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// How progress is shown.
pub enum Display {
    /// A progress bar.
    Bar(ProgressBar),
    /// Single lines.
    Lines {
        /// When the next line may be printed.
        next: Instant,
        /// Least time between two lines.
        interval: Duration,
    },
    /// Nothing.
    Off,
}

impl Display {
    /// Depends on `choice` and on whether there is a terminal. The bar has `steps` and looks as indicatif's
    /// `template` says, where `prefix` fills the placeholder of that name. Lines are at least `interval` apart.
    pub fn new(choice: ProgressChoice, steps: u64, template: &str, prefix: &str, interval: Duration) -> Self {
        match (choice, stderr().is_terminal()) {
            (ProgressChoice::Off, _) | (ProgressChoice::Auto, false) => Display::Off,
            (ProgressChoice::On, false) => Display::Lines { next: Instant::now(), interval },
            (_, true) => Display::Bar(bar(ProgressDrawTarget::stderr(), steps, template, prefix)),
        }
    }

    /// Whether it is a bar, whose length shows the progress.
    pub fn is_bar(&self) -> bool {
        matches!(self, Display::Bar(_))
    }

    /// Shows `words` at step `position`. A line is printed only if one is due.
    pub fn update(&mut self, position: u64, words: impl FnOnce() -> String) {
        match self {
            Display::Lines { next, .. } if Instant::now() < *next => {}
            _ => self.announce(position, words),
        }
    }

    /// Shows `words` at step `position` even if no line is due.
    pub fn announce(&mut self, position: u64, words: impl FnOnce() -> String) {
        match self {
            Display::Bar(bar) => {
                bar.set_position(position);
                bar.set_message(console::printable(&words()).into_owned());
            }
            Display::Lines { next, interval } => {
                *next = Instant::now() + *interval;
                console::note(&words());
            }
            Display::Off => {}
        }
    }

    /// Prints a message that must be read, even if progress is off.
    pub fn say(&self, message: &str) {
        match self {
            Display::Bar(bar) => bar.suspend(|| console::note(message)),
            Display::Lines { .. } | Display::Off => console::note(message),
        }
    }

    /// Hides the bar while `print` writes to the terminal.
    pub fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        match self {
            Display::Bar(bar) => bar.suspend(print),
            Display::Lines { .. } | Display::Off => print(),
        }
    }

    /// Removes the bar.
    pub fn clear(&self) {
        if let Display::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

fn bar(target: ProgressDrawTarget, steps: u64, template: &str, prefix: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(steps), target);
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.set_prefix(console::printable(prefix).into_owned());
    bar
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use std::io;
    use std::sync::{Arc, Mutex};

    /// All that is written to a terminal of 80 columns.
    #[derive(Clone, Debug, Default)]
    struct Written(Arc<Mutex<String>>);

    impl TermLike for Written {
        fn width(&self) -> u16 {
            80
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }

        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_line_is_asked_for_only_when_it_is_due_unless_it_is_announced() {
        let interval = Duration::from_secs(3600);
        let mut display = Display::Lines { next: Instant::now(), interval };
        let mut asked = Vec::new();
        let mut tell = |display: &mut Display, word: &'static str, must: bool| {
            let words = || {
                asked.push(word);
                word.to_owned()
            };
            if must { display.announce(1, words) } else { display.update(1, words) }
        };
        tell(&mut display, "first", false);
        tell(&mut display, "too soon", false);
        tell(&mut display, "announced", true);
        tell(&mut display, "too soon again", false);
        let mut off = Display::Off;
        tell(&mut off, "nothing", false);
        tell(&mut off, "nothing", true);
        assert_eq!(asked, ["first", "announced"]);
        assert!(!display.is_bar() && !off.is_bar());
    }

    #[test]
    fn a_bar_shows_its_name_its_length_and_the_words_until_it_is_cleared() {
        let written = Written::default();
        let target = ProgressDrawTarget::term_like(Box::new(written.clone()));
        let bar = bar(target, 4, "{prefix} [{bar:8}] {wide_msg}", "a\u{1b}b");
        let mut display = Display::Bar(bar.clone());
        display.update(2, || "half\u{1b} done".to_owned());
        let shown = written.0.lock().unwrap().clone();
        // A name cannot control the terminal.
        assert!(shown.contains("a\\u{1b}b [====>   ] half\\u{1b} done"), "{shown:?}");
        assert!(!bar.is_finished() && display.is_bar());
        assert_eq!((bar.position(), bar.length()), (2, Some(4)));
        display.clear();
        assert!(bar.is_finished());
    }
}
