//! A writer that takes no more than a number of bytes.

use std::io::{self, Seek, SeekFrom, Write};

/// Writes the first `limit` bytes and only counts the others, so that it is known how many there would be.
pub struct Bounded<'a, W> {
    inner: &'a mut W,
    limit: u64,
    at: u64,
    end: u64,
}

impl<'a, W: Write + Seek> Bounded<'a, W> {
    /// A writer at the start of `inner`.
    pub fn new(inner: &'a mut W, limit: u64) -> Self {
        Bounded { inner, limit, at: 0, end: 0 }
    }

    /// Bytes that the whole file has, or would have.
    pub fn bytes(&self) -> u64 {
        self.end
    }

    /// Whether there were more bytes than the limit, so that the file is not whole.
    pub fn is_over(&self) -> bool {
        self.end > self.limit
    }
}

impl<W: Write + Seek> Write for Bounded<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let is_over = self.is_over() || self.at + bytes.len() as u64 > self.limit;
        let written = if is_over { bytes.len() } else { self.inner.write(bytes)? };
        self.at += written as u64;
        self.end = self.end.max(self.at);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Write + Seek> Seek for Bounded<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
        };
        self.at = at.ok_or(io::ErrorKind::InvalidInput)?;
        if !self.is_over() {
            self.inner.seek(SeekFrom::Start(self.at))?;
        }
        Ok(self.at)
    }
}
