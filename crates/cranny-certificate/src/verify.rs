//! The check of a certificate.

use thiserror::Error;

use crate::body::{Triangles, cross_each_other};
use crate::cells::{has_area, shared};
use crate::certificate::{Certificate, Claim, Frame, Step, SurfaceVerdict};
use crate::direction::Parts;
use crate::groups::halves;
use crate::posed::{Parting, PosedPair};
use crate::solids::Solids;

/// Why a certificate does not hold.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Refusal {
    /// A mesh that is none.
    #[error("body {body}: {reason}")]
    Mesh {
        /// `'A'` or `'B'`.
        body: char,
        /// What is wrong.
        reason: String,
    },
    /// Poses that are none, or a map that does not come from them.
    #[error("{0}")]
    Poses(String),
    /// Evidence of another verdict, or of none.
    #[error("the evidence is not of '{claimed}': {reason}")]
    Kind {
        /// The verdict.
        claimed: &'static str,
        /// What is missing.
        reason: &'static str,
    },
    /// A face that the body has not.
    #[error("body {body} has {count} faces, and no face {face}")]
    Face {
        /// `'A'` or `'B'`.
        body: char,
        /// The number.
        face: u32,
        /// How many there are.
        count: usize,
    },
    /// Two faces that do not meet as the evidence says.
    #[error("face {a} of A and face {b} of B do not {how}")]
    Meeting {
        /// Face of A.
        a: u32,
        /// Face of B.
        b: u32,
        /// `cross` or `touch`.
        how: &'static str,
    },
    /// A step that proves nothing.
    #[error("step {step} of {steps}: {reason}")]
    Step {
        /// From 0.
        step: usize,
        /// How many there are.
        steps: usize,
        /// What is wrong.
        reason: String,
    },
    /// The surfaces are right, and the claim about the solids is not.
    #[error("{0}")]
    Solids(String),
}

/// Checks that a claim about two bodies holds. `bodies` are A and B as filed, scaled.
///
/// # Errors
///
/// [`Refusal`] where it does not hold, or is not proved.
pub fn verify(
    claim: &Claim,
    certificate: &Certificate,
    bodies: [&Triangles; 2],
) -> Result<(), Refusal> {
    for (body, triangles) in ['A', 'B'].into_iter().zip(bodies) {
        check_mesh(triangles).map_err(|reason| Refusal::Mesh { body, reason })?;
    }
    check_map(certificate).map_err(Refusal::Poses)?;
    let pair = PosedPair::of(certificate, bodies).map_err(Refusal::Poses)?;
    let solids = match claim.surface {
        SurfaceVerdict::Cross => crossing(certificate, &pair)?,
        SurfaceVerdict::None => apart(certificate, &pair, false)?,
        SurfaceVerdict::Touch => {
            touching(certificate, &pair)?;
            apart(certificate, &pair, true)?
        }
    };
    let claimed = Solids { solid: claim.solid, contained: claim.contained };
    if solids == claimed {
        return Ok(());
    }
    Err(Refusal::Solids(format!(
        "solid is {}, contained is {:?}; claimed are {} and {:?}",
        solids.solid, solids.contained, claimed.solid, claimed.contained
    )))
}

fn check_mesh(body: &Triangles) -> Result<(), String> {
    let count = body.vertices.len();
    if body.faces.is_empty() {
        return Err("it has no face".to_owned());
    }
    if let Some(face) = body.faces.iter().position(|f| f.iter().any(|&v| v as usize >= count)) {
        return Err(format!("face {face} names a vertex that is not there; there are {count}"));
    }
    match body.are_finite() {
        true => Ok(()),
        false => Err("a coordinate is not finite".to_owned()),
    }
}

/// By how much a map may miss the product of the poses: what the two pose matrices themselves are
/// off from rotations, and this for rounding. Smaller: products that were rounded in another order
/// are refused. Larger: a map of other poses passes for that of these.
const MAP_ROUNDING: f64 = 1e-12;

/// A pose matrix farther than this from a rotation is none. Larger: a scaled body passes for a
/// rigid one. Smaller: matrices written with seven digits are refused.
const MOST_DEVIATION: f64 = 1e-6;

/// Where the bodies are is what the poses say; the map, to the bit, says where exactly.
fn check_map(certificate: &Certificate) -> Result<(), String> {
    let [a, b] = &certificate.poses;
    let (first, second) = match certificate.frame {
        Frame::A => (a, b),
        Frame::B => (b, a),
    };
    let deviation = deviation(first) + deviation(second);
    if deviation.is_nan() || deviation > 2.0 * MOST_DEVIATION {
        return Err(format!("the poses are no rigid motions: they deviate by {deviation:e}"));
    }
    let column = |m: &[f64; 16], j: usize| [m[j], m[4 + j], m[8 + j]];
    let inner = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let (from, to) = (column(first, 3), column(second, 3));
    let way: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
    let length = from.iter().chain(&to).fold(0.0f64, |most, x| most.max(x.abs()));
    let allowed = 4.0 * deviation + MAP_ROUNDING;
    for i in 0..3 {
        for j in 0..4 {
            let (expected, scale) = match j {
                3 => (inner(column(first, i), way), length),
                _ => (inner(column(first, i), column(second, j)), 1.0),
            };
            let found = certificate.map[4 * i + j];
            let off = (found - expected).abs();
            if off.is_nan() || off > allowed * scale {
                return Err(format!(
                    "the map is not that of the poses: {found} stands in row {i}, column {j}, and \
                     {expected} follows from them"
                ));
            }
        }
    }
    Ok(())
}

/// How far the linear part is from a rotation: the largest entry of `RᵀR - 1`, 2 where it mirrors.
fn deviation(m: &[f64; 16]) -> f64 {
    let column = |j: usize| [m[j], m[4 + j], m[8 + j]];
    let inner = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    let mut worst = [m[12], m[13], m[14], m[15] - 1.0].into_iter().map(f64::abs).sum::<f64>();
    for i in 0..3 {
        for j in 0..3 {
            let off = inner(column(i), column(j)) - f64::from(u8::from(i == j));
            worst = if off.is_nan() { f64::INFINITY } else { worst.max(off.abs()) };
        }
    }
    let [[ax, ay, az], [bx, by, bz], c] = [0, 1, 2].map(column);
    let turned = inner([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], c);
    if turned > 0.0 { worst } else { worst.max(2.0) }
}

fn crossing(certificate: &Certificate, pair: &PosedPair) -> Result<Solids, Refusal> {
    let missing =
        Refusal::Kind { claimed: "cross", reason: "it names no pair of faces that cross" };
    let [f, g] = known(certificate.evidence.crossing.ok_or(missing)?, pair)?;
    match cross_each_other(&pair.a.triangle(f), &pair.b.triangle(g)) {
        true => Ok(Solids::CROSSING),
        false => Err(Refusal::Meeting { a: f, b: g, how: "cross" }),
    }
}

fn touching(certificate: &Certificate, pair: &PosedPair) -> Result<(), Refusal> {
    let missing =
        Refusal::Kind { claimed: "touch", reason: "it names no pair of faces that touch" };
    let [f, g] = known(certificate.evidence.touching.ok_or(missing)?, pair)?;
    match share_a_point(pair, [f, g]) {
        true => Ok(()),
        false => Err(Refusal::Meeting { a: f, b: g, how: "touch" }),
    }
}

/// Whether two faces, with area or without, share a point.
fn share_a_point(pair: &PosedPair, [f, g]: [u32; 2]) -> bool {
    let (a, b) = (pair.a.triangle(f), pair.b.triangle(g));
    match (has_area(&a), has_area(&b)) {
        (_, true) => !shared(&a, &b).is_empty(),
        (true, false) => !shared(&b, &a).is_empty(),
        // Two convex sets share a point where no pair of their parts has a direction between.
        (false, false) => {
            Parts::all().all(|parts| pair.parting_of_faces([f, g], parts) != Parting::Apart)
        }
    }
}

fn known(faces: [u32; 2], pair: &PosedPair) -> Result<[u32; 2], Refusal> {
    for ((body, face), own) in [('A', faces[0]), ('B', faces[1])].into_iter().zip(pair.bodies()) {
        let count = own.faces.len();
        if face as usize >= count {
            return Err(Refusal::Face { body, face, count });
        }
    }
    Ok(faces)
}

/// Follows the steps: each pair of faces is parted by one of them, and by a gap unless faces may
/// touch. Returns what follows for the solids.
fn apart(certificate: &Certificate, pair: &PosedPair, may_touch: bool) -> Result<Solids, Refusal> {
    let steps = &certificate.evidence.apart;
    let [a, b] = pair.bodies();
    let mut open = vec![[a.groups().all(), b.groups().all()]];
    let mut touching = Vec::new();
    for (number, step) in steps.iter().enumerate() {
        let wrong = |reason: &str| Refusal::Step {
            step: number,
            steps: steps.len(),
            reason: reason.to_owned(),
        };
        let groups = open.pop().ok_or_else(|| wrong("all faces are parted already"))?;
        let singles = || match groups.each_ref().map(|group| group.len()) {
            [1, 1] => Ok([a.groups().faces(&groups[0])[0], b.groups().faces(&groups[1])[0]]),
            _ => Err(wrong("it is about two single faces, and the groups hold more")),
        };
        let parting = match *step {
            Step::Halve(side @ (1 | 2)) => {
                let side = usize::from(side) - 1;
                if groups[side].len() < 2 {
                    return Err(wrong("a single face cannot be divided"));
                }
                for half in halves(&groups[side]) {
                    let mut parts = groups.clone();
                    parts[side] = half;
                    open.push(parts);
                }
                continue;
            }
            Step::Halve(_) => return Err(wrong("it divides neither 1 nor 2")),
            Step::Direction(direction) => pair.parting(&groups, direction),
            Step::Parts(parts) => pair.parting_by(&groups, singles()?, parts),
            Step::PartsOf { faces, parts } => pair.parting_by(&groups, known(faces, pair)?, parts),
            Step::Needle { needle } => match needle && pair.has_needle(singles()?) {
                true => Parting::Touching,
                false => return Err(wrong("neither face is a needle")),
            },
        };
        if parting == Parting::None || (parting == Parting::Touching && !may_touch) {
            return Err(wrong("the direction does not part the groups"));
        }
        if number == 0 {
            // A plane between the whole bodies.
            return match steps.len() {
                1 => Ok(Solids::PARTED),
                _ => Err(wrong("it parts all faces, and more steps follow")),
            };
        }
        if parting == Parting::Touching {
            touching.push(singles()?);
        }
    }
    if !open.is_empty() {
        let reason = format!("the steps end, and {} pairs of groups are left", open.len());
        return Err(Refusal::Step { step: steps.len(), steps: steps.len(), reason });
    }
    touching.retain(|&faces| share_a_point(pair, faces));
    Solids::of(pair, &touching).map_err(Refusal::Solids)
}
