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

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn what_is_too_long_is_counted_and_not_written() {
        for (limit, written) in [(10, 10), (9, 8), (3, 0)] {
            let mut file = Cursor::new(Vec::new());
            let mut bounded = Bounded::new(&mut file, limit);
            bounded.write_all(b"head").unwrap();
            bounded.write_all(b"tail").unwrap();
            bounded.seek(SeekFrom::Start(0)).unwrap();
            bounded.write_all(b"HEAD").unwrap();
            bounded.seek(SeekFrom::End(0)).unwrap();
            bounded.write_all(b"..").unwrap();
            assert_eq!((bounded.bytes(), bounded.is_over()), (10, limit < 10));
            assert_eq!(file.into_inner(), b"HEADtail.."[..written]);
        }
    }

    #[test]
    fn it_goes_where_it_is_sent_whether_or_not_all_is_written() {
        for limit in [10, 3] {
            let mut file = Cursor::new(Vec::new());
            let mut bounded = Bounded::new(&mut file, limit);
            bounded.write_all(b"0123456789").unwrap();
            let to = [SeekFrom::Current(-3), SeekFrom::Current(2), SeekFrom::End(-4), SeekFrom::Start(2)];
            let found = to.map(|to| bounded.seek(to).unwrap());
            assert_eq!((found, bounded.bytes()), ([7, 9, 6, 2], 10), "limit {limit}");
            let before = bounded.seek(SeekFrom::Current(-3)).unwrap_err();
            assert_eq!(before.kind(), io::ErrorKind::InvalidInput);
        }
    }
}
