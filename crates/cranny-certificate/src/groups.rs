//! Groups of faces: all of a body, its halves, their halves, down to single faces. They are part of
//! the format: a certificate names a group by the way to it, and never lists faces.

use std::ops::Range;

use crate::body::Triangles;

/// The faces of a body in an order in which each group is a run.
///
/// A group of `n` faces has two halves, the first with `n / 2` of them. The faces are divided along
/// the axis in which the sums of their corners' coordinates reach farthest, in order of these sums,
/// ties by number. Coordinates are those that were filed, so groups do not depend on poses.
#[derive(Clone, Debug)]
pub struct Groups {
    order: Vec<u32>,
}

impl Groups {
    /// The groups of a body.
    #[must_use]
    pub fn of(body: &Triangles) -> Self {
        let sum = |face: &[u32; 3]| -> [f64; 3] {
            let [a, b, c] = face.map(|v| body.vertices[v as usize]);
            // Zeros of both signs are one number.
            std::array::from_fn(|axis| (a[axis] + b[axis]) + c[axis] + 0.0)
        };
        let sums: Vec<[f64; 3]> = body.faces.iter().map(sum).collect();
        let mut order: Vec<u32> = (0..sums.len() as u32).collect();
        let all: Range<usize> = 0..order.len();
        let mut open = Vec::from([all]);
        while let Some(run) = open.pop() {
            if run.len() < 2 {
                continue;
            }
            let faces = &mut order[run.clone()];
            let axis = longest(faces.iter().map(|&f| &sums[f as usize]));
            let half = faces.len() / 2;
            faces.select_nth_unstable_by(half, |&f, &g| {
                let (x, y) = (sums[f as usize][axis], sums[g as usize][axis]);
                x.total_cmp(&y).then(f.cmp(&g))
            });
            open.extend(halves(&run));
        }
        Self { order }
    }

    /// The group of all faces.
    #[must_use]
    pub fn all(&self) -> Range<usize> {
        0..self.order.len()
    }

    /// The faces of a group.
    ///
    /// # Panics
    ///
    /// Where it is no run of the order.
    #[must_use]
    pub fn faces(&self, group: &Range<usize>) -> &[u32] {
        &self.order[group.clone()]
    }
}

/// The two halves of a group of at least two faces.
#[must_use]
pub fn halves(group: &Range<usize>) -> [Range<usize>; 2] {
    let middle = group.start + group.len() / 2;
    [group.start..middle, middle..group.end]
}

fn longest<'a>(points: impl Iterator<Item = &'a [f64; 3]>) -> usize {
    let none = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let (low, high) = points.fold(none, |(low, high), p| {
        (std::array::from_fn(|i| low[i].min(p[i])), std::array::from_fn(|i| high[i].max(p[i])))
    });
    let extent: [f64; 3] = std::array::from_fn(|i| high[i] - low[i]);
    (1..3).fold(0, |best, axis| if extent[axis] > extent[best] { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_halved_along_the_longest_axis_and_hold_each_face_once() {
        let vertices = (0..7).map(|i| [0.0, f64::from(i * i), 0.5 * f64::from(i % 2)]).collect();
        let faces = [4, 0, 3, 1, 2].map(|i| [i, i + 1, i + 2]).to_vec();
        let groups = Groups::of(&Triangles { vertices, faces });
        let [low, high] = halves(&groups.all());
        let mut first: Vec<u32> = groups.faces(&low).to_vec();
        first.sort_unstable();
        assert_eq!(first, [1, 3]);
        let mut all: Vec<u32> =
            groups.faces(&low).iter().chain(groups.faces(&high)).copied().collect();
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3, 4]);
    }
}
