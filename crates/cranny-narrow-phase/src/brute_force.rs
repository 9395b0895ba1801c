//! The slow, obviously right version: every face against every face, no trees, no memory.
//!
//! An oracle for tests and for doubt. It shares the posing function and the predicates with the
//! fast version (both have oracles of their own) and nothing of its search.

use cranny_exact::{Meeting, classify_triangles};
use cranny_geometry::FaceId;

use crate::answer::Surface;
use crate::evaluate::QueryError;
use crate::pair::{Pair, Side};
use crate::query::Placed;
use cranny_geometry::triangle_distance::triangle_distance;

/// What brute force answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BruteForce {
    /// How the surfaces meet.
    pub surface: Surface,
    /// Pairs of faces that meet.
    pub triangle_pairs: u32,
    /// Least distance between the surfaces.
    pub distance: f64,
}

/// Classifies and measures all pairs of faces: O(n m).
///
/// # Errors
///
/// [`QueryError`] where a pose is none, as [`query`](crate::query()) says.
pub fn brute_force(a: Placed, b: Placed) -> Result<BruteForce, QueryError> {
    let pair = Pair::new(a, b)?;
    let faces = |side| (0..pair.mesh(side).faces().len() as u32).map(FaceId);
    let mut out = BruteForce { surface: Meeting::None, triangle_pairs: 0, distance: f64::INFINITY };
    for f in faces(Side::First) {
        let first = pair.triangle(Side::First, f);
        for g in faces(Side::Second) {
            let second = pair.triangle(Side::Second, g);
            let meeting = classify_triangles(&first, &second);
            out.surface = out.surface.max(meeting);
            if meeting.meets() {
                out.triangle_pairs += 1;
                out.distance = 0.0;
            } else {
                out.distance = out.distance.min(triangle_distance(&first, &second).squared.sqrt());
            }
        }
    }
    Ok(out)
}
