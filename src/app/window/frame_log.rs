//! `--frame-log`: measures how long the window's frames take.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// The times of a frame.
#[derive(Clone, Copy, Default)]
pub struct FrameTimes {
    /// Everything that the frame's thread did, including drawing and waiting for the display.
    pub cpu: Duration,
    /// Controls, layout and state; part of `cpu`.
    pub ui: Duration,
    /// Taking in a new picture; part of the above.
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
        if let Some(last) = self.last.replace(now) {
            let [apart, cpu, ui, picture] =
                [now - last, times.cpu, times.ui, times.picture].map(milliseconds);
            self.line("frame", &format!("{apart:.3},{cpu:.3},{ui:.3},{picture:.3}"));
        }
    }

    /// Logs a command.
    pub fn command(&mut self, name: &str) {
        self.line("command", name);
        let _ = self.file.flush();
    }

    /// Logs that a backend has added samples to a render, once for each backend.
    pub fn tracing(&mut self, run: u64, backend: &str) {
        let tracing = Some((run, backend.to_owned()));
        if self.tracing != tracing {
            self.tracing = tracing;
            self.line("tracing", &format!("{run},{backend}"));
            let _ = self.file.flush();
        }
    }

    /// Notes that the user has changed the picture.
    pub fn changed(&mut self) {
        self.changes.push(Instant::now());
    }

    /// Logs the latency: the first picture of a render that began at `begun` has arrived.
    pub fn pictured(&mut self, begun: Instant) {
        let shown = self.changes.partition_point(|change| *change <= begun);
        for change in self.changes.drain(..shown).collect::<Vec<_>>() {
            self.line("latency", &format!("{:.3}", milliseconds(change.elapsed())));
        }
    }

    /// Writes a line. Errors are ignored, because a failed log should not disturb the user.
    fn line(&mut self, kind: &str, values: &str) {
        let _ = writeln!(self.file, "{kind},{:.3},{values}", milliseconds(self.start.elapsed()));
    }
}

impl Drop for FrameLog {
    fn drop(&mut self) {
        let _ = self.file.flush();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fields of the lines that `write` logs, without the time since the start.
    fn logged(write: impl FnOnce(&mut FrameLog)) -> Vec<Vec<String>> {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("log.csv");
        let mut log = FrameLog::create(&path).unwrap();
        write(&mut log);
        drop(log);
        let text = std::fs::read_to_string(&path).unwrap();
        let fields = |line: &str| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            assert!(fields.remove(1).parse::<f64>().unwrap() >= 0.0, "{line}");
            fields
        };
        text.lines().map(fields).collect()
    }

    #[test]
    fn the_latency_is_that_of_the_first_picture_after_each_change() {
        let lines = logged(|log| {
            log.changed();
            let begun = log.changes[0];
            log.changes.push(begun + Duration::from_secs(1));
            log.pictured(begun);
            assert_eq!(log.changes.len(), 1, "the second change is not to be seen yet");
            log.pictured(begun);
        });
        let [line] = &lines[..] else { panic!("{lines:?}") };
        assert!(line[0] == "latency" && line[1].parse::<f64>().unwrap() >= 0.0, "{line:?}");
    }
}
