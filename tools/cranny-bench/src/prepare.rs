//! Whole preparation of meshes: against parry's, stage by stage, and how it grows.

use cpu_time::ThreadTime;
use cranny_concavity::Concavities;
use cranny_geometry::{BuildOptions, ConvexHull, Mesh, Model};
use cranny_shapes::ShapeError;
use parry3d::math::Vector;
use parry3d::transformation::try_convex_hull;
use parry3d::transformation::vhacd::{VHACD, VHACDParameters};

use crate::hulls::single;
use crate::report::{Cell, Report, Table};
use crate::solid;
use crate::stopwatch::{Repeats, keep, median, race};

/// How often the stages of one mesh are timed.
const STAGE_RUNS: usize = 9;

pub(crate) fn measure(quick: bool) -> Report {
    let (mut peers, mut stages) = (Vec::new(), Vec::new());
    for (name, mesh) in solids(quick) {
        match mesh.map_err(|error| error.to_string()).and_then(buildable) {
            Ok(mesh) => {
                peers.push(against_parry(name, &mesh, quick));
                stages.extend(by_stage(name, &mesh, if quick { 3 } else { STAGE_RUNS }));
            }
            Err(error) => peers.push(refused(name, &error)),
        }
    }
    Report {
        title: "Preparation of a model",
        notes: vec![
            "decomposition: parry's VHACD::decompose and compute_exact_convex_hulls, both at their defaults, f32".into(),
            "same run, same meshes, in turns; medians of thread CPU time; ratio = decomposition / cranny".into(),
            "load: Model::decode of what Model::encode made, in turns with building; build / load likewise".into(),
            "load all: the same and Model::prepare_all, which makes what a loaded model otherwise makes when it \
             is first wanted for it"
                .into(),
            "concavities: Concavities::of the model, which nobody pays for who does not ask for them".into(),
        ],
        tables: vec![
            Table {
                title: "Against parry",
                columns: vec![
                    "mesh", "triangles", "cranny", "decomposition", "ratio", "hull alone",
                    "cranny / hull", "parry hull", "load", "build / load", "load all", "build / all",
                    "concavities", "concavities / cranny",
                ],
                rows: peers,
            },
            Table { title: "Stages", columns: vec!["mesh", "stage", "time", "share"], rows: stages },
            growth(quick),
        ],
    }
}

type Solid = (&'static str, Result<Mesh, ShapeError>);

fn solids(quick: bool) -> Vec<Solid> {
    let mut solids = vec![
        ("golf ball 1k", solid::golf_ball(1_000)),
        ("golf ball 10k", solid::golf_ball(10_000)),
    ];
    if !quick {
        solids.push(("golf ball 100k", solid::golf_ball(100_000)));
    }
    solids.extend([("torus 10k", solid::torus()), ("bolt 28k", solid::bolt())]);
    solids
}

/// The mesh, once it is known that a model can be built of it: a refusal would look quick.
fn buildable(mesh: Mesh) -> Result<Mesh, String> {
    match Model::build(mesh.clone(), &BuildOptions::default()) {
        Ok(_) => Ok(mesh),
        Err(error) => Err(error.to_string()),
    }
}

fn build(mesh: &Mesh) {
    keep(Model::build(mesh.clone(), &BuildOptions::default()));
}

fn against_parry(name: &str, mesh: &Mesh, quick: bool) -> Vec<Cell> {
    let points: Vec<Vector> = single(mesh.vertices());
    let parameters = VHACDParameters::default();
    let [ours, hull, parry_hull] = race(
        Repeats::of(quick),
        [&mut || build(mesh), &mut || keep(ConvexHull::of_points(mesh.vertices())), &mut || {
            keep(try_convex_hull(&points));
        }],
    );
    // Apart from the others, which it would keep from running often.
    let [again, decomposition] = race(
        Repeats { least: if quick { 1 } else { 3 }, ..Repeats::of(quick) },
        [&mut || build(mesh), &mut || {
            let parts = VHACD::decompose(&parameters, &points, mesh.faces(), true);
            keep(parts.compute_exact_convex_hulls(&points, mesh.faces()));
        }],
    );
    let saved =
        Model::build(mesh.clone(), &BuildOptions::default()).map(|(model, _)| model.encode());
    let loaded = || saved.as_ref().map(|bytes| Model::decode(bytes));
    let [built, load, load_all] = race(
        Repeats::of(quick),
        [&mut || build(mesh), &mut || keep(loaded()), &mut || {
            let model = loaded();
            if let Ok(Ok(model)) = &model {
                model.prepare_all();
            }
            keep(model);
        }],
    );
    let model = Model::build(mesh.clone(), &BuildOptions::default()).map(|(model, _)| model);
    let [built_beside, concavities] = race(
        Repeats::of(quick),
        [&mut || build(mesh), &mut || keep(model.as_ref().map(Concavities::of))],
    );
    vec![
        Cell::Text(name.into()),
        Cell::Count(mesh.faces().len()),
        Cell::Time(ours),
        Cell::Time(decomposition),
        Cell::Ratio(decomposition / again),
        Cell::Time(hull),
        Cell::Ratio(ours / hull),
        Cell::Time(parry_hull),
        Cell::Time(load),
        Cell::Ratio(built / load),
        Cell::Time(load_all),
        Cell::Ratio(built / load_all),
        Cell::Time(concavities),
        Cell::Ratio(concavities / built_beside),
    ]
}

fn refused(name: &str, error: &str) -> Vec<Cell> {
    let mut row = vec![Cell::Absent; 14];
    row[0] = Cell::Text(format!("{name}: {error}"));
    row
}

/// The time from each stage's beginning to the next one's, as a share of building the model.
fn by_stage(name: &str, mesh: &Mesh, runs: usize) -> Vec<Vec<Cell>> {
    let mut of_model: Vec<(String, Vec<f64>)> = Vec::new();
    let mut of_concavities = Vec::new();
    for _ in 0..runs {
        let mut begun: Vec<(String, ThreadTime)> = Vec::new();
        let mesh = mesh.clone();
        let observe = &mut |stage| begun.push((format!("{stage:?}"), ThreadTime::now()));
        let built = Model::build_observed(mesh, &BuildOptions::default(), observe);
        book(&begun, &mut of_model);
        let Ok((model, _)) = built else { continue };
        begun.clear();
        keep(Concavities::observed(&model, Concavities::DEFAULT_LEAF_SIZE, &mut |stage| {
            begun.push((format!("concavities: {stage:?}"), ThreadTime::now()));
        }));
        book(&begun, &mut of_concavities);
    }
    let medians = |stages: Vec<(String, Vec<f64>)>| -> Vec<(String, f64)> {
        stages.into_iter().map(|(stage, times)| (stage, median(times))).collect()
    };
    let (of_model, of_concavities) = (medians(of_model), medians(of_concavities));
    let total: f64 = of_model.iter().map(|(_, time)| time).sum();
    let row = |(stage, time): (String, f64)| {
        vec![
            Cell::Text(name.into()),
            Cell::Text(stage.to_lowercase()),
            Cell::Time(time),
            Cell::Ratio(time / total),
        ]
    };
    of_model.into_iter().chain(of_concavities).map(row).collect()
}

/// Books the time between one beginning and the next on the first of the two.
fn book(begun: &[(String, ThreadTime)], stages: &mut Vec<(String, Vec<f64>)>) {
    for pair in begun.windows(2) {
        let (stage, time) = (&pair[0].0, pair[1].1.duration_since(pair[0].1).as_secs_f64());
        match stages.iter_mut().find(|(known, _)| known == stage) {
            Some((_, times)) => times.push(time),
            None => stages.push((stage.clone(), vec![time])),
        }
    }
}

/// Golf balls of growing size: the slope is the exponent of growth since the row before; n log n
/// has 1.1 to 1.07 at these sizes.
fn growth(quick: bool) -> Table {
    let sizes: &[u32] = if quick { &[1_000, 10_000] } else { &[1_000, 10_000, 100_000, 1_000_000] };
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    let mut before: Option<(f64, f64, f64)> = None;
    for &size in sizes {
        let Ok(mesh) = solid::golf_ball(size) else { continue };
        let [whole, hull] = race(
            Repeats { most: 50, ..Repeats::of(quick) },
            [&mut || build(&mesh), &mut || keep(ConvexHull::of_points(mesh.vertices()))],
        );
        let n = mesh.faces().len() as f64;
        let slope = |since: Option<(f64, f64)>, now: f64| match since {
            Some((fewer, then)) => Cell::Slope((now / then).ln() / (n / fewer).ln()),
            None => Cell::Absent,
        };
        rows.push(vec![
            Cell::Count(mesh.faces().len()),
            Cell::Time(whole),
            slope(before.map(|(n, whole, _)| (n, whole)), whole),
            Cell::Nanos(whole / (n * n.log2()) * 1e9),
            Cell::Time(hull),
            slope(before.map(|(n, _, hull)| (n, hull)), hull),
        ]);
        before = Some((n, whole, hull));
    }
    Table {
        title: "Growth on golf balls",
        columns: vec!["triangles", "cranny", "slope", "per n log2 n", "hull alone", "hull slope"],
        rows,
    }
}
