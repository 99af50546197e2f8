//! Tables and charts of measurements: kept files, each with the command that made it and the machine.

mod comparison;
mod error;
mod speed;

use super::faults::Fault;
use super::library::{FOLDER, Library};
use maud::{Markup, html};
use serde::Deserialize;
use std::collections::BTreeMap;

/// Where the kept measurements are listed.
const FILE: &str = "docs/companion/measured.toml";

/// A measurement and how it was made.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    /// Its file in `docs/companion`.
    file: String,
    /// The command that makes such a file.
    command: String,
    /// The machine, if the file does not name it.
    machine: Option<String>,
    /// The day of the measurement.
    date: Option<String>,
    #[serde(skip)]
    text: String,
}

/// All measurements by name.
#[derive(Clone, Debug, Default)]
pub struct Measured {
    kept: BTreeMap<String, Kept>,
}

impl Measured {
    /// Reads the kept measurements.
    pub fn read(library: &Library, faults: &mut Vec<Fault>) -> Self {
        let listed =
            library.read(FILE).and_then(|text| toml::from_str(&text).map_err(|error| error.to_string()));
        let mut kept: BTreeMap<String, Kept> = listed.unwrap_or_else(|message| {
            faults.push(Fault::new(FILE, 0, message));
            BTreeMap::new()
        });
        kept.retain(|name, kept| match library.read(&format!("{FOLDER}/{}", kept.file)) {
            Ok(text) => {
                kept.text = text.into_owned();
                true
            }
            Err(message) => {
                faults.push(Fault::new(FILE, 0, format!("{name}: {FOLDER}/{} {message}", kept.file)));
                false
            }
        });
        Measured { kept }
    }

    /// Replaces the table of speed by the JSON of another `weekender bench`.
    ///
    /// # Errors
    /// If the text is not such JSON.
    pub fn set_bench(&mut self, text: String) -> Result<(), String> {
        speed::Figures::parse(&text)?;
        let command = "weekender bench --json FILE".to_owned();
        let kept = Kept { file: String::new(), command, machine: None, date: None, text };
        self.kept.insert("speed".to_owned(), kept);
        Ok(())
    }

    fn find(&self, name: &str) -> Result<&Kept, String> {
        self.kept.get(name).ok_or_else(|| {
            let known: Vec<&str> = self.kept.keys().map(String::as_str).collect();
            format!("there is no measurement {name:?}; measured.toml has {}", known.join(", "))
        })
    }
}

/// The table with this name.
///
/// # Errors
/// If there is none, or its file cannot be read.
pub fn table(measured: &Measured, name: &str) -> Result<Markup, String> {
    let kept = measured.find(name)?;
    let in_file = |message: String| format!("{FOLDER}/{}: {message}", kept.file);
    match name {
        "speed" => speed::tables(kept).map_err(in_file),
        "error" => error::table(kept).map_err(in_file),
        _ => comparison::table(kept).map_err(in_file),
    }
}

/// The chart with this name.
///
/// # Errors
/// If there is none, or its file cannot be read.
pub fn chart(measured: &Measured, name: &str) -> Result<Markup, String> {
    match name {
        "error" => error::chart(measured.find(name)?),
        _ => Err(format!("there is no chart {name:?}; use error")),
    }
}

/// Smallest, middle and largest value of several runs.
#[derive(Clone, Copy, Debug, Deserialize)]
struct Spread {
    median: f64,
    min: f64,
    max: f64,
}

/// The line below a table: where and how it was measured.
fn origin(kept: &Kept, machine: Option<&str>) -> Markup {
    let machine = machine.or(kept.machine.as_deref());
    html! {
        "Measured"
        @if let Some(date) = &kept.date { " on " (date) }
        @if let Some(machine) = machine { ", " (machine) }
        ", by "
        // A flag must not be broken after its first hyphen.
        code { @for word in kept.command.split(' ') { span .nb { (word) } " " } }
        "."
    }
}

/// A table that scrolls in its own box where it is wider than the page.
fn scrolling(name: &str, caption: &Markup, table: &Markup) -> Markup {
    html! {
        figure .measured {
            div .scroll tabindex="0" role="group" aria-label=(name) { (table) }
            figcaption { (caption) }
        }
    }
}

/// Millions with as many digits as make sense.
fn millions(number: f64) -> String {
    let millions = number / 1e6;
    let digits = match millions {
        m if m < 10.0 => 2,
        m if m < 100.0 => 1,
        _ => 0,
    };
    format!("{millions:.digits$}")
}

/// A cell with the median, a bar of this share of the longest, and the range.
fn speed_cell(spread: Option<Spread>, longest: f64) -> Markup {
    html! {
        @match spread {
            None => td .bar { "not measured" },
            Some(Spread { median, min, max }) => td .bar style={ "--share:" (format!("{:.3}", median / longest)) } {
                strong { (millions(median)) } " " span .range { (millions(min)) "–" (millions(max)) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn millions_have_three_digits() {
        assert_eq!([5.214e6, 54.62e6, 154.2e6].map(millions), ["5.21", "54.6", "154"]);
        assert_eq!([10e6, 100e6].map(millions), ["10.0", "100"]);
    }

    #[test]
    fn a_measurement_whose_file_is_missing_is_a_fault_of_the_list() {
        let directory = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(directory.path().join(FOLDER)).unwrap();
        let entry = |name: &str| format!("[{name}]\nfile = \"{name}.json\"\ncommand = \"true\"\n");
        std::fs::write(directory.path().join(FILE), entry("error") + &entry("speed")).unwrap();
        std::fs::write(directory.path().join(FOLDER).join("speed.json"), "{}").unwrap();
        let mut faults = Vec::new();
        let measured = Measured::read(&Library::Checkout(directory.path().to_owned()), &mut faults);
        assert_eq!(measured.kept.keys().collect::<Vec<_>>(), ["speed"]);
        let [fault] = faults.as_slice() else { panic!("{faults:?}") };
        assert_eq!((fault.file.as_str(), fault.line), (FILE, 0));
        assert!(fault.message.starts_with("error: docs/companion/error.json "), "{fault}");
    }
}
