//! The arguments of each command.

mod accuracy;
mod recover;
mod replay;
mod report;
mod robot;
mod scene;
mod show;
mod stability;
mod verify;

use std::path::PathBuf;

use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use cranny_estimate::Accuracy;
use cranny_geometry::Repair;

pub(crate) use accuracy::AccuracyArgs;
pub(crate) use recover::RecoverArgs;
pub(crate) use replay::{ReplayArgs, ViewArg};
pub(crate) use report::ReportArgs;
pub(crate) use robot::RobotArgs;
pub(crate) use scene::{
    CheckArgs, CompareArgs, DetectorArg, EffortArgs, ExplainArgs, InsteadArgs, RecyclingArg,
    RunArgs, SetArgs, SubstepsArg,
};
use show::show;
pub(crate) use show::{CutAxis, Show, Up};
pub(crate) use stability::StabilityArgs;
pub(crate) use verify::VerifyArgs;

/// Exact collision detection for bodies that are not convex.
///
/// Results go to standard output; errors, warnings, logs and progress to standard error, logs only
/// where a flag says so, and progress only where that is a terminal. The warnings of `check` are
/// its result, and so on standard output.
#[derive(Debug, Parser)]
#[command(name = "cranny", version, arg_required_else_help = true, after_help = EXIT_CODES)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,

    /// How results are printed [default: json for `query`, text for all others]
    #[arg(long, global = true, value_enum, value_name = "FORMAT")]
    pub(crate) format: Option<Format>,

    /// Show no progress and no warnings on standard error: errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,

    /// Say more on standard error; twice or three times for more still (RUST_LOG overrides it)
    #[arg(short, long, global = true, action = ArgAction::Count)]
    pub(crate) verbose: u8,
}

const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 reading, writing or the work itself failed; 2 wrong arguments or input.";

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a scene; record it, draw it, and sum up
    Run(RunArgs),
    /// Compute a recording anew and compare to the bit; draw any moment of it
    Replay(ReplayArgs),
    /// Make a whole recording of what a killed run left, or of a damaged file
    Recover(RecoverArgs),
    /// One page about a recorded run: pictures, plots, deepest overlaps
    Report(ReportArgs),
    /// The same scene under each detector, side by side: times, overlaps, energy, what tore
    Compare(CompareArgs),
    /// What a scene asks for, what will run for it, and what will not
    Explain(ExplainArgs),
    /// Do two meshes meet? Verdict, distance and contact regions at each of a list of poses
    Query(QueryArgs),
    /// Do the certificates of `query --certificate` hold? Checked in exact arithmetic, without the
    /// detector
    Verify(VerifyArgs),
    /// What certainty costs: time and errors of each level and budget, beside parry's
    Accuracy(AccuracyArgs),
    /// Do hard cases come out right? Families of them, judged by exact rationals, beside parry's
    /// answers
    Stability(StabilityArgs),
    /// What is known of a mesh: defects and repairs, hull, concavities, sizes and times
    Inspect(InspectArgs),
    /// A robot's links, joints and masses; which links meet at each of a list of configurations
    Robot(RobotArgs),
    /// Read a scene file and all that it names, and say whether it is right
    Check(CheckArgs),
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people: aligned columns.
    Text,
    /// For programs: one JSON value a line.
    Json,
}

/// What a query answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum DemandArg {
    /// Whether they meet: verdict on surfaces and solids, containment
    Intersects,
    /// The above, and the distance with its witness points
    Distance,
    /// Whether they meet, and contacts for a solver; no distance
    Contacts,
    /// All of these, and the contact regions with normal, depth and area
    Regions,
}

/// Elementary tests that a step may take; `None`: as many as it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StepBudget(pub(crate) Option<u64>);

/// Two meshes.
#[derive(Debug, Args)]
pub(crate) struct PairArgs {
    /// Mesh A (.obj, .stl, .ply, .off, .gltf, .glb, .dae) or saved model (.cranny)
    #[arg(value_name = "A")]
    pub(crate) mesh_a: PathBuf,

    /// Mesh or model B; may be the same file
    #[arg(value_name = "B")]
    pub(crate) mesh_b: PathBuf,

    /// Scale of mesh A, applied to its vertices before anything else
    #[arg(long, value_name = "S", default_value = "1", value_parser = scale, allow_hyphen_values = true)]
    pub(crate) scale_a: f64,

    /// Scale of mesh B
    #[arg(long, value_name = "S", default_value = "1", value_parser = scale, allow_hyphen_values = true)]
    pub(crate) scale_b: f64,
}

/// Arguments of `cranny query`.
#[derive(Debug, Args)]
#[command(after_help = QUERY_NOTES)]
pub(crate) struct QueryArgs {
    #[command(flatten)]
    pub(crate) pair: PairArgs,

    /// List of poses: [{"a": M|null, "b": M|null}, ...] (see below)
    #[arg(long, value_name = "POSES.json")]
    pub(crate) poses: PathBuf,

    /// What to answer; only that work is done
    #[arg(long, value_enum, value_name = "DEMAND", default_value = "regions")]
    pub(crate) demand: DemandArg,

    /// What is read of the bodies: boxes, hulls, caps, tree:DEPTH or exact (see below)
    #[arg(long, value_name = "LEVEL", default_value = "exact", value_parser = level)]
    pub(crate) accuracy: Accuracy,

    /// Stop after this many elementary tests a pose, whatever is still open then
    #[arg(long, value_name = "N", value_parser = budget, allow_hyphen_values = true)]
    pub(crate) budget: Option<u64>,

    /// How the triangles that meet are found at level exact, for all demands but contacts: the same
    /// answers
    #[arg(long, value_enum, value_name = "METHOD", default_value = "boxes")]
    pub(crate) method: MethodArg,

    /// Forget everything between one pose and the next: the same answers, slower where poses are
    /// close
    #[arg(long)]
    pub(crate) cold: bool,

    /// Add to each line what proves its verdict; `cranny verify` checks it
    #[arg(long)]
    pub(crate) certificate: bool,

    /// Paint what the search of the last pose compares on both meshes: each by itself, seen from
    /// the side of the other
    #[arg(long, value_name = "OUT.png")]
    pub(crate) heat: Option<PathBuf>,
}

/// How the triangles that meet are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodArg {
    /// Trees of boxes over all triangles, kept from pose to pose.
    Boxes,
    /// The concavities that the other hull reaches, by the layers of their envelopes; mostly
    /// slower.
    Envelopes,
}

const QUERY_NOTES: &str = r#"Poses: M is 16 numbers, row-major, world-from-mesh: a rotation and a translation.
`null` (or leaving "a" or "b" out) means that the mesh stays where its file has it.

Output: one JSON object a line for each pose, in order, in world coordinates:
  pose            index from 0
  surface         "none", "touch" or "cross": how the two triangle surfaces meet, exactly
  solid           whether the bodies share interior points (one inside the other counts)
  contained       "A_in_B", "B_in_A" or null; the outer one is closed, the inner one may be
                  anything: an open sheet in a closed cube counts
  distance        between the surfaces, 0 where they meet; witness_a, witness_b: the nearest points;
                  where surfaces cross, one shared point
  triangle_pairs  triangles that meet
  contacts        point_a, point_b, normal (A to B), separation: for a solver; with --demand regions the
                  points of the regions, which are others
  regions         point, normal (A to B), depth, area, separation, triangle_pairs; depth is the least
                  way out of this region along this normal, not the least of all directions: moved so,
                  concave bodies may meet elsewhere
  tests           elementary tests made; micros: time of the query alone. Neither counts the search
                  for the shared point where surfaces cross: the query does not need it
  closed_a        whether the mesh is closed; if not, it is queried as a surface: closed_b likewise
  verdict         "certain": they share a point; "excluded": they do not; "open": not known
  separation      [at least, at most]: what holds the distance, or minus the depth of regions; null:
                  without bound
  places          min, max, separation: where contact may be, a box for each pair of parts of
                  the two bodies that may be near each other
  certificate     with --certificate: the files, and what proves surface, solid and contained; sum, at the
                  end, is of the whole line
What --demand does not ask for is null.
With --format text a pose is a row: solid also says which body is in the other, regions are counted, depth
is that of the deepest. With --demand contacts the contacts of a pose follow, a row each: features,
separation, normal (A to B), and the point half-way between point_a and point_b.

Levels. Each is certain of what it says, and says `unknown` or null for what it does not know:
  boxes       the bodies' boxes: excluded, or open
  hulls       their convex hulls: excluded, or open
  caps        hulls, and faces on them; what lies in concavities is known by its boxes only
  tree:DEPTH  boxes of trees, opened so often
  exact       everything; the default
With a level or a budget, distance, contacts and regions are null: separation and places stand for them.
The witnesses, where there are any, are no farther apart than separation's upper end. It is narrowed only
as far as the demand needs: distance narrows it most.
What was open at one pose is narrowed at the next, unless --cold.

A body against itself, or against its like in the same place, has depth too. No direction is the way out
there, so the pair is read beside its place, shifted by about 1e-9 of its size in a fixed direction, and the
normal is what comes of that: a cube of size 1 in itself is 1.732 deep, along its diagonal, though 1 would do.

Examples:
  echo '[{"a": null, "b": [1,0,0,2.5, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]' > poses.json
  cranny query bolt.obj nut.obj --poses poses.json
  cranny query house.glb car.glb --scale-b 0.12 --poses poses.json --demand distance --format text
  cranny query bolt.obj nut.obj --poses poses.json --certificate | cranny verify -"#;

/// Arguments of `cranny inspect`.
#[derive(Debug, Args)]
#[command(after_help = INSPECT_NOTES)]
pub(crate) struct InspectArgs {
    /// Mesh (.obj, .stl, .ply, .off, .gltf, .glb, .dae) or saved model (.cranny)
    #[arg(value_name = "MESH")]
    pub(crate) mesh: PathBuf,

    /// What may be mended before it is reported (see below)
    #[arg(long, value_enum, value_name = "POLICY", default_value = "none")]
    pub(crate) repair: RepairArg,

    /// What 'the same place' means, in units of the mesh; 0 for exactly the same, at most a
    /// hundredth of the mesh's diagonal [default: from how finely its coordinates are stored]
    #[arg(long, value_name = "DISTANCE", value_parser = weld, allow_hyphen_values = true)]
    pub(crate) weld: Option<f64>,

    /// How far from a plane points may lie that are meant to lie in it, as a share of the largest
    /// coordinate, at most 0.01; marks no deeper are taken for rounding. Less than 9e-16 counts as
    /// that: planes are not known more finely [default: from how finely its coordinates are stored,
    /// which a mesh that was turned since does not show]
    #[arg(long, value_name = "SHARE", value_parser = flat, allow_hyphen_values = true)]
    pub(crate) flat: Option<f64>,

    /// Draw the mesh; the report says what the colours mean
    #[arg(long, value_name = "OUT.png")]
    pub(crate) render: Option<PathBuf>,

    /// What the picture shows: classes, patches, boxes:LEVEL, envelope:DEPTH or findings (see
    /// below) [default: classes]
    #[arg(long, value_name = "WHAT", value_parser = show, requires = "render")]
    pub(crate) show: Option<Show>,

    /// Which axis points up in the picture [default: y for glTF, whose own rule that is; z for all
    /// others]
    #[arg(long, value_enum, value_name = "AXIS", requires = "render")]
    pub(crate) up: Option<Up>,

    /// Cut the body open in the picture: across this axis of the mesh, through the middle of its
    /// box
    #[arg(long, value_enum, value_name = "AXIS", requires = "render")]
    pub(crate) cut: Option<CutAxis>,

    /// Save the prepared model; `query` and `inspect` load it in place of the mesh, without
    /// preparing it again
    #[arg(long, value_name = "MODEL.cranny")]
    pub(crate) save: Option<PathBuf>,
}

const INSPECT_NOTES: &str = "\
A mesh with open edges is accepted; it is a surface then, without inside, volume or depth.

Repairs. Whatever the policy, vertices in exactly the same place are welded, unused ones dropped, and
a closed mesh that is inside out is turned.
  none  nothing else
  safe  keeps the surface within the weld distance, and proves it: cracks and T-vertices are closed,
        faces without area or filed twice dropped, faces that look the wrong way turned
  full  safe, and shells in shells become cavities, double faces within the solid are dropped
Holes are never filled. Findings are those that remain.

Concavities are what the hull covers and the body does not fill. A pocket has one lid, a passage
several (a through-hole; also notches that share an edge), a void none; an island is a piece inside
another's pocket; an opening has a lid and no faces beneath: the mesh is open there, or filed twice. With --format json all are listed, by id:
  faces, loops, lids  how many; loops are its rims
  cap_area, area      of its lids together, and of its faces
  pocket_volume       between them; negative for an island; null where volumes_unknown says why
  parent              what surrounds one without a lid, or null
  tree_nodes          boxes of its tree; envelope_layers, envelope_depth, envelope_facets likewise
Lengths are in the unit of the file, points in its frame; docs/inspect.md explains every key.
skin_volume is what else lies between hull and body, pockets as thin as rounding; skin_area what the hull
has more there than the body. flatness is the share of the largest coordinate that counted as rounding:
see --flat.
bytes is the size of the saved model, null without --save. Of a saved model that is inspected,
filed_vertices, filed_faces, deviation and repairs are null: it does not say; --repair, --weld
and --flat need the mesh.

Pictures:
  classes         on the hull grey; concavities in colours, their caps amber, loops dark
  patches         the surface's patches; neighbours differ in colour
  boxes:LEVEL     the boxes of a level of the concavities' trees, from 0, the roots
  envelope:DEPTH  the layers of the concavities' envelopes at a depth, from 0, the first below the cap; each
                  face in the colour of the facet that it lies beneath
  findings        the faces concerned, and a dot at each
In all of them, open edges are red, edges of more than two faces violet, and edges along which the
faces' orientations contradict orange.

Examples:
  cranny inspect nut.obj
  cranny inspect nut.obj --repair safe --weld 2e-6
  cranny inspect nut.obj --save nut.cranny
  cranny inspect house.glb --render house.png
  cranny inspect teapot.obj --render teapot.png --up y
  cranny inspect cup.obj --render cup.png --show envelope:0 --cut z
  cranny inspect nut.obj --format json";

/// What may be mended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RepairArg {
    /// The surface stays as filed
    None,
    /// What keeps the surface within the weld distance
    Safe,
    /// `safe`, and what changes the solid inside
    Full,
}

impl From<RepairArg> for Repair {
    fn from(policy: RepairArg) -> Self {
        match policy {
            RepairArg::None => Self::None,
            RepairArg::Safe => Self::Safe,
            RepairArg::Full => Self::Full,
        }
    }
}

fn weld(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        Ok(_) => {
            Err("a weld distance is not below 0, and at most a hundredth of the mesh's diagonal"
                .to_owned())
        }
        Err(_) => Err("a weld distance is a number, such as 1e-6".to_owned()),
    }
}

fn flat(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.01).contains(&value) => Ok(value),
        Ok(_) => Err("a flatness is a share from 0 to 0.01".to_owned()),
        Err(_) => Err("a flatness is a number, such as 2e-6".to_owned()),
    }
}

fn budget(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a budget is a whole number of tests from 0 to {}", u64::MAX))
}

/// Reads a level of accuracy.
pub(crate) fn level(text: &str) -> Result<Accuracy, String> {
    match text.split_once(':') {
        None => match text {
            "boxes" => Ok(Accuracy::Boxes),
            "hulls" => Ok(Accuracy::Hulls),
            "caps" => Ok(Accuracy::Caps),
            "exact" => Ok(Accuracy::Exact),
            "tree" => Err("how deep? Say tree:8, or another depth".to_owned()),
            _ => Err("choose boxes, hulls, caps, tree:DEPTH or exact".to_owned()),
        },
        Some(("tree", depth)) => depth
            .parse()
            .map(Accuracy::Tree)
            .map_err(|_| "a depth is a number from 0 to 255, as in tree:8".to_owned()),
        Some(_) => {
            Err("only tree has a depth; choose boxes, hulls, caps, tree:DEPTH or exact".to_owned())
        }
    }
}

/// Reads a budget of a step, which may be lifted.
fn step_budget(text: &str) -> Result<StepBudget, String> {
    match text {
        "unlimited" => Ok(StepBudget(None)),
        _ => text.parse().map(|tests| StepBudget(Some(tests))).map_err(|_| {
            format!(
                "a budget is a whole number of tests a step from 0 to {}, or unlimited",
                u64::MAX
            )
        }),
    }
}

fn scale(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value != 0.0 => Ok(value),
        Ok(_) => Err("a scale must be finite and not 0".to_owned()),
        Err(_) => Err("a scale is a number, such as 0.001".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn levels_and_scales_are_checked() {
        assert_eq!(step_budget("2000"), Ok(StepBudget(Some(2000))));
        assert_eq!(step_budget("unlimited"), Ok(StepBudget(None)));
        for text in ["-1", "1.5", "none", ""] {
            assert!(step_budget(text).unwrap_err().contains("or unlimited"), "{text:?}");
        }
        assert_eq!(level("caps"), Ok(Accuracy::Caps));
        assert_eq!(
            (level("tree:0"), level("tree:255")),
            (Ok(Accuracy::Tree(0)), Ok(Accuracy::Tree(255)))
        );
        for (text, reason) in [
            ("tree", "how deep"),
            ("tree:256", "0 to 255"),
            ("tree:-1", "0 to 255"),
            ("hulls:2", "only tree"),
            ("perfect", "choose"),
            ("", "choose"),
        ] {
            assert!(level(text).unwrap_err().contains(reason), "{text}");
        }
        assert_eq!(scale("-0.5"), Ok(-0.5));
        for text in ["0", "inf", "NaN", "two", ""] {
            assert!(scale(text).is_err(), "{text}");
        }
        assert_eq!((flat("0"), flat("2e-6")), (Ok(0.0), Ok(2e-6)));
        for text in ["-1e-9", "0.02", "inf", "NaN", "flat"] {
            assert!(flat(text).is_err(), "{text}");
        }
        assert_eq!((weld("0"), weld("2e-6")), (Ok(0.0), Ok(2e-6)));
        for text in ["-1", "inf", "NaN", "two", ""] {
            assert!(weld(text).is_err(), "{text}");
        }
    }
}
