//! The nearest faces of bodies that a plane parts: they are among those that lie foremost.
//!
//! Along any direction d (of length 1, from the first body to the second), let the hulls be apart by L, and some pair of
//! faces by D. Points p and q no farther from each other than D have d · (q − p) <= D. No point of the first body lies
//! higher than its hull's top, none of the second lower than its hull's bottom. So p lies in the *layer* of the first
//! body that reaches D − L below the top, q in that of the second, and their difference leaves d sideways by at most the
//! root of D² − L². Along the line between the nearest points of convex parts D = L, and the layers are two features of
//! the hulls: last frame's, or some beside them. Wherever they face each other, faces are measured: every face that
//! reaches there, whatever it is part of. So the answer is that of a search of all.
//!
//! Where a lid is foremost D is more than L, the layers hold much, and the search is left to the trees.
//!
//! Cost: two support points, climbed to from the last ones; the vertices of the hulls in the layers; a descent of each
//! tree to one place; the pairs of faces found. No heap, once lists have grown.

use cranny_exact::{Aabb, DVec2, DVec3, RigidMap};
use cranny_geometry::hull::{ConvexHull, HullVertexId};
use cranny_geometry::{Content, FaceId};

use crate::answer::Counters;
use crate::closest::NearestFaces;
use crate::gjk::{Sight, Simplex};
use crate::pair::{Pair, Side};
use crate::patience::Patience;
use crate::triangle_distance::{Prepared, triangle_distance};

/// Faces of a body that are looked at, at most. Fewer: where a vertex has more faces, all is searched; more: over
/// lids a search of the trees is cheaper.
const MOST_FACES: usize = 64;

/// Vertices of a hull that are looked at in a layer, at most. Fewer: a facet with more corners is left to the trees; more:
/// time is lost over lids.
const MOST_VERTICES: usize = 64;

/// What is kept of where two bodies were nearest. All of it is a guess to begin with.
#[derive(Clone, Debug, Default)]
pub(crate) struct Foremost {
    /// Where the hulls reached farthest towards each other.
    tops: [Option<HullVertexId>; 2],
    /// Where the search for the line ended along which they are farthest apart.
    simplex: Simplex,
    patience: Patience,
    /// Scratch.
    layers: [Layer; 2],
    faces: [Vec<Face>; 2],
    stack: Vec<u32>,
}

/// By what part of the distance known the hulls may be nearer for the layers to be looked at as they are. Larger: they
/// hold more; smaller: a better direction is sought in vain.
const SETTLED: f64 = 1e-6;

impl Foremost {
    /// Offers all pairs of faces that may be as near as the nearest that were offered before; whether these were few enough.
    /// `parting` is a direction along which the bodies are apart, for the first query; of no length if there is none.
    pub(crate) fn offer(
        &mut self,
        pair: &Pair,
        parting: DVec3,
        nearest: &mut NearestFaces,
        counters: &mut Counters,
    ) -> bool {
        if !self.patience.is_over() {
            return false;
        }
        let found = self.search(pair, parting, nearest, counters).is_some();
        match found {
            true => self.patience.succeeded(),
            false => self.patience.failed(),
        }
        found
    }

    /// Offers what there is to offer; `None` where that is too much, or no line parts the hulls.
    fn search(
        &mut self,
        pair: &Pair,
        parting: DVec3,
        nearest: &mut NearestFaces,
        counters: &mut Counters,
    ) -> Option<()> {
        let sight = self.sight(pair, parting, nearest)?;
        self.tops = sight.tops.map(Some);
        if nearest.limit() == f64::INFINITY {
            let at = |side: Side| {
                let i = side.index();
                let vertex = pair.model(side).hull().source(sight.tops[i]);
                pair.topology(side).faces_at(vertex).first().copied()
            };
            nearest.offer(at(Side::First)?, at(Side::Second)?, counters);
        }
        // As if the bodies were no farther apart than their hulls, and if they are, as far as is known then.
        let close = (sight.least * (1.0 + SETTLED)).min(nearest.limit());
        self.gather(pair, &sight, close, counters)?;
        self.measure(pair, &sight, nearest, counters);
        if nearest.limit() > close {
            self.gather(pair, &sight, nearest.limit(), counters)?;
            self.measure(pair, &sight, nearest, counters);
        }
        Some(())
    }

    /// The line along which to look: that between the nearest faces known, if hulls are as far apart along it as these are.
    fn sight(&mut self, pair: &Pair, parting: DVec3, nearest: &NearestFaces) -> Option<Sight> {
        let known = nearest.toward().and_then(|toward| Sight::along(pair, toward, self.tops));
        let limit = nearest.limit();
        if let Some(sight) = known.filter(|s| limit - s.least <= SETTLED * s.least) {
            return Some(sight);
        }
        let start = match known.filter(|sight| sight.least > 0.0) {
            Some(sight) => sight,
            None => Sight::along(pair, parting, self.tops)?,
        };
        Some(start.farthest(pair, SETTLED, &mut self.simplex)).filter(|sight| sight.least > 0.0)
    }

    /// Offers the pairs of faces that were gathered, but those that are certainly not as near as what is known.
    fn measure(
        &self,
        pair: &Pair,
        sight: &Sight,
        nearest: &mut NearestFaces,
        counters: &mut Counters,
    ) {
        let rounding = pair.culling_error() + 2.0 * pair.length_error();
        let [first, second] = &self.faces;
        for f in first {
            for g in second {
                let (most, along) = (nearest.limit() + rounding, sight.least + f.depth + g.depth);
                if along > most {
                    break;
                }
                if along * along + f.aside_squared(g) > most * most
                    || f.is_beyond(&g.posed, most)
                    || g.is_beyond(&f.posed, most)
                {
                    continue;
                }
                counters.triangle_tests += 1;
                let found = f.triangle.nearest(f.corners, &g.triangle, g.corners);
                // What wins is told as whenever faces are measured, whatever was left out here.
                if nearest.would_win([f.face, g.face], &found) {
                    nearest.take([f.face, g.face], triangle_distance(&f.posed, &g.posed));
                }
            }
        }
    }

    /// Finds the faces that may be no farther apart than `limit`; `None` where they are many.
    fn gather(
        &mut self,
        pair: &Pair,
        sight: &Sight,
        limit: f64,
        counters: &mut Counters,
    ) -> Option<()> {
        let hulls = Side::BOTH.map(|side| pair.model(side).hull());
        let map = &pair.first_from_second;
        let &Sight { directions, tops, least, .. } = sight;
        // The limit may be off by a constructed length, and the distance sought by another.
        let error = pair.culling_error();
        let most = limit + 2.0 * pair.length_error() + error;
        for i in 0..2 {
            let top = directions[i].dot(hulls[i].position(tops[i]));
            let floor = top - (most - least) - error;
            if !self.layers[i].fill(hulls[i], directions[i], tops[i], floor, error) {
                return None;
            }
        }
        let aside = ((most - least) * (most + least)).sqrt() + 2.0 * error;
        let back = map.inverse();
        let maps = [[&RigidMap::IDENTITY, map], [&back, &RigidMap::IDENTITY]];
        for side in Side::BOTH {
            let i = side.index();
            // The other's layer, moved over this one's by L: from there, points at most D apart are no farther than the
            // root of D² − L², since (s − L)² + D² − s² is no more for a part s >= L along the line.
            let [own, its] = [i, 1 - i].map(|j| self.layers[j].bounds(maps[i][j]));
            let over = least * directions[i];
            let place = Aabb { min: its.min - over, max: its.max - over }.grown(aside);
            if !place.overlaps(&own) {
                // Nothing can be nearer than what is known.
                self.faces[i].clear();
                continue;
            }
            let place = Aabb { min: place.min.max(own.min), max: place.max.min(own.max) };
            self.find(pair, side, [directions[i], directions[0]], &place, counters);
        }
        for faces in &mut self.faces {
            if faces.len() > MOST_FACES {
                return None;
            }
            faces.sort_unstable_by(|f, g| f.depth.total_cmp(&g.depth));
        }
        Some(())
    }

    /// Lists the faces of a body that reach into its layer at a place, a box in its own frame; more than enough
    /// are not listed.
    fn find(
        &mut self,
        pair: &Pair,
        side: Side,
        [direction, toward]: [DVec3; 2],
        place: &Aabb,
        counters: &mut Counters,
    ) {
        let (tree, mesh) = (pair.model(side).tree(), pair.mesh(side));
        let (faces, stack) = (&mut self.faces[side.index()], &mut self.stack);
        let axes: [DVec3; 2] = toward.any_orthonormal_pair().into();
        let Layer { top, floor, .. } = self.layers[side.index()];
        faces.clear();
        stack.clear();
        stack.push(0);
        while let Some(node) = stack.pop() {
            counters.node_tests += 1;
            if !tree.node(node).bounds.overlaps(place) {
                continue;
            }
            match tree.content(node) {
                Content::Inner { left, right } => stack.extend([left, right]),
                Content::Leaf { .. } => {
                    for &face in tree.leaf_faces(node) {
                        let heights = mesh.triangle(face).map(|p| direction.dot(p));
                        let [a, b, c] = heights.map(|height| u8::from(height >= floor));
                        let corners = a | b << 1 | c << 2;
                        if corners != 0 {
                            let [a, b, c] = heights;
                            let posed = pair.triangle(side, face);
                            faces.push(Face {
                                face,
                                corners,
                                depth: top - a.max(b).max(c),
                                across: across(axes, &posed),
                                triangle: Prepared::of(&posed),
                                normal: (posed[1] - posed[0])
                                    .cross(posed[2] - posed[0])
                                    .normalize_or_zero(),
                                posed,
                            });
                        }
                    }
                    if faces.len() > MOST_FACES {
                        return;
                    }
                }
            }
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        let faces = self.faces.iter().map(|faces| faces.capacity() * size_of::<Face>());
        faces.sum::<usize>()
            + self.layers.iter().map(Layer::bytes).sum::<usize>()
            + self.stack.capacity() * size_of::<u32>()
    }
}

/// A face that reaches into the layer of its body.
#[derive(Clone, Debug)]
struct Face {
    face: FaceId,
    /// Its corners that do, a bit each.
    corners: u8,
    /// How far below the hull's top it ends.
    depth: f64,
    /// Its least and greatest coordinates across the direction, in the pair's frame.
    across: [DVec2; 2],
    posed: [DVec3; 3],
    normal: DVec3,
    triangle: Prepared,
}

impl Face {
    /// Square of a lower bound of how far the difference of two points leaves the direction sideways.
    fn aside_squared(&self, other: &Self) -> f64 {
        let [gap, back] = [other.across[0] - self.across[1], self.across[0] - other.across[1]];
        gap.max(back).max(DVec2::ZERO).length_squared()
    }

    /// Whether a triangle lies farther off along the face's normal, on one side, than `most`. A needle's normal may be noise:
    /// what the face reaches along it counts.
    fn is_beyond(&self, its: &[DVec3; 3], most: f64) -> bool {
        let range = |corners: &[DVec3; 3]| {
            let [a, b, c] = corners.map(|p| self.normal.dot(p - self.posed[0]));
            [a.min(b).min(c), a.max(b).max(c)]
        };
        let ([low, high], [least, greatest]) = (range(&self.posed), range(its));
        least - high > most || low - greatest > most
    }
}

fn across([u, v]: [DVec3; 2], triangle: &[DVec3; 3]) -> [DVec2; 2] {
    let [a, b, c] = triangle.map(|p| DVec2::new(u.dot(p), v.dot(p)));
    [a.min(b).min(c), a.max(b).max(c)]
}

/// What of a hull lies above a plane.
#[derive(Clone, Debug, Default)]
struct Layer {
    /// The hull's greatest height.
    top: f64,
    floor: f64,
    /// The hull's vertices there.
    vertices: Vec<HullVertexId>,
    /// These, and where the plane cuts edges that lead to them.
    points: Vec<DVec3>,
}

impl Layer {
    /// Looks at the vertices around the top: what lies above a plane hangs together over the edges of a convex polytope.
    /// Whether these are few. `error` bounds how far heights are off.
    fn fill(
        &mut self,
        hull: &ConvexHull,
        direction: DVec3,
        top: HullVertexId,
        floor: f64,
        error: f64,
    ) -> bool {
        (self.top, self.floor) = (direction.dot(hull.position(top)), floor);
        self.vertices.clear();
        self.points.clear();
        self.vertices.push(top);
        // Lower than is asked for: a vertex about as high as the floor is taken in, and the cuts lie beyond those sought.
        let cut = floor - 2.0 * error;
        let mut next = 0;
        while let Some(&v) = self.vertices.get(next) {
            next += 1;
            let p = hull.position(v);
            let height = direction.dot(p);
            self.points.push(p);
            for &w in hull.neighbours(v) {
                let q = hull.position(w);
                let its = direction.dot(q);
                if its < cut {
                    self.points.push(p + (q - p) * ((height - cut) / (height - its)));
                } else if !self.vertices.contains(&w) {
                    if self.vertices.len() == MOST_VERTICES {
                        return false;
                    }
                    self.vertices.push(w);
                }
            }
        }
        true
    }

    /// The box around it, in another frame.
    fn bounds(&self, map: &RigidMap) -> Aabb {
        Aabb::of_points(self.points.iter().map(|p| map.apply(*p)))
    }

    fn bytes(&self) -> usize {
        self.vertices.capacity() * size_of::<HullVertexId>()
            + self.points.capacity() * size_of::<DVec3>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brute_force::brute_force;
    use crate::closest::{self, Closest};
    use crate::memory::PairMemory;
    use crate::query::{Demand, Placed, Query};
    use crate::surface::meeting_pairs;
    use cranny_exact::{DQuat, Pose};
    use cranny_geometry::{BuildOptions, Mesh, Model, Repair};
    use cranny_shapes::{Comb, Cuboid, Cup, GolfBall, Shape, Torus};
    use cranny_testkit::Rng;
    use std::f64::consts::TAU;

    fn bodies() -> Vec<Model> {
        let shapes: [Shape; 6] = [
            Cuboid { size: [1.0; 3] }.into(),
            Cup { segments: 10, ..Cup::default() }.into(),
            Comb { teeth: 4, ..Comb::default() }.into(),
            Torus { major_segments: 14, minor_segments: 6, ..Torus::default() }.into(),
            GolfBall { triangles: 320, dimples: 12, ..GolfBall::default() }.into(),
            GolfBall { triangles: 180, dimples: 0, ..GolfBall::default() }.into(),
        ];
        let mut meshes: Vec<Mesh> = shapes.map(|s| s.build().unwrap()).into();
        meshes.push(Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap());
        let options = BuildOptions::default();
        meshes.into_iter().map(|mesh| Model::build(mesh, &options).unwrap().0).collect()
    }

    /// All that is told: faces, features, and bits of lengths.
    fn told(found: Option<Closest>) -> String {
        format!("{found:?}")
    }

    /// Along random directions, at all gaps; every other pose along the axes, where faces lie flush and ties abound. One
    /// memory for all: what it says stems from other bodies, at other poses.
    #[test]
    fn finds_what_a_search_of_all_faces_finds() {
        let bodies = bodies();
        let mut rng = Rng::new(5);
        let mut foremost = Foremost::default();
        let (mut settled, mut left) = (0, 0);
        let mut last = None;
        for round in 0..1500 {
            let [a, b] = [&bodies[rng.below(7)], &bodies[rng.below(7)]];
            let aligned = round % 2 == 0;
            let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let (turn, way) = match aligned {
                true => (DQuat::IDENTITY, DVec3::AXES[round / 2 % 3]),
                false => (DQuat::from_scaled_axis(3.0 * vector()), vector().normalize_or(DVec3::X)),
            };
            let far = [0.7, 0.9, 1.02, 1.1, 3.0][round % 5] * (a.radius() + b.radius());
            let pose = Pose { rotation: turn.normalize(), translation: far * way };
            let placed = [Placed { model: a, pose: Pose::IDENTITY }, Placed { model: b, pose }];
            let (told, faces) = agrees(&mut foremost, placed, last);
            settled += told;
            left += 2 - told;
            last = faces.or(last);
        }
        assert!(settled > 1000 && left > 20, "{settled} {left}");
    }

    /// Asks for the nearest faces, without and with a way to begin with, knowing what was nearest elsewhere: how often they were told, as a search of all tells them; and which they are, if surfaces do not meet.
    fn agrees(
        foremost: &mut Foremost,
        [a, b]: [Placed; 2],
        last: Option<[FaceId; 2]>,
    ) -> (u32, Option<[FaceId; 2]>) {
        let mut memory = PairMemory::default();
        let pair = Pair::new(a, b, &mut memory.posed);
        let mut counters = Counters::default();
        if !meeting_pairs(&pair, &mut counters).is_empty() {
            return (0, None);
        }
        let mut all = NearestFaces::less_than(&pair, f64::INFINITY);
        closest::search(&pair, &mut all, &mut counters);
        let mut settled = 0;
        for has_way in [false, true] {
            let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
            let has = |side: Side, face: FaceId| face.index() < pair.mesh(side).faces().len();
            if let Some([f, g]) = last.filter(|l| has(Side::First, l[0]) && has(Side::Second, l[1]))
            {
                nearest.offer(f, g, &mut counters);
            }
            let way = if has_way { pair.first_from_second.translation } else { DVec3::ZERO };
            // What is tested is not how long it waits.
            foremost.patience = Patience::default();
            if foremost.offer(&pair, way.normalize_or_zero(), &mut nearest, &mut counters) {
                assert_eq!(told(nearest.found()), told(all.found()), "{:?}", b.pose);
                settled += 1;
            }
        }
        (settled, all.faces())
    }

    fn unmended(vertices: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Option<Model> {
        let options = BuildOptions { repair: Repair::None, ..BuildOptions::default() };
        Some(Model::build(Mesh::new(vertices, faces).ok()?, &options).ok()?.0)
    }

    /// Some triangles over points of a lattice, each in a plane of it or slanted: needles and triangles without area among
    /// them.
    fn soup(rng: &mut Rng) -> Option<Model> {
        let count = 1 + rng.below(4) as u32;
        let mut vertices = Vec::new();
        for _ in 0..count {
            let (flat, level) = (rng.below(4), rng.below(7));
            for _ in 0..3 {
                let mut at = |axis| if axis == flat { level } else { rng.below(7) };
                let p = [at(0), at(1), at(2)].map(|k| 0.25 * k as f64);
                vertices.push(DVec3::from_array(p));
            }
        }
        unmended(vertices, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    }

    /// Ties of all kinds; whatever was measured before the trees are asked, the answer is theirs.
    #[test]
    fn ties_are_told_as_a_search_tells_them() {
        let mut rng = Rng::new(11);
        let (mut same, mut none) = (0, 0);
        for round in 0..6_000 {
            let (Some(a), Some(b)) = (soup(&mut rng), soup(&mut rng)) else { continue };
            let mut step = || 0.5 * rng.below(9) as f64 - 2.0;
            let pose = Pose::at(DVec3::new(step(), step(), step()));
            let mut memory = PairMemory::default();
            let [a, b] =
                [(&a, Pose::IDENTITY), (&b, pose)].map(|(model, pose)| Placed { model, pose });
            let pair = Pair::new(a, b, &mut memory.posed);
            let mut counters = Counters::default();
            if !meeting_pairs(&pair, &mut counters).is_empty() {
                continue;
            }
            let below = [f64::INFINITY, 0.75, 2.0][round % 3];
            let mut all = NearestFaces::less_than(&pair, below);
            closest::search(&pair, &mut all, &mut counters);
            let mut nearest = NearestFaces::less_than(&pair, below);
            if round % 2 == 0 {
                nearest.offer(FaceId(0), FaceId(0), &mut counters);
            }
            let way = pair.first_from_second.translation.normalize_or_zero();
            if !Foremost::default().offer(&pair, way, &mut nearest, &mut counters) {
                closest::search(&pair, &mut nearest, &mut counters);
            }
            assert_eq!(told(nearest.found()), told(all.found()), "round {round}");
            same += u32::from(all.found().is_some());
            none += u32::from(all.found().is_none());
        }
        assert!(same > 2_000 && none > 300, "{same} {none}");
    }

    /// The normal of a face without area is noise, and may lie along the face.
    #[test]
    fn faces_that_are_lines_are_near() {
        let mut rng = Rng::new(13);
        let mut told = 0;
        for _ in 0..3_000 {
            let mut vector = || DVec3::new(rng.unit(), rng.unit(), rng.unit());
            let (start, along) = (vector(), vector());
            let share = 0.3 + 0.6 * vector().x.abs();
            let line = unmended(vec![start, start + along, start + share * along], vec![[0, 1, 2]]);
            let corners = vec![vector(), vector(), vector(), vector()];
            let solid = unmended(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
            let (Some(line), Some(solid)) = (line, solid) else { continue };
            let pose = Pose {
                rotation: DQuat::from_scaled_axis(3.0 * vector()).normalize(),
                translation: 3.0 * vector().normalize_or(DVec3::X),
            };
            let a = Placed { model: &line, pose: Pose::IDENTITY };
            let b = Placed { model: &solid, pose };
            let query = Query::of(Demand::Distance { below: None });
            let found = crate::query(a, b, &query, &mut PairMemory::default()).unwrap();
            assert_eq!(found.distance, Some(brute_force(a, b).unwrap().distance), "{pose:?}");
            told += 1;
        }
        assert!(told > 2_000, "{told}");
    }

    /// Here the first pass, which leaves corners out, finds the nearest faces and not the point on them that is told.
    #[test]
    fn what_a_thin_layer_leaves_out_does_not_show() {
        let torus = Torus { major_segments: 14, minor_segments: 6, ..Torus::default() };
        let shapes: [Shape; 2] = [torus.into(), Comb { teeth: 4, ..Comb::default() }.into()];
        let [torus, comb] =
            shapes.map(|s| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap().0);
        let turn =
            [-0.6734244524593356, 0.2163181212198827, 0.20337920902652656, 0.6770102470402414];
        let pose = Pose {
            rotation: DQuat::from_array(turn),
            translation: DVec3::new(0.5769018192288595, 0.7543956214707733, -2.6564991223455245),
        };
        let a = Placed { model: &torus, pose: Pose::IDENTITY };
        let b = Placed { model: &comb, pose };
        let query = Query::of(Demand::Distance { below: None });
        let mut memory = PairMemory::default();
        let [cold, warm] = [0, 1].map(|_| crate::query(a, b, &query, &mut memory).unwrap());
        assert_eq!(cold.witnesses, warm.witnesses);
    }

    /// A vertex with many neighbours is not looked at for long.
    #[test]
    fn layers_of_many_vertices_are_left_at_once() {
        let rim = |k: u32| {
            let (sin, cos) = (f64::from(k) * TAU / 2_000.0).sin_cos();
            DVec3::new(cos, sin, 0.0)
        };
        let mut points: Vec<DVec3> = (0..2_000).map(rim).collect();
        points.extend([0.01 * DVec3::Z, -DVec3::Z]);
        let hull = ConvexHull::of_points(&points);
        let top = hull.support(DVec3::Z, None).unwrap();
        let mut layer = Layer::default();
        assert!(!layer.fill(&hull, DVec3::Z, top, -0.5, 0.0));
        assert!(layer.vertices.len() <= MOST_VERTICES && layer.points.len() <= MOST_VERTICES);
        assert!(layer.fill(&hull, DVec3::Z, top, 0.005, 0.0));
        assert_eq!([layer.vertices.len(), layer.points.len()], [1, 2_001]);
    }

    /// Over a dish, whose lid is nearer than its floor: nothing of the floor is in a layer that is too thin.
    #[test]
    fn looks_beneath_lids() {
        let dish = Cup { radius: 1.0, wall: 0.02, height: 0.3, floor: 0.1, segments: 8 };
        let [dish, cube] = [Shape::from(dish), Cuboid { size: [0.2; 3] }.into()]
            .map(|s: Shape| Model::build(s.build().unwrap(), &BuildOptions::default()).unwrap().0);
        let mut settled = 0;
        for round in 0..60 {
            let at = |k: i32| f64::from(k) * 0.137;
            let pose = Pose::at(DVec3::new(
                at(round % 7 - 3),
                at(round % 5 - 2),
                0.42 + 0.01 * f64::from(round),
            ));
            let placed =
                [Placed { model: &dish, pose: Pose::IDENTITY }, Placed { model: &cube, pose }];
            settled += u32::from(agrees(&mut Foremost::default(), placed, None).0 > 0);
        }
        assert!(settled > 40, "{settled}");
    }

    /// Between convex parts layers are thin: whatever the number of faces, few are looked at.
    #[test]
    fn work_does_not_grow_with_the_faces() {
        for triangles in [500, 2_000, 8_000] {
            let ball = GolfBall { triangles, dimples: 0, ..GolfBall::default() };
            let (model, _) = Model::build(ball.build().unwrap(), &BuildOptions::default()).unwrap();
            let mut foremost = Foremost::default();
            let mut last: Option<[FaceId; 2]> = None;
            for frame in 0..50 {
                let angle = 0.001 * f64::from(frame);
                let pose = Pose {
                    rotation: DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle).normalize(),
                    translation: 1.02 * DVec3::new(1.2, 1.28, 0.96),
                };
                let mut memory = PairMemory::default();
                let [a, b] = [Pose::IDENTITY, pose].map(|pose| Placed { model: &model, pose });
                let pair = Pair::new(a, b, &mut memory.posed);
                let mut nearest = NearestFaces::less_than(&pair, f64::INFINITY);
                let mut counters = Counters::default();
                if let Some([f, g]) = last {
                    nearest.offer(f, g, &mut counters);
                }
                let way = pose.translation.normalize();
                assert!(foremost.offer(&pair, way, &mut nearest, &mut counters));
                last = nearest.faces();
                if frame > 0 {
                    let Counters { node_tests, triangle_tests, .. } = counters;
                    assert!(node_tests < 400 && triangle_tests < 50, "{triangles} {counters:?}");
                }
            }
        }
    }
}
