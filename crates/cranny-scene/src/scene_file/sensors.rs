//! Sensors that nothing reads.

use cranny_world::description::{BodyDescription, Effect, SceneDescription};

/// A warning of each sensor whose pairs have no effect that works without a solver.
pub(super) fn unread(scene: &SceneDescription) -> Vec<String> {
    let sensors = scene.bodies.iter().enumerate().filter(|(_, body)| body.sensor);
    let unread = sensors.filter(|&(index, _)| !is_read(scene, index));
    let warning = |(_, BodyDescription { name, .. }): (usize, &BodyDescription)| {
        format!(
            "body {name:?} is a sensor, and no effect of its pairs reads it: it pushes nothing and nobody hears of it. Name Trigger(), Contacts(...) or another effect of contacts for it"
        )
    };
    unread.map(warning).collect()
}

fn is_read(scene: &SceneDescription, sensor: usize) -> bool {
    let body = &scene.bodies[sensor];
    let by_others = scene.bodies.iter().enumerate().any(|(other, partner)| {
        other != sensor && reads(&partner.effects) && may_meet(scene, [sensor, other])
    });
    let mut pairs = scene.pairs.iter().filter(|pair| [&pair.a, &pair.b].contains(&&body.name));
    reads(&scene.effects) || reads(&body.effects) || by_others || pairs.any(|p| reads(&p.effects))
}

fn reads(effects: &[Effect]) -> bool {
    effects.iter().any(|effect| !effect.pushes())
}

/// Whether neither layers nor a pair keeps two bodies apart.
pub(super) fn may_meet(scene: &SceneDescription, [a, b]: [usize; 2]) -> bool {
    let [layers_a, layers_b] = [a, b].map(|index| &scene.bodies[index].layers);
    let excluded = scene.excluded_pairs.iter().any(|&pair| pair == (a.min(b), a.max(b)));
    !excluded && layers_a.iter().any(|layer| layers_b.contains(layer))
}
