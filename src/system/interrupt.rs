//! Signals that ask the program to end. The first requests an orderly end: what was rendered is saved. Another Ctrl-C
//! ends the program at once, but never while files are being written. The exit code tells which signal it was. On Linux,
//! a signal that was ignored at the start, such as SIGHUP under nohup, stays ignored. On Windows, these are console
//! events.

use crate::system::console;
use anyhow::{Context, Result};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The signals that ask for an end: number and meaning. The exit code is 128 plus the number of the first one in this
/// table that has arrived: the person at the keyboard decides before any program.
const SIGNALS: &[(i32, &str)] = &[
    (INTERRUPT, "Ctrl-C"),
    (QUIT, "Ctrl-\\"),
    (TERMINATE, "SIGTERM: the system or a scheduler ends the program"),
    #[cfg(unix)]
    (signal_hook::consts::SIGXCPU, "SIGXCPU: the limit on processor time (ulimit -t) is reached"),
    #[cfg(target_os = "linux")]
    (rustix::process::Signal::POWER.as_raw(), "SIGPWR: the power fails"),
    #[cfg(unix)]
    (signal_hook::consts::SIGUSR2, "SIGUSR2: a scheduler warns that it will end the program"),
    #[cfg(unix)]
    (signal_hook::consts::SIGUSR1, "SIGUSR1: a scheduler warns that it will end or suspend the program"),
    #[cfg(unix)]
    (signal_hook::consts::SIGALRM, "SIGALRM: a timer has run out"),
    (HANG_UP, "SIGHUP: the terminal was closed"),
];

const HANG_UP: i32 = 1;
const INTERRUPT: i32 = 2;
const QUIT: i32 = 3;
const TERMINATE: i32 = 15;

/// A second signal within this time is an echo of the first: `timeout` and shells signal a program and then its group.
const ECHO: Duration = Duration::from_millis(500);

/// Whether the program has been asked to end.
pub struct Interrupt(Arc<Shared>);

#[derive(Default)]
struct Shared {
    is_set: AtomicBool,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    /// When the first signal arrived.
    since: Option<Instant>,
    /// Which of [`SIGNALS`] has arrived, the first in the table.
    signal: Option<usize>,
    /// Description of what is being written.
    writing: Option<String>,
}

impl State {
    /// Whether somebody waits at a keyboard. Schedulers repeat SIGTERM, and send SIGKILL to a program that takes too
    /// long.
    fn hurries(&self) -> bool {
        self.signal.is_some_and(|signal| matches!(SIGNALS[signal].0, INTERRUPT | QUIT))
    }
}

/// Calls `answer` with each signal, on its own thread.
#[cfg(unix)]
fn watch(answer: impl Fn(i32) + Send + 'static) -> Result<()> {
    // Called before any is handled, this tells those ignored at the start.
    let ignored = ignored_in(&std::fs::read_to_string("/proc/self/status").unwrap_or_default());
    let numbers = SIGNALS.iter().map(|(number, _)| *number);
    let handled = numbers.filter(|number| ignored & (1 << (number - 1)) == 0);
    let mut signals = signal_hook::iterator::Signals::new(handled)?;
    let listen = move || signals.forever().for_each(answer);
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen)?;
    Ok(())
}

/// Closing the console counts as a hangup, and the end of the session as SIGTERM. After these the system waits some
/// seconds, then ends the program.
#[cfg(windows)]
fn watch(answer: impl Fn(i32) + Send + 'static) -> Result<()> {
    use std::task::Poll;
    use tokio::signal::windows::{ctrl_break, ctrl_c, ctrl_close, ctrl_logoff, ctrl_shutdown};
    let (mut by_key, mut by_break, mut close) = (ctrl_c()?, ctrl_break()?, ctrl_close()?);
    let (mut log_off, mut shut_down) = (ctrl_logoff()?, ctrl_shutdown()?);
    let listen = move || {
        loop {
            answer(pollster::block_on(std::future::poll_fn(|context| {
                if by_key.poll_recv(context).is_ready() | by_break.poll_recv(context).is_ready() {
                    Poll::Ready(INTERRUPT)
                } else if close.poll_recv(context).is_ready() {
                    Poll::Ready(HANG_UP)
                } else if log_off.poll_recv(context).is_ready() | shut_down.poll_recv(context).is_ready() {
                    Poll::Ready(TERMINATE)
                } else {
                    Poll::Pending
                }
            })));
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen)?;
    Ok(())
}

/// Other systems have no signals; they end the program as a whole.
#[cfg(not(any(unix, windows)))]
fn watch(_: impl Fn(i32) + Send + 'static) -> Result<()> {
    Ok(())
}

/// The signals that a process ignores, by its `/proc/self/status`, as a bit mask with signal 1 lowest.
#[cfg(unix)]
fn ignored_in(status: &str) -> u64 {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// The response to a signal.
#[derive(Debug, PartialEq, Eq)]
enum Answer {
    /// Sets only the flag.
    Nothing,
    Say(String),
    Exit,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn signalled(&self, number: i32, now: Instant) -> Answer {
        let mut state = self.state();
        let first = *state.since.get_or_insert(now);
        let was_set = self.is_set.swap(true, Ordering::Relaxed);
        let signal = SIGNALS.iter().position(|(known, _)| *known == number);
        state.signal = [signal, state.signal].into_iter().flatten().min();
        match &state.writing {
            Some(what) => Answer::Say(format!("still writing {what}; the program ends when that is done")),
            None if was_set && state.hurries() && now.duration_since(first) >= ECHO => Answer::Exit,
            None => Answer::Nothing,
        }
    }

    fn exit_code(&self) -> u8 {
        128 + SIGNALS[self.state().signal.unwrap_or(0)].0 as u8
    }
}

impl Interrupt {
    /// Starts handling signals. Call it once per process.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn install() -> Result<Self> {
        Self::install_with(|| {})
    }

    /// Like [`Interrupt::install`], and calls `wake` on another thread when a signal has arrived.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn install_with(wake: impl Fn() + Send + 'static) -> Result<Self> {
        let shared = Arc::new(Shared::default());
        let seen = Arc::clone(&shared);
        let answer = move |number| match seen.signalled(number, Instant::now()) {
            Answer::Nothing => wake(),
            Answer::Say(message) => console::note(&message),
            Answer::Exit => {
                console::note("ended at once; unsaved results are lost");
                std::process::exit(i32::from(seen.exit_code()));
            }
        };
        watch(answer).context("cannot handle Ctrl-C and other signals")?;
        Ok(Interrupt(shared))
    }

    /// An instance that ignores signals; only its flag ends the work.
    pub fn unheard() -> Self {
        Interrupt(Arc::default())
    }

    /// Becomes `true` when an end is requested.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.is_set
    }

    pub fn is_set(&self) -> bool {
        self.0.is_set.load(Ordering::Relaxed)
    }

    /// Whether somebody at a keyboard asked for the end and can ask again.
    pub fn is_by_hand(&self) -> bool {
        self.0.state().hurries()
    }

    /// What the signal means.
    pub fn cause(&self) -> &'static str {
        SIGNALS[self.0.state().signal.unwrap_or(0)].1
    }

    /// Exit code of a program that ends cleanly after a signal.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.0.exit_code())
    }

    /// Until the result is dropped, a signal prints a message that names `what` instead of ending the program.
    pub fn while_writing(&self, what: impl Into<String>) -> Writing<'_> {
        self.0.state().writing = Some(what.into());
        Writing(&self.0)
    }
}

/// Guard of [`Interrupt::while_writing`].
pub struct Writing<'a>(&'a Shared);

impl Drop for Writing<'_> {
    fn drop(&mut self) {
        self.0.state().writing = None;
    }
}

/// Makes writes beyond the file size limit (`ulimit -f`) fail with an error. By default the system ends the program
/// with SIGXFSZ.
pub fn survive_file_size_limit() {
    #[cfg(unix)]
    {
        // The flag is not used: having a handler is enough. If it cannot be installed, the default applies.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::<AtomicBool>::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_signal_asks_and_a_later_ctrl_c_ends() {
        let (shared, now) = (Shared::default(), Instant::now());
        assert_eq!(shared.exit_code(), 130);
        assert_eq!(shared.signalled(HANG_UP, now), Answer::Nothing);
        assert_eq!((shared.is_set.load(Ordering::Relaxed), shared.exit_code()), (true, 129));
        assert_eq!(
            shared.signalled(TERMINATE, now + 2 * ECHO),
            Answer::Nothing,
            "no scheduler is in a hurry"
        );
        assert_eq!(shared.exit_code(), 143);
        assert_eq!(shared.signalled(INTERRUPT, now + ECHO / 2), Answer::Nothing, "an echo");
        assert_eq!(shared.exit_code(), 130);
        assert_eq!(shared.signalled(INTERRUPT, now + ECHO), Answer::Exit);
        assert_eq!(Shared::default().signalled(INTERRUPT, now), Answer::Nothing);
    }
}
