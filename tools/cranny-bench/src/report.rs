//! Tables of figures, as text and as JSON.

use serde_json::{Map, Value, json};
use std::fmt;

/// What a command found out.
#[derive(Clone, Debug)]
pub(crate) struct Report {
    pub(crate) title: &'static str,
    /// What one must know to read the figures.
    pub(crate) notes: Vec<String>,
    pub(crate) tables: Vec<Table>,
}

/// Rows under named columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) title: &'static str,
    pub(crate) columns: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<Cell>>,
}

/// One figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    Text(String),
    Count(usize),
    /// Seconds; printed as milliseconds.
    Time(f64),
    /// Nanoseconds.
    Nanos(f64),
    /// Microseconds.
    Micros(f64),
    /// How many times one is of another.
    Ratio(f64),
    /// An exponent.
    Slope(f64),
    /// Not measured, or not to be had.
    Absent,
}

impl Cell {
    fn to_json(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Count(n) => json!(n),
            Self::Time(x) | Self::Nanos(x) | Self::Micros(x) | Self::Ratio(x) | Self::Slope(x) => {
                json!(x)
            }
            Self::Absent => Value::Null,
        }
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match *self {
            Self::Text(ref text) => text.clone(),
            Self::Count(n) => n.to_string(),
            Self::Time(seconds) => format!("{:.3} ms", seconds * 1e3),
            Self::Nanos(nanos) => format!("{nanos:.0} ns"),
            Self::Micros(micros) => format!("{micros:.2} us"),
            Self::Ratio(ratio) => times(ratio),
            Self::Slope(slope) => format!("{slope:.2}"),
            Self::Absent => "-".into(),
        };
        f.pad(&text)
    }
}

impl Report {
    /// Rows as objects: times in seconds, absent figures as null.
    pub(crate) fn to_json(&self) -> Value {
        let tables = self.tables.iter().map(|table| {
            let row = |cells: &Vec<Cell>| -> Value {
                let pairs = table.columns.iter().zip(cells);
                Value::Object(
                    pairs.map(|(&key, cell)| (key.into(), cell.to_json())).collect::<Map<_, _>>(),
                )
            };
            json!({ "title": table.title, "rows": table.rows.iter().map(row).collect::<Vec<_>>() })
        });
        json!({ "title": self.title, "notes": self.notes, "tables": tables.collect::<Vec<_>>() })
    }
}

/// A ratio with at least two digits that count.
pub(crate) fn times(ratio: f64) -> String {
    if ratio < 0.1 { format!("{ratio:.4}x") } else { format!("{ratio:.2}x") }
}

/// The geometric mean of positive numbers; NaN of none.
pub(crate) fn geometric_mean(ratios: &[f64]) -> f64 {
    (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        for note in &self.notes {
            writeln!(f, "  {note}")?;
        }
        for table in &self.tables {
            writeln!(f, "\n{}", table.title)?;
            let width = |column: usize| {
                let cells = table.rows.iter().map(|row| row[column].to_string().len());
                cells.chain([table.columns[column].len()]).max().unwrap_or(0)
            };
            let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
            for (i, (name, &w)) in table.columns.iter().zip(&widths).enumerate() {
                if i == 0 { write!(f, "  {name:<w$}")? } else { write!(f, "  {name:>w$}")? }
            }
            writeln!(f)?;
            for row in &table.rows {
                for (i, (cell, &w)) in row.iter().zip(&widths).enumerate() {
                    if i == 0 { write!(f, "  {cell:<w$}")? } else { write!(f, "  {cell:>w$}")? }
                }
                writeln!(f)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        Report {
            title: "Figures",
            notes: vec!["a note".into()],
            tables: vec![Table {
                title: "Table",
                columns: vec!["name", "time", "ratio"],
                rows: vec![
                    vec![Cell::Text("a".into()), Cell::Time(0.0015), Cell::Ratio(2.0)],
                    vec![Cell::Text("longer".into()), Cell::Time(1.25), Cell::Absent],
                ],
            }],
        }
    }

    #[test]
    fn text_is_aligned_under_its_head() {
        let text = report().to_string();
        let rows = [
            "  name           time  ratio",
            "  a          1.500 ms  2.00x",
            "  longer  1250.000 ms      -",
        ];
        assert_eq!(text, format!("Figures\n  a note\n\nTable\n{}\n", rows.join("\n")));
    }

    #[test]
    fn a_half_and_a_double_come_to_one() {
        assert!((geometric_mean(&[0.5, 2.0]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn json_names_every_cell() {
        let json = report().to_json();
        assert_eq!(json["tables"][0]["rows"][0]["time"], 0.0015);
        assert_eq!(json["tables"][0]["rows"][1]["ratio"], Value::Null);
    }
}
