//! A ball of nearly equal triangles, with dimples.

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Sign, orient3d};
use cranny_geometry::Mesh;
use serde::Deserialize;

use crate::{
    builder::{MeshBuilder, direction},
    error::{Checked, ShapeError},
};

/// A geodesic sphere centred at the origin, dented by dimples that lie on a spherical Fibonacci
/// lattice (Swinbank and Purser, 2006) from pole to pole along z.
///
/// The surface is a radius for every direction, so it cannot cross itself. Between dimples the
/// vertices lie on the sphere; within one, the radius falls off quadratically from rim to middle.
/// The mesh does not follow the rims: they are as sharp as its edges are short. A vertex so close
/// to a rim that the ball's convex hull would pass through it stays on the sphere. So every dimple
/// is one concavity while edges are shorter than the land between dimples, and dimples much deeper
/// than the sphere rises above their rims.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GolfBall {
    /// Radius of the sphere, scene units. Default: 1.
    pub radius: f64,
    /// Number of dimples, 0 to 2,000. Default: 336.
    pub dimples: u32,
    /// What the middle of a dimple lies below the sphere; at most a quarter of the radius.
    /// Default: 0.03.
    pub dimple_depth: f64,
    /// Diameter of a dimple as a fraction of the least distance between the middles of two: 0.1 to
    /// 1. Default: 0.7.
    pub coverage: f64,
    /// About how many triangles: the nearest `20 n^2` is built. At least 20, and so many that every
    /// dimple holds a vertex. Default: 20,480.
    pub triangles: u32,
}

impl Default for GolfBall {
    fn default() -> Self {
        Self { radius: 1.0, dimples: 336, dimple_depth: 0.03, coverage: 0.7, triangles: 20_480 }
    }
}

impl GolfBall {
    /// The mesh, in the frame said above.
    ///
    /// # Errors
    ///
    /// [`ShapeError::Parameter`] outside the ranges above; [`ShapeError::TooCoarse`] where a dimple
    /// would hold no vertex; [`ShapeError::TooManyFaces`].
    pub fn build(&self) -> Result<Mesh, ShapeError> {
        let checked = Checked { shape: "GolfBall" };
        self.check(&checked)?;
        let sphere = Geodesic::new((f64::from(self.triangles) / 20.0).sqrt().round() as u32);
        let dimples = Dimples::new(self.dimples, self.coverage);
        let rim = 1.0 - dimples.margin(self.dimple_depth / self.radius, &sphere);
        let mut seen = vec![false; self.dimples as usize];
        let mut builder = MeshBuilder::default();
        for &d in &sphere.directions {
            let mut radius = self.radius;
            if let Some((dimple, share)) = dimples.at(d).filter(|&(_, share)| share < rim) {
                seen[dimple] = true;
                radius -= self.dimple_depth * (1.0 - share);
            }
            builder.vertex(radius * d);
        }
        if seen.contains(&false) {
            let enough = (TRIANGLES / dimples.reach_squared).ceil() as u64;
            return Err(ShapeError::TooCoarse {
                shape: checked.shape,
                triangles: self.triangles,
                detail: "dimple",
                enough,
            });
        }
        for [a, b, c] in sphere.faces {
            builder.triangle(a, b, c);
        }
        builder.finish(checked.shape)
    }

    fn check(&self, checked: &Checked) -> Result<(), ShapeError> {
        checked.length("radius", self.radius)?;
        checked.count("dimples", self.dimples, 0, 2_000)?;
        let most = 0.25 * self.radius;
        if self.dimples > 0 {
            let reason = "at most a quarter of the radius";
            checked.detail("dimple_depth", self.dimple_depth, self.radius, most, reason)?;
        }
        checked.within("coverage", self.coverage, [0.1, 1.0], "a fraction of the spacing")?;
        checked.count("triangles", self.triangles, 20, u32::MAX)?;
        checked.faces(self.triangles.into())
    }
}

/// So many triangles of a sphere, divided by the square of a dimple's reach, put a vertex into the
/// dimple: a triangle of area 4 pi / n reaches at most 1.3 times the radius of its circumcircle,
/// were it regular, and that circle must fit into the dimple: n = 1.7 * 16 pi / (3
/// sqrt 3) / reach^2.
const TRIANGLES: f64 = 16.5;

/// Middles of dimples, by descending z, and how far each reaches.
struct Dimples {
    middles: Vec<DVec3>,
    /// Square of the chord from middle to rim.
    reach_squared: f64,
}

impl Dimples {
    fn new(count: u32, coverage: f64) -> Self {
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let middle = |k: u32| {
            let z = 1.0 - f64::from(2 * k + 1) / f64::from(count);
            let angle = std::f64::consts::TAU * (f64::from(k) * golden).fract();
            ((1.0 - z * z).sqrt() * cranny_exact::DVec2::from_angle(angle)).extend(z)
        };
        let middles: Vec<_> = (0..count).map(middle).collect();
        // One dimple alone covers at most a hemisphere: its rim is a right angle away.
        let mut least = 8f64;
        for (k, p) in middles.iter().enumerate() {
            least = middles[..k].iter().map(|q| p.distance_squared(*q)).fold(least, f64::min);
        }
        Self { middles, reach_squared: least * (0.5 * coverage).powi(2) }
    }

    /// How near the rim vertices stay on the sphere, as a share of the dimple's area.
    ///
    /// The hull bridges a dimple from vertices that lie up to an edge `m` beyond its rim, which is
    /// `a` from the middle. At the rim it passes up to `((a + m)^2 - a^2) / 2` below the sphere of
    /// radius 1; a share `t` within the rim the dimple is `t` times its depth below it. But no
    /// dimple shrinks so far that it need not hold a vertex.
    fn margin(&self, depth: f64, sphere: &Geodesic) -> f64 {
        if self.middles.is_empty() {
            return 0.0;
        }
        let (reach, edge) = (self.reach_squared.sqrt(), sphere.longest_edge());
        let bridged = edge * (reach + 0.5 * edge);
        let spare = 1.0 - TRIANGLES / (sphere.faces.len() as f64 * self.reach_squared);
        (bridged / depth).min(spare).max(0.0)
    }

    /// The dimple that holds a direction, and the square of its place there: 0 in the middle, 1 at
    /// the rim.
    fn at(&self, d: DVec3) -> Option<(usize, f64)> {
        let reach = self.reach_squared.sqrt();
        let first = self.middles.partition_point(|m| m.z > d.z + reach);
        let near = self.middles[first..].iter().take_while(|m| m.z >= d.z - reach).enumerate();
        let nearest = near
            .map(|(k, m)| (first + k, m.distance_squared(d) / self.reach_squared))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (nearest.1 < 1.0).then_some(nearest)
    }
}

/// A sphere of `20 frequency^2` triangles: the faces of an icosahedron cut evenly and projected.
struct Geodesic {
    directions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    frequency: u32,
    /// Inner points of the icosahedron's edges, from the lower corner to the higher.
    edges: BTreeMap<[u32; 2], Vec<u32>>,
}

impl Geodesic {
    fn new(frequency: u32) -> Self {
        let (corners, faces) = icosahedron();
        let mut sphere =
            Self { directions: corners, faces: Vec::new(), frequency, edges: BTreeMap::new() };
        for face in faces {
            sphere.subdivide(face);
        }
        sphere
    }

    fn longest_edge(&self) -> f64 {
        let at = |i: u32| self.directions[i as usize];
        let sides = self.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        sides.map(|[a, b]| at(a).distance_squared(at(b))).fold(0.0, f64::max).sqrt()
    }

    fn subdivide(&mut self, [a, b, c]: [u32; 3]) {
        let n = self.frequency;
        let (left, right) = (self.edge(a, b), self.edge(a, c));
        let base = self.edge(b, c);
        let mut above = vec![a];
        for row in 1..=n {
            let ends = [left[row as usize], right[row as usize]];
            let points = if row == n { base.clone() } else { self.row(ends, [a, b, c], row) };
            for k in 0..row as usize {
                self.faces.push([above[k], points[k], points[k + 1]]);
                if k + 1 < row as usize {
                    self.faces.push([above[k], points[k + 1], above[k + 1]]);
                }
            }
            above = points;
        }
    }

    /// A row of points parallel to `bc`, `row` steps from `a`.
    fn row(&mut self, [first, last]: [u32; 2], [a, b, c]: [u32; 3], row: u32) -> Vec<u32> {
        let [a, b, c] = [a, b, c].map(|i| self.directions[i as usize]);
        let inner = (1..row).map(|k| {
            let weights = [self.frequency - row, row - k, k].map(f64::from);
            (weights[0] * a + weights[1] * b + weights[2] * c).normalize()
        });
        let inner: Vec<_> = inner.collect();
        let start = self.directions.len() as u32;
        self.directions.extend(inner);
        std::iter::once(first)
            .chain(start..self.directions.len() as u32)
            .chain(std::iter::once(last))
            .collect()
    }

    /// All points of an icosahedron edge, both ends included.
    fn edge(&mut self, from: u32, to: u32) -> Vec<u32> {
        let key = [from.min(to), from.max(to)];
        if !self.edges.contains_key(&key) {
            let [low, high] = key.map(|i| self.directions[i as usize]);
            let start = self.directions.len() as u32;
            for k in 1..self.frequency {
                let [s, t] = [self.frequency - k, k].map(f64::from);
                self.directions.push((s * low + t * high).normalize());
            }
            self.edges.insert(key, (start..self.directions.len() as u32).collect());
        }
        let inner = self.edges[&key].iter().copied();
        if from < to {
            std::iter::once(from).chain(inner).chain(std::iter::once(to)).collect()
        } else {
            std::iter::once(from).chain(inner.rev()).chain(std::iter::once(to)).collect()
        }
    }
}

/// Unit corners (poles on z) and outward faces.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (z, r) = (1.0 / 5f64.sqrt(), 2.0 / 5f64.sqrt());
    let mut corners = vec![DVec3::Z];
    corners.extend((0..5).map(|k| (r * direction(2 * k, 10)).extend(z)));
    corners.extend((0..5).map(|k| (r * direction(2 * k + 1, 10)).extend(-z)));
    corners.push(-DVec3::Z);
    let mut faces = Vec::new();
    for k in 0..5 {
        let next = (k + 1) % 5;
        let [north, north_next, south, south_next] = [1 + k, 1 + next, 6 + k, 6 + next];
        faces.push([0, north, north_next]);
        faces.push([north, south, north_next]);
        faces.push([north_next, south, south_next]);
        faces.push([11, south_next, south]);
    }
    debug_assert!(faces.iter().all(|f| {
        let [a, b, c] = f.map(|i: u32| corners[i as usize]);
        orient3d(a, b, c, DVec3::ZERO) == Sign::Negative
    }));
    (corners, faces)
}
