//! Two bodies in one frame, and which groups of their faces a direction parts.

use std::ops::Range;

use dashu_int::IBig;

use crate::body::{Body, Motion, Triangles};
use crate::certificate::{Certificate, Frame};
use crate::direction::Parts;
use crate::exact::{Grid, Vector, dot, is_zero, normal};

/// How a direction parts two groups of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Parting {
    /// It does not.
    None,
    /// They reach the same height at most: they may touch, and cannot cross.
    Touching,
    /// There is a gap between them.
    Apart,
}

/// Two bodies in the frame of one of them, the vertices of the other posed and rounded. Numbers of
/// faces, and groups, are those of the files.
#[derive(Clone, Debug)]
pub struct PosedPair {
    pub(crate) a: Body,
    pub(crate) b: Body,
}

impl PosedPair {
    /// Poses the bodies as a certificate says. `bodies` are A and B as filed, scaled.
    ///
    /// # Errors
    ///
    /// Where the map is no rigid motion or a coordinate leaves the finite numbers.
    pub fn of(certificate: &Certificate, bodies: [&Triangles; 2]) -> Result<Self, String> {
        let motion = Motion::of(&certificate.map);
        let placed = match certificate.frame {
            Frame::A => [bodies[0].clone(), bodies[1].moved(&motion)],
            Frame::B => [bodies[0].moved(&motion), bodies[1].clone()],
        };
        if !placed.iter().all(Triangles::are_finite) {
            return Err("a posed coordinate is not finite".to_owned());
        }
        let grid = Grid::of(placed.iter().flat_map(Triangles::numbers));
        let [a, b] = [0, 1].map(|i| Body::new(bodies[i], &placed[i], grid));
        Ok(Self { a, b })
    }

    /// The two bodies.
    #[must_use]
    pub fn bodies(&self) -> [&Body; 2] {
        [&self.a, &self.b]
    }

    /// How a direction parts two groups; each is a run of [`Body::groups`].
    #[must_use]
    pub fn parting(&self, groups: &[Range<usize>; 2], direction: [f64; 3]) -> Parting {
        let finite = direction.iter().all(|x| x.is_finite());
        let direction = if finite { direction } else { [0.0; 3] };
        self.parted(groups, &Grid::of(direction.into_iter()).vector(direction))
    }

    /// How the direction between parts of two faces parts two groups.
    #[must_use]
    pub fn parting_by(&self, groups: &[Range<usize>; 2], faces: [u32; 2], parts: Parts) -> Parting {
        let (f, g) = (self.a.triangle(faces[0]), self.b.triangle(faces[1]));
        self.parted(groups, &parts.direction(&f, &g))
    }

    /// Whether one of two faces has no area: such a face crosses nothing.
    #[must_use]
    pub fn has_needle(&self, faces: [u32; 2]) -> bool {
        is_zero(&normal(&self.a.triangle(faces[0]))) || is_zero(&normal(&self.b.triangle(faces[1])))
    }

    /// How the direction between parts of two faces parts these.
    #[must_use]
    pub fn parting_of_faces(&self, [f, g]: [u32; 2], parts: Parts) -> Parting {
        let (f, g) = (self.a.triangle(f), self.b.triangle(g));
        let direction = parts.direction(&f, &g);
        compared(&direction, extent(f.iter(), &direction), extent(g.iter(), &direction))
    }

    fn parted(&self, [a, b]: &[Range<usize>; 2], direction: &Vector) -> Parting {
        let (a, b) = (self.a.extent(a, direction), self.b.extent(b, direction));
        compared(direction, a, b)
    }
}

/// What the heights of two groups along a direction say.
fn compared(direction: &Vector, a: Option<[IBig; 2]>, b: Option<[IBig; 2]>) -> Parting {
    match (a, b) {
        _ if is_zero(direction) => Parting::None,
        (Some(a), Some(b)) if a[1] < b[0] || b[1] < a[0] => Parting::Apart,
        (Some(a), Some(b)) if a[1] <= b[0] || b[1] <= a[0] => Parting::Touching,
        _ => Parting::None,
    }
}

/// The least and the greatest height of some points along a direction.
fn extent<'a>(points: impl Iterator<Item = &'a Vector>, direction: &Vector) -> Option<[IBig; 2]> {
    let mut heights = points.map(|p| dot(direction, p));
    let first = heights.next()?;
    Some(heights.fold([first.clone(), first], |[low, high], height| {
        if height < low {
            [height, high]
        } else if height > high {
            [low, height]
        } else {
            [low, high]
        }
    }))
}

impl Body {
    /// The groups of its faces.
    #[must_use]
    pub fn groups(&self) -> &crate::groups::Groups {
        &self.groups
    }

    /// The least and the greatest height of a group along a direction.
    fn extent(&self, group: &Range<usize>, direction: &Vector) -> Option<[IBig; 2]> {
        let faces = self.groups.faces(group).iter();
        let mut corners: Vec<u32> = faces.flat_map(|&f| self.faces[f as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        extent(corners.iter().map(|&v| &self.vertices[v as usize]), direction)
    }
}
