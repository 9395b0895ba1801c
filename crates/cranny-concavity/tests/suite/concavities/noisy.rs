//! Boxes whose sides are rough by a few flatnesses: pockets, slivers and facets about as thin as
//! rounding.

use std::collections::BTreeMap;

use cranny_exact::{DMat3, DVec3};
use cranny_geometry::Mesh;
use cranny_testkit::Rng;

use super::ways::{moved, rounded_to_decimals, rounded_to_single};

#[derive(Clone, Copy, Debug)]
pub(crate) enum Written {
    Double,
    Single,
    Decimals(usize),
}

impl Written {
    pub(crate) const ALL: [Self; 3] = [Self::Double, Self::Single, Self::Decimals(5)];

    /// About the flatness of a unit cube so written.
    fn flatness(self) -> f64 {
        match self {
            Self::Double => 1.6e-14,
            Self::Single => 2e-7,
            Self::Decimals(decimals) => 2.0 * 10f64.powi(-(decimals as i32)),
        }
    }

    fn apply(self, mesh: &Mesh) -> Mesh {
        match self {
            Self::Double => mesh.clone(),
            Self::Single => rounded_to_single(mesh),
            Self::Decimals(decimals) => rounded_to_decimals(mesh, decimals),
        }
    }
}

/// A unit cube of `cells` squares along each edge, each cut by either diagonal; points of the
/// surface lie off its sides by up to `rough` flatnesses, beneath them as well as above.
pub(crate) fn noisy_cube(
    cells: i32,
    rough: f64,
    written: Written,
    is_turned: bool,
    rng: &mut Rng,
) -> Mesh {
    let depth = rough * written.flatness();
    let mut ids = BTreeMap::new();
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [0, cells] {
            for i in 0..cells {
                for j in 0..cells {
                    let mut corner = |du: i32, dv: i32, rng: &mut Rng| {
                        let mut p = [side; 3];
                        p[(axis + 1) % 3] = i + du;
                        p[(axis + 2) % 3] = j + dv;
                        *ids.entry(p).or_insert_with(|| {
                            let beneath = |c: i32| match c {
                                0 => depth * rng.unit(),
                                c if c == cells => 1.0 - depth * rng.unit(),
                                c => f64::from(c) / f64::from(cells),
                            };
                            vertices.push(DVec3::from_array(p.map(beneath)));
                            vertices.len() as u32 - 1
                        })
                    };
                    let mut quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| corner(u, v, rng));
                    if side == 0 {
                        quad.reverse();
                    }
                    let [a, b, c, d] = quad;
                    faces.extend(match rng.below(2) {
                        0 => [[a, b, c], [a, c, d]],
                        _ => [[a, b, d], [b, c, d]],
                    });
                }
            }
        }
    }
    let mesh = Mesh::new(vertices, faces).unwrap();
    if !is_turned {
        return written.apply(&mesh);
    }
    let turn = DMat3::from_quat(rng.rotation());
    written.apply(&moved(&mesh, |p| turn * p))
}
