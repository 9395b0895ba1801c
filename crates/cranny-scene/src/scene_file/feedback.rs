//! Force feedback that nobody feels.

use cranny_world::description::{BodyKind, Effect, SceneDescription};

use super::sensors::may_meet;

/// A warning of each `ForceFeedback` none of whose pairs has a kinematic body.
pub(super) fn unfelt(scene: &SceneDescription) -> Vec<String> {
    let feels = |body: usize| scene.bodies[body].kind == BodyKind::Kinematic;
    let all = || 0..scene.bodies.len();
    let mut owners = Vec::new();
    if named(&scene.effects) && !all().any(feels) {
        owners.push("the scene".to_owned());
    }
    for (index, body) in scene.bodies.iter().enumerate().filter(|(_, body)| named(&body.effects)) {
        let mut partners = all().filter(|&other| other != index && may_meet(scene, [index, other]));
        if !feels(index) && !partners.any(feels) {
            owners.push(format!("body {:?}", body.name));
        }
    }
    for pair in scene.pairs.iter().filter(|pair| named(&pair.effects)) {
        let is_end = |index: &usize| [&pair.a, &pair.b].contains(&&scene.bodies[*index].name);
        if !all().filter(is_end).any(feels) {
            owners.push(format!("the pair {:?} and {:?}", pair.a, pair.b));
        }
    }
    let warning = |owner: String| {
        format!(
            "{owner} names ForceFeedback, which only Kinematic bodies feel, and none can meet it. Make one Kinematic, or take the effect out"
        )
    };
    owners.into_iter().map(warning).collect()
}

fn named(effects: &[Effect]) -> bool {
    effects.iter().any(|effect| matches!(effect, Effect::ForceFeedback { .. }))
}
