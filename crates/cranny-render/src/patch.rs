//! Areas that loops bound: regions of contact, as they are seen.

use cranny_exact::DVec3;

use crate::color::Color;

/// An area bounded by closed loops in space: what an odd number of them surrounds, seen from the
/// camera. Loops need not be plane or convex, and may hold holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Each closes from its last point to its first.
    pub loops: Vec<Vec<DVec3>>,
    /// Colour; its alpha blends.
    pub color: Color,
    /// Whether the patch shows through whatever hides it.
    pub on_top: bool,
}

impl Patch {
    /// The triangles that cover each point of the area an odd number of times, all others an even
    /// number: a fan about the first point of all, since the winding of fans adds up.
    pub(crate) fn fan(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let hub = self.loops.iter().flatten().next().copied().unwrap_or_default();
        self.loops.iter().filter(|l| l.len() > 2).flat_map(move |points| {
            let next = points.iter().cycle().skip(1);
            points.iter().zip(next).map(move |(&a, &b)| [hub, a, b])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(half: f64) -> Vec<DVec3> {
        let corner = |x: f64, y: f64| DVec3::new(x * half, y * half, 0.0);
        vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]
    }

    /// How often triangles cover a place.
    fn covers(patch: &Patch, p: DVec3) -> usize {
        let side = |a: DVec3, b: DVec3| (b - a).cross(p - a).z > 0.0;
        let inside = |[a, b, c]: &[DVec3; 3]| {
            let sides = [side(*a, *b), side(*b, *c), side(*c, *a)];
            sides == [true; 3] || sides == [false; 3]
        };
        patch.fan().filter(inside).count()
    }

    #[test]
    fn a_ring_is_covered_between_its_loops_only() {
        let loops = vec![square(2.0), square(1.0)];
        let patch = Patch { loops, color: Color::BLACK, on_top: true };
        let at = |x: f64, y: f64| covers(&patch, DVec3::new(x, y, 0.0)) % 2;
        assert_eq!((at(1.5, 0.3), at(-1.45, -0.2), at(0.1, -1.7)), (1, 1, 1));
        assert_eq!((at(0.1, 0.2), at(-0.3, 0.7), at(2.5, 0.1)), (0, 0, 0));
    }

    #[test]
    fn loops_of_less_than_three_points_bound_nothing() {
        let loops = vec![vec![DVec3::X, DVec3::Y], Vec::new()];
        assert_eq!(Patch { loops, color: Color::BLACK, on_top: false }.fan().count(), 0);
    }
}
