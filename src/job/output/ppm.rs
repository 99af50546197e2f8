//! Binary PPM (P6). Comments in the header hold the description: lines `# key: value`, then a line with the recipe's
//! key alone, then the lines of the recipe.

use super::{Description, RECIPE_KEY, RECIPE_LIMIT, write_rows};
use crate::film::Film;
use crate::stages::Transfer;
use std::io::{self, BufRead, Write};

pub(super) fn write(
    film: &Film,
    transfer: Transfer,
    description: &Description,
    writer: &mut impl Write,
) -> io::Result<()> {
    writeln!(writer, "P6")?;
    for line in description.lines() {
        writeln!(writer, "# {line}")?;
    }
    writeln!(writer, "# {RECIPE_KEY}:")?;
    for line in description.recipe().split('\n') {
        writeln!(writer, "# {line}")?;
    }
    writeln!(writer, "{} {}\n255", film.width(), film.height())?;
    write_rows(film, transfer, writer)
}

pub(super) fn read_description(reader: impl BufRead) -> io::Result<Option<Description>> {
    // Each line of the recipe has a prefix of two bytes; the rest is for the other entries.
    let mut reader = reader.take(4 * RECIPE_LIMIT as u64);
    let mut line = Vec::new();
    reader.read_until(b'\n', &mut line)?;
    let mut comments = Vec::new();
    loop {
        line.clear();
        reader.read_until(b'\n', &mut line)?;
        match line.strip_prefix(b"# ") {
            Some(comment) => {
                comments.push(String::from_utf8_lossy(comment).trim_end_matches('\n').to_owned())
            }
            None => break,
        }
    }
    let is_recipe = |line: &String| line.strip_suffix(':') == Some(RECIPE_KEY);
    let Some(start) = comments.iter().position(is_recipe) else { return Ok(None) };
    let mut description = Description::new(&comments[start + 1..].join("\n"));
    for line in &comments[..start] {
        description.set_line(line);
    }
    Ok(Some(description))
}
