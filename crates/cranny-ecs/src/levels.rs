//! Levels and budgets that mean something: triggers and distances can be known at a level, and what
//! needs exact contacts cannot.

use cranny_world::description::{Accuracy, Effect, SceneDescription};

use crate::error::SceneAppError;

/// Fails where a scene states a level or a budget that would change nothing.
///
/// # Errors
///
/// [`SceneAppError::NotAtLevel`], [`SceneAppError::NoLevels`].
pub(crate) fn check_levels(scene: &SceneDescription) -> Result<(), SceneAppError> {
    let has_sensors = scene.bodies.iter().any(|body| body.sensor);
    let has_levels = scene.all_effects().any(Effect::has_levels);
    for what in of_all(scene.accuracy, scene.budget) {
        if !has_levels {
            return Err(SceneAppError::NoLevels { what });
        }
        unless_exact(what, scene.effects.iter(), has_sensors)?;
    }
    let owner = || "the scene".to_owned();
    check_stated(owner, &scene.effects, scene.effects.iter(), has_sensors)?;
    for body in &scene.bodies {
        let all = scene.effects.iter().chain(&body.effects);
        let owner = || format!("body '{}'", body.name);
        check_stated(owner, &body.effects, all, has_sensors)?;
    }
    for pair in &scene.pairs {
        let owner = || format!("the pair '{}' and '{}'", pair.a, pair.b);
        let ends = || scene.bodies.iter().filter(|body| [&pair.a, &pair.b].contains(&&body.name));
        let of_ends = ends().flat_map(|body| &body.effects);
        let all = scene.effects.iter().chain(of_ends).chain(&pair.effects);
        let sensor = ends().any(|body| body.sensor);
        if let Some(level) = pair.accuracy {
            let what = format!("`accuracy: {:?}` of {}", level, owner());
            if !all.clone().any(Effect::has_levels) {
                return Err(SceneAppError::NoLevels { what });
            }
            if level != Accuracy::Exact {
                unless_exact(what, all.clone(), sensor)?;
            }
        }
        check_stated(owner, &pair.effects, all, sensor)?;
    }
    Ok(())
}

/// The same of an app whose bodies are yet to come: its effects of all bodies must not need exact
/// contacts, unless sensors may come.
///
/// # Errors
///
/// [`SceneAppError::NotAtLevel`].
pub(crate) fn check_app_levels(
    effects: &[Effect],
    accuracy: Accuracy,
    budget: Option<u64>,
) -> Result<(), SceneAppError> {
    for what in of_all(accuracy, budget) {
        unless_exact(what, effects.iter(), true)?;
    }
    check_stated(|| "the app".to_owned(), effects, effects.iter(), true)
}

/// What a scene states for all its pairs, in words.
fn of_all(accuracy: Accuracy, budget: Option<u64>) -> impl Iterator<Item = String> {
    let level = (accuracy != Accuracy::Exact).then(|| format!("`accuracy: {accuracy:?}`"));
    level.into_iter().chain(budget.map(|budget| format!("`budget: {budget}`")))
}

/// Fails where one of an owner's effects states a level, and another effect of all its pairs needs
/// exact contacts.
fn check_stated<'a>(
    owner: impl Fn() -> String,
    own: &[Effect],
    all: impl Iterator<Item = &'a Effect>,
    sensor: bool,
) -> Result<(), SceneAppError> {
    let coarse = own.iter().find_map(|effect| {
        effect.stated_level().filter(|level| *level != Accuracy::Exact).map(|level| (effect, level))
    });
    coarse.map_or(Ok(()), |(effect, level)| {
        let what = format!("`{}(accuracy: {level:?})` of {}", effect.name(), owner());
        unless_exact(what, all, sensor)
    })
}

fn unless_exact<'a>(
    what: String,
    mut effects: impl Iterator<Item = &'a Effect>,
    sensor: bool,
) -> Result<(), SceneAppError> {
    let needs_contacts = |effect: &&Effect| !(effect.has_levels() || sensor && effect.pushes());
    match effects.find(needs_contacts) {
        Some(effect) => Err(SceneAppError::NotAtLevel { what, effect: effect.name() }),
        None => Ok(()),
    }
}

/// Levels in words, the coarsest first: "hulls, exact".
pub(crate) fn in_words(levels: &[Accuracy]) -> String {
    levels.iter().map(Accuracy::to_string).collect::<Vec<_>>().join(", ")
}
