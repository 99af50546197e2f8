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

#[cfg(test)]
mod tests {
    use super::*;

    fn html(rows: &str) -> Result<String, String> {
        let text = format!("{{\"about\": \"Mappings.\", \"machine\": \"a GPU\", \"rows\": [{rows}]}}");
        let (file, command) = ("c.json".to_owned(), "make it".to_owned());
        let kept = Kept { file, command, machine: None, date: None, text };
        table(&kept).map(Markup::into_string)
    }

    fn row(name: &str, median: f64, more: &str) -> String {
        let speeds = format!("{{\"median\": {median:.1}, \"min\": 1e6, \"max\": 9e6}}");
        format!("{{\"name\": \"{name}\", \"paths_per_second\": {speeds}{more}}}")
    }

    #[test]
    fn rows_are_compared_with_the_first() {
        let rows = [row("one", 2e6, ""), row("two", 8e6, ", \"in_use\": 0.625"), row("three", 1e6, "")];
        let html = html(&rows.join(",")).unwrap();
        let range = "<span class=\"range\">1.00–9.00</span>";
        for (name, share, speed, ratio, in_use) in [
            ("one", "0.250", "2.00", "1.00", ""),
            ("two", "1.000", "8.00", "4.00", "62.5 %"),
            ("three", "0.125", "1.00", "0.50", ""),
        ] {
            let name = format!("<th scope=\"row\">{name}</th>");
            let bar =
                format!("<td class=\"bar\" style=\"--share:{share}\"><strong>{speed}</strong> {range}</td>");
            let row = format!("{name}{bar}<td>{ratio}</td><td>{in_use}</td></tr>");
            assert!(html.contains(&row), "{row}: {html}");
        }
        assert!(html.contains("lanes in use") && html.contains("Mappings. Median and range of the runs."));
        assert!(html.contains("Measured, a GPU, by "), "{html}");
    }

    #[test]
    fn a_column_that_would_be_empty_is_left_out_and_a_table_too() {
        let html_of_one = html(&row("one", 2e6, "")).unwrap();
        assert!(!html_of_one.contains("lanes in use") && html_of_one.contains("<td>1.00</td></tr>"));
        assert_eq!(html("").unwrap_err(), "has no rows");
    }
}
