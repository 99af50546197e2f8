//! Keeps what libraries print on standard error apart from the program's own messages.

/// Runs `work`, during which graphics drivers may print messages of their own, such as "error: XDG_RUNTIME_DIR is
/// invalid" on a server, which would look like the program's own. They go to the log instead.
pub fn logged<T>(work: impl FnOnce() -> T) -> T {
    let captured = Captured::begin();
    let result = work();
    drop(captured);
    result
}

/// Standard error is redirected until this is dropped.
#[derive(Debug)]
pub struct Captured {
    #[cfg(target_os = "linux")]
    _redirected: Option<linux::Redirected>,
}

impl Captured {
    /// Begins to redirect standard error; [`console`](super::console) still reaches the original. Does nothing on
    /// systems other than Linux, if the system refuses, or if standard error is already redirected.
    pub fn begin() -> Captured {
        Captured {
            #[cfg(target_os = "linux")]
            _redirected: linux::Redirected::begin().unwrap_or_default(),
        }
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use crate::system::console;
    use std::fs::File;
    use std::io::{self, Read, Seek};
    use std::os::fd::AsFd;
    use std::sync::atomic::{AtomicBool, Ordering};

    static IS_REDIRECTED: AtomicBool = AtomicBool::new(false);

    /// Longest text that is logged, bytes.
    const MOST: u64 = 64 << 10;

    #[derive(Debug)]
    pub(super) struct Redirected {
        original: File,
        messages: File,
    }

    impl Redirected {
        pub fn begin() -> io::Result<Option<Redirected>> {
            let original = File::from(io::stderr().as_fd().try_clone_to_owned()?);
            let messages = File::from(rustix::fs::memfd_create("messages", rustix::fs::MemfdFlags::CLOEXEC)?);
            if IS_REDIRECTED.swap(true, Ordering::SeqCst) {
                return Ok(None);
            }
            console::set_standard_error(original.try_clone().ok());
            // From here on, dropping it restores standard error.
            let redirected = Redirected { original, messages };
            rustix::stdio::dup2_stderr(&redirected.messages)?;
            Ok(Some(redirected))
        }
    }

    impl Drop for Redirected {
        fn drop(&mut self) {
            // It cannot fail: both files are open.
            let _ = rustix::stdio::dup2_stderr(&self.original);
            console::set_standard_error(None);
            IS_REDIRECTED.store(false, Ordering::SeqCst);
            let mut text = Vec::new();
            let _ = self.messages.rewind();
            let _ = (&self.messages).take(MOST).read_to_end(&mut text);
            let text = String::from_utf8_lossy(&text);
            for line in text.lines().filter(|line| !line.trim().is_empty()) {
                log::warn!(target: "driver", "{line}");
            }
        }
    }
}
