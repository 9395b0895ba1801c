//! From an answer to its certificate.

use cranny_certificate::{
    Certificate, Claim, Contained, Evidence, Frame, PosedPair, SurfaceVerdict, Triangles,
};
use cranny_exact::Meeting;
use cranny_geometry::Mesh;
use cranny_narrow_phase::operations::Pair;
use cranny_narrow_phase::{Containment, Placed, QueryError, Surface};
use thiserror::Error;

use crate::cloud::Clouds;
use crate::descent::Descent;

/// A verdict without a proof.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ProveError {
    /// The poses are none.
    #[error(transparent)]
    Query(#[from] QueryError),
    /// The certificate's own arithmetic refuses the bodies.
    #[error("{0}")]
    Bodies(String),
    /// Faces that meet otherwise than the verdict says. The query is wrong: please report it.
    #[error(
        "the verdict is '{claimed}', but face {a} of A and face {b} of B {found}; please report this with both meshes and the poses"
    )]
    Contradicted {
        /// The verdict.
        claimed: &'static str,
        /// Face of A.
        a: u32,
        /// Face of B.
        b: u32,
        /// How they meet.
        found: &'static str,
    },
    /// No two faces meet as the verdict says. The query is wrong: please report it.
    #[error(
        "the verdict is '{claimed}', but no two faces do so; please report this with both meshes and the poses"
    )]
    Missing {
        /// The verdict.
        claimed: &'static str,
    },
}

/// The triangles of a mesh, for a certificate.
#[must_use]
pub fn filed(mesh: &Mesh) -> Triangles {
    Triangles {
        vertices: mesh.vertices().iter().map(|p| p.to_array()).collect(),
        faces: mesh.faces().to_vec(),
    }
}

/// What an answer says, as a certificate claims it.
#[must_use]
pub fn claim(surface: Surface, solid: bool, contained: Option<Containment>) -> Claim {
    Claim {
        surface: match surface {
            Surface::None => SurfaceVerdict::None,
            Surface::Touch => SurfaceVerdict::Touch,
            Surface::Cross => SurfaceVerdict::Cross,
        },
        solid,
        contained: contained.map(|contained| match contained {
            Containment::AInB => Contained::AInB,
            Containment::BInA => Contained::BInA,
        }),
    }
}

/// Makes the certificate of a claim about two models at their poses. `filed` are the triangles that
/// the models were prepared from, without repairs; the certificate names their faces.
///
/// # Errors
///
/// [`ProveError`] where a pose is none, or the claim is wrong.
pub fn prove(
    claim: &Claim,
    [a, b]: [Placed; 2],
    filed: [&Triangles; 2],
) -> Result<Certificate, ProveError> {
    let pair = Pair::new(a, b)?;
    let map = *pair.first_from_second();
    let [frame, _] = pair.ordered(Frame::A, Frame::B);
    let (l, t) = (map.linear, map.translation);
    let row = |i: usize| [l.x_axis[i], l.y_axis[i], l.z_axis[i], t[i]];
    let rows = [row(0), row(1), row(2)];
    let mut certificate = Certificate {
        poses: [a.pose, b.pose].map(|pose| pose.to_row_major()),
        frame,
        map: std::array::from_fn(|k| rows[k / 4][k % 4]),
        evidence: Evidence { crossing: None, touching: None, apart: Vec::new() },
    };
    let posed = PosedPair::of(&certificate, filed).map_err(ProveError::Bodies)?;
    let moved = |i: usize| Clouds::new(filed[i], |p| map.apply(p));
    let still = |i: usize| Clouds::new(filed[i], |p| p);
    let clouds = match frame {
        Frame::A => [still(0), moved(1)],
        Frame::B => [moved(0), still(1)],
    };
    let mut descent = Descent { pair: &posed, clouds };
    certificate.evidence = evidence(claim.surface, &mut descent)?;
    Ok(certificate)
}

fn evidence(surface: SurfaceVerdict, descent: &mut Descent<'_>) -> Result<Evidence, ProveError> {
    let claimed = match surface {
        SurfaceVerdict::None => "none",
        SurfaceVerdict::Touch => "touch",
        SurfaceVerdict::Cross => "cross",
    };
    let missing = || ProveError::Missing { claimed };
    if surface == SurfaceVerdict::Cross {
        let crossing = Some(descent.find_crossing().ok_or_else(missing)?);
        return Ok(Evidence { crossing, touching: None, apart: Vec::new() });
    }
    let may_touch = surface == SurfaceVerdict::Touch;
    let parted = descent.part(may_touch).map_err(|found| ProveError::Contradicted {
        claimed,
        a: found.faces[0],
        b: found.faces[1],
        found: match found.meeting {
            Meeting::Cross => "cross",
            Meeting::Touch => "touch",
            Meeting::None => "are parted by no plane",
        },
    })?;
    if may_touch && parted.touching.is_none() {
        return Err(missing());
    }
    Ok(Evidence { crossing: None, touching: parted.touching, apart: parted.steps })
}
