//! What a scene file's generators say beyond their triangles: threads whose screw motion is worth
//! following, rings that may be linked.

use cranny_scene::LoadedScene;
use cranny_shapes::Shape;
use ron::extensions::Extensions;
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::links::Ring;
use crate::motion::Helix;

/// Of a scene file only what is looked for; everything else is skipped.
#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    bodies: Vec<GeneratedBody>,
}

#[derive(Deserialize)]
struct GeneratedBody {
    name: String,
    shape: GeneratedShape,
}

#[derive(Deserialize)]
enum GeneratedShape {
    Generator(Shape),
    Mesh {},
    Primitive(IgnoredAny),
}

/// The generated bodies of the scene and of what it includes.
fn bodies(scene: &LoadedScene) -> Vec<GeneratedBody> {
    let texts = scene.included_texts.iter().chain([&scene.source_text]);
    texts.flat_map(|text| bodies_of(text)).collect()
}

/// Those of a file, if its text can be read as a scene of such.
fn bodies_of(text: &str) -> Vec<GeneratedBody> {
    let extensions = Extensions::UNWRAP_VARIANT_NEWTYPES | Extensions::IMPLICIT_SOME;
    let options = ron::Options::default().with_default_extension(extensions);
    // The text was parsed in full when the scene was loaded. What cannot be read as this excerpt
    // is no scene of generated bodies.
    options.from_str(text).map_or_else(|_| Vec::new(), |scene: Scene| scene.bodies)
}

/// Each generated ISO nut with each generated ISO bolt of equal pitch. A nut has its thread about z
/// through its origin, as has a bolt.
#[must_use]
pub fn helices(scene: &LoadedScene) -> Vec<Helix> {
    let bodies = bodies(scene);
    let mut helices = Vec::new();
    for bolt in &bodies {
        let GeneratedShape::Generator(Shape::IsoBolt(outer)) = &bolt.shape else { continue };
        for nut in &bodies {
            let GeneratedShape::Generator(Shape::IsoNut(inner)) = &nut.shape else { continue };
            if inner.pitch == outer.pitch {
                let (bolt, nut) = (bolt.name.clone(), nut.name.clone());
                helices.push(Helix { bolt, nut, pitch: outer.pitch });
            }
        }
    }
    helices
}

/// The centre circle of each generated torus: it lies about z around the origin.
#[must_use]
pub fn rings(scene: &LoadedScene) -> Vec<Ring> {
    let ring = |body: GeneratedBody| match body.shape {
        GeneratedShape::Generator(Shape::Torus(torus)) => {
            Some(Ring { body: body.name, radius: torus.major_radius })
        }
        _ => None,
    };
    bodies(scene).into_iter().filter_map(ring).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_scene::{LoadOptions, parse_scene};

    fn loaded(text: &str) -> LoadedScene {
        parse_scene(text.to_owned(), "scene.ron".as_ref(), &LoadOptions::default()).unwrap()
    }

    #[test]
    fn nuts_find_bolts_of_their_pitch() {
        let text = r#"(gravity: (0, 0, -1), bodies: [
            (name: "bolt", shape: Generator(IsoBolt(diameter: 16, pitch: 2, segments: 24)), kind: Fixed),
            (name: "nut", shape: Generator(IsoNut(diameter: 16, pitch: 2, segments: 24)),
             pose: (at: (0, 0, 20)), material: (friction: 0)),
            (name: "other", shape: Generator(IsoNut(diameter: 16, pitch: 1.5, segments: 24)),
             pose: (at: (90, 0, 0))),
            (name: "box", shape: Generator(Cuboid()), pose: (at: (50, 0, 0))),
            (name: "ball", shape: Primitive(Ball(radius: 1)), pose: (at: (70, 0, 0))),
        ], effects: [Contacts(margin: 0.1)])"#;
        let expected = Helix { bolt: "bolt".into(), nut: "nut".into(), pitch: 2.0 };
        assert_eq!(helices(&loaded(text)), [expected]);
        assert_eq!(rings(&loaded(text)), []);
    }

    #[test]
    fn a_torus_is_a_ring() {
        let text = r#"(gravity: (0, 0, -1), bodies: [
            (name: "link", shape: Generator(Torus(major_radius: 3, minor_radius: 0.5))),
            (name: "box", shape: Generator(Cuboid()), pose: (at: (50, 0, 0))),
        ], effects: [Contacts(margin: 0.1)])"#;
        assert_eq!(rings(&loaded(text)), [Ring { body: "link".into(), radius: 3.0 }]);
    }
}
