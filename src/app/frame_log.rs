//! `--frame-log`: how long the window's frames take, for measuring.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// What is said of a frame once it is over.
#[derive(Clone, Copy, Default)]
pub struct FrameTimes {
    /// All that the frame's thread did, drawing and waiting for the display included.
    pub cpu: Duration,
    /// Of that, controls, layout and state.
    pub ui: Duration,
    /// Of that, taking a new picture in.
    pub picture: Duration,
}

/// Lines `frame,since_start_ms,since_last_ms,cpu_ms,ui_ms,picture_ms`, `latency,since_start_ms,ms` from each change
/// to the frame that draws its first picture, `command,since_start_ms,NAME` and `tracing,since_start_ms,RUN,BACKEND`.
pub struct FrameLog {
    file: BufWriter<File>,
    start: Instant,
    last: Option<Instant>,
    /// Changes that no picture has shown yet.
    changes: Vec<Instant>,
    tracing: Option<(u64, String)>,
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl FrameLog {
    pub fn create(path: &Path) -> std::io::Result<Self> {
        let file = BufWriter::new(File::create(path)?);
        Ok(FrameLog { file, start: Instant::now(), last: None, changes: Vec::new(), tracing: None })
    }

    /// A frame begins; the one before took `times`.
    pub fn frame(&mut self, times: FrameTimes) {
        let now = Instant::now();
        if let Some(last) = self.last {
            let [cpu, ui, picture] = [times.cpu, times.ui, times.picture].map(milliseconds);
            self.line(format_args!(
                "frame,{:.3},{:.3},{cpu:.3},{ui:.3},{picture:.3}",
                milliseconds(now - self.start),
                milliseconds(now - last)
            ));
        }
        self.last = Some(now);
    }

    /// A command is carried out.
    pub fn command(&mut self, name: &str) {
        let since_start = milliseconds(self.start.elapsed());
        self.line(format_args!("command,{since_start:.3},{name}"));
        let _ = self.file.flush();
    }

    /// A backend has added samples to a render; said once for each.
    pub fn tracing(&mut self, run: u64, backend: &str) {
        let is_news = self.tracing.as_ref().is_none_or(|(old, name)| (*old, name.as_str()) != (run, backend));
        if is_news {
            self.tracing = Some((run, backend.to_owned()));
            let since_start = milliseconds(self.start.elapsed());
            self.line(format_args!("tracing,{since_start:.3},{run},{backend}"));
            let _ = self.file.flush();
        }
    }

    /// The user has changed the picture.
    pub fn changed(&mut self) {
        self.changes.push(Instant::now());
    }

    /// There is a picture of what was begun then.
    pub fn pictured(&mut self, begun: Instant) {
        let shown = self.changes.partition_point(|change| *change <= begun);
        for change in self.changes.drain(..shown).collect::<Vec<_>>() {
            let since_start = milliseconds(self.start.elapsed());
            self.line(format_args!("latency,{since_start:.3},{:.3}", milliseconds(change.elapsed())));
        }
    }

    /// A log that cannot be written is no reason to disturb anyone.
    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.file, "{line}");
    }
}

impl Drop for FrameLog {
    fn drop(&mut self) {
        let _ = self.file.flush();
    }
}
