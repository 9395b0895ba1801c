//! The concavities: in a line, and the largest of them in a table.

use cranny_geometry::hull::FLATNESS;

use super::super::summary::{ConcavityLine, Summary};
use crate::words::{counted, number};

/// So many concavities are listed; the rest is counted.
const LISTED: usize = 8;

const HEAD: [&str; 10] =
    ["id", "kind", "faces", "loops", "lids", "cap area", "area", "volume", "tree", "envelope"];

/// How many concavities of each kind there are, and how much they hold.
pub(super) fn in_short(summary: &Summary) -> String {
    let all = &summary.concavities;
    let skin = match summary.skin_volume {
        rounding if rounding.abs() <= FLATNESS * summary.hull.volume => String::new(),
        volume => format!("; skin {}", number(volume)),
    };
    if all.is_empty() {
        return format!("nothing: no concavity{skin}");
    }
    let of_kind = |kind: &str| all.iter().filter(|c| c.kind == kind).count();
    let kinds = ["pocket", "passage", "void", "island", "opening"];
    let counts = kinds.iter().filter(|kind| of_kind(kind) > 0);
    let counts: Vec<String> = counts.map(|kind| counted(of_kind(kind), kind)).collect();
    let held = match summary.volumes_unknown {
        Some(why) => format!("what they hold is unknown: {why}"),
        None => {
            let pockets: f64 = all.iter().filter_map(|c| c.pocket_volume).sum();
            format!("pockets hold {}{skin}", number(pockets))
        }
    };
    format!("{}; {held}", counts.join(", "))
}

/// The largest by volume, one a line; of one size, by id.
pub(super) fn table(lines: &mut Vec<String>, all: &[ConcavityLine]) {
    if all.is_empty() {
        return;
    }
    let mut by_size: Vec<&ConcavityLine> = all.iter().collect();
    by_size.sort_by(|a, b| {
        // By area where volumes are unknown.
        let size = |c: &ConcavityLine| c.pocket_volume.unwrap_or(c.area).abs();
        size(b).total_cmp(&size(a)).then(a.id.cmp(&b.id))
    });
    let rows: Vec<[String; 10]> = by_size.iter().take(LISTED).map(|c| row(c)).collect();
    let width = |column: usize| {
        rows.iter().map(|row| row[column].len()).fold(HEAD[column].len(), usize::max)
    };
    let widths: [usize; 10] = std::array::from_fn(width);
    lines.push("concavities, the largest first".to_owned());
    lines.push(line(&HEAD.map(str::to_owned), &widths));
    lines.extend(rows.iter().map(|row| line(row, &widths)));
    if all.len() > LISTED {
        lines.push(format!("  and {} more (all with --format json)", all.len() - LISTED));
    }
}

fn row(concavity: &ConcavityLine) -> [String; 10] {
    let kind = match concavity.parent {
        None => concavity.kind.to_owned(),
        Some(parent) => format!("{} in {parent}", concavity.kind),
    };
    let envelope = match concavity.envelope_layers {
        0 => "none".to_owned(),
        count => format!("{}, {} deep", counted(count, "layer"), concavity.envelope_depth),
    };
    [
        concavity.id.to_string(),
        kind,
        concavity.faces.to_string(),
        concavity.loops.to_string(),
        concavity.lids.to_string(),
        number(concavity.cap_area),
        number(concavity.area),
        concavity.pocket_volume.map_or_else(|| "unknown".to_owned(), number),
        counted(concavity.tree_nodes, "node"),
        envelope,
    ]
}

/// Words to the left of their column, numbers to the right.
fn line(cells: &[String; 10], widths: &[usize; 10]) -> String {
    let padded = cells.iter().zip(widths).zip(HEAD).map(|((cell, &width), head)| match head {
        "kind" | "envelope" => format!("  {cell:<width$}"),
        _ => format!("  {cell:>width$}"),
    });
    padded.collect::<String>().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pocket(id: u32, volume: f64) -> ConcavityLine {
        ConcavityLine {
            id,
            kind: "pocket",
            faces: 12,
            loops: 1,
            lids: 1,
            cap_area: 0.5,
            area: 2.0,
            pocket_volume: Some(volume),
            parent: None,
            tree_nodes: 11,
            envelope_layers: 3,
            envelope_depth: 2,
            envelope_facets: 9,
        }
    }

    #[test]
    fn the_largest_stand_first_and_the_rest_is_counted() {
        let mut all: Vec<_> = (0..10).map(|id| pocket(id, 0.25)).collect();
        all[7] = ConcavityLine { kind: "island", parent: Some(0), ..pocket(7, -3.0) };
        let mut lines = Vec::new();
        table(&mut lines, &all);
        assert_eq!(
            lines[1..4],
            [
                "  id  kind         faces  loops  lids  cap area  area  volume      tree  envelope",
                "   7  island in 0     12      1     1       0.5     2      -3  11 nodes  3 layers, 2 deep",
                "   0  pocket          12      1     1       0.5     2    0.25  11 nodes  3 layers, 2 deep",
            ]
        );
        assert_eq!(lines.len(), 11);
        assert_eq!(lines[10], "  and 2 more (all with --format json)");
        lines.clear();
        table(&mut lines, &[]);
        assert!(lines.is_empty());
    }
}
