//! Binary PPM (P6), without a description: simple readers stumble over comments in the header.

use super::write_rows;
use crate::film::Film;
use crate::stages::Transfer;
use std::io::{self, Write};

pub(super) fn write(film: &Film, transfer: Transfer, writer: &mut impl Write) -> io::Result<()> {
    writeln!(writer, "P6\n{} {}\n255", film.width(), film.height())?;
    write_rows(film, transfer, writer)
}
