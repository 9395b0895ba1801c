//! Dents: what the surface loses, where, and where it does not yield.

use cranny_exact::DVec3;
use cranny_geometry::{Blow, BuildOptions, Dent, Mesh, Model, VertexId};
use cranny_shapes::{Cuboid, Floor, Torus};

fn built(mesh: Mesh) -> Model {
    Model::build(mesh, &BuildOptions::default()).unwrap().0
}

/// A closed slab from z = -0.2 to 0, its top and bottom of `n` by `n` squares, with sides of 2.
fn slab(n: u32) -> Model {
    let model = built(Floor { size: [2.0, 2.0, 0.2], squares: [n, n] }.build().unwrap());
    assert!(model.is_closed() && (volume(&model) - 0.8).abs() < 1e-12, "{}", volume(&model));
    model
}

/// By the divergence theorem, from the vertices alone.
fn volume(model: &Model) -> f64 {
    let mesh = model.mesh();
    let tetrahedra = mesh.faces().iter().map(|face| {
        let [a, b, c] = face.map(|v| mesh.position(VertexId(v)));
        a.dot(b.cross(c)) / 6.0
    });
    tetrahedra.sum()
}

fn blow() -> Blow {
    let at = DVec3::new(0.1, -0.2, 0.001);
    Blow { at, inward: DVec3::NEG_Z, radius: 0.5, volume: 0.01, most_depth: 0.1 }
}

#[test]
fn the_body_loses_what_the_dent_holds() {
    for n in [8, 20, 31] {
        let mut model = slab(n);
        let before = model.clone();
        let dent = Dent::of(&model, &blow()).unwrap();
        assert!((dent.volume - 0.01).abs() < 1e-15 && dent.depth < 0.1, "{n}: {}", dent.depth);
        // The integral of the profile over the disc is depth x π r² / 3.
        if n > 20 {
            let smooth = std::f64::consts::PI * 0.25 / 3.0 * dent.depth;
            assert!((smooth / 0.01 - 1.0).abs() < 0.01, "{n}: {smooth}");
        }
        model.deform(&dent.moves).unwrap();
        assert!((volume(&before) - volume(&model) - 0.01).abs() < 1e-12, "{n}");
        let mass = model.mass_properties().unwrap().volume;
        assert!((mass - volume(&model)).abs() < 1e-12, "{n}");
        for (v, (old, new)) in
            before.mesh().vertices().iter().zip(model.mesh().vertices()).enumerate()
        {
            let from = (*old - blow().at) * DVec3::new(1.0, 1.0, 0.0);
            let moves = old.z == 0.0 && from.length() < 0.5;
            assert_eq!(new.z < old.z, moves, "{n}: vertex {v} at {old}");
            assert_eq!((new.x, new.y), (old.x, old.y));
        }
        model.topology().validate(model.mesh()).unwrap();
    }
}

#[test]
fn a_dent_is_no_deeper_than_it_may_be() {
    let model = slab(20);
    let dent = Dent::of(&model, &Blow { volume: 5.0, ..blow() }).unwrap();
    assert_eq!(dent.depth, 0.1);
    let mut dented = model.clone();
    dented.deform(&dent.moves).unwrap();
    assert!((volume(&model) - volume(&dented) - dent.volume).abs() < 1e-12);
}

#[test]
fn where_nothing_can_yield_there_is_no_dent() {
    let cube = built(Cuboid { size: [1.0; 3] }.build().unwrap());
    let top = Blow { at: DVec3::new(0.0, 0.0, 0.5), radius: 0.3, ..blow() };
    assert_eq!(Dent::of(&cube, &top), None, "no vertex is within the radius");
    let above = Blow { at: DVec3::new(0.0, 0.0, 5.0), radius: 2.0, ..blow() };
    assert_eq!(Dent::of(&cube, &above), None, "nothing is near");
    let from_below = Blow { inward: DVec3::Z, ..blow() };
    let slab = slab(20);
    let dent = Dent::of(&slab, &from_below).unwrap();
    let bottom = |&(v, _): &(VertexId, DVec3)| slab.mesh().position(v).z < -0.1;
    assert!(dent.moves.iter().all(bottom), "the side that looks away does not yield");
    let none = Dent::of(&slab, &Blow { volume: f64::NAN, ..blow() });
    assert_eq!(none, None);
}

/// The other side of a ring is within the radius too.
#[test]
fn only_what_hangs_together_with_the_blow_yields() {
    let torus =
        Torus { major_radius: 1.0, minor_radius: 0.2, major_segments: 48, minor_segments: 24 };
    let ring = built(torus.build().unwrap());
    let blow = Blow {
        at: DVec3::new(1.0, 0.0, 0.2),
        inward: DVec3::NEG_Z,
        radius: 1.95,
        volume: 0.001,
        most_depth: 0.1,
    };
    let wide = Dent::of(&ring, &blow).unwrap();
    assert!(wide.moves.iter().all(|(v, _)| ring.mesh().position(*v).z > -1e-9));
    let narrow = Dent::of(&ring, &Blow { radius: 0.3, ..blow }).unwrap();
    assert!(narrow.moves.iter().all(|(v, _)| ring.mesh().position(*v).x > 0.5));
    assert!(narrow.moves.len() < wide.moves.len());
}
