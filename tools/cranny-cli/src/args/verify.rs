//! Arguments of `cranny verify`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `cranny verify`.
#[derive(Debug, Args)]
#[command(after_help = VERIFY_NOTES)]
pub(crate) struct VerifyArgs {
    /// Lines of `cranny query --certificate`; `-` for standard input
    #[arg(value_name = "CERTIFICATES", required = true)]
    pub(crate) certificates: Vec<PathBuf>,

    /// Mesh A, where it lies elsewhere than the certificates say
    #[arg(long, value_name = "MESH")]
    pub(crate) mesh_a: Option<PathBuf>,

    /// Mesh B
    #[arg(long, value_name = "MESH")]
    pub(crate) mesh_b: Option<PathBuf>,
}

const VERIFY_NOTES: &str = "\
Each line claims how two surfaces meet (surface), whether the bodies share interior points (solid) and which
lies in which (contained). The certificate proves it:
  cross  two triangles that share a point inside both
  none   planes, each of which parts a group of A's triangles from a group of B's by a gap; together the
         groups cover every pair of triangles
  touch  the same, without a gap where triangles touch, and two triangles that share a point
Whether a body is inside the other where surfaces do not cross is computed from the meshes.

Everything is decided in whole and rational numbers, by code of its own, for the vertices as filed, the moving
body's posed by the certificate's map and rounded to f64, as the query does. Distances, depths and regions are
not certified.

A line that was changed since, be it by one bit, is refused, as is one that proves nothing; the exit code is 1
then.

Examples:
  cranny query bolt.obj nut.obj --poses poses.json --certificate > certificates.jsonl
  cranny verify certificates.jsonl
  cranny verify certificates.jsonl --mesh-a elsewhere/bolt.obj --format json";
