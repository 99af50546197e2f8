//! The spheres of a scene of many as a table: CSV, in a file of its own or in a string of the scene file. TOML takes 3 kB
//! of memory per sphere.

use super::read::text_of;
use crate::scene::{Material, Scene, Sphere, missing_material};
use crate::system::files::{self, ShownPath};
use crate::system::memory;
use anyhow::{Context, Result, anyhow};
use csv_core::ReadRecordResult;
use glam::DVec3;
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::HashMap;
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
pub(super) struct Table<'a> {
    text: Cow<'a, str>,
    /// The file that it is in, and the lines of that file before it.
    file: String,
    lines_before: usize,
}

impl<'a> Table<'a> {
    /// The table in a `value` of several lines at a `line` of the scene file `name`, or in the file of that name in
    /// `directory`.
    pub fn open(value: Cow<'a, str>, line: usize, name: &str, directory: Option<&Path>) -> Result<Self> {
        if value.contains('\n') {
            return Ok(Table { text: value, file: name.to_owned(), lines_before: line });
        }
        let directory = directory.with_context(|| {
            format!(
                "{name}:{line}: spheres names the file {value:?}, which only a scene file can do; put its table here"
            )
        })?;
        let path = directory.join(&*value);
        let mut text = text_of(&path, files::read(&path, "a table of spheres", LENGTH_LIMIT)?)?;
        if !text.contains('\n') {
            // Line ends of old Macintosh programs.
            text = text.replace('\r', "\n");
        }
        Ok(Table { text: text.into(), file: path.shown(), lines_before: 0 })
    }

    /// Adds its spheres to a scene that has the materials `index_of`.
    pub fn add_to(&self, scene: &mut Scene, index_of: &mut HashMap<String, usize>) -> Result<()> {
        let text = self.text.trim_start_matches('\u{feff}');
        let at = |byte: usize, reason: String| {
            // Blank lines before a row belong to it.
            let start = text.len() - text[byte..].trim_start().len();
            let line = 1 + text[..start].matches('\n').count();
            anyhow!("{}:{}: {reason}", self.file, self.lines_before + line)
        };
        let rows = text.bytes().filter(|byte| *byte == b'\n').count();
        let remedy = "use a table of fewer spheres, or close other programs";
        memory::check(|| format!("reading {}", self.file), (rows * size_of::<Sphere>()) as u64, remedy)?;
        scene.spheres.reserve_exact(rows);
        let (mut reader, mut rest) = (csv_core::Reader::new(), text.as_bytes());
        let (mut row, mut columns, mut coloured) = (Row::default(), None, HashMap::new());
        loop {
            let byte = text.len() - rest.len();
            if !row.read(&mut reader, &mut rest) {
                break;
            }
            if row.len() == 1 && row.get(0) == Some("") {
                continue;
            }
            let Some(columns) = &columns else {
                columns = Some(columns_of(&row).map_err(|reason| at(byte, reason))?);
                continue;
            };
            let index = scene.spheres.len();
            let values = Values { index, row: &row, columns };
            let mut sphere = || -> Result<Sphere, String> {
                values.check()?;
                let center = values.vector(0)?;
                let radius = values.number(RADIUS)?;
                if let Some(name) = values.text(MATERIAL) {
                    let material = index_of.get(name).copied();
                    let material = material.ok_or_else(|| missing_material(index, name).to_string())?;
                    return Ok(Sphere { center, radius, material });
                }
                let albedo = values.vector(MATERIAL + 1)?;
                let bits = albedo.to_array().map(f64::to_bits);
                let material = match coloured.get(&bits) {
                    Some(known) => *known,
                    None => added_material(index, Material::Lambertian { albedo }, scene, index_of)?,
                };
                coloured.insert(bits, material);
                Ok(Sphere { center, radius, material })
            };
            let sphere = sphere().map_err(|reason| at(byte, reason))?;
            sphere.validate(index, scene.materials.len()).map_err(|error| at(byte, error.to_string()))?;
            scene.spheres.push(sphere);
        }
        columns.map_or_else(|| columns_of(&row).map(drop).map_err(|reason| at(0, reason)), |_| Ok(()))
    }
}

/// Adds the own material of a sphere, which gets a unique name, and returns its index.
pub(super) fn added_material(
    sphere: usize,
    material: Material,
    scene: &mut Scene,
    index_of: &mut HashMap<String, usize>,
) -> Result<usize, String> {
    material.validate(format_args!("spheres[{sphere}].material")).map_err(|error| error.to_string())?;
    let mut name = format!("sphere-{sphere}");
    while index_of.contains_key(&name) {
        name.push('*');
    }
    let index = scene.add_material(name.clone(), material);
    index_of.insert(name, index);
    Ok(index)
}

/// A row of a table.
#[derive(Default)]
struct Row {
    /// The values, one after another, and where each ends.
    text: Vec<u8>,
    ends: Vec<usize>,
    count: usize,
}

impl Row {
    /// Reads the next row; `false` after the last.
    fn read(&mut self, reader: &mut csv_core::Reader, rest: &mut &[u8]) -> bool {
        let mut length = 0;
        self.count = 0;
        loop {
            let (text, ends) = (&mut self.text[length..], &mut self.ends[self.count..]);
            let (result, read, written, ended) = reader.read_record(rest, text, ends);
            *rest = &rest[read..];
            (length, self.count) = (length + written, self.count + ended);
            match result {
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull => self.text.resize(2 * self.text.len() + 256, 0),
                ReadRecordResult::OutputEndsFull => self.ends.resize(2 * self.ends.len() + 16, 0),
                ReadRecordResult::Record => return true,
                ReadRecordResult::End => return false,
            }
        }
    }

    fn len(&self) -> usize {
        self.count
    }

    fn get(&self, index: usize) -> Option<&str> {
        let end = *self.ends[..self.count].get(index)?;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        Some(std::str::from_utf8(&self.text[start..end]).unwrap_or_default().trim())
    }

    fn iter(&self) -> impl Iterator<Item = &str> {
        (0..self.count).filter_map(|index| self.get(index))
    }
}

/// For each of [`COLUMNS`], which value of a row it is.
fn columns_of(header: &Row) -> Result<[Option<usize>; COLUMNS.len()], String> {
    let columns = COLUMNS.map(|name| header.iter().position(|own| own == name));
    let is_there = columns.map(|column| column.is_some());
    let with_material = [true, true, true, true, true, false, false, false];
    let with_colour = [true, true, true, true, false, true, true, true];
    let is_known = [with_material, with_colour].contains(&is_there);
    if is_known && header.len() == columns.iter().flatten().count() {
        return Ok(columns);
    }
    let found = match header.iter().find(|name| !COLUMNS.contains(name)) {
        Some(name) if name.contains(';') => "separated by semicolons".to_owned(),
        Some(name) if name.contains('\t') => "separated by tabs".to_owned(),
        Some("") => "with a column that has no name, as an index has none".to_owned(),
        Some(name) => format!("with the unknown column {name:?}"),
        None => "not all that are needed, or too many".to_owned(),
    };
    let header = header.iter().collect::<Vec<_>>().join(",");
    Err(format!(
        "the first line of a table of spheres is {header:?}, {found}, but must name its columns: x,y,z,radius and either \
         material or red,green,blue, each once, separated by commas, and no others"
    ))
}

/// The values of a row.
struct Values<'a> {
    index: usize,
    row: &'a Row,
    columns: &'a [Option<usize>; COLUMNS.len()],
}

impl Values<'_> {
    fn check(&self) -> Result<(), String> {
        let (index, found, count) = (self.index, self.row.len(), self.columns.iter().flatten().count());
        if found == count {
            return Ok(());
        }
        Err(format!(
            "spheres[{index}] should have {count} values, one for each column, and has {found}; separate the values by \
             commas, and write a point in a number"
        ))
    }

    /// A value; `None` if there is no such column.
    fn text(&self, column: usize) -> Option<&str> {
        self.row.get(self.columns[column]?)
    }

    fn number(&self, column: usize) -> Result<f64, String> {
        let (index, name, value) = (self.index, COLUMNS[column], self.text(column).unwrap_or_default());
        value.parse().map_err(|_| {
            format!("spheres[{index}].{name} is {value:?}, but must be a number such as -1.5 or 2e3")
        })
    }

    /// The vector in three columns from this one.
    fn vector(&self, column: usize) -> Result<DVec3, String> {
        Ok(DVec3::new(self.number(column)?, self.number(column + 1)?, self.number(column + 2)?))
    }
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
