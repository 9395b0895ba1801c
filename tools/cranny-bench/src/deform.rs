//! Deformations: what moving k neighbouring vertices costs beside building the moved mesh anew.

use std::collections::BTreeSet;

use cranny_concavity::ConcavityWork;
use cranny_concavity::features::Feature;
use cranny_concavity::{Concavities, Features, FollowedConcavities};
use cranny_exact::DVec3;
use cranny_geometry::{BuildOptions, ChangeSet, DeformError, Mesh, Model, VertexId, Work};

use crate::report::{Cell, Report, Table};
use crate::solid;
use crate::stopwatch::{Repeats, keep, race};

/// How far vertices are moved, as a share of their distance from the body's middle. Larger, and
/// patches of the smallest meshes are divided; smaller than slabs are deep (2⁻⁴⁰ or so), and
/// nothing would leave the hull.
const SHARE: f64 = 1e-5;

const MOVED: [usize; 4] = [1, 10, 100, 1_000];

/// Where vertices are moved, and which way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// About the vertex that is most edges from the hull, all off it, inwards.
    Pocket,
    /// About a vertex on the hull with a neighbour off it, inwards.
    Rim,
    /// About a vertex on the hull, inwards.
    Hull,
    /// The same, outwards.
    Outward,
}

impl Place {
    const ALL: [Self; 4] = [Self::Pocket, Self::Rim, Self::Hull, Self::Outward];

    fn name(self) -> &'static str {
        match self {
            Self::Pocket => "in a pocket",
            Self::Rim => "at a rim",
            Self::Hull => "on the hull",
            Self::Outward => "outward",
        }
    }

    fn seed(self, model: &Model, features: &Features) -> Option<VertexId> {
        let is_off = |v: VertexId| features.vertex(v) == Feature::Concavity;
        if self == Self::Pocket {
            return deepest(model, features).filter(|&v| is_off(v));
        }
        let is_corner = |v: VertexId| model.hull().vertex_of_source(v).is_some();
        let bounds = model.bounds();
        // Away from the sides of the box, which decides how flat is flat.
        let is_away = |v: VertexId| {
            let p = model.mesh().position(v);
            let slack = (p - bounds.min).min(bounds.max - p);
            slack.min_element() > 0.02 * bounds.diagonal()
        };
        let mut all = vertices(model);
        all.find(|&v| {
            is_away(v)
                && is_corner(v)
                && match self {
                    Self::Rim => neighbours(model, v).any(is_off),
                    _ => !neighbours(model, v).any(is_off),
                }
        })
    }

    /// Whether vertices are where they are said to be.
    fn holds(self, features: &Features, vertices: &[VertexId]) -> bool {
        let is_off = |v: &VertexId| features.vertex(*v) == Feature::Concavity;
        self != Self::Pocket || vertices.iter().all(is_off)
    }
}

fn vertices(model: &Model) -> impl Iterator<Item = VertexId> + use<> {
    (0..model.mesh().vertices().len() as u32).map(VertexId)
}

/// A vertex as many edges from those on the hull as any.
fn deepest(model: &Model, features: &Features) -> Option<VertexId> {
    let on_hull = |v: &VertexId| features.vertex(*v) != Feature::Concavity;
    let mut found: Vec<VertexId> = vertices(model).filter(on_hull).collect();
    let mut seen: BTreeSet<VertexId> = found.iter().copied().collect();
    let mut next = 0;
    while next < found.len() {
        let fresh: Vec<VertexId> =
            neighbours(model, found[next]).filter(|&v| seen.insert(v)).collect();
        found.extend(fresh);
        next += 1;
    }
    found.last().copied()
}

pub(crate) fn measure(quick: bool) -> Report {
    let mut rows = Vec::new();
    let mut solids = vec![
        ("golf ball 1k", solid::golf_ball(1_000)),
        ("golf ball 10k", solid::golf_ball(10_000)),
    ];
    if !quick {
        solids.extend([("golf ball 100k", solid::golf_ball(100_000)), ("bolt 28k", solid::bolt())]);
    }
    for (name, mesh) in solids {
        match mesh.map_err(|error| error.to_string()).and_then(built) {
            Ok(model) => rows.extend(of_model(name, &model, quick)),
            Err(error) => rows.push(refused(name, &error)),
        }
    }
    Report {
        title: "Deformations",
        notes: vec![
            "neighbouring vertices are moved by a hundred-thousandth of their distance from the middle and \
             back, in turns with building the moved mesh (no search for faces that meet)"
                .into(),
            "the first deformation, which makes what the others keep, is not measured; deform: the model alone; \
             followed: its concavities as well, beside making the model and them anew; with envelopes: the same, \
             and those of the concavities touched"
                .into(),
            "counts are of the way there: whether everything was built anew, faces judged, facets whose caps \
             were looked at, faces and caps put together into concavities, triangles of the hull passed on the way to moved vertices, and measured, nodes of trees fitted, faces of \
             concavities whose envelopes wait to be built, faces of patches measured, faces and vertices \
             added up for sizes of the body"
                .into(),
        ],
        tables: vec![Table { title: "Moved vertices", columns: COLUMNS.to_vec(), rows }],
    }
}

const COLUMNS: [&str; 20] = [
    "mesh",
    "where",
    "moved",
    "build",
    "deform",
    "build / deform",
    "followed",
    "both built / followed",
    "with envelopes",
    "both built / envelopes",
    "anew",
    "faces",
    "facets",
    "grouped",
    "located",
    "hull",
    "nodes",
    "enveloped",
    "patched",
    "summed",
];

fn options() -> BuildOptions {
    BuildOptions { self_intersections: false, ..BuildOptions::default() }
}

fn built(mesh: Mesh) -> Result<Model, String> {
    Model::build(mesh, &options()).map(|(model, _)| model).map_err(|error| error.to_string())
}

fn refused(name: &str, error: &str) -> Vec<Cell> {
    let mut row = vec![Cell::Absent; COLUMNS.len()];
    row[0] = Cell::Text(format!("{name}: {error}"));
    row
}

fn of_model(name: &str, model: &Model, quick: bool) -> Vec<Vec<Cell>> {
    let features = &Features::of(model);
    let seed = |place: Place| Some((place, place.seed(model, features)?));
    let seeds = Place::ALL.into_iter().filter_map(seed);
    let cases = seeds.flat_map(|seed| MOVED.map(|count| (seed, count)));
    let cases = cases.map(|((place, seed), count)| (place, region(model, seed, count)));
    cases
        .filter(|(place, region)| {
            2 * region.len() < model.mesh().vertices().len() && place.holds(features, region)
        })
        .map(|(place, region)| row(name, place, model, &region, quick))
        .collect()
}

fn row(name: &str, place: Place, model: &Model, region: &[VertexId], quick: bool) -> Vec<Cell> {
    let begun = || Swinging::of(model, place, region);
    let (mut bare, mut followed, mut whole, work, beneath) = match (begun(), begun(), begun()) {
        (Ok((bare, work, beneath)), Ok((followed, ..)), Ok((whole, ..))) => {
            (bare, followed, whole, work, beneath)
        }
        (Err(error), ..) | (_, Err(error), _) | (.., Err(error)) => {
            return refused(name, &error.to_string());
        }
    };
    let (mut mesh, moved) = (model.mesh().clone(), bare.places[0].len());
    let mut vertices = mesh.vertices().to_vec();
    bare.places[0].iter().for_each(|&(v, p)| vertices[v.index()] = p);
    match Mesh::new(vertices, mesh.faces().to_vec()) {
        Ok(there) => mesh = there,
        Err(error) => return refused(name, &error.to_string()),
    }
    let [build, both_built, deform, follow, enveloping] = race(
        Repeats::of(quick),
        [
            &mut || keep(Model::build(mesh.clone(), &options())),
            &mut || {
                let built = Model::build(mesh.clone(), &options());
                keep(built.map(|(model, _)| Concavities::of(&model)));
            },
            &mut || keep(bare.swing()),
            &mut || keep(followed.swing_followed()),
            &mut || {
                keep(whole.swing_followed());
                keep(whole.followed.concavities(&whole.model));
            },
        ],
    );
    let Work { is_anew, located, hull_triangles, nodes, patched, summed } = work;
    let ConcavityWork { faces, facets, grouped, nodes: nodes_beneath, enveloped, .. } = beneath;
    let nodes = nodes + nodes_beneath;
    let mut cells = vec![
        Cell::Text(name.into()),
        Cell::Text(place.name().into()),
        Cell::Count(moved),
        Cell::Time(build),
        Cell::Time(deform),
        Cell::Ratio(build / deform),
        Cell::Time(follow),
        Cell::Ratio(both_built / follow),
        Cell::Time(enveloping),
        Cell::Ratio(both_built / enveloping),
    ];
    cells.push(Cell::Text(if is_anew { "yes" } else { "" }.into()));
    let counts =
        [faces, facets, grouped, located, hull_triangles, nodes, enveloped, patched, summed];
    cells.extend(counts.map(Cell::Count));
    cells
}

/// A model whose vertices go to the first places next, and then to the second.
struct Swinging {
    model: Model,
    followed: FollowedConcavities,
    places: [Vec<(VertexId, DVec3)>; 2],
}

impl Swinging {
    /// Of some vertices, which have been there and are back: what the first deformation makes is
    /// there. And how much there was to look at on the way there.
    fn of(
        model: &Model,
        place: Place,
        region: &[VertexId],
    ) -> Result<(Self, Work, ConcavityWork), DeformError> {
        // The first deformation makes it a copy of its own, which the others change in place.
        let followed = FollowedConcavities::of(model);
        let places = places(model, place, region);
        let mut swinging = Self { model: model.clone(), followed, places };
        let (work, beneath) = swinging.swing_followed()?;
        swinging.swing_followed()?;
        Ok((swinging, work, beneath))
    }

    /// The model alone: what follows it has missed a deformation then.
    fn swing(&mut self) -> Result<ChangeSet, DeformError> {
        let change = self.model.deform(&self.places[0])?;
        self.places.swap(0, 1);
        Ok(change)
    }

    fn swing_followed(&mut self) -> Result<(Work, ConcavityWork), DeformError> {
        let change = self.swing()?;
        let beneath = self.followed.follow(&self.model, &change);
        Ok((change.work, beneath.work))
    }
}

/// Where some vertices go, and where they are.
fn places(model: &Model, place: Place, region: &[VertexId]) -> [Vec<(VertexId, DVec3)>; 2] {
    let middle = model.bounds().center();
    let home: Vec<(VertexId, DVec3)> =
        region.iter().map(|&v| (v, model.mesh().position(v))).collect();
    let share = if place == Place::Outward { -SHARE } else { SHARE };
    let away = home.iter().map(|&(v, p)| (v, p + share * (middle - p))).collect();
    [away, home]
}

/// A golf ball whose vertices are moved, again and again, and what follows it.
pub(crate) struct Deformed {
    features: Features,
    swinging: Swinging,
    is_away: bool,
}

impl Deformed {
    pub(crate) fn golf_ball(triangles: u32) -> Option<Self> {
        let model = built(solid::golf_ball(triangles).ok()?).ok()?;
        let features = Features::of(&model);
        let followed = FollowedConcavities::of(&model);
        let swinging = Swinging { model, followed, places: [Vec::new(), Vec::new()] };
        Some(Self { features, swinging, is_away: false })
    }

    /// One deformation of so many of its vertices, which have been there and are back, and which
    /// its concavities follow.
    pub(crate) fn work(&mut self, place: Place, count: usize) -> Option<Box<dyn FnMut() + '_>> {
        let Self { features, swinging, is_away } = self;
        if std::mem::take(is_away) {
            swinging.swing_followed().ok()?;
        }
        let model = &swinging.model;
        let region = region(model, place.seed(model, features)?, count);
        swinging.places = places(model, place, &region);
        swinging.swing_followed().ok()?;
        swinging.swing_followed().ok()?;
        Some(Box::new(move || {
            let swung = swinging.swing_followed();
            *is_away = swung.is_ok();
            keep(swung);
        }))
    }
}

fn neighbours(model: &Model, v: VertexId) -> impl Iterator<Item = VertexId> + '_ {
    model.topology().faces_at(v).iter().flat_map(|&f| model.mesh().corners(f))
}

/// So many vertices, nearest by edges to one of them.
fn region(model: &Model, seed: VertexId, count: usize) -> Vec<VertexId> {
    let (mut seen, mut found) = (BTreeSet::from([seed]), vec![seed]);
    let mut next = 0;
    while next < found.len() && found.len() < count {
        for v in neighbours(model, found[next]) {
            if found.len() < count && seen.insert(v) {
                found.push(v);
            }
        }
        next += 1;
    }
    found
}
