//! The exact triangulated hull: quickhull (Barber, Dobkin and Huhdanpaa 1996) on exact signs.
//!
//! Every point that lies strictly above some triangle waits in the conflict list of one such
//! triangle. A step takes the highest point of a list, removes the triangles that it sees and closes
//! the hole with a fan. Heights are `f64` and only choose *which* point comes next.
//!
//! # Coplanar points
//!
//! A point *sees* a triangle when it lies **strictly** above its plane. A point in the plane of a
//! facet and outside it does not see that facet, but it strictly sees the neighbour across each edge
//! that it lies beyond, so it waits in a list all the same; its fan then extends the facet in its own
//! plane, across a flat edge. What is seen is what a point moved a little towards the interior would
//! see in general position: a disk, bounded by one simple cycle, the horizon; and no new triangle is
//! degenerate, for its apex lies strictly above a plane through its base.
//!
//! A waiting point `q` that is above a removed triangle and still outside afterwards is above a new
//! one: what `q` sees is connected across edges, so it reaches the outside over a horizon edge, and
//! the new plane through that edge is a non-negative combination of the two old ones, above both of
//! which `q` lies. So no list but those of the removed triangles need be looked at, and the result
//! holds every point, inside or on it.
//!
//! # Only extreme points
//!
//! A vertex may come to lie inside an edge or a facet of the final hull. Such vertices are found from
//! the exact convexity of the edges, and the hull is built once more from the others.

use cranny_exact::{Aabb, DVec3, Sign};

use super::side::Side;
use super::sieve::outer_points;
use super::span::{Span, span_of};

const NONE: u32 = u32::MAX;

/// A closed triangulated surface. Half-edge `3 f + i` runs from corner `i` of triangle `f` to the
/// next.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Surface {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) twins: Vec<u32>,
}

/// The hull of points that are not coplanar: a surface over their indices, whose vertices are exactly
/// the extreme points (the lowest index of each).
pub(super) fn exact_hull(points: &[DVec3], simplex: [u32; 4]) -> Surface {
    let (surface, flat) = triangulate(points, simplex);
    if flat.is_empty() {
        return surface;
    }
    let mut extreme: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    extreme.sort_unstable();
    extreme.dedup();
    extreme.retain(|v| flat.binary_search(v).is_err());
    of_subset(points, &extreme).map_or(surface, |(surface, _)| surface)
}

/// The hull of points that are not coplanar, and those of its vertices, sorted, that lie inside an edge
/// or a facet of it.
fn triangulate(points: &[DVec3], simplex: [u32; 4]) -> (Surface, Vec<u32>) {
    outer_points(points)
        .and_then(|kept| of_subset(points, &kept))
        .unwrap_or_else(|| of_all(points, simplex))
}

/// [`triangulate`], no point set aside.
pub(super) fn of_all(points: &[DVec3], simplex: [u32; 4]) -> (Surface, Vec<u32>) {
    Builder::new(points, simplex).run()
}

/// [`triangulate`] of some of the points, over the indices of all; `None` if they are coplanar.
fn of_subset(points: &[DVec3], indices: &[u32]) -> Option<(Surface, Vec<u32>)> {
    let subset: Vec<DVec3> = indices.iter().map(|&i| points[i as usize]).collect();
    let Span::Space(simplex) = span_of(&subset) else { return None };
    let (mut surface, mut flat) = of_all(&subset, simplex);
    for vertex in surface.triangles.iter_mut().flatten().chain(&mut flat) {
        *vertex = indices[*vertex as usize];
    }
    Some((surface, flat))
}

/// Vertices that are not extreme, sorted. At an extreme point three or more edges are strictly
/// convex; inside an edge of the hull two are, inside a facet none. `edge_sign` is the exact
/// [`edge_sign`] of a half-edge of the surface, over `points` points.
pub(super) fn flat_vertices(
    points: usize,
    surface: &Surface,
    edge_sign: impl Fn(u32) -> Sign,
) -> Vec<u32> {
    let mut convex_edges = vec![0u32; points];
    for (half_edge, &twin) in (0u32..).zip(&surface.twins) {
        if half_edge < twin && edge_sign(half_edge) != Sign::Zero {
            for v in surface.ends(half_edge) {
                convex_edges[v as usize] += 1;
            }
        }
    }
    let mut flat: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    flat.retain(|&v| convex_edges[v as usize] < 3);
    flat.sort_unstable();
    flat.dedup();
    flat
}

/// On which side of a triangle the apex of its neighbour lies: `Negative` where the edge is convex,
/// `Zero` where it is flat.
pub(super) fn edge_sign(points: &[DVec3], surface: &Surface, half_edge: u32) -> Sign {
    let [a, b, c] = surface.triangles[half_edge as usize / 3].map(|v| points[v as usize]);
    let apex = surface.origin(previous(surface.twins[half_edge as usize]));
    cranny_exact::orient3d(a, b, c, points[apex as usize])
}

/// The next half-edge of the same triangle.
pub(super) fn next(half_edge: u32) -> u32 {
    if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
}

/// The previous half-edge of the same triangle.
pub(super) fn previous(half_edge: u32) -> u32 {
    if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
}

impl Surface {
    /// The vertex that a half-edge starts from.
    pub(super) fn origin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// Start and end of a half-edge.
    pub(super) fn ends(&self, half_edge: u32) -> [u32; 2] {
        [self.origin(half_edge), self.origin(next(half_edge))]
    }
}

struct Face {
    vertices: [u32; 3],
    twins: [u32; 3],
    side: Side,
    /// Highest waiting point, or `NONE`; the others hang in a list.
    apex: u32,
    apex_height: f64,
    list: u32,
    /// The step that last looked at the face, and what it saw.
    step: u32,
    visible: bool,
    alive: bool,
}

struct Builder<'a> {
    points: &'a [DVec3],
    extent: DVec3,
    faces: Vec<Face>,
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
    stack: Vec<u32>,
    removed: Vec<u32>,
    horizon: Vec<(u32, u32, u32)>,
    orphans: Vec<u32>,
    fan: Vec<(u32, Side)>,
}

impl<'a> Builder<'a> {
    fn new(points: &'a [DVec3], [a, b, c, d]: [u32; 4]) -> Self {
        let bounds = Aabb::of_points(points.iter().copied());
        let mut builder = Self {
            points,
            extent: bounds.max - bounds.min,
            faces: Vec::new(),
            free: Vec::new(),
            successor: vec![NONE; points.len()],
            pending: Vec::new(),
            step: 0,
            duplicates: Vec::new(),
            fan_start: vec![NONE; points.len()],
            stack: Vec::new(),
            removed: Vec::new(),
            horizon: Vec::new(),
            orphans: Vec::new(),
            fan: Vec::new(),
        };
        // `d` lies above (a, b, c): the base looks away from it, and `d` closes the hole above.
        let base = builder.add_face([a, c, b]);
        builder.horizon = vec![(a, b, 3 * base + 2), (b, c, 3 * base + 1), (c, a, 3 * base)];
        builder.close_hole(d);
        builder.fan.push((base, builder.faces[base as usize].side));
        builder.orphans = (0..points.len() as u32).filter(|i| ![a, b, c, d].contains(i)).collect();
        builder.assign_orphans(&[a, b, c, d]);
        builder
    }

    /// As [`triangulate`].
    fn run(mut self) -> (Surface, Vec<u32>) {
        while let Some(face) = self.pending.pop() {
            let apex = self.faces[face as usize].apex;
            if self.faces[face as usize].alive && apex != NONE {
                self.insert(face, apex);
            }
        }
        self.into_surface()
    }

    /// Makes `apex`, which waits above `face`, a vertex of the hull.
    fn insert(&mut self, face: u32, apex: u32) {
        self.faces[face as usize].apex = NONE;
        self.find_horizon(face, apex);
        for i in 0..self.removed.len() {
            self.release(self.removed[i]);
        }
        self.close_hole(apex);
        self.assign_orphans(&[apex]);
    }

    /// Collects the triangles that `apex` sees, from one of them, and the edges around them.
    fn find_horizon(&mut self, seen: u32, apex: u32) {
        self.step += 1;
        self.removed.clear();
        self.horizon.clear();
        self.mark(seen, true);
        self.stack.push(seen);
        while let Some(f) = self.stack.pop() {
            self.removed.push(f);
            let (vertices, twins) = (self.faces[f as usize].vertices, self.faces[f as usize].twins);
            for i in 0..3 {
                let neighbour = twins[i] / 3;
                if self.faces[neighbour as usize].step != self.step {
                    let sign = self.look(neighbour, apex);
                    self.mark(neighbour, sign == Sign::Positive);
                    if sign == Sign::Positive {
                        self.stack.push(neighbour);
                    }
                }
                if !self.faces[neighbour as usize].visible {
                    self.horizon.push((vertices[i], vertices[(i + 1) % 3], twins[i]));
                }
            }
        }
    }

    fn mark(&mut self, face: u32, visible: bool) {
        let face = &mut self.faces[face as usize];
        face.step = self.step;
        face.visible = visible;
    }

    /// On which side of a face a point lies: exact.
    #[inline]
    fn look(&self, face: u32, point: u32) -> Sign {
        let side = &self.faces[face as usize].side;
        let p = self.points[point as usize];
        side.sign(side.height(p), p, || self.corners(face))
    }

    fn corners(&self, face: u32) -> [DVec3; 3] {
        self.faces[face as usize].vertices.map(|v| self.points[v as usize])
    }

    /// Takes a face out of the surface; the points that waited above it become orphans.
    fn release(&mut self, index: u32) {
        let face = &mut self.faces[index as usize];
        face.alive = false;
        if face.apex != NONE {
            self.orphans.push(face.apex);
        }
        let mut waiting = face.list;
        while waiting != NONE {
            self.orphans.push(waiting);
            waiting = self.successor[waiting as usize];
        }
        self.free.push(index);
    }

    /// Joins every horizon edge to `apex` and links the new faces. The horizon is a simple cycle, so
    /// each of its vertices starts one edge.
    fn close_hole(&mut self, apex: u32) {
        self.fan.clear();
        for i in 0..self.horizon.len() {
            let (from, to, outer) = self.horizon[i];
            let face = self.add_face([from, to, apex]);
            self.faces[face as usize].twins[0] = outer;
            self.faces[outer as usize / 3].twins[outer as usize % 3] = 3 * face;
            self.fan_start[from as usize] = face;
            self.fan.push((face, self.faces[face as usize].side));
        }
        for i in 0..self.fan.len() {
            let (face, _) = self.fan[i];
            let to = self.faces[face as usize].vertices[1];
            let neighbour = self.fan_start[to as usize];
            self.faces[face as usize].twins[1] = 3 * neighbour + 2;
            self.faces[neighbour as usize].twins[2] = 3 * face + 1;
        }
    }

    fn add_face(&mut self, vertices: [u32; 3]) -> u32 {
        let face = Face {
            vertices,
            twins: [NONE; 3],
            side: Side::new(vertices.map(|v| self.points[v as usize]), self.extent),
            apex: NONE,
            apex_height: 0.0,
            list: NONE,
            step: 0,
            visible: false,
            alive: true,
        };
        match self.free.pop() {
            Some(index) => {
                self.faces[index as usize] = face;
                index
            }
            None => {
                self.faces.push(face);
                self.faces.len() as u32 - 1
            }
        }
    }

    /// Hands every orphan to the first new face that it lies above. One that lies above none is inside
    /// or on the hull and leaves, remembered only where it coincides with a new vertex: equal points
    /// always wait in the same list, so they leave when the first of them becomes a vertex.
    fn assign_orphans(&mut self, vertices: &[u32]) {
        let orphans = std::mem::take(&mut self.orphans);
        for &point in &orphans {
            let place = self.points[point as usize];
            let above = self.fan.iter().find_map(|&(face, ref side)| {
                let height = side.height(place);
                let sign = side.sign(height, place, || self.corners(face));
                (sign == Sign::Positive).then_some((face, height))
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
        let fan = self.fan.iter().map(|&(face, _)| face);
        self.pending.extend(fan.filter(|&face| self.faces[face as usize].apex != NONE));
    }

    fn wait(&mut self, face: u32, point: u32, height: f64) {
        let face = &mut self.faces[face as usize];
        let mut waiting = point;
        if face.apex == NONE || height > face.apex_height {
            waiting = std::mem::replace(&mut face.apex, point);
            face.apex_height = height;
        }
        if waiting != NONE {
            self.successor[waiting as usize] = face.list;
            face.list = waiting;
        }
    }

    fn into_surface(self) -> (Surface, Vec<u32>) {
        let mut lowest = std::collections::BTreeMap::new();
        for &(vertex, duplicate) in &self.duplicates {
            let least = lowest.entry(vertex).or_insert(duplicate);
            *least = duplicate.min(*least);
        }
        let alive: Vec<u32> =
            (0..self.faces.len() as u32).filter(|&f| self.faces[f as usize].alive).collect();
        let mut new_index = vec![NONE; self.faces.len()];
        for (new, &old) in (0..).zip(&alive) {
            new_index[old as usize] = new;
        }
        let mut surface = Surface::default();
        for &old in &alive {
            let face = &self.faces[old as usize];
            surface.triangles.push(face.vertices.map(|v| *lowest.get(&v).unwrap_or(&v)));
            surface.twins.extend(face.twins.map(|t| 3 * new_index[t as usize / 3] + t % 3));
        }
        let flat = flat_vertices(self.points.len(), &surface, |half_edge| {
            let apex = surface.origin(previous(surface.twins[half_edge as usize]));
            self.look(alive[half_edge as usize / 3], apex)
        });
        (surface, flat)
    }
}
