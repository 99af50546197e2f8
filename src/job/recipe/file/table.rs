//! The spheres of a scene of many as a table: CSV, in a file of its own or in a string of the scene file. TOML takes 3 kB
//! of memory per sphere.

use super::growing::GrowingScene;
use crate::scene::{Scene, Sphere};
use crate::system::files::{self, ShownPath};
use crate::system::memory;
use anyhow::{Context, Result, anyhow};
use glam::DVec3;
use serde::Deserialize;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

/// Longest table, bytes: about twenty million spheres.
const LENGTH_LIMIT: u64 = 1 << 30;

/// The columns of a table. Either the material or the colour is missing.
const COLUMNS: [&str; 8] = ["x", "y", "z", "radius", "material", "red", "green", "blue"];
const RADIUS: usize = 3;
const MATERIAL: usize = 4;

/// The text of a table.
pub(super) struct Table {
    text: String,
    /// The file that it is in, and the lines of that file before it.
    file: String,
    lines_before: usize,
}

/// The text of a file.
///
/// # Errors
/// What the file is instead, by its first bytes, and what to do.
pub(super) fn text_of(path: &Path, bytes: Vec<u8>) -> anyhow::Result<String> {
    let found = match bytes.as_slice() {
        [0x1f, 0x8b, ..] => "is packed by gzip; unpack it",
        [b'P', b'K', 3, 4, ..] => "is a ZIP archive or a workbook of a spreadsheet; save it as CSV",
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "is UTF-16 text; save it as UTF-8",
        [0x89, b'P', b'N', b'G', ..] => "is a PNG picture; name a text file",
        _ => "is not UTF-8 text; save it as UTF-8",
    };
    String::from_utf8(bytes).map_err(|_| anyhow!("cannot read {}: it {found}", path.shown()))
}

impl Table {
    /// The table in a `value` of several lines at a `line` of the scene file `name`, or in the file of that name in
    /// `directory`.
    pub fn open(value: String, line: usize, name: &str, directory: Option<&Path>) -> Result<Self> {
        if value.contains('\n') {
            return Ok(Table { text: value, file: name.to_owned(), lines_before: line });
        }
        let directory = directory.with_context(|| {
            format!(
                "{name}:{line}: spheres names the file {value:?}, which only a scene file can do; put its table here"
            )
        })?;
        let path = directory.join(&value);
        let read = files::read(&path, "a table of spheres", LENGTH_LIMIT).map_err(Into::into);
        let text = read.and_then(|bytes| text_of(&path, bytes));
        let mut text = text.map_err(|error| anyhow!("{name}:{line}: {error:#}"))?;
        if !text.contains('\n') {
            // Line ends of old Macintosh programs.
            text = text.replace('\r', "\n");
        }
        Ok(Table { text, file: path.shown(), lines_before: 0 })
    }

    /// Adds its spheres to a scene that has their materials.
    pub fn add_to(&self, scene: &mut GrowingScene) -> Result<()> {
        let at =
            |line: usize, reason: String| anyhow!("{}:{}: {reason}", self.file, self.lines_before + line);
        let rows = self.text.bytes().filter(|byte| *byte == b'\n').count();
        let remedy = "use a table of fewer spheres, or close other programs";
        memory::check(|| format!("reading {}", self.file), (rows * size_of::<Sphere>()) as u64, remedy)?;
        scene.scene.spheres.reserve_exact(rows);
        let text = self.text.trim_start_matches('\u{feff}');
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        let (line, header) = lines.next().unwrap_or((1, ""));
        let columns = columns_of(&values_of(header)).map_err(|reason| at(line, reason))?;
        for (line, row) in lines {
            add_row(&values_of(row), &columns, scene).map_err(|reason| at(line, reason))?;
        }
        Ok(())
    }
}

/// Adds the sphere of a row, whose values are in `columns`.
fn add_row(
    row: &[&str],
    columns: &[Option<usize>; COLUMNS.len()],
    scene: &mut GrowingScene,
) -> Result<(), String> {
    let (index, found, count) = (scene.scene.spheres.len(), row.len(), columns.iter().flatten().count());
    if found != count {
        return Err(format!(
            "spheres[{index}] should have {count} values, one for each column, and has {found}; separate the values by \
             commas, and write a point in a number and no comma in a name"
        ));
    }
    let texts = columns.map(|column| row.get(column?).copied());
    let number = |column: usize| -> Result<f64, String> {
        let (name, value) = (COLUMNS[column], texts[column].unwrap_or_default());
        value.parse().map_err(|_| {
            format!("spheres[{index}].{name} is {value:?}, but must be a number such as -1.5 or 2e3")
        })
    };
    let vector = |first: usize| -> Result<_, String> {
        Ok(DVec3::new(number(first)?, number(first + 1)?, number(first + 2)?))
    };
    let (center, radius) = (vector(0)?, number(RADIUS)?);
    let material = match texts[MATERIAL] {
        Some(name) => scene.material(name)?,
        None => scene.matte(vector(MATERIAL + 1)?)?,
    };
    scene.add_sphere(center, radius, material)
}

/// The values of a row, each of which may be quoted. No value has a comma.
fn values_of(row: &str) -> Vec<&str> {
    fn unquoted(value: &str) -> Option<&str> {
        Some(value.strip_prefix('"')?.strip_suffix('"')?.trim())
    }
    row.split(',').map(str::trim).map(|value| unquoted(value).unwrap_or(value)).collect()
}

/// For each of [`COLUMNS`], which value of a row it is.
fn columns_of(names: &[&str]) -> Result<[Option<usize>; COLUMNS.len()], String> {
    let columns = COLUMNS.map(|name| names.iter().position(|own| *own == name));
    let is_there = columns.map(|column| column.is_some());
    let with_material = [true, true, true, true, true, false, false, false];
    let with_colour = [true, true, true, true, false, true, true, true];
    let is_known = [with_material, with_colour].contains(&is_there);
    if is_known && names.len() == columns.iter().flatten().count() {
        return Ok(columns);
    }
    let found = match names.iter().find(|name| !COLUMNS.contains(name)) {
        Some(name) if name.contains(';') => "separated by semicolons".to_owned(),
        Some(name) if name.contains('\t') => "separated by tabs".to_owned(),
        Some(&"") => "with a column that has no name, as an index has none".to_owned(),
        Some(name) => format!("with the unknown column {name:?}"),
        None => "not all that are needed, or too many".to_owned(),
    };
    let header = names.join(",");
    Err(format!(
        "the first line of a table of spheres is {header:?}, {found}, but must name its columns: x,y,z,radius and either material \
         or red,green,blue, each once, separated by commas, and no others"
    ))
}

/// The spheres as the value of a scene file's key; `None` if the name of a material does not fit into a table.
pub(super) fn to_value(scene: &Scene) -> Option<String> {
    let fits =
        |name: &str| name == name.trim() && !name.contains(|c: char| "\",'\\".contains(c) || c.is_control());
    let names = || scene.materials.iter().map(|named| named.name.as_str());
    if !names().all(fits) {
        return None;
    }
    let names: Vec<&str> = names().collect();
    let mut text = String::with_capacity(64 * scene.spheres.len());
    text += &format!("'''\n{}\n", COLUMNS[..=MATERIAL].join(","));
    for Sphere { center: DVec3 { x, y, z }, radius, material } in &scene.spheres {
        let name = names.get(*material).copied().unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{x:?},{y:?},{z:?},{radius:?},{name}");
    }
    Some(text + "'''")
}

/// The files that a scene file is read from: itself, and its table, if it names one.
pub fn inputs(scene_file: &Path) -> Vec<PathBuf> {
    #[derive(Deserialize)]
    struct Line {
        spheres: String,
    }
    let text = fs::read_to_string(scene_file).unwrap_or_default();
    let lines = text.lines().filter(|line| line.trim_start().starts_with("spheres"));
    let table = lines.filter_map(|line| toml::from_str(line).ok()).next();
    let table = table.map(|Line { spheres }| scene_file.with_file_name(spheres));
    [scene_file.to_owned()].into_iter().chain(table).collect()
}
