//! Keeps what libraries print on standard error apart from the program's own messages.

/// Standard error is redirected until this is dropped.
#[derive(Debug)]
pub struct Captured {
    #[cfg(target_os = "linux")]
    _messages: Option<linux::Messages>,
}

impl Captured {
    /// Begins to redirect standard error to the log, so that messages of libraries such as "error: XDG_RUNTIME_DIR is
    /// invalid" on a server do not look like the program's; [`console`](super::console) still reaches the original. Does
    /// nothing on systems other than Linux, if the system refuses, or if standard error is already redirected.
    pub fn begin() -> Captured {
        Captured {
            #[cfg(target_os = "linux")]
            _messages: linux::Messages::begin().unwrap_or_default(),
        }
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use crate::system::console::STANDARD_ERROR;
    use std::fs::File;
    use std::io::{self, Read, Seek};
    use std::os::fd::AsFd;
    use std::sync::PoisonError;

    /// Longest text that is logged, bytes.
    const MOST: u64 = 64 << 10;

    #[derive(Debug)]
    pub(super) struct Messages(File);

    impl Messages {
        pub fn begin() -> io::Result<Option<Messages>> {
            let mut original = STANDARD_ERROR.lock().unwrap_or_else(PoisonError::into_inner);
            if original.is_some() {
                return Ok(None);
            }
            let messages = File::from(rustix::fs::memfd_create("messages", rustix::fs::MemfdFlags::CLOEXEC)?);
            *original = Some(io::stderr().as_fd().try_clone_to_owned()?.into());
            rustix::stdio::dup2_stderr(&messages).inspect_err(|_| *original = None)?;
            Ok(Some(Messages(messages)))
        }
    }

    impl Drop for Messages {
        fn drop(&mut self) {
            if let Some(original) = STANDARD_ERROR.lock().unwrap_or_else(PoisonError::into_inner).take() {
                // It cannot fail: both files are open.
                let _ = rustix::stdio::dup2_stderr(&original);
            }
            let mut text = Vec::new();
            let _ = self.0.rewind();
            let _ = (&self.0).take(MOST).read_to_end(&mut text);
            let text = String::from_utf8_lossy(&text);
            for line in text.lines().filter(|line| !line.trim().is_empty()) {
                log::warn!(target: "driver", "{line}");
            }
        }
    }
}
