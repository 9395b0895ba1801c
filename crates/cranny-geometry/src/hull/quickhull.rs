//! The exact triangulated hull: quickhull (Barber, Dobkin and Huhdanpaa 1996) on exact signs.
//!
//! Every point that lies strictly above some triangle waits in the conflict list of one such
//! triangle. A step takes the highest point of a list, removes the triangles that it sees and
//! closes the hole with a fan. Heights are `f64` and only choose *which* point comes next.
//!
//! # Coplanar points
//!
//! A point *sees* a triangle when it lies **strictly** above its plane. A point in the plane of a
//! facet and outside it does not see that facet, but it strictly sees the neighbour across each
//! edge that it lies beyond, so it waits in a list all the same; its fan then extends the facet in
//! its own plane, across a flat edge. What is seen is what a point moved a little towards the
//! interior would see in general position: a disk, bounded by one simple cycle, the horizon; and no
//! new triangle is degenerate, for its apex lies strictly above a plane through its base.
//!
//! A waiting point `q` that is above a removed triangle and still outside afterwards is above a new
//! one: what `q` sees is connected across edges, so it reaches the outside over a horizon edge, and
//! the new plane through that edge is a non-negative combination of the two old ones, above both of
//! which `q` lies. So no list but those of the removed triangles need be looked at, and the result
//! holds every point, inside or on it.
//!
//! # Only extreme points
//!
//! A vertex may come to lie inside an edge or a facet of the final hull. Such vertices are found
//! from the exact convexity of the edges, and the hull is built once more from the others.
//!
//! # Cost
//!
//! A step costs the triangles that its point sees and, at worst, the product of the points that
//! waited above them and the new triangles. In all O(n log n) on the clouds measured, as is usual
//! for quickhull; no such bound holds at worst.

use std::collections::{BTreeMap, BTreeSet};

use cranny_exact::{Aabb, DVec3, Sign};

use super::canonical::{TURNED, canonical, lowest_corner};
use super::fan::Fan;
use super::flat::Flat;
use super::side::Side;
use super::sieve::outer_points;
use super::span::{Span, span_of};
use crate::each_once::each_once;

const NONE: u32 = u32::MAX;

/// A closed triangulated surface. Half-edge `3 f + i` runs from corner `i` of triangle `f` to the
/// next.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct HullSurface {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) twins: Vec<u32>,
}

/// The hull of points that are not coplanar: a surface over their indices, whose vertices are
/// exactly the extreme points (the lowest index of each), in the [one form](super::canonical) that
/// these decide.
pub(super) fn exact_hull(points: &[DVec3], simplex: [u32; 4]) -> HullSurface {
    let (mut surface, mut flat) = triangulate(points, simplex);
    if !flat.vertices.is_empty() {
        let mut extreme = each_once(surface.triangles.iter().flatten().copied());
        extreme.retain(|v| flat.vertices.binary_search(v).is_err());
        (surface, flat) = of_subset(points, &extreme).unwrap_or((surface, flat));
    }
    canonical(surface, &flat.edges)
}

/// As [`exact_hull`]; `None` if the points are coplanar.
pub(super) fn hull_of_some(points: &[DVec3]) -> Option<HullSurface> {
    let Span::Space(simplex) = span_of(points) else { return None };
    Some(exact_hull(points, simplex))
}

/// The hull of points that are not coplanar, and what of it is flat.
fn triangulate(points: &[DVec3], simplex: [u32; 4]) -> (HullSurface, Flat) {
    outer_points(points)
        .and_then(|kept| of_subset(points, &kept))
        .unwrap_or_else(|| of_all(points, simplex))
}

/// [`triangulate`], no point set aside.
pub(super) fn of_all(points: &[DVec3], simplex: [u32; 4]) -> (HullSurface, Flat) {
    HullBuilder::new(points, simplex).run()
}

/// [`triangulate`] of some of the points, ascending, over the indices of all; `None` if they are
/// coplanar.
fn of_subset(points: &[DVec3], indices: &[u32]) -> Option<(HullSurface, Flat)> {
    let subset: Vec<DVec3> = indices.iter().map(|&i| points[i as usize]).collect();
    let Span::Space(simplex) = span_of(&subset) else { return None };
    let (mut surface, mut flat) = of_all(&subset, simplex);
    for vertex in surface.triangles.iter_mut().flatten().chain(&mut flat.vertices) {
        *vertex = indices[*vertex as usize];
    }
    Some((surface, flat))
}

/// The next half-edge of the same triangle.
pub(super) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The previous half-edge of the same triangle.
pub(super) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}

impl HullSurface {
    /// The vertex that a half-edge starts from.
    pub(super) fn origin(&self, half_edge: u32) -> u32 {
        self.triangles.as_flattened()[half_edge as usize]
    }

    /// For each of so many vertices a half-edge that starts there; `NONE` where none does.
    /// Triangles that are gone have `NONE` for corners.
    pub(super) fn leaving(&self, vertices: usize) -> Vec<u32> {
        let mut leaving = vec![NONE; vertices];
        for (h, &v) in (0..).zip(self.triangles.as_flattened()) {
            if v != NONE {
                leaving[v as usize] = h;
            }
        }
        leaving
    }

    /// The half-edges that leave a vertex, from one of them on.
    pub(super) fn spokes(&self, first: u32) -> impl Iterator<Item = u32> + '_ {
        let around = move |&h: &u32| {
            let next = self.twins[previous(h) as usize];
            (next != first).then_some(next)
        };
        std::iter::successors(Some(first), around)
    }

    /// Some triangles, and all that hang together with them over half-edges that `joins` names.
    pub(super) fn hanging_together(
        &self,
        mut front: Vec<u32>,
        joins: impl Fn(u32) -> bool,
    ) -> BTreeSet<u32> {
        let mut region: BTreeSet<u32> = front.iter().copied().collect();
        while let Some(t) = front.pop() {
            for h in 3 * t..3 * t + 3 {
                let beside = self.twins[h as usize] / 3;
                if !region.contains(&beside) && joins(h) {
                    region.insert(beside);
                    front.push(beside);
                }
            }
        }
        region
    }

    /// Walks from a triangle across half-edges that `leads_out` names to one that none of its own
    /// leads out of. Returns that triangle and how many it came to; `None` where it runs into
    /// itself.
    pub(super) fn walk(&self, start: u32, leads_out: impl Fn(u32) -> bool) -> Option<(u32, usize)> {
        let mut triangle = start;
        let mut visited = BTreeSet::from([start]);
        loop {
            let out = (3 * triangle..3 * triangle + 3).filter(|&h| leads_out(h));
            let mut across = out.map(|h| self.twins[h as usize] / 3).peekable();
            if across.peek().is_none() {
                return Some((triangle, visited.len()));
            }
            triangle = across.find(|&next| visited.insert(next))?;
        }
    }

    /// Start and end of a half-edge.
    pub(super) fn ends(&self, half_edge: u32) -> [u32; 2] {
        [self.origin(half_edge), self.origin(next(half_edge))]
    }
}

/// What a test of a face that may be seen reads: a cache line.
#[repr(align(64))]
struct Facing {
    side: Side,
    /// The step that last looked at the face, and what it saw.
    step: u32,
    visible: bool,
}

/// Corners and twins of a face. Here a half-edge is `4 face + corner`, quick to take apart.
#[derive(Clone, Copy)]
struct Links {
    vertices: [u32; 3],
    twins: [u32; 3],
}

/// The points that wait above a face: the highest, or `NONE`, and a list of the others.
#[derive(Clone, Copy)]
struct Waiting {
    apex: u32,
    list: u32,
    apex_height: f64,
}

impl Waiting {
    const NOBODY: Self = Self { apex: NONE, list: NONE, apex_height: f64::NEG_INFINITY };
}

/// Room for as many faces is made at once: less, and the faces of a small cloud are moved as they
/// become more; more, and room is reserved that large clouds of few vertices never use.
const MOST_FACES_AT_FIRST: usize = 1 << 12;

struct HullBuilder<'a> {
    points: &'a [DVec3],
    extent: DVec3,
    // By face; the corners of a face that is gone are `NONE`.
    facing: Vec<Facing>,
    links: Vec<Links>,
    waiting: Vec<Waiting>,
    free: Vec<u32>,
    /// Successor of a point in its conflict list.
    successor: Vec<u32>,
    pending: Vec<u32>,
    step: u32,
    /// `(vertex, lower index of a point in the same place)`.
    duplicates: Vec<(u32, u32)>,
    /// New face whose base starts at a vertex; read only for vertices of the present horizon.
    fan_start: Vec<u32>,
    // Scratch space of a step.
    removed: Vec<u32>,
    horizon: Vec<(u32, u32, u32)>,
    orphans: Vec<u32>,
    fan: Fan,
}

impl<'a> HullBuilder<'a> {
    fn new(points: &'a [DVec3], [a, b, c, d]: [u32; 4]) -> Self {
        let bounds = Aabb::of_points(points.iter().copied());
        // As many as there are at last, of small clouds; of large ones nobody knows how many.
        let faces = (2 * points.len()).min(MOST_FACES_AT_FIRST);
        let mut builder = Self {
            points,
            extent: bounds.max - bounds.min,
            facing: Vec::with_capacity(faces),
            links: Vec::with_capacity(faces),
            waiting: Vec::with_capacity(faces),
            free: Vec::new(),
            successor: vec![NONE; points.len()],
            pending: Vec::new(),
            step: 0,
            duplicates: Vec::new(),
            fan_start: vec![NONE; points.len()],
            removed: Vec::new(),
            horizon: Vec::new(),
            orphans: Vec::new(),
            fan: Fan::default(),
        };
        // `d` lies above (a, b, c): the base looks away from it, and `d` closes the hole above.
        let (base, side) = builder.add_face([a, c, b], [NONE; 3]);
        builder.horizon = vec![(a, b, 4 * base + 2), (b, c, 4 * base + 1), (c, a, 4 * base)];
        builder.close_hole(d);
        builder.fan.push(base, &side);
        builder.orphans = (0..points.len() as u32).filter(|i| ![a, b, c, d].contains(i)).collect();
        builder.assign_orphans(&[a, b, c, d]);
        builder
    }

    /// As [`triangulate`].
    fn run(mut self) -> (HullSurface, Flat) {
        while let Some(face) = self.pending.pop() {
            let apex = self.waiting[face as usize].apex;
            if apex != NONE {
                self.insert(face, apex);
            }
        }
        self.into_surface()
    }

    /// Makes `apex`, which waits above `face`, a vertex of the hull.
    fn insert(&mut self, face: u32, apex: u32) {
        self.waiting[face as usize].apex = NONE;
        self.find_horizon(face, apex);
        self.release_removed();
        self.close_hole(apex);
        self.assign_orphans(&[apex]);
    }

    /// Collects the triangles that `apex` sees, from one of them, and the edges around them.
    fn find_horizon(&mut self, seen: u32, apex: u32) {
        self.step += 1;
        self.removed.clear();
        self.horizon.clear();
        let facing = &mut self.facing[seen as usize];
        (facing.step, facing.visible) = (self.step, true);
        self.removed.push(seen);
        let p = self.points[apex as usize];
        let mut next = 0;
        while let Some(&face) = self.removed.get(next) {
            next += 1;
            let Links { vertices, twins } = self.links[face as usize];
            for i in 0..3 {
                let neighbour = twins[i] >> 2;
                let facing = &mut self.facing[neighbour as usize];
                if facing.step != self.step {
                    let corners =
                        || self.links[neighbour as usize].vertices.map(|v| self.points[v as usize]);
                    let sign = facing.side.sign(facing.side.height(p), p, corners);
                    (facing.step, facing.visible) = (self.step, sign == Sign::Positive);
                    if facing.visible {
                        self.removed.push(neighbour);
                    }
                }
                if !facing.visible {
                    self.horizon.push((vertices[i], vertices[(i + 1) % 3], twins[i]));
                }
            }
        }
    }

    fn corners(&self, face: u32) -> [DVec3; 3] {
        self.links[face as usize].vertices.map(|v| self.points[v as usize])
    }

    /// Takes the removed faces out of the surface; the points that waited above them become
    /// orphans.
    fn release_removed(&mut self) {
        for &face in &self.removed {
            self.links[face as usize].vertices = [NONE; 3];
            let Waiting { apex, mut list, .. } =
                std::mem::replace(&mut self.waiting[face as usize], Waiting::NOBODY);
            if apex != NONE {
                self.orphans.push(apex);
            }
            while list != NONE {
                self.orphans.push(list);
                list = self.successor[list as usize];
            }
        }
        self.free.extend(&self.removed);
    }

    /// Joins every horizon edge to `apex` and links the new faces. The horizon is a simple cycle,
    /// so each of its vertices starts one edge.
    fn close_hole(&mut self, apex: u32) {
        self.fan.clear();
        let horizon = std::mem::take(&mut self.horizon);
        for &(from, to, outer) in &horizon {
            let (face, side) = self.add_face([from, to, apex], [outer, NONE, NONE]);
            self.links[(outer >> 2) as usize].twins[(outer & 3) as usize] = 4 * face;
            self.fan_start[from as usize] = face;
            self.fan.push(face, &side);
        }
        self.horizon = horizon;
        for face in self.fan.faces() {
            let to = self.links[face as usize].vertices[1];
            let neighbour = self.fan_start[to as usize];
            self.links[face as usize].twins[1] = 4 * neighbour + 2;
            self.links[neighbour as usize].twins[2] = 4 * face + 1;
        }
    }

    #[inline]
    fn add_face(&mut self, vertices: [u32; 3], twins: [u32; 3]) -> (u32, Side) {
        let side = Side::new(vertices.map(|v| self.points[v as usize]), self.extent);
        let facing = Facing { side, step: 0, visible: false };
        let links = Links { vertices, twins };
        let face = match self.free.pop() {
            Some(face) => {
                self.facing[face as usize] = facing;
                self.links[face as usize] = links;
                face
            }
            None => {
                self.facing.push(facing);
                self.links.push(links);
                self.waiting.push(Waiting::NOBODY);
                self.links.len() as u32 - 1
            }
        };
        (face, side)
    }

    /// Hands every orphan to the first new face that it lies above. One that lies above none is
    /// inside or on the hull and leaves, remembered only where it coincides with a new vertex:
    /// equal points always wait in the same list, so they leave when the first of them becomes a
    /// vertex.
    fn assign_orphans(&mut self, vertices: &[u32]) {
        let orphans = std::mem::take(&mut self.orphans);
        for &point in &orphans {
            let place = self.points[point as usize];
            let above = self.fan.first_above(place, |face, height| {
                self.facing[face as usize].side.sign(height, place, || self.corners(face))
            });
            match above {
                Some((face, height)) => self.wait(face, point, height),
                None => {
                    let same = vertices.iter().find(|&&v| self.points[v as usize] == place);
                    self.duplicates.extend(same.filter(|&&v| point < v).map(|&v| (v, point)));
                }
            }
        }
        self.orphans = orphans;
        self.orphans.clear();
        self.pending
            .extend(self.fan.faces().filter(|&face| self.waiting[face as usize].apex != NONE));
    }

    fn wait(&mut self, face: u32, point: u32, height: f64) {
        let waiting = &mut self.waiting[face as usize];
        let is_highest = height > waiting.apex_height;
        let lower = if is_highest { waiting.apex } else { point };
        waiting.apex = if is_highest { point } else { waiting.apex };
        waiting.apex_height = if is_highest { height } else { waiting.apex_height };
        if lower != NONE {
            self.successor[lower as usize] = waiting.list;
            waiting.list = lower;
        }
    }

    /// The faces that are left, each from its lowest vertex on.
    fn into_surface(self) -> (HullSurface, Flat) {
        let mut lowest = BTreeMap::new();
        for &(vertex, duplicate) in &self.duplicates {
            let least = lowest.entry(vertex).or_insert(duplicate);
            *least = duplicate.min(*least);
        }
        let alive: Vec<u32> = (0..self.links.len() as u32)
            .filter(|&f| self.links[f as usize].vertices[0] != NONE)
            .collect();
        // The place of a face, and the corner that comes first there.
        let mut places = vec![(NONE, 0); self.links.len()];
        let mut triangles = Vec::with_capacity(alive.len());
        for (place, &face) in (0..).zip(&alive) {
            let mut vertices = self.links[face as usize].vertices;
            if !lowest.is_empty() {
                vertices = vertices.map(|v| *lowest.get(&v).unwrap_or(&v));
            }
            let first = lowest_corner(vertices);
            places[face as usize] = (3 * place, first);
            triangles.push(TURNED[first as usize].map(|corner| vertices[corner]));
        }
        let half_edge = |twin: u32| {
            let (place, first) = places[(twin >> 2) as usize];
            let corner = (twin & 3) + 3 - first;
            place + corner - 3 * u32::from(corner >= 3)
        };
        let mut twins = Vec::with_capacity(3 * alive.len());
        for &face in &alive {
            let own = &self.links[face as usize].twins;
            let (_, first) = places[face as usize];
            twins.extend(TURNED[first as usize].map(|corner| half_edge(own[corner])));
        }
        let surface = HullSurface { triangles, twins };
        let across = |half_edge: u32| {
            let apex = surface.origin(previous(surface.twins[half_edge as usize]));
            let face = alive[half_edge as usize / 3];
            (face, &self.facing[face as usize].side, self.points[apex as usize])
        };
        let is_surely_bent = |half_edge: u32| {
            let (_, side, p) = across(half_edge);
            side.height(p).abs() > side.margin()
        };
        let flat = Flat::of(self.points.len(), &surface, is_surely_bent, |half_edge| {
            let (face, side, p) = across(half_edge);
            side.sign(side.height(p), p, || self.corners(face))
        });
        (surface, flat)
    }
}
