//! The same contacts, found face pair by face pair, with nothing kept: what
//! [`near_regions`](super::near_regions) must find where faces have areas.

use std::collections::HashMap;

use cranny_exact::DVec3;
use cranny_geometry::{DisjointSets, EdgeId, FaceId, VertexId};

use crate::answer::{Contact, Feature};
use crate::contacts::facing::{PARALLEL, Ridge, faces_towards, in_cone, in_wedge, over};
use crate::pair::{Pair, Side};
use cranny_geometry::triangle_distance::{Part, closest_on_segments, closest_on_triangle};

/// All contacts between surfaces that are apart by more than 0 and at most `margin`, grouped into
/// regions, in the pair's frame.
pub(super) fn near_regions(pair: &Pair, margin: f64) -> Vec<Vec<Contact>> {
    let mut finder = Finder::new(pair, margin);
    let faces = Side::BOTH.map(|side| 0..pair.mesh(side).faces().len() as u32);
    for first in faces[0].clone() {
        for second in faces[1].clone() {
            finder.add(FaceId(first), FaceId(second));
        }
    }
    finder.regions()
}

/// Whether an edge is more than a line drawn on a plane.
fn is_sharp(pair: &Pair, side: Side, edge: EdgeId) -> bool {
    Ridge::of(pair, side, edge).is_sharp
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

    /// Finds or makes the contact of two features; `make` is called once.
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
        let its = Feature::of_part(part, self.pair.model(side.other()), face);
        let towards = if part == Part::Inside || over(height, separation, raw) {
            // A vertex that stands over a face counts also where its neighbours are nearer: a
            // tilted box lands on all its corners.
            if !faces_towards(self.pair, side, vertex, -outward) {
                return None;
            }
            -outward
        } else {
            // Beside the face: only where both features are the nearest of their bodies.
            let towards = (foot - p) / separation;
            let faces_it = separation > self.pair.length_error()
                && in_cone(self.pair, side, vertex, towards)
                && match its {
                    Feature::Vertex(w) => in_cone(self.pair, side.other(), w, -towards),
                    Feature::Edge(e) => in_wedge(self.pair, side.other(), e, -towards),
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
            let sharp =
                is_sharp(finder.pair, Side::First, e) && is_sharp(finder.pair, Side::Second, g);
            if !sharp || separation > finder.margin || separation <= finder.pair.length_error() {
                return None;
            }
            let normal = gap / separation;
            let faces_it = in_wedge(finder.pair, Side::First, e, normal)
                && in_wedge(finder.pair, Side::Second, g, -normal);
            faces_it.then_some(Contact { id, point_a, point_b, normal, separation })
        })
    }

    fn regions(self) -> Vec<Vec<Contact>> {
        let mut sets = DisjointSets::new(self.contacts.len());
        for (i, j) in self.joins {
            sets.union(i, j);
        }
        let of_group = |group: Vec<usize>| group.into_iter().map(|i| self.contacts[i]).collect();
        sets.groups().into_iter().map(of_group).collect()
    }
}
