//! Volume, centre and inertia of the solid that a closed mesh bounds.
//!
//! Signed tetrahedra from a reference point to every face (Mirtich, 'Fast and accurate computation
//! of polyhedral mass properties', 1996, uses the same divergence argument). The reference is the
//! centre of the bounding box, so that a body far from its origin loses no digits.
//!
//! Cost: O(n); after deformations with the functions.

use cranny_exact::{DMat3, DVec3};

use crate::chunks::{CHUNK, touched};
use crate::ids::FaceId;
use crate::mesh::Mesh;

/// Roundings of a tetrahedron's volume, each by at most half an ulp of the sum of its products'
/// magnitudes: three differences, two products and two sums a term, and the division. Fewer, and
/// sheets back to back may have a volume, of either sign; more, and thin solids whose faces lie
/// slanted have none.
const ROUNDINGS: f64 = 16.0;

/// Of a solid of density 1, in the body's frame. What holds no more than rounding could have left
/// of nothing has volume and inertia 0, and its centre is that of its box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Volume, negative where the mesh is inside out, which that of a [`Model`](crate::Model) is
    /// not. Unit: length^3.
    pub volume: f64,
    /// Centre of mass.
    pub center: DVec3,
    /// Inertia tensor about the centre of mass. Unit: length^5.
    pub inertia: DMat3,
}

impl MassProperties {
    /// Integrates over a closed, oriented mesh. For others the result means nothing. O(n).
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let reference = mesh.bounds().center();
        let faces = mesh.faces();
        Sums::over(mesh, reference, faces).properties(reference, faces.len())
    }
}

/// Of a surface of density 1 per area, in the body's frame: a shell that is thin for its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceProperties {
    /// Area. Unit: length^2.
    pub area: f64,
    /// Centre of mass; that of the box where there is no area.
    pub center: DVec3,
    /// Inertia tensor about the centre of mass. Unit: length^4.
    pub inertia: DMat3,
}

impl SurfaceProperties {
    /// Integrates over a mesh, open or closed; what lies twice in one place counts twice. O(n).
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let reference = mesh.bounds().center();
        let (mut area, mut first, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for corners in mesh.faces() {
            let [a, b, c] = corners.map(|i| mesh.vertices()[i as usize] - reference);
            let of_face = 0.5 * (b - a).cross(c - a).length();
            let sum = a + b + c;
            area += of_face;
            first += sum * (of_face / 3.0);
            // Integral of x xᵀ over the triangle.
            second += (outer(a) + outer(b) + outer(c) + outer(sum)) * (of_face / 12.0);
        }
        if area == 0.0 {
            return Self { area, center: reference, inertia: DMat3::ZERO };
        }
        let offset = first / area;
        let inertia = about_center(second - outer(offset) * area);
        Self { area, center: reference + offset, inertia }
    }
}

/// What is added up over faces: integrals over the tetrahedra that these make with a reference
/// point.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    volume: f64,
    first: DVec3,
    /// Of all products that are added up, regardless of sign: sums round in proportion to it.
    magnitude: f64,
    /// xx, yy, zz.
    squares: DVec3,
    /// xy, yz, zx.
    mixed: DVec3,
}

impl Sums {
    /// Over some faces of a mesh.
    fn over(mesh: &Mesh, reference: DVec3, faces: &[[u32; 3]]) -> Self {
        let mut sums = Self::default();
        for corners in faces {
            let [a, b, c] = corners.map(|i| mesh.vertices()[i as usize] - reference);
            let six_volume = a.dot(b.cross(c));
            let sum = a + b + c;
            sums.volume += six_volume / 6.0;
            let [p, q, r] = [a.abs(), b.abs(), c.abs()];
            let products =
                DVec3::new(q.y * r.z + q.z * r.y, q.z * r.x + q.x * r.z, q.x * r.y + q.y * r.x);
            sums.magnitude += p.dot(products);
            sums.first += six_volume / 24.0 * sum;
            // Integral of x xᵀ over the tetrahedron (0, a, b, c).
            let share = six_volume / 120.0;
            sums.squares += (a * a + b * b + c * c + sum * sum) * share;
            let turned = |v: DVec3| DVec3::new(v.y, v.z, v.x);
            let products = a * turned(a) + b * turned(b) + c * turned(c) + sum * turned(sum);
            sums.mixed += products * share;
        }
        sums
    }

    fn add(self, other: &Self) -> Self {
        Self {
            volume: self.volume + other.volume,
            first: self.first + other.first,
            magnitude: self.magnitude + other.magnitude,
            squares: self.squares + other.squares,
            mixed: self.mixed + other.mixed,
        }
    }

    /// What the sums over so many faces, all of a mesh, come to.
    fn properties(&self, reference: DVec3, faces: usize) -> MassProperties {
        let &Self { volume, first, magnitude, squares, mixed } = self;
        let roundings = ROUNDINGS + faces as f64;
        if volume.abs() <= 0.5 * f64::EPSILON * roundings * magnitude / 6.0 {
            return MassProperties { volume: 0.0, center: reference, inertia: DMat3::ZERO };
        }
        let second = DMat3::from_cols(
            DVec3::new(squares.x, mixed.x, mixed.z),
            DVec3::new(mixed.x, squares.y, mixed.y),
            DVec3::new(mixed.z, mixed.y, squares.z),
        );
        let offset = first / volume;
        let inertia = about_center(second - outer(offset) * volume);
        MassProperties { volume, center: reference + offset, inertia }
    }
}

/// The sums of a mesh, chunk by chunk of its faces: nothing is ever taken away from a sum, so that
/// errors do not gather.
#[derive(Clone, Debug)]
pub(crate) struct MassSums {
    reference: DVec3,
    of_chunks: Vec<Sums>,
}

impl MassSums {
    /// Of a mesh, about the centre of its box.
    pub(crate) fn of(mesh: &Mesh, reference: DVec3) -> Self {
        let of_chunk = |faces: &[[u32; 3]]| Sums::over(mesh, reference, faces);
        Self { reference, of_chunks: mesh.faces().chunks(CHUNK).map(of_chunk).collect() }
    }

    /// Follows faces that have moved, which ascend; `reference` is where the centre of the box is
    /// now. Returns how many faces were added up.
    pub(crate) fn update(&mut self, mesh: &Mesh, reference: DVec3, moved: &[FaceId]) -> usize {
        if reference != self.reference {
            *self = Self::of(mesh, reference);
            return mesh.faces().len();
        }
        let mut looked_at = 0;
        for (chunk, range) in touched(moved.iter().map(|f| f.index()), mesh.faces().len()) {
            let faces = &mesh.faces()[range];
            self.of_chunks[chunk] = Sums::over(mesh, reference, faces);
            looked_at += faces.len();
        }
        looked_at
    }

    /// What they come to.
    pub(crate) fn properties(&self, mesh: &Mesh) -> MassProperties {
        let all = self.of_chunks.iter().fold(Sums::default(), Sums::add);
        all.properties(self.reference, mesh.faces().len())
    }
}

/// The inertia tensor of the integral of x xᵀ about the centre of mass.
fn about_center(central: DMat3) -> DMat3 {
    let trace = central.x_axis.x + central.y_axis.y + central.z_axis.z;
    DMat3::from_diagonal(DVec3::splat(trace)) - central
}

fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::VertexId;

    fn brick(size: DVec3, turn: DMat3) -> Mesh {
        let corner = |i: u32| DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64);
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Mesh::new((0..8).map(|i| turn * (size * corner(i))).collect(), faces).unwrap()
    }

    #[test]
    fn what_rounding_leaves_of_nothing_is_nothing_and_thin_things_have_their_volume() {
        let (s, c) = (0.6, 0.8);
        let about_z = DMat3::from_cols(DVec3::new(c, s, 0.0), DVec3::new(-s, c, 0.0), DVec3::Z);
        let about_x = DMat3::from_cols(DVec3::X, DVec3::new(0.0, c, s), DVec3::new(0.0, -s, c));
        for turn in [DMat3::IDENTITY, about_z, about_z * about_x] {
            for thin in [1e-13, 1e-8, 1e-3] {
                let mass = MassProperties::of(&brick(DVec3::new(1.0, 2.0, thin), turn));
                assert!((mass.volume - 2.0 * thin).abs() <= 0.02 * thin, "{thin}: {mass:?}");
            }
            let flat = brick(DVec3::new(1.0, 2.0, 0.0), turn);
            for mesh in [flat.clone().turned_inside_out(), flat] {
                let mass = MassProperties::of(&mesh);
                assert_eq!((mass.volume, mass.inertia), (0.0, DMat3::ZERO), "{mass:?}");
                assert_eq!(mass.center, mesh.bounds().center());
            }
        }
        let wire = MassProperties::of(&brick(DVec3::new(1.0, 1e-8, 1e-8), DMat3::IDENTITY));
        assert!((wire.volume / 1e-16 - 1.0).abs() < 1e-9, "{wire:?}");
    }

    #[test]
    fn a_cuboid_far_from_the_origin() {
        let far = DVec3::new(1e4, -3e4, 2e4);
        let brick = brick(DVec3::new(1.0, 2.0, 3.0), DMat3::IDENTITY);
        let vertices = brick.vertices().iter().map(|&p| far + p).collect();
        let mesh = Mesh::new(vertices, brick.faces().to_vec()).unwrap();
        let mass = MassProperties::of(&mesh);
        assert!((mass.volume - 6.0).abs() < 1e-10);
        assert!((mass.center - far - DVec3::new(0.5, 1.0, 1.5)).length() < 1e-9);
        // m / 12 (b² + c²) and so on, for edges 1, 2, 3 and mass 6.
        let expected = DMat3::from_diagonal(DVec3::new(6.5, 5.0, 2.5));
        let error = (mass.inertia - expected).to_cols_array().map(f64::abs);
        assert!(error.into_iter().all(|e| e < 1e-9), "{error:?}");
        let inside_out = MassProperties::of(&mesh.turned_inside_out());
        assert!((inside_out.volume + 6.0).abs() < 1e-10);
    }

    #[test]
    fn a_shell_weighs_by_its_area() {
        let (size, far) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(70.0, -30.0, 20.0));
        let moved = brick(size, DMat3::IDENTITY).vertices().iter().map(|&p| far + p).collect();
        let mesh = Mesh::new(moved, brick(size, DMat3::IDENTITY).faces().to_vec()).unwrap();
        let shell = SurfaceProperties::of(&mesh);
        assert!((shell.area - 22.0).abs() < 1e-10);
        assert!((shell.center - far - 0.5 * size).length() < 1e-10);
        // Of x²: two sides of area 6 at distance 1/2, and four of lengths 1: 16 of area / 12.
        let [xx, yy, zz] =
            [12.0 * 0.25 + 10.0 / 12.0, 6.0 + 16.0 * 4.0 / 12.0, 4.0 * 2.25 + 18.0 * 9.0 / 12.0];
        let expected = DMat3::from_diagonal(DVec3::new(yy + zz, zz + xx, xx + yy));
        let error = (shell.inertia - expected).to_cols_array().map(f64::abs);
        assert!(error.into_iter().all(|e| e < 1e-9), "{error:?}");
        // A single triangle is a shell too, and one without area has a place.
        let sheet = Mesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let sheet = SurfaceProperties::of(&sheet);
        assert_eq!(sheet.area, 0.5);
        assert!((sheet.center - DVec3::new(1.0, 1.0, 0.0) / 3.0).length() < 1e-15, "{sheet:?}");
        assert!((sheet.inertia.x_axis.x - 1.0 / 36.0).abs() < 1e-15, "{sheet:?}");
        let line = Mesh::new(vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], vec![[0, 1, 2]]).unwrap();
        assert_eq!(SurfaceProperties::of(&line).inertia, DMat3::ZERO);
    }

    #[test]
    fn chunks_follow_faces_that_move() {
        // Many bricks, so that there are several chunks.
        let size = DVec3::new(1.0, 2.0, 3.0);
        let moved_by =
            |by: DVec3| brick(size, DMat3::IDENTITY).vertices().iter().map(|&p| p + by).collect();
        let one = |i: u32| {
            let by = f64::from(i) * 4.0 * DVec3::X;
            Mesh::new(moved_by(by), brick(size, DMat3::IDENTITY).faces().to_vec()).unwrap()
        };
        let mut mesh = (1..40).map(one).fold(one(0), |all, next| all.joined(&next));
        let close = |a: MassProperties, b: MassProperties| {
            let inertia = (a.inertia - b.inertia).to_cols_array().map(f64::abs);
            (a.volume - b.volume).abs() <= 1e-12 * b.volume
                && (a.center - b.center).length() <= 1e-12 * 160.0
                && inertia
                    .into_iter()
                    .all(|e| e <= 1e-12 * b.inertia.x_axis.length().max(b.inertia.y_axis.length()))
        };
        let mut sums = MassSums::of(&mesh, mesh.bounds().center());
        assert!(close(sums.properties(&mesh), MassProperties::of(&mesh)));
        // A corner of the last but one goes up; one of the first goes out of the box.
        for (vertex, by, few) in
            [(38 * 8 + 7, 0.5 * DVec3::NEG_Z, true), (0, -8.0 * DVec3::X, false)]
        {
            mesh.set_position(VertexId(vertex), mesh.position(VertexId(vertex)) + by);
            let of_vertex = |f: &u32| mesh.faces()[*f as usize].contains(&vertex);
            let faces: Vec<FaceId> = (0..480).filter(of_vertex).map(FaceId).collect();
            let looked_at = sums.update(&mesh, mesh.bounds().center(), &faces);
            assert_eq!(looked_at <= 2 * CHUNK, few);
            assert!(close(sums.properties(&mesh), MassProperties::of(&mesh)), "vertex {vertex}");
        }
    }
}
