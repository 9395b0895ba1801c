//! Lines of `query --certificate`: written, sealed, and read back.

use std::path::{Path, PathBuf};

use cranny_certificate::{Certificate, Claim, Contained, SurfaceVerdict, Triangles};
use cranny_estimate::Estimate;
use cranny_narrow_phase::Placed;
use cranny_prover::{ProveError, claim, prove};
use serde::{Deserialize, Serialize};

use crate::args::PairArgs;
use crate::failure::Failure;
use crate::model_file::triangles;

/// A mesh file, and how its vertices are scaled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BodyFile {
    /// As the command was given it.
    pub(crate) file: PathBuf,
    /// Factor of all coordinates.
    pub(crate) scale: f64,
}

/// A certificate and the files that it is about.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FiledCertificate {
    /// A and B.
    pub(crate) bodies: [BodyFile; 2],
    /// What proves the verdict.
    pub(crate) proof: Certificate,
}

/// An answer's line with its certificate.
#[derive(Serialize)]
pub(crate) struct CertifiedLine<L> {
    #[serde(flatten)]
    pub(crate) line: L,
    pub(crate) certificate: FiledCertificate,
}

/// What [`Certifier`] needs of a pair to certify pose after pose.
pub(crate) struct Certifier {
    bodies: [BodyFile; 2],
    triangles: [Triangles; 2],
}

impl Certifier {
    /// Reads the meshes as filed.
    ///
    /// # Errors
    ///
    /// As [`triangles`].
    pub(crate) fn new(pair: &PairArgs) -> Result<Self, Failure> {
        let body = |file: &Path, scale| BodyFile { file: file.to_owned(), scale };
        let bodies = [body(&pair.mesh_a, pair.scale_a), body(&pair.mesh_b, pair.scale_b)];
        let [a, b] = bodies.each_ref().map(|body| triangles(&body.file, body.scale));
        Ok(Self { triangles: [a?, b?], bodies })
    }

    /// The certificate of an exact answer.
    ///
    /// # Errors
    ///
    /// [`ProveError`], where the answer is wrong.
    pub(crate) fn certify(
        &self,
        placed: [Placed; 2],
        found: &Estimate,
    ) -> Result<FiledCertificate, ProveError> {
        let (Some(surface), Some(solid)) = (found.surface, found.solid) else {
            return Err(ProveError::Bodies("the verdict is open".to_owned()));
        };
        let claim = claim(surface, solid, found.contained);
        let proof = prove(&claim, placed, self.triangles.each_ref())?;
        Ok(FiledCertificate { bodies: self.bodies.clone(), proof })
    }
}

/// Before the sum, which ends a line.
const SUM_KEY: &str = ",\"sum\":\"";

/// Hexadecimal digits of a sum.
const SUM_DIGITS: usize = 32;

/// A line as JSON, with the sum of all that stands before it: a changed line is seen.
///
/// # Errors
///
/// A value that JSON does not hold.
pub(crate) fn sealed(line: &impl Serialize) -> Result<String, Failure> {
    let mut text = serde_json::to_string(line)
        .map_err(|error| Failure::run(format!("the result cannot be written as JSON: {error}")))?;
    text.pop();
    let sum = sum_of(&text);
    Ok(format!("{text}{SUM_KEY}{sum}\"}}"))
}

fn sum_of(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex()[..SUM_DIGITS].to_owned()
}

/// What a line claims, and its certificate.
#[derive(Debug, Deserialize)]
pub(crate) struct ReadLine {
    /// The pose's number.
    pub(crate) pose: u64,
    surface: SurfaceVerdict,
    solid: bool,
    contained: Option<Contained>,
    /// What proves it.
    pub(crate) certificate: FiledCertificate,
}

impl ReadLine {
    /// Reads a sealed line.
    ///
    /// # Errors
    ///
    /// Says what is wrong with it.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let unsealed = "it has no sum at its end: it is no line of 'cranny query --certificate'";
        let (content, end) = text.rsplit_once(SUM_KEY).ok_or(unsealed)?;
        if end.strip_suffix("\"}") != Some(&sum_of(content)) {
            return Err("its sum is another: the line has been changed or cut off".to_owned());
        }
        serde_json::from_str(text).map_err(|error| error.to_string())
    }

    /// What is claimed.
    pub(crate) fn claim(&self) -> Claim {
        Claim { surface: self.surface, solid: self.solid, contained: self.contained }
    }
}
