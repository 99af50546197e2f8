//! Small tables that compare ways of doing the same work, from the JSON of `examples/mappings.rs`.

use super::{Kept, Spread, origin, scrolling, speed_cell};
use maud::{Markup, html};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
struct Comparison {
    /// What was rendered.
    about: String,
    /// The processor or the adapter.
    machine: String,
    /// The first row is what the others are compared with.
    rows: Vec<Row>,
}

#[derive(Debug, Deserialize)]
struct Row {
    name: String,
    paths_per_second: Spread,
    /// Fraction of lanes or threads that had work.
    in_use: Option<f64>,
}

/// The table, with the ratio to the first row.
pub fn table(kept: &Kept) -> Result<Markup, String> {
    let Comparison { about, machine, rows } =
        serde_json::from_str(&kept.text).map_err(|error| error.to_string())?;
    let longest = rows.iter().map(|row| row.paths_per_second.median).fold(0.0, f64::max);
    let Some(first) = rows.first().map(|row| row.paths_per_second.median) else {
        return Err("has no rows".to_owned());
    };
    let has_use = rows.iter().any(|row| row.in_use.is_some());
    let table = html! {
        table .numbers {
            thead {
                tr {
                    th scope="col" { "who traces what" }
                    th .bars scope="col" { "million paths per second" }
                    th scope="col" { "× the first" }
                    @if has_use { th scope="col" { "lanes in use" } }
                }
            }
            tbody {
                @for row in &rows {
                    tr {
                        th scope="row" { (row.name) }
                        (speed_cell(Some(row.paths_per_second), longest))
                        td { (format!("{:.2}", row.paths_per_second.median / first)) }
                        @if has_use {
                            td { @if let Some(share) = row.in_use { (format!("{:.1} %", 100.0 * share)) } }
                        }
                    }
                }
            }
        }
    };
    let caption = html! { (about) " Median and range of the runs. " (origin(kept, Some(&machine))) };
    Ok(scrolling(&about, &caption, &table))
}
