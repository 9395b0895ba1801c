//! Solids and placements whose coordinates are small multiples of powers of two: every pose is
//! exact, in the product as in the oracle, so that bodies can be made to touch exactly.

use cranny_exact::{DMat3, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_shapes::{Comb, Cuboid, LPrism, UPrism};
use cranny_testkit::Rng;

/// Coordinates of shapes are multiples of this.
const GRID: f64 = 1.0 / 64.0;

/// A rotation of the axes onto the axes, then a translation by multiples of [`GRID`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    rotation: DMat3,
    translation: DVec3,
}

impl Placement {
    pub(crate) const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// A rotation about the origin.
    pub(crate) fn turned(rotation: DMat3) -> Self {
        Self { rotation, ..Self::IDENTITY }
    }

    /// A random one.
    pub(crate) fn random(rng: &mut Rng) -> Self {
        let turns = axis_rotations();
        let mut coordinate = || f64::from(rng.between(-512, 512)) * GRID;
        let translation = DVec3::new(coordinate(), coordinate(), coordinate());
        Self { rotation: turns[rng.below(turns.len())], translation }
    }

    /// Turned the same way, and moved so that `p` of the body comes to lie on `target`.
    pub(crate) fn bringing(self, p: DVec3, target: DVec3) -> Self {
        Self { rotation: self.rotation, translation: target - self.rotation * p }
    }

    pub(crate) fn apply(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// First `inner`, then `self`.
    pub(crate) fn after(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.apply(inner.translation),
        }
    }

    /// Moved on by a vector.
    pub(crate) fn moved(self, by: DVec3) -> Self {
        Self { translation: self.translation + by, ..self }
    }

    /// As a pose file has it.
    pub(crate) fn row_major(&self) -> [f64; 16] {
        let (r, t) = (self.rotation.transpose(), self.translation);
        let mut rows = [0.0; 16];
        for (i, (axis, shift)) in
            [r.x_axis, r.y_axis, r.z_axis].iter().zip(t.to_array()).enumerate()
        {
            rows[4 * i..4 * i + 4].copy_from_slice(&[axis.x, axis.y, axis.z, shift]);
        }
        rows[15] = 1.0;
        rows
    }

    /// The same motion, to the bit.
    pub(crate) fn pose(&self) -> Pose {
        let pose = Pose::from_row_major(&self.row_major()).unwrap();
        let map = pose.world_from_body();
        assert_eq!((map.linear, map.translation), (self.rotation, self.translation));
        pose
    }
}

/// The 24 rotations that take axes to axes.
pub(crate) fn axis_rotations() -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut turns = Vec::new();
    for x in 0..3 {
        for y in (0..3).filter(|&y| y != x) {
            for signs in 0..4 {
                let sign = |bit: i32| if signs & bit == 0 { 1.0 } else { -1.0 };
                let (first, second) = (sign(1) * axes[x], sign(2) * axes[y]);
                turns.push(DMat3::from_cols(first, second, first.cross(second)));
            }
        }
    }
    turns
}

/// A solid under a name.
pub(crate) type Solid = (&'static str, Mesh);

/// Convex and non-convex solids, a hollow one among them, all on the grid.
pub(crate) fn solids() -> Vec<Solid> {
    let cuboid = |x: f64, y: f64, z: f64| Cuboid { size: [x, y, z] }.build().unwrap();
    let comb =
        Comb { teeth: 3, tooth_width: 0.25, gap: 0.25, tooth_length: 0.5, bar: 0.25, depth: 0.25 };
    let l = LPrism { width: 1.0, height: 1.0, thickness: 0.25, depth: 0.5 };
    let u = UPrism { width: 1.0, height: 1.0, thickness: 0.25, depth: 0.5 };
    let hollow = cuboid(2.0, 2.0, 2.0).joined(&inside_out(&cuboid(1.0, 1.0, 1.0)));
    vec![
        ("cube", cuboid(1.0, 1.0, 1.0)),
        ("slab", cuboid(1.0, 0.5, 0.25)),
        ("corner", tetrahedron([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])),
        ("tetrahedron", tetrahedron([[1, 1, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]])),
        ("l", on_grid(&l.build().unwrap())),
        ("u", on_grid(&u.build().unwrap())),
        ("comb", on_grid(&comb.build().unwrap())),
        ("hollow", hollow),
    ]
}

/// The same mesh at a quarter of its size.
pub(crate) fn quartered(mesh: &Mesh) -> Mesh {
    mesh.scaled(DVec3::splat(0.25)).unwrap()
}

/// A tetrahedron, outward whatever the order of its corners.
fn tetrahedron(corners: [[i32; 3]; 4]) -> Mesh {
    let p = corners.map(|c| DVec3::from_array(c.map(f64::from)));
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mesh = Mesh::new(p.to_vec(), faces.to_vec()).unwrap();
    let positive = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) > 0.0;
    if positive { mesh } else { inside_out(&mesh) }
}

fn inside_out(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|&[a, b, c]| [a, c, b]).collect();
    Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
}

/// Moved so that one vertex is the origin, and freed of the rounding of its centroid.
fn on_grid(mesh: &Mesh) -> Mesh {
    let origin = mesh.vertices()[0];
    let snapped = |&p: &DVec3| {
        let q = GRID * ((p - origin) / GRID).round();
        assert!((q - (p - origin)).length() < 1e-12, "{p} is not on the grid");
        q
    };
    Mesh::new(mesh.vertices().iter().map(snapped).collect(), mesh.faces().to_vec()).unwrap()
}
