//! `cranny explain`: what a scene runs, read from the schedule that its plugins build.

use std::fmt::Write;

use cranny_ecs::{ContactFields, Plan, PlannedPairs, PluginOptions, RunOptions, SceneApp};
use serde::Serialize;

use crate::args::{ExplainArgs, Format};
use crate::failure::Failure;
use crate::output::Output;
use crate::run::of_flags;
use crate::scene_file::load;
use crate::words::counted;

/// The plan of a scene under its name.
#[derive(Debug, Serialize)]
struct Explanation<'a> {
    version: u32,
    scene: &'a str,
    bodies: usize,
    #[serde(flatten)]
    plan: &'a Plan,
}

/// Runs the command.
///
/// # Errors
///
/// A scene that cannot be read, is wrong, or cannot be composed.
pub(crate) fn explain(args: &ExplainArgs, format: Option<Format>) -> Result<(), Failure> {
    let scene = load(&args.scene, &args.set.load_options(None))?;
    // As `cranny run` runs it.
    let plugins = PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() };
    let options = RunOptions {
        plugins,
        accuracy: args.effort.accuracy,
        budget: args.effort.budget.map(|budget| budget.0),
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene.description, &options)
        .map_err(|error| of_flags(&args.effort, error))?;
    let plan = app.plan().map_err(Failure::run)?;
    let (name, bodies) = (&*scene.description.name, scene.description.bodies.len());
    let mut output = Output::new();
    match format.unwrap_or(Format::Text) {
        Format::Json => output.json(&Explanation { version: 1, scene: name, bodies, plan: &plan }),
        Format::Text => output.line(&text(name, bodies, &plan)),
    }
}

/// The plan for people.
fn text(scene: &str, bodies: usize, plan: &Plan) -> String {
    let mut out = format!("scene {scene}: {}", counted(bodies, "body"));
    let mut add = |line: String| {
        out.push('\n');
        out.push_str(&line);
    };
    let budget = plan.budget.map_or(String::new(), |tests| {
        format!(" ({tests} tests a step for those of which triggers and distances alone are asked)")
    });
    add(format!("\npairs{budget}"));
    plan.pairs.iter().for_each(|group| add(pairs(group)));
    add("\neffects".to_owned());
    if plan.effects.is_empty() {
        add("  none".to_owned());
    }
    for effect in &plan.effects {
        add(format!("  {}: named by {}", effect.name, effect.asked_by.join(", ")));
        effect.read_by.iter().for_each(|reader| add(format!("      {reader}")));
    }
    for schedule in &plan.schedules {
        add(format!("\n{}, in this order", schedule.name));
        for (number, system) in schedule.systems.iter().enumerate() {
            let number = number + 1;
            let sets = system.sets.join(", ");
            add(format!("  {number:>2}  {:<34} {sets}", system.name));
        }
    }
    add("\nabsent: no system, component, message or resource of".to_owned());
    for effect in &plan.absent {
        add(format!("  {}: {}", effect.name, effect.why));
    }
    out
}

fn pairs(group: &PlannedPairs) -> String {
    let wanted =
        if group.effects.is_empty() { "nothing".to_owned() } else { group.effects.join(", ") };
    let mut line =
        format!("  {}: {wanted}, detected by {} ({})", group.count, group.detected_by, group.why);
    if !group.fields.is_empty() {
        let level = group.accuracy.as_ref().map_or(String::new(), |level| format!("; at {level}"));
        // Writing to a string cannot fail.
        let _ = write!(line, "\n      computed: {}{level}", group.fields.join(", "));
        let _ = write!(line, "\n      {}", group.read_by.join("; "));
    }
    let named: Vec<String> = group.examples.iter().map(|[a, b]| format!("{a} and {b}")).collect();
    let more = if group.count > named.len() { ", ..." } else { "" };
    // Writing to a string cannot fail.
    let _ = write!(line, "\n      {}{more}", named.join(", "));
    line
}
