//! Arguments of `cranny robot`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `cranny robot`.
#[derive(Debug, Args)]
#[command(after_help = ROBOT_NOTES)]
pub(crate) struct RobotArgs {
    /// Robot file; its meshes are looked for as ROS does (`package://`, `ROS_PACKAGE_PATH`)
    #[arg(value_name = "URDF")]
    pub(crate) urdf: PathBuf,

    /// List of configurations, `[{"joint": position, ...}, ...]`: a line for each is printed
    /// instead of the description (see below). `-` reads them from standard input
    #[arg(long, value_name = "Q.json")]
    pub(crate) configurations: Option<PathBuf>,

    /// Semantic description: pairs of links that its `disable_collisions` names are not checked. A
    /// file of another robot is refused; single links and joints that this one lacks are warned of
    #[arg(long, value_name = "ROBOT.srdf")]
    pub(crate) srdf: Option<PathBuf>,

    /// Checks only pairs that a group of the SRDF file moves: those with a link of the group, or
    /// with one that hangs from its joints. A group without such pairs is refused
    #[arg(long, value_name = "NAME", requires = "srdf")]
    pub(crate) group: Option<String>,

    /// The least distance between two links as well
    #[arg(long, requires = "configurations")]
    pub(crate) distance: bool,

    /// Draw the robot as it collides; links that meet are red, with their names. Of
    /// --configurations the first is drawn, or the one that --at names
    #[arg(long, value_name = "OUT.png")]
    pub(crate) render: Option<PathBuf>,

    /// The configuration that is drawn, from 0
    #[arg(
        long,
        value_name = "N",
        requires = "render",
        requires = "configurations",
        default_value = "0"
    )]
    pub(crate) at: usize,
}

const ROBOT_NOTES: &str = r#"Without --configurations: links, joints, masses, the pairs of links that are checked, and what was mended
or stands in for what is missing.

Configurations: radians, or metres for prismatic joints. A joint that is not named is at 0, or at the
limit that is nearer to 0; one that follows another (mimic) follows it and is not named. Limits are not
enforced: recorded robots exceed them.

Output with --configurations: one JSON object a line for each configuration, in order:
  configuration   index from 0
  hits            pairs of links that touch or overlap, or one of which lies inside the other, by name:
                  of all pairs but those that a joint joins and those that the SRDF disables;
                  with --group, of those pairs that the group moves, as MoveIt checks a group.
                  Links that fixed joints hold together by way of a third link are among them; those of
                  them that meet do so at every configuration, and a warning names them
  distance        least distance of two such links, 0 where some meet; null without --distance, or
                  where there is no pair to check
  pair            the links that are so near
  micros          time of the checks alone, without reading and preparing

A link whose only collision geometry is a box, a sphere, a cylinder or a capsule is checked exactly as that.
Of a link with several, the round ones are checked as meshes inscribed in them, of 32 sides.
Links without collision geometry take no part; where no link has any, visual meshes stand for it.

Examples:
  cranny robot panda.urdf
  echo '[{}, {"panda_joint2": 1.2}]' | cranny robot panda.urdf --configurations -
  cranny robot panda.urdf --configurations q.json --srdf panda.srdf --distance
  cranny robot panda.urdf --configurations q.json --srdf panda.srdf --group hand
  cranny robot panda.urdf --configurations q.json --render panda.png --at 1"#;
