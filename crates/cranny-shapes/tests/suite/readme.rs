//! The README lists every generator.

use std::collections::BTreeSet;

use cranny_shapes::Shape;

#[test]
fn the_readme_has_one_line_for_each_generator() {
    let rows = include_str!("../../README.md").lines();
    let rows = rows.filter_map(|line| line.strip_prefix("| `")?.split_once('`'));
    let listed: Vec<&str> = rows.map(|(name, _)| name).collect();
    let all = Shape::defaults();
    let all: BTreeSet<&str> = all.iter().map(Shape::name).collect();
    assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), all);
    assert_eq!(listed.len(), all.len(), "each once");
}
