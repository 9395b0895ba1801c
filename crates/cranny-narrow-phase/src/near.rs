//! Contacts across a gap: pairs of features that face each other within a margin.
//!
//! A vertex over a face, and two convex edges whose nearest points lie between their ends, are what
//! two polyhedra touch with next; a vertex before an edge or another vertex is where sharp parts are
//! nearest. Each yields a contact whose normal is exact at its own point: the face's, or the line
//! between the two points. Pairs of faces that share such a contact belong to one region.

use std::collections::HashMap;
use std::ops::ControlFlow;

use cranny_exact::DVec3;
use cranny_geometry::{DisjointSets, EdgeId, FaceId, VertexId};

use crate::answer::{Contact, Counters, Feature};
use crate::descent::for_each_near_pair;
use crate::pair::{Pair, Side};
use crate::touch::mean_normal;
use crate::triangle_distance::{Part, closest_on_segments, closest_on_triangle};

/// Squared sine of the angle below which two edges count as parallel: their nearest points are not
/// unique, and vertices stand for them. Larger: crossed edges at small angles are missed; smaller:
/// the contact's normal is lost in rounding.
const PARALLEL: f64 = 1e-6;

/// By how much, as a sine (30 degrees), a vertex's neighbours may be nearer to a face that the vertex
/// stands before. Smaller: a tilted box loses the corners that will touch next; larger: flat vertices
/// of a floor stop what slides along it.
const NEIGHBOUR_LEAD: f64 = 0.5;

/// How far outside the wedge of an edge's two faces a direction may lie and still count as within,
/// as a sine. Zero would drop contacts of smooth meshes by rounding.
const WEDGE_SLACK: f64 = 1e-9;

/// All contacts between surfaces that are apart by more than 0 and at most `margin`, grouped into
/// regions, in the pair's frame.
pub(crate) fn near_regions(pair: &Pair, margin: f64, counters: &mut Counters) -> Vec<Vec<Contact>> {
    let mut finder = Finder::new(pair, margin);
    for_each_near_pair(pair, margin, counters, |first, second, counters| {
        counters.triangle_tests += 1;
        finder.add(first, second);
        ControlFlow::Continue(())
    });
    finder.regions()
}

/// Whether a point that is as far from a face's plane as `height` (times the length of `raw`, the
/// plane's normal) stands over its rim rather than beside it.
fn over(height: f64, separation: f64, raw: DVec3) -> bool {
    height >= (1.0 - WEDGE_SLACK) * separation * raw.length()
}

struct Finder<'a, 'b> {
    pair: &'a Pair<'b>,
    margin: f64,
    by_id: HashMap<(Feature, Feature), Option<usize>>,
    contacts: Vec<Contact>,
    joins: Vec<(usize, usize)>,
}

impl<'a, 'b> Finder<'a, 'b> {
    fn new(pair: &'a Pair<'b>, margin: f64) -> Self {
        Self { pair, margin, by_id: HashMap::new(), contacts: Vec::new(), joins: Vec::new() }
    }

    fn add(&mut self, first: FaceId, second: FaceId) {
        let (a, b) =
            (self.pair.triangle(Side::First, first), self.pair.triangle(Side::Second, second));
        let mut here: Option<usize> = None;
        let mut join = |found: Option<usize>, joins: &mut Vec<(usize, usize)>| {
            if let Some(index) = found {
                if let Some(previous) = here {
                    joins.push((previous, index));
                }
                here = Some(index);
            }
        };
        for i in 0..3 {
            let v = self.pair.corner(Side::First, first, i);
            join(self.vertex_face(Side::First, v, a[i], second, &b), &mut self.joins);
            let v = self.pair.corner(Side::Second, second, i);
            join(self.vertex_face(Side::Second, v, b[i], first, &a), &mut self.joins);
        }
        for i in 0..3 {
            for j in 0..3 {
                let (e, g) = (
                    self.pair.edge(Side::First, first, i),
                    self.pair.edge(Side::Second, second, j),
                );
                let segments = [[a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]]];
                join(self.edge_edge(e, g, segments), &mut self.joins);
            }
        }
    }

    /// Finds or makes the contact of two features; `make` is asked once.
    fn once(
        &mut self,
        id: (Feature, Feature),
        make: impl FnOnce(&Self) -> Option<Contact>,
    ) -> Option<usize> {
        if let Some(&known) = self.by_id.get(&id) {
            return known;
        }
        let index = make(self).map(|contact| {
            self.contacts.push(contact);
            self.contacts.len() - 1
        });
        self.by_id.insert(id, index);
        index
    }

    /// A vertex of `side` before a face of the other body, or the nearest part of its rim.
    fn vertex_face(
        &mut self,
        side: Side,
        vertex: VertexId,
        p: DVec3,
        face: FaceId,
        triangle: &[DVec3; 3],
    ) -> Option<usize> {
        // Cheap refusal before anything else: too far from the face's plane, or behind it.
        let raw = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        let height = raw.dot(p - triangle[0]);
        if height <= 0.0 || height > self.margin * raw.length() {
            return None;
        }
        let (foot, part) = closest_on_triangle(p, triangle);
        let separation = (p - foot).length();
        if separation > self.margin {
            return None;
        }
        let outward = raw.normalize_or_zero();
        let own = Feature::Vertex(vertex);
        let its = part.feature(self.pair.model(side.other()), face);
        let towards = if part == Part::Inside || over(height, separation, raw) {
            // A vertex that stands over a face counts also where its neighbours are nearer: a tilted
            // box lands on all its corners.
            if !self.faces_towards(side, vertex, -outward) {
                return None;
            }
            -outward
        } else {
            // Beside the face: only where both features are the nearest of their bodies.
            let towards = (foot - p) / separation;
            let faces_it = separation > self.pair.length_error()
                && self.in_cone(side, vertex, towards)
                && match its {
                    Feature::Vertex(w) => self.in_cone(side.other(), w, -towards),
                    Feature::Edge(e) => self.in_wedge(side.other(), e, -towards),
                    Feature::Face(_) => false,
                };
            if !faces_it {
                return None;
            }
            towards
        };
        let contact = match side {
            Side::First => {
                Contact { id: (own, its), point_a: p, point_b: foot, normal: towards, separation }
            }
            Side::Second => {
                Contact { id: (its, own), point_a: foot, point_b: p, normal: -towards, separation }
            }
        };
        self.once(contact.id, |_| Some(contact))
    }

    /// Whether a vertex can be what touches along `direction`: some face at it looks that way (the
    /// back of a thin part does not touch), and no neighbour is much farther that way (a vertex in
    /// the middle of a floor is not what stops a box that slides along it).
    fn faces_towards(&self, side: Side, vertex: VertexId, direction: DVec3) -> bool {
        let p = self.pair.position(side, vertex);
        let faces = self.pair.topology(side).faces_at(vertex);
        faces.iter().any(|&f| self.pair.area_vector(side, f).dot(direction) > 0.0)
            && faces.iter().flat_map(|&f| self.pair.mesh(side).corners(f)).all(|q| {
                let edge = self.pair.position(side, q) - p;
                direction.dot(edge) <= NEIGHBOUR_LEAD * edge.length()
            })
    }

    fn edge_edge(&mut self, e: EdgeId, g: EdgeId, [p, q]: [[DVec3; 2]; 2]) -> Option<usize> {
        let (d1, d2) = (p[1] - p[0], q[1] - q[0]);
        let cross = d1.cross(d2);
        let squared = cross.length_squared();
        if squared <= PARALLEL * d1.length_squared() * d2.length_squared() {
            return None;
        }
        let lift = cross.dot(q[0] - p[0]);
        if lift.abs() > self.margin * squared.sqrt() {
            return None;
        }
        let id = (Feature::Edge(e), Feature::Edge(g));
        self.once(id, |finder| {
            let (s, t) = closest_on_segments(&p, &q);
            let open = |x: f64| x > 0.0 && x < 1.0;
            if !open(s) || !open(t) {
                return None;
            }
            let (point_a, point_b) = (p[0] + d1 * s, q[0] + d2 * t);
            let gap = point_b - point_a;
            let separation = gap.length();
            // A flat edge touches nothing before its ends do, or the edges around it.
            let sharp = finder.is_sharp(Side::First, e) && finder.is_sharp(Side::Second, g);
            if !sharp || separation > finder.margin || separation <= finder.pair.length_error() {
                return None;
            }
            let normal = gap / separation;
            let faces_it = finder.in_wedge(Side::First, e, normal)
                && finder.in_wedge(Side::Second, g, -normal);
            faces_it.then_some(Contact { id, point_a, point_b, normal, separation })
        })
    }

    /// Whether all edges at a vertex fall away from a direction that does not lead into the body.
    fn in_cone(&self, side: Side, vertex: VertexId, direction: DVec3) -> bool {
        let p = self.pair.position(side, vertex);
        let faces = self.pair.topology(side).faces_at(vertex);
        let falls_away = |q: DVec3| direction.dot(q - p) <= WEDGE_SLACK * (q - p).length();
        faces.iter().flat_map(|&f| self.pair.triangle(side, f)).all(falls_away)
            && self.faces_towards(side, vertex, direction)
    }

    /// Whether an edge is more than a line drawn on a plane.
    fn is_sharp(&self, side: Side, edge: EdgeId) -> bool {
        let [h, g] = *self.pair.topology(side).half_edges(edge) else { return true };
        let (n, m) = (self.pair.normal(side, h.face()), self.pair.normal(side, g.face()));
        n.dot(m) <= 0.0 || n.cross(m).length() > WEDGE_SLACK
    }

    /// Whether a direction lies between the outward normals of an edge's faces: both faces fall away
    /// from it, and it does not lead into the body.
    fn in_wedge(&self, side: Side, edge: EdgeId, direction: DVec3) -> bool {
        // At a reflex edge both faces fall away from what leads inside. The sum of the normals tells;
        // each of them by itself would refuse half of what a sharp edge can touch.
        if mean_normal(self.pair, side, Feature::Edge(edge)).dot(direction) < 0.0 {
            return false;
        }
        let around = self.pair.topology(side).half_edges(edge);
        around.iter().all(|&h| {
            let [a, b, c] = self.pair.triangle(side, h.face());
            let corners = [a, b, c];
            let start = corners[h.corner()];
            let end = corners[(h.corner() + 1) % 3];
            let apex = corners[(h.corner() + 2) % 3];
            let along = (end - start).normalize_or_zero();
            let into = (apex - start) - along * along.dot(apex - start);
            direction.dot(into) <= WEDGE_SLACK * into.length()
        })
    }

    fn regions(self) -> Vec<Vec<Contact>> {
        let mut sets = DisjointSets::new(self.contacts.len());
        for (i, j) in self.joins {
            sets.union(i, j);
        }
        let mut regions: Vec<Vec<Contact>> = Vec::new();
        let mut region_of_root = HashMap::new();
        for (index, contact) in self.contacts.into_iter().enumerate() {
            let region = *region_of_root.entry(sets.find(index)).or_insert(regions.len());
            if region == regions.len() {
                regions.push(Vec::new());
            }
            regions[region].push(contact);
        }
        regions
    }
}
