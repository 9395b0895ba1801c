//! The ISO 68-1 metric thread as a surface over (angle, z).
//!
//! The basic profile: flanks at 30 degrees to the radius, a fundamental triangle of height
//! `H = sqrt(3) / 2 pitch`, of which `5/8 H` is used: flats of `pitch / 8` at the major diameter
//! and `pitch / 4` at the minor one.
//!
//! # Phase
//!
//! The helix is right-handed about +z. A crest of the bolt (the widest radius) is centred where
//! `z = pitch (angle / 2 pi + k)`, k whole, angle counted from +x; the nut's grooves likewise, in
//! its own frame. So a nut fits its bolt when, in the bolt's frame, it stands at height `z` turned
//! about z by `2 pi z / pitch`: at a multiple of the pitch unturned, and anywhere along the screw
//! motion from there.
//!
//! # How the surface stays closed and simple
//!
//! The radius is a single-valued function of angle and z. Each of `segments` columns (half planes
//! through the axis) holds the exact polyline of that function over z, cut at both ends and bounded
//! by the chamfers. Two neighbouring columns are joined by a strip that climbs both: it joins
//! points of equal height *along the helix* where there are such, so crests and roots stay sharp
//! helices.

use cranny_exact::{DVec2, DVec3};

use crate::{
    builder::{MeshBuilder, direction},
    error::{Checked, MAX_LENGTH, MIN_LENGTH, ShapeError},
};

/// Points of a column nearer to each other than this fraction of the pitch are one point. Smaller,
/// and needles appear that are narrower than coordinates resolve at a great height; larger, and the
/// profile's corners move visibly.
const MERGE: f64 = 1e-6;

/// A threaded surface between two planes `z = const`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thread {
    pub(crate) pitch: f64,
    /// Greatest radius.
    pub(crate) crest: f64,
    /// Columns a turn.
    pub(crate) segments: u32,
    /// Chords of each flank, along the profile.
    pub(crate) flank_segments: u32,
    /// Least and greatest z.
    pub(crate) ends: [f64; 2],
}

/// A cone at 45 degrees that bounds the thread near one end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chamfer {
    /// Where the radius is `radius`.
    pub(crate) z: f64,
    pub(crate) radius: f64,
    /// Change of the radius along z: 1 or -1.
    pub(crate) slope: f64,
    /// What is kept of the thread.
    pub(crate) keep: Keep,
}

/// Which of thread and cone bounds the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    /// The lesser radius: a bolt.
    Inner,
    /// The greater radius: a nut.
    Outer,
}

/// Which way the surface faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Facing {
    /// Away from the axis: a bolt.
    Outward,
    /// Towards the axis: a nut.
    Inward,
}

/// A point of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    z: f64,
    radius: f64,
}

/// Radial depth of the thread, `5/8 H`.
pub(crate) fn thread_depth(pitch: f64) -> f64 {
    0.625 * 0.75f64.sqrt() * pitch
}

/// Checks what bolt and nut have in common.
pub(crate) fn check_thread(
    checked: &Checked,
    diameter: f64,
    pitch: f64,
    segments: u32,
    flank_segments: u32,
) -> Result<(), ShapeError> {
    let range = [MIN_LENGTH / 1e-4, MAX_LENGTH * 1e-4];
    checked.within("diameter", diameter, range, "a length in scene units")?;
    let reason = "between diameter / 1000 and diameter / 4";
    checked.within("pitch", pitch, [1e-3 * diameter, 0.25 * diameter], reason)?;
    checked.count("segments", segments, 12, 4096)?;
    checked.count("flank_segments", flank_segments, 1, 64)
}

impl Thread {
    fn root(&self) -> f64 {
        self.crest - thread_depth(self.pitch)
    }

    /// About how many triangles the surface has.
    pub(crate) fn faces(&self) -> u64 {
        let turns = ((self.ends[1] - self.ends[0]) / self.pitch).ceil() as u64 + 1;
        4 * u64::from(self.segments) * u64::from(self.flank_segments + 1) * turns
    }

    /// The corners of one pitch, crest centred at 0: offset along z and radius, ascending.
    fn profile(&self) -> Vec<[f64; 2]> {
        let n = self.flank_segments;
        let (crest, flank) = (0.0625 * self.pitch, 0.3125 * self.pitch);
        let step = |k: u32| f64::from(k) / f64::from(n);
        let radius = |t: f64| self.root() + (self.crest - self.root()) * t;
        let rising = (0..=n).map(|k| [flank * step(k) - crest - flank, radius(step(k))]);
        let falling = (0..=n).map(|k| [crest + flank * step(k), radius(1.0 - step(k))]);
        rising.chain(falling).collect()
    }

    /// The polyline of a column, from the lower end to the upper.
    fn column(&self, index: u32, chamfers: &[Chamfer]) -> Vec<Node> {
        let shift = self.shift(index);
        let profile = self.profile();
        let first = ((self.ends[0] - shift) / self.pitch).floor() as i64 - 1;
        let last = ((self.ends[1] - shift) / self.pitch).ceil() as i64 + 1;
        let turns = (first..=last).flat_map(|turn| {
            let base = turn as f64 * self.pitch;
            profile.iter().map(move |&[offset, radius]| Node { z: (base + offset) + shift, radius })
        });
        let mut nodes = cut(&turns.collect::<Vec<_>>(), self.ends);
        for chamfer in chamfers {
            nodes = bound(&nodes, chamfer);
        }
        merge_near(nodes, MERGE * self.pitch)
    }

    /// How far the helix has climbed at a column.
    fn shift(&self, index: u32) -> f64 {
        self.pitch * (f64::from(index) / f64::from(self.segments))
    }

    /// Adds the surface; returns the rings of vertices at the lower and the upper end, in the order
    /// of the columns.
    pub(crate) fn build(
        &self,
        builder: &mut MeshBuilder,
        chamfers: &[Chamfer],
        facing: Facing,
    ) -> [Vec<u32>; 2] {
        let columns: Vec<Column> =
            (0..self.segments).map(|i| self.add_column(builder, i, chamfers)).collect();
        for (i, left) in columns.iter().enumerate() {
            // After a whole turn the helix has climbed by a pitch.
            let (next, climbed) =
                if i + 1 == columns.len() { (0, -self.pitch) } else { (i + 1, 0.0) };
            self.join(builder, left, &columns[next], climbed, facing);
        }
        let ring = |k: fn(&Column) -> Option<&u32>| columns.iter().filter_map(k).copied().collect();
        [ring(|c| c.vertices.first()), ring(|c| c.vertices.last())]
    }

    fn add_column(&self, builder: &mut MeshBuilder, index: u32, chamfers: &[Chamfer]) -> Column {
        let (shift, outward) = (self.shift(index), direction(index, self.segments));
        let nodes = self.column(index, chamfers);
        let vertices = nodes.iter().map(|n| builder.vertex((n.radius * outward).extend(n.z)));
        Column {
            vertices: vertices.collect(),
            heights: nodes.iter().map(|n| n.z - shift).collect(),
        }
    }

    /// The strip between two columns: climbs on the side whose next point comes first along the
    /// helix.
    fn join(
        &self,
        builder: &mut MeshBuilder,
        left: &Column,
        right: &Column,
        climbed: f64,
        facing: Facing,
    ) {
        let tie = MERGE * self.pitch;
        let (mut l, mut r) = (0, 0);
        while l + 1 < left.vertices.len() || r + 1 < right.vertices.len() {
            let climb_left = match (left.heights.get(l + 1), right.heights.get(r + 1)) {
                (Some(a), Some(b)) => *a <= b + climbed + tie,
                (next, _) => next.is_some(),
            };
            let [a, b] = [left.vertices[l], right.vertices[r]];
            let c = if climb_left { left.vertices[l + 1] } else { right.vertices[r + 1] };
            match facing {
                Facing::Outward => builder.triangle(a, b, c),
                Facing::Inward => builder.triangle(b, a, c),
            }
            if climb_left { l += 1 } else { r += 1 }
        }
    }
}

/// Vertices of a column, and their heights along the helix (z less the helix's climb).
struct Column {
    vertices: Vec<u32>,
    heights: Vec<f64>,
}

/// The part of a polyline between two heights; it must reach beyond both.
fn cut(nodes: &[Node], [low, high]: [f64; 2]) -> Vec<Node> {
    let end = |z: f64| {
        let k = nodes.partition_point(|n| n.z < z).clamp(1, nodes.len() - 1);
        let (a, b) = (nodes[k - 1], nodes[k]);
        Node { z, radius: a.radius + (b.radius - a.radius) * ((z - a.z) / (b.z - a.z)) }
    };
    let inner = nodes.iter().copied().filter(|n| low < n.z && n.z < high);
    std::iter::once(end(low)).chain(inner).chain(std::iter::once(end(high))).collect()
}

/// The polyline bounded by a cone: crossings are added, and points beyond the cone move onto it.
/// They stay, though a column is straight there, so that neighbouring columns have the same corners
/// to join. Along the helix the surface is then interpolated on the side of its own solid: a nut's
/// facets never reach into the bolt where its lead-in cuts a corner of the thread.
fn bound(nodes: &[Node], chamfer: &Chamfer) -> Vec<Node> {
    let cone = |z: f64| chamfer.radius + chamfer.slope * (z - chamfer.z);
    let beyond = |n: &Node| match chamfer.keep {
        Keep::Inner => n.radius - cone(n.z),
        Keep::Outer => cone(n.z) - n.radius,
    };
    let mut bounded = Vec::with_capacity(nodes.len() + 4);
    let mut previous: Option<&Node> = None;
    for node in nodes {
        let after = beyond(node);
        if let Some(previous) = previous {
            let before = beyond(previous);
            if before * after < 0.0 {
                let z = previous.z + (node.z - previous.z) * (before / (before - after));
                bounded.push(Node { z, radius: cone(z) });
            }
        }
        bounded.push(if after <= 0.0 { *node } else { Node { z: node.z, radius: cone(node.z) } });
        previous = Some(node);
    }
    bounded
}

/// Drops inner points that are nearer than `least` along z to the one before, or to the end.
fn merge_near(nodes: Vec<Node>, least: f64) -> Vec<Node> {
    let Some(&end) = nodes.last() else { return nodes };
    let mut kept: Vec<Node> = Vec::with_capacity(nodes.len());
    for node in &nodes[..nodes.len() - 1] {
        let clear_below = kept.last().is_none_or(|k| node.z - k.z > least);
        if clear_below && (kept.is_empty() || end.z - node.z > least) {
            kept.push(*node);
        }
    }
    kept.push(end);
    kept
}

/// A hexagonal prism's outline: corners at multiples of 60 degrees from +x.
pub(crate) fn hexagon(builder: &mut MeshBuilder, across_flats: f64, z: f64) -> Vec<u32> {
    let corner = across_flats / 3f64.sqrt();
    (0..6).map(|k| builder.vertex(DVec2::extend(corner * direction(k, 6), z))).collect()
}

/// The flat ring between a round hole (any number of vertices, evenly spread, the first at +x) and
/// a hexagon around it, facing +z or -z. Each edge of the hole goes to the nearest corner, which
/// sees it if the hexagon is wide enough: see [`MIN_FLATS`].
pub(crate) fn collar(builder: &mut MeshBuilder, hole: &[u32], hexagon: &[u32], up: bool) {
    let n = hole.len();
    let mut face = |a, b, c| if up { builder.triangle(a, b, c) } else { builder.triangle(a, c, b) };
    // The corner nearest to the middle of edge i: round(6 (i + 1/2) / n).
    let nearest = |i: usize| (6 * (2 * i + 1) + n) / (2 * n);
    for i in 0..n {
        let corner = nearest(i);
        let before = if i == 0 { 0 } else { nearest(i - 1) };
        for k in before..corner {
            face(hole[i], hexagon[k % 6], hexagon[(k + 1) % 6]);
        }
        face(hole[i], hexagon[corner % 6], hole[(i + 1) % n]);
    }
}

/// Least width of a hexagon across flats, in diameters of the round hole. At 1.2 the corner is 1.39
/// radii away and sees 43 degrees of the circle on either side: the 30 that it needs, and 13 more
/// for the slope of the thread (at most 7 degrees for `pitch = diameter / 4`). Narrower, and faces
/// of the collar fold over; the test `threads_of_any_accepted_parameters_are_solids` tries the
/// narrowest.
pub(crate) const MIN_FLATS: f64 = 1.2;

/// The tip of a bolt: a disc around the axis, facing +z.
pub(crate) fn disc(builder: &mut MeshBuilder, rim: &[u32], z: f64) {
    let centre = builder.vertex(DVec3::new(0.0, 0.0, z));
    builder.band(rim, &[centre]);
}

#[cfg(test)]
mod tests {
    use super::*;

    const M16: Thread =
        Thread { pitch: 2.0, crest: 8.0, segments: 144, flank_segments: 1, ends: [0.0, 10.0] };

    #[test]
    fn the_profile_is_that_of_iso_68_1() {
        let profile = M16.profile();
        let root = 8.0 - 0.625 * 3f64.sqrt(); // minor diameter 13.835 mm
        assert!((2.0 * root - 13.835).abs() < 5e-4);
        let expected = [[-0.75, root], [-0.125, 8.0], [0.125, 8.0], [0.75, root]];
        for (found, expected) in profile.iter().zip(expected) {
            assert!((found[0] - expected[0]).abs() < 1e-15);
            assert!((found[1] - expected[1]).abs() < 1e-14);
        }
        // Flanks at 30 degrees, and the pitch diameter d - 3/4 H where ridge and groove are equal.
        let slope = (profile[1][0] - profile[0][0]) / (profile[1][1] - profile[0][1]);
        assert!((slope - 30f64.to_radians().tan()).abs() < 1e-12);
    }

    #[test]
    fn a_column_is_cut_at_its_ends_and_climbs() {
        let column = M16.column(36, &[]);
        assert_eq!(column[0].z, 0.0);
        assert_eq!(column[column.len() - 1].z, 10.0);
        assert!(column.windows(2).all(|w| w[0].z < w[1].z));
        // A quarter of a turn: the crest's middle lies half a millimetre up.
        assert!(column.iter().any(|n| (n.z - 0.625).abs() < 1e-12 && n.radius == 8.0));
    }

    #[test]
    fn a_chamfer_keeps_the_lesser_radius() {
        let chamfer = Chamfer { z: 10.0, radius: 6.5, slope: -1.0, keep: Keep::Inner };
        let column = M16.column(0, &[chamfer]);
        assert!(column.iter().all(|n| n.radius <= 6.5 + 10.0 - n.z + 1e-12));
        assert_eq!(column[column.len() - 1], Node { z: 10.0, radius: 6.5 });
    }
}
