//! Bodies that can meet nothing, as their layers are spelt.

use std::collections::BTreeMap;

use cranny_world::description::{BodyDescription, SceneDescription};

/// Layers that a warning lists.
const LISTED: usize = 8;

/// A warning of each body that shares no layer with any other, in a scene of several bodies.
pub(super) fn alone(scene: &SceneDescription) -> Vec<String> {
    let mut members: BTreeMap<&str, usize> = BTreeMap::new();
    for body in &scene.bodies {
        let mut layers: Vec<&str> = body.layers.iter().map(String::as_str).collect();
        layers.sort_unstable();
        layers.dedup();
        layers.into_iter().for_each(|layer| *members.entry(layer).or_default() += 1);
    }
    let is_alone = |body: &&BodyDescription| {
        scene.bodies.len() > 1 && body.layers.iter().all(|layer| members[layer.as_str()] < 2)
    };
    scene.bodies.iter().filter(is_alone).map(|body| warning(body, &members)).collect()
}

fn warning(body: &BodyDescription, members: &BTreeMap<&str, usize>) -> String {
    let others = members.keys().filter(|layer| !body.layers.iter().any(|own| own == *layer));
    let known: Vec<String> = others.take(LISTED).map(|layer| format!("{layer:?}")).collect();
    let known = match known.is_empty() {
        true => String::new(),
        false => format!(" Layers of other bodies are {}.", known.join(", ")),
    };
    let BodyDescription { name, layers, .. } = body;
    format!(
        "body {name:?} shares no layer with any other body, so it meets nothing: its layers are {layers:?}.{known}"
    )
}
