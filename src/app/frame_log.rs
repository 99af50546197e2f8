//! `--frame-log`: how long the window's frames take, for measuring.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Lines `frame,since_start_ms,since_last_ms,cpu_ms` and `latency,since_start_ms,ms`.
pub struct FrameLog {
    file: BufWriter<File>,
    start: Instant,
    last: Option<Instant>,
    changed: Option<Instant>,
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

impl FrameLog {
    pub fn create(path: &Path) -> std::io::Result<Self> {
        let file = BufWriter::new(File::create(path)?);
        Ok(FrameLog { file, start: Instant::now(), last: None, changed: None })
    }

    /// A frame begins; the one before took `cpu_seconds` of this thread.
    pub fn frame(&mut self, cpu_seconds: Option<f32>) {
        let now = Instant::now();
        if let Some(last) = self.last {
            let cpu = cpu_seconds.unwrap_or_default() * 1e3;
            self.line(format_args!(
                "frame,{:.3},{:.3},{cpu:.3}",
                milliseconds(now - self.start),
                milliseconds(now - last)
            ));
        }
        self.last = Some(now);
    }

    /// The user has changed the picture.
    pub fn changed(&mut self) {
        self.changed.get_or_insert_with(Instant::now);
    }

    /// The first picture of what was changed is there.
    pub fn pictured(&mut self) {
        if let Some(changed) = self.changed.take() {
            let since_start = milliseconds(self.start.elapsed());
            self.line(format_args!("latency,{since_start:.3},{:.3}", milliseconds(changed.elapsed())));
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
