//! Piles: many bodies in a region, apart from each other at the start.
//!
//! Every body's bounding sphere has a cell of a grid to itself, so bodies cannot overlap whatever
//! their orientation. Layers fill from the bottom; cells are as low as the largest sphere allows
//! and as wide as the region allows, and each sphere lies anywhere in the middle of its cell that
//! leaves half the gap to the walls. A cell in which its body would meet what stands there stays
//! empty.

use std::sync::Arc;

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_geometry::Mesh;
use cranny_world::Random;

/// Bodies of a group at most. More: a slip of the pen fills the memory before it is refused; fewer:
/// crowds that can be simulated are refused.
const MOST_BODIES: u128 = 1_000_000;

/// Fails where a group has more bodies than anybody can simulate.
///
/// # Errors
///
/// How many there may be, as a sentence.
pub(super) fn check_count(count: u128) -> Result<(), String> {
    if count <= MOST_BODIES {
        return Ok(());
    }
    Err(format!("it has {count} bodies, but a group has {MOST_BODIES} at most. Lower the count"))
}

/// A body of a pile.
pub(super) struct Piece {
    /// Index into the shapes.
    pub(super) shape: usize,
    pub(super) pose: Pose,
}

/// Places `count` pieces; every random choice comes from the seed.
///
/// # Errors
///
/// What does not fit, as a sentence.
pub(super) fn place(
    count: usize,
    seed: u64,
    region: &Aabb,
    gap: f64,
    shapes: &[Arc<Mesh>],
    mut is_clear: impl FnMut(&Piece) -> Result<bool, String>,
) -> Result<Vec<Piece>, String> {
    let spheres: Vec<(DVec3, f64)> = shapes.iter().map(|mesh| bounding_sphere(mesh)).collect();
    let largest = spheres.iter().map(|&(_, radius)| radius).fold(0.0, f64::max);
    let gap = 2.0 * largest * gap;
    let least = 2.0 * largest + gap;
    let extent = region.max - region.min;
    let [nx, ny, nz] = (extent / least).to_array().map(|n| n.floor().min(1e6) as usize);
    let holds = nx.saturating_mul(ny).saturating_mul(nz);
    if holds < count {
        return Err(refused(Room { holds, along: [nx, ny, nz], each: least }, count));
    }
    check_count(count as u128)?;
    let cell = DVec3::new(extent.x / nx as f64, extent.y / ny as f64, least);
    let mut random = Random::new(seed);
    let mut candidate = |i: usize| {
        let shape = random.below(shapes.len());
        let (center, radius) = spheres[shape];
        let rotation = random.rotation();
        let index = DVec3::new((i % nx) as f64, (i / nx % ny) as f64, (i / nx / ny) as f64);
        let jitter = DVec3::new(random.signed(), random.signed(), random.signed());
        let room = (0.5 * (cell - gap) - radius).max(DVec3::ZERO);
        let at = region.min + (index + 0.5) * cell + room * jitter;
        Piece { shape, pose: Pose { rotation, translation: at - rotation * center } }
    };
    let mut pieces = Vec::with_capacity(count);
    for cell in 0..holds {
        if pieces.len() == count {
            break;
        }
        let piece = candidate(cell);
        if is_clear(&piece)? {
            pieces.push(piece);
        }
    }
    if pieces.len() < count {
        return Err(format!(
            "its region has {holds} places ({nx} x {ny} x {nz}), of which {} are clear of what stands there, but its count is {count}. Enlarge or move the region, or lower the count",
            pieces.len()
        ));
    }
    Ok(pieces)
}

/// How many bodies a region has room for.
struct Room {
    holds: usize,
    /// Along x, y and z.
    along: [usize; 3],
    /// What each needs along x, y and z.
    each: f64,
}

/// Why a region does not hold so many bodies.
fn refused(Room { holds, along: [nx, ny, nz], each }: Room, count: usize) -> String {
    let needs = format!(
        "A body needs {each:.4} along x, y and z, since it lies in the region whole, however it is turned, and keeps its `gap`"
    );
    match holds {
        0 => format!("its region holds no body. {needs}. Enlarge the region"),
        _ => format!(
            "its region has room for {holds} ({nx} x {ny} x {nz}), but its count is {count}. {needs}. Enlarge the region or lower the count"
        ),
    }
}

/// About the centre of the box: not the smallest, but within a factor of √3 of it.
fn bounding_sphere(mesh: &Mesh) -> (DVec3, f64) {
    let center = mesh.bounds().center();
    let squared = mesh.vertices().iter().map(|&p| p.distance_squared(center));
    (center, squared.fold(0.0, f64::max).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_shapes::{Cuboid, Cup};

    fn free(_: &Piece) -> Result<bool, String> {
        Ok(true)
    }

    fn shapes() -> Vec<Arc<Mesh>> {
        let cuboid = Cuboid { size: [1.0, 0.5, 0.25] }.build().unwrap();
        vec![Arc::new(cuboid), Arc::new(Cup::default().build().unwrap())]
    }

    #[test]
    fn spheres_keep_their_gap_and_stay_in_the_region() {
        let shapes = shapes();
        let region = Aabb { min: DVec3::new(-4.0, -3.0, 1.0), max: DVec3::new(4.0, 3.0, 30.0) };
        let pieces = place(150, 3, &region, 0.05, &shapes, free).unwrap();
        let spheres: Vec<_> = pieces
            .iter()
            .map(|piece| {
                let (center, radius) = bounding_sphere(&shapes[piece.shape]);
                (piece.pose.world_from_body().apply(center), radius)
            })
            .collect();
        let largest = spheres.iter().map(|s| s.1).fold(0.0, f64::max);
        for (i, a) in spheres.iter().enumerate() {
            assert!((a.0 - a.1).cmpge(region.min).all() && (a.0 + a.1).cmple(region.max).all());
            for b in &spheres[..i] {
                assert!(a.0.distance(b.0) - a.1 - b.1 > 0.099 * largest);
            }
        }
        assert!(pieces.iter().any(|p| p.shape == 0) && pieces.iter().any(|p| p.shape == 1));
    }

    #[test]
    fn the_seed_decides_everything() {
        let shapes = shapes();
        let region = Aabb { min: DVec3::ZERO, max: DVec3::splat(8.0) };
        let poses = |seed| {
            let pieces = place(20, seed, &region, 0.0, &shapes, free).unwrap();
            pieces.iter().map(|p| (p.shape, p.pose.bits())).collect::<Vec<_>>()
        };
        assert_eq!(poses(1), poses(1));
        assert_ne!(poses(1), poses(2));
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let region = Aabb { min: DVec3::ZERO, max: DVec3::splat(3.0) };
        let error = place(100, 0, &region, 0.0, &shapes(), free).err().unwrap();
        assert!(error.contains("room for 8 (2 x 2 x 2), but its count is 100"), "{error}");
        let narrow = Aabb { max: DVec3::new(3.0, 3.0, 1.0), ..region };
        let error = place(1, 0, &narrow, 0.0, &shapes(), free).err().unwrap();
        assert!(error.contains("holds no body. A body needs 1."), "{error}");
    }
}
