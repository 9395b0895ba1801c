//! `cranny robot`: a robot file described, or its links checked against each other.

mod configuration_file;
mod description;
mod picture;

use std::fmt::Display;
use std::path::Path;
use std::time::Instant;

use cranny_ecs::check_outputs;
use cranny_primitives::BodyShape;
use cranny_scene::robot::{RobotJoint, Semantics, read_robot, read_semantics};
use cranny_scene::{Robot, RobotError};
use cranny_world::description::{JointKind, JointPositions};
use cranny_world::{Arranged, Arrangement, Wanted};
use serde::Serialize;

use crate::args::{Format, RobotArgs};
use crate::failure::Failure;
use crate::output::Output;
use crate::paths::{check_input, check_output, read_text};
use crate::picture::{Drawing, PictureView, Trouble, draw};
use crate::progress;
use configuration_file::{named, read_configurations};
use description::Description;

/// Pairs that a warning lists.
const LISTED: usize = 8;

/// What is found at a configuration.
#[derive(Debug, Serialize)]
struct ConfigurationLine<'a> {
    configuration: usize,
    hits: Vec<[&'a str; 2]>,
    distance: Option<f64>,
    pair: Option<[&'a str; 2]>,
    micros: f64,
}

/// Runs the command.
///
/// # Errors
///
/// Wrong files or options; standard output that cannot be written.
pub(crate) fn robot(args: &RobotArgs, format: Option<Format>) -> Result<(), Failure> {
    check_input("robot file", &args.urdf)?;
    refuse_srdf(&args.urdf)?;
    if let Some(path) = &args.render {
        let inputs = [Some(&args.urdf), args.configurations.as_ref(), args.srdf.as_ref()];
        let inputs: Vec<&Path> = inputs.into_iter().flatten().map(|path| &**path).collect();
        check_outputs(&[path], &inputs).map_err(Failure::input)?;
        check_output("--render", path, &["png"])?;
    }
    // Short files first: a mistake in them is reported before meshes are read.
    let configurations = args.configurations.as_deref().map(read_configurations).transpose()?;
    let semantics = args.srdf.as_deref().map(read_srdf).transpose()?.unwrap_or_default();
    let mut robot = read_robot(&args.urdf).map_err(|error| refused(&error))?;
    let drawn = robot.collide_as_drawn();
    let mut warnings = warnings(args, &robot, &semantics, drawn)?;
    let pairs = checked_pairs(args, &robot, &semantics)?;
    let shapes = robot
        .link_shapes()
        .map_err(|error| Failure::input(format!("robot file {}: {error}", args.urdf.display())))?;
    if configurations.is_some() {
        // Search trees are part of preparing, and no configuration's time.
        shapes.iter().flatten().filter_map(BodyShape::model).for_each(|model| {
            model.clusters();
        });
    }
    warnings.extend(always_meeting(args, &robot, &shapes, &pairs)?);
    let mut checked = Arrangement::new(shapes, pairs);
    let Some(configurations) = configurations else {
        let mut description = Description::of(&args.urdf, &robot, &checked);
        description.notes.extend(warnings);
        let pictured = render(args, &robot, &mut checked, &JointPositions::new());
        description.notes.extend(pictured.as_ref().ok().cloned().flatten());
        let mut output = Output::new();
        match format.unwrap_or(Format::Text) {
            Format::Json => output.json(&description)?,
            Format::Text => output.line(&description.text())?,
        }
        return pictured.map(|_| ());
    };
    for note in &robot.notes {
        tracing::info!("{note}");
    }
    for warning in warnings {
        tracing::warn!("{warning}");
    }
    if checked.pairs().len() == 0 {
        tracing::warn!("no pair of links is checked: none can meet at any configuration");
    }
    let drawn = configurations.get(args.at).ok_or_else(|| {
        let last = configurations.len() - 1;
        Failure::input(format!(
            "--at {}: the last configuration is {last}. Name one up to it.",
            args.at
        ))
    })?;
    check(args, &robot, &mut checked, &configurations, format.unwrap_or(Format::Json))?;
    render(args, &robot, &mut checked, drawn).map(|_| ())
}

/// Fails if the file says by its name that it is the semantics of a robot.
fn refuse_srdf(path: &Path) -> Result<(), Failure> {
    let is_srdf = path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("srdf"));
    match is_srdf {
        false => Ok(()),
        true => Err(Failure::input(format!(
            "robot file {}: by its name it is an SRDF file. Name the URDF, and this one with --srdf.",
            path.display()
        ))),
    }
}

/// Draws a configuration, where a picture is wanted; returns what is to be said of it.
fn render(
    args: &RobotArgs,
    robot: &Robot,
    links: &mut Arrangement,
    positions: &JointPositions,
) -> Result<Option<String>, Failure> {
    let Some(path) = &args.render else { return Ok(None) };
    let wrong =
        |what: &dyn Display| Failure::input(format!("robot file {}: {what}", args.urdf.display()));
    let mut positions = positions.clone();
    robot.clamp_to_limits(&mut positions);
    let poses = robot.forward_kinematics(&positions).map_err(|error| wrong(&error))?;
    let found = links.at(&poses, Wanted::Meeting).map_err(|error| wrong(&error))?;
    let drawn = || {
        let list = picture::draw_list(robot, &poses, &found.meeting)?;
        Ok(Drawing { views: vec![PictureView::of(list)], ..Drawing::default() })
    };
    match draw(path, drawn) {
        Ok(()) => Ok(Some(format!("drawn: {}", path.display()))),
        Err(Trouble::NoGraphics(why)) => {
            tracing::warn!("no picture: {why}");
            Ok(Some(format!("not drawn: {}: {why}", path.display())))
        }
        Err(Trouble::Failed(failure)) => Err(failure),
    }
}

/// Prints a line for each configuration.
fn check(
    args: &RobotArgs,
    robot: &Robot,
    links: &mut Arrangement,
    configurations: &[JointPositions],
    format: Format,
) -> Result<(), Failure> {
    let wanted = if args.distance { Wanted::Nearest } else { Wanted::Meeting };
    let wrong = |index: usize, what: &dyn Display| {
        let file = named(args.configurations.as_deref().unwrap_or(Path::new("")));
        Failure::input(format!("{file}: configuration {index}: {what}"))
    };
    // All of them first: nothing is printed of a file that is wrong farther down.
    let poses = configurations.iter().enumerate().map(|(index, positions)| {
        let mut positions = positions.clone();
        robot.clamp_to_limits(&mut positions);
        robot.forward_kinematics(&positions).map_err(|error| wrong(index, &error))
    });
    let poses = poses.collect::<Result<Vec<_>, _>>()?;
    let mut output = Output::new();
    let bar = progress::bar(poses.len() as u64, "checking");
    for (index, poses) in poses.iter().enumerate() {
        let start = Instant::now();
        let found = links.at(poses, wanted).map_err(|error| wrong(index, &error))?;
        let line =
            ConfigurationLine::of(index, robot, &found, start.elapsed().as_nanos() as f64 / 1e3);
        match format {
            Format::Json => output.json(&line),
            Format::Text => output.line(&line.text()),
        }?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(())
}

impl<'a> ConfigurationLine<'a> {
    fn of(configuration: usize, robot: &'a Robot, found: &Arranged, micros: f64) -> Self {
        let named = |(a, b): (usize, usize)| {
            let mut names = [a, b].map(|link| robot.links[link].name.as_str());
            names.sort_unstable();
            names
        };
        let mut hits: Vec<_> = found.meeting.iter().map(|&pair| named(pair)).collect();
        hits.sort_unstable();
        let nearest = found.nearest;
        Self {
            configuration,
            hits,
            distance: nearest.map(|nearest| nearest.distance),
            pair: nearest.map(|nearest| named(nearest.pair)),
            micros,
        }
    }

    fn text(&self) -> String {
        let Self { configuration, hits, distance, pair, micros } = self;
        let mut parts = vec![format!("{configuration:5}")];
        parts.push(match hits.as_slice() {
            [] => "no links meet".to_owned(),
            hits => {
                let names: Vec<_> = hits.iter().map(|[a, b]| format!("{a} - {b}")).collect();
                names.join(", ")
            }
        });
        if let (Some(distance), Some([a, b])) = (distance, pair) {
            parts.push(format!("nearest {distance:.6} ({a} - {b})"));
        }
        parts.push(format!("{micros:.1} us"));
        parts.join("  ")
    }
}

fn read_srdf(path: &Path) -> Result<Semantics, Failure> {
    let text = read_text("SRDF file", path)?;
    read_semantics(&text).map_err(|problem| wrong_srdf(path, &problem))
}

/// Pairs of links that are checked. Of a group: those of which it moves at least one.
fn checked_pairs(
    args: &RobotArgs,
    robot: &Robot,
    semantics: &Semantics,
) -> Result<Vec<(usize, usize)>, Failure> {
    let mut pairs = robot.checked_pairs(&semantics.disabled_pairs);
    let (Some(name), Some(file)) = (&args.group, &args.srdf) else { return Ok(pairs) };
    let group = semantics.group_of(robot, name).map_err(|problem| wrong_srdf(file, &problem))?;
    let moved = group.moved_links(robot);
    pairs.retain(|(a, b)| moved.contains(a) || moved.contains(b));
    if pairs.is_empty() {
        return Err(Failure::input(format!(
            "SRDF file {}: the group {name:?} moves no pair of links that is checked: a joint joins them, the file disables them, or they have no collision geometry. Name another group, or leave --group out.",
            file.display()
        )));
    }
    Ok(pairs)
}

/// What somebody should know of the files before configurations are checked.
fn warnings(
    args: &RobotArgs,
    robot: &Robot,
    semantics: &Semantics,
    drawn: bool,
) -> Result<Vec<String>, Failure> {
    let stands_for = "no link has collision geometry: the visual meshes stand for it";
    let mut warnings: Vec<String> = drawn.then(|| stands_for.to_owned()).into_iter().collect();
    if let Some(file) = &args.srdf {
        warnings.extend(semantics.misfits(robot).map_err(|problem| wrong_srdf(file, &problem))?);
    }
    Ok(warnings)
}

/// That links meet which fixed joints hold together: they do so at every configuration.
fn always_meeting(
    args: &RobotArgs,
    robot: &Robot,
    shapes: &[Option<BodyShape>],
    pairs: &[(usize, usize)],
) -> Result<Option<String>, Failure> {
    let above = |link: usize| {
        let is_above = |joint: &&RobotJoint| joint.child == link && joint.kind == JointKind::Fixed;
        robot.joints.iter().find(is_above).map(|joint| joint.parent)
    };
    let top = |link: usize| std::iter::successors(Some(link), |&link| above(link)).last();
    let tops: Vec<Option<usize>> = (0..robot.links.len()).map(top).collect();
    let rigid: Vec<_> = pairs.iter().copied().filter(|&(a, b)| tops[a] == tops[b]).collect();
    if rigid.is_empty() {
        return Ok(None);
    }
    let wrong =
        |what: &dyn Display| Failure::input(format!("robot file {}: {what}", args.urdf.display()));
    let poses = robot.forward_kinematics(&JointPositions::new()).map_err(|error| wrong(&error))?;
    let found = Arrangement::new(shapes.to_vec(), rigid).at(&poses, Wanted::Meeting);
    let meeting = found.map_err(|error| wrong(&error))?.meeting;
    let names =
        |&(a, b): &(usize, usize)| format!("{} - {}", robot.links[a].name, robot.links[b].name);
    let mut listed: Vec<String> = meeting.iter().take(LISTED).map(names).collect();
    if meeting.len() > LISTED {
        listed.push(format!("{} more", meeting.len() - LISTED));
    }
    let count = match meeting.len() {
        0 => return Ok(None),
        1 => "1 pair of links meets".to_owned(),
        count => format!("{count} pairs of links meet"),
    };
    let advice = if args.srdf.is_some() {
        "Disable them in the SRDF file"
    } else {
        "Name an SRDF file that disables them (--srdf)"
    };
    Ok(Some(format!(
        "{count} at every configuration, since fixed joints hold them together: {}. {advice}",
        listed.join(", ")
    )))
}

fn wrong_srdf(file: &Path, problem: &str) -> Failure {
    Failure::input(format!("SRDF file {}: {problem}.", file.display()))
}

fn refused(error: &RobotError) -> Failure {
    match error {
        RobotError::Unreadable { source, .. } => Failure::unreadable(error, source.kind()),
        _ => Failure::input(error),
    }
}
