//! `trees`: kinds of box trees over the same faces, and envelopes beside the tree that was kept.

mod descent;
mod pockets;
mod scenes;
mod variant;

use cranny_exact::{Aabb, DVec3};
use cranny_geometry::{BuildOptions, FaceTree, Mesh, Patches, Topology};
use cranny_shapes::ShapeError;

use crate::report::{Cell, Report, Table};
use crate::solid;
use crate::stopwatch::{Repeats, keep, race};
use descent::{Counts, descend};
use scenes::Scene;
use variant::{Kind, Rule, Tree};

pub(crate) fn measure(quick: bool) -> Report {
    let tables = tables(quick).unwrap_or_else(|error| {
        vec![Table {
            title: "a solid could not be made",
            columns: vec!["error"],
            rows: vec![vec![Cell::Text(error.to_string())]],
        }]
    });
    Report {
        title: "Box trees, patches, envelopes",
        notes: vec![
            "Counts are means over poses at which the bodies touch or nearly do.".into(),
            "A descent finds all pairs of faces that meet; it keeps nothing between poses.".into(),
            "Bytes: what the nodes of both trees take with f64 boxes.".into(),
        ],
        tables,
    }
}

fn tables(quick: bool) -> Result<Vec<Table>, ShapeError> {
    let scenes = scenes::all(quick)?;
    let mut tables: Vec<Table> = scenes.iter().map(|scene| kinds(scene, quick)).collect();
    tables.push(building(quick)?);
    tables.extend(pockets::tables(&scenes, quick)?);
    Ok(tables)
}

fn kinds_to_compare() -> Vec<Kind> {
    let kind = |rule, arity, oriented, leaf_size| Kind { rule, arity, oriented, leaf_size };
    use Rule::{Median, Octree, SurfaceArea};
    vec![
        kind(SurfaceArea, 2, false, 1),
        kind(SurfaceArea, 2, false, 2),
        kind(SurfaceArea, 2, false, 4),
        kind(SurfaceArea, 2, false, 8),
        kind(SurfaceArea, 4, false, 1),
        kind(SurfaceArea, 8, false, 1),
        kind(Median, 2, false, 1),
        kind(Median, 4, false, 1),
        kind(Octree, 8, false, 1),
        kind(SurfaceArea, 2, true, 1),
        kind(Median, 2, true, 1),
        kind(Octree, 8, true, 1),
    ]
}

fn kinds(scene: &Scene, quick: bool) -> Table {
    let mut rows = Vec::new();
    let mut meetings = None;
    for kind in kinds_to_compare() {
        let trees = [0, 1].map(|i| Tree::build(&scene.meshes[i], kind));
        let (counts, seconds) = walked(scene, &trees, quick);
        // All kinds must find the same.
        assert_eq!(*meetings.get_or_insert(counts.meetings), counts.meetings, "{kind:?}");
        let [build] = race(
            Repeats { least: 1, most: 3, ..Repeats::of(true) },
            [&mut || keep(Tree::build(&scene.meshes[0], kind))],
        );
        let poses = scene.poses.len();
        rows.push(vec![
            Cell::Text(format!("{:?}", kind.rule)),
            Cell::Count(kind.arity),
            Cell::Text(if kind.oriented { "oriented" } else { "aligned" }.into()),
            Cell::Count(kind.leaf_size),
            Cell::Count(counts.box_tests / poses),
            Cell::Count(counts.triangle_tests / poses),
            Cell::Count(trees.iter().map(Tree::bytes).sum()),
            Cell::Time(build),
            Cell::Time(seconds / poses as f64),
        ]);
    }
    let columns = vec![
        "rule",
        "children",
        "boxes",
        "leaf",
        "box tests",
        "triangle tests",
        "bytes",
        "build",
        "query",
    ];
    Table { title: scene.name, columns, rows }
}

fn walked(scene: &Scene, trees: &[Tree; 2], quick: bool) -> (Counts, f64) {
    let (mut total, mut seconds) = (Counts::default(), 0.0);
    for map in &scene.poses {
        let second: Vec<[DVec3; 3]> = (0..scene.meshes[1].faces().len() as u32)
            .map(|f| scene.meshes[1].triangle(cranny_geometry::FaceId(f)).map(|p| map.apply(p)))
            .collect();
        let radius = scene.meshes[1].bounds().max.length() + scene.meshes[1].bounds().min.length();
        let slack = 4.0 * map.posing_error(radius);
        let mut counts = Counts::default();
        let [time] = race(
            Repeats { least: 1, most: if quick { 1 } else { 5 }, ..Repeats::of(true) },
            [&mut || {
                counts = descend([&trees[0], &trees[1]], &scene.meshes[0], &second, map, slack);
            }],
        );
        total.box_tests += counts.box_tests;
        total.triangle_tests += counts.triangle_tests;
        total.meetings += counts.meetings;
        seconds += time;
    }
    (total, seconds)
}

/// What the product's trees and patches cost to build.
fn building(quick: bool) -> Result<Table, ShapeError> {
    let balls: &[u32] = if quick { &[10_000] } else { &[10_000, 100_000] };
    let mut solids: Vec<(String, Mesh)> = vec![("bolt".into(), solid::bolt()?)];
    for &n in balls {
        solids.push((format!("golf ball {n}"), solid::golf_ball(n)?));
    }
    let mut rows = Vec::new();
    for (name, mesh) in solids {
        let topology = Topology::of(&mesh);
        let patches = Patches::of(&mesh, &topology);
        let [tree, whole] = race(
            Repeats::of(quick),
            [&mut || keep(FaceTree::of(&mesh, BuildOptions::DEFAULT_LEAF_SIZE)), &mut || {
                keep(Patches::of(&mesh, &topology));
            }],
        );
        rows.push(vec![
            Cell::Text(name),
            Cell::Count(mesh.faces().len()),
            Cell::Time(tree),
            Cell::Count(patches.len()),
            Cell::Time(whole),
        ]);
    }
    let columns = vec!["solid", "faces", "tree", "patches", "patches in all"];
    Ok(Table { title: "building trees and patches", columns, rows })
}

/// The corners of a box.
fn corners(b: &Aabb) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let pick =
            |bit: usize, axis: usize| if i >> bit & 1 == 0 { b.min[axis] } else { b.max[axis] };
        DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
    })
}
