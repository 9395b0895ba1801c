//! Certificates of right verdicts hold; nothing makes a wrong verdict hold.

use cranny_certificate::{
    Certificate, Claim, Contained, Evidence, Refusal, Step, SurfaceVerdict, Triangles, verify,
};
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_prover::{ProveError, claim, filed, prove};
use cranny_shapes::{Cup, Torus};
use cranny_testkit::Rng;
use cranny_testkit::bodies::{angle, channel, cuboid};

struct Body {
    model: Model,
    triangles: Triangles,
}

impl Body {
    fn new(mesh: Mesh) -> Self {
        let triangles = filed(&mesh);
        Self { model: Model::build(mesh, &BuildOptions::default()).unwrap().0, triangles }
    }
}

struct Case<'a> {
    bodies: [&'a Body; 2],
    poses: [Pose; 2],
}

impl Case<'_> {
    fn placed(&self) -> [Placed<'_>; 2] {
        [0, 1].map(|i| Placed { model: &self.bodies[i].model, pose: self.poses[i] })
    }

    fn claim(&self) -> Claim {
        let [a, b] = self.placed();
        let question = Query::of(Demand::Intersects);
        let answer = query(a, b, &question, &mut PairMemory::default()).unwrap();
        claim(answer.surface, answer.solid, answer.contained)
    }

    fn prove(&self, claim: &Claim) -> Result<Certificate, ProveError> {
        prove(claim, self.placed(), self.bodies.map(|body| &body.triangles))
    }

    fn verify(&self, claim: &Claim, certificate: &Certificate) -> Result<(), Refusal> {
        verify(claim, certificate, self.bodies.map(|body| &body.triangles))
    }
}

/// Every claim there is.
fn claims() -> impl Iterator<Item = Claim> {
    let surfaces = [SurfaceVerdict::None, SurfaceVerdict::Touch, SurfaceVerdict::Cross];
    surfaces.into_iter().flat_map(|surface| {
        [false, true].into_iter().flat_map(move |solid| {
            let all = [None, Some(Contained::AInB), Some(Contained::BInA)];
            all.map(|contained| Claim { surface, solid, contained })
        })
    })
}

fn bodies() -> Vec<Body> {
    let torus = Torus { major_segments: 16, minor_segments: 8, ..Torus::default() };
    let cup = Cup { segments: 10, ..Cup::default() };
    [torus.build().unwrap(), cup.build().unwrap(), angle(), channel(), cuboid([-0.1; 3], [0.1; 3])]
        .map(Body::new)
        .into()
}

/// Of each verdict that chance brings, the certificate holds, and it proves no other claim.
#[test]
fn a_certificate_proves_its_claim_and_no_other() {
    let bodies = bodies();
    let mut rng = Rng::new(11);
    let mut seen = std::collections::BTreeMap::new();
    for k in 0..400 {
        let [a, b] = [k % 5, k / 5 % 5].map(|i| &bodies[i]);
        let reach = [0.02, 0.3, 0.8, 1.3][k % 4] * (a.model.radius() + b.model.radius());
        let pose = |rng: &mut Rng, by: f64| Pose {
            rotation: if k % 3 == 0 { DQuat::IDENTITY } else { rng.rotation() },
            translation: by * rng.direction() * rng.unit(),
        };
        let case =
            Case { bodies: [a, b], poses: [pose(&mut rng, 3.0), pose(&mut rng, 3.0 + reach)] };
        let case = Case { poses: [case.poses[0], nearer(&case.poses, reach)], ..case };
        let right = case.claim();
        let certificate = case.prove(&right).unwrap_or_else(|error| panic!("{k}: {error}"));
        assert_eq!(case.verify(&right, &certificate), Ok(()), "{k}");
        for wrong in claims().filter(|&claim| claim != right) {
            assert!(case.verify(&wrong, &certificate).is_err(), "{k}: {wrong:?}");
        }
        *seen.entry(format!("{right:?}")).or_insert(0) += 1;
    }
    assert!(seen.len() >= 4 && seen.values().all(|&times| times > 0), "{seen:?}");
}

/// The second pose, brought to within a reach of the first.
fn nearer([first, second]: &[Pose; 2], reach: f64) -> Pose {
    let way = (second.translation - first.translation).clamp_length_max(reach);
    Pose { rotation: second.rotation, translation: first.translation + way }
}

/// Boxes on, in and beside each other, exactly.
#[test]
fn touching_bodies_are_certified() {
    let [large, small, channel] =
        [cuboid([0.0; 3], [4.0; 3]), cuboid([0.0; 3], [1.0; 3]), channel()].map(Body::new);
    let at = |x: f64, y: f64, z: f64| Pose::at(DVec3::new(x, y, z));
    let touch = |solid, contained| Claim { surface: SurfaceVerdict::Touch, solid, contained };
    for (b, pose, expected) in [
        (&small, at(1.0, 1.0, 4.0), touch(false, None)),
        (&small, at(4.0, 4.0, 4.0), touch(false, None)),
        (&small, at(4.0, 1.0, -0.5), touch(false, None)),
        (&small, at(1.0, 1.0, 3.0), touch(true, Some(Contained::BInA))),
        (&small, at(0.0, 0.0, 0.0), touch(true, Some(Contained::BInA))),
        (&large, at(0.0, 0.0, 0.0), touch(true, None)),
        (&large, at(2.0, 0.0, 0.0), touch(true, None)),
    ] {
        let case = Case { bodies: [&large, b], poses: [Pose::IDENTITY, pose] };
        assert_eq!(case.claim(), expected, "{pose:?}");
        let certificate = case.prove(&expected).unwrap();
        assert_eq!(case.verify(&expected, &certificate), Ok(()), "{pose:?}");
        for wrong in claims().filter(|&claim| claim != expected) {
            assert!(case.verify(&wrong, &certificate).is_err(), "{pose:?} {wrong:?}");
        }
    }
    // No plane parts the halves of a channel from what fills it.
    let bounds = channel.model.bounds();
    let case = Case {
        bodies: [&channel, &channel],
        poses: [Pose::IDENTITY, Pose::at(DVec3::new(0.0, 0.0, bounds.max.z - bounds.min.z))],
    };
    let claim = case.claim();
    assert_eq!(case.verify(&claim, &case.prove(&claim).unwrap()), Ok(()));
}

#[test]
fn a_wrong_verdict_has_no_certificate() {
    let cube = Body::new(cuboid([0.0; 3], [1.0; 3]));
    let truths =
        [(1.5, SurfaceVerdict::None), (1.0, SurfaceVerdict::Touch), (0.5, SurfaceVerdict::Cross)];
    for (x, truth) in truths {
        let pose = Pose::at(DVec3::new(x, 0.25, 0.25));
        let case = Case { bodies: [&cube, &cube], poses: [Pose::IDENTITY, pose] };
        for (_, surface) in truths {
            let claim = Claim { surface, solid: surface == SurfaceVerdict::Cross, contained: None };
            let proved = case.prove(&claim).is_ok();
            assert_eq!(proved, surface == truth, "{surface:?} at {x}");
        }
    }
}

/// Two rings as links of a chain: no plane parts their hulls.
fn links() -> (Body, [Pose; 2]) {
    let ring = Torus { major_segments: 16, minor_segments: 6, ..Torus::default() }.build().unwrap();
    let turned = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let beside = Torus::default().major_radius * DVec3::X;
    (Body::new(ring), [Pose::IDENTITY, Pose { rotation: turned, translation: beside }])
}

#[test]
fn mangled_evidence_is_refused() {
    let (ring, poses) = links();
    let case = Case { bodies: [&ring, &ring], poses };
    let apart = Claim { surface: SurfaceVerdict::None, solid: false, contained: None };
    assert_eq!(case.claim(), apart);
    let whole = case.prove(&apart).unwrap();
    let steps = &whole.evidence.apart;
    assert!(steps.len() > 10 && case.verify(&apart, &whole).is_ok());
    let with = |change: &dyn Fn(&mut Certificate)| {
        let mut mangled = whole.clone();
        change(&mut mangled);
        case.verify(&apart, &mangled)
    };
    for k in 0..steps.len() {
        assert!(with(&|c| _ = c.evidence.apart.remove(k)).is_err(), "without step {k}");
        assert!(with(&|c| c.evidence.apart.truncate(k)).is_err(), "cut before step {k}");
        assert!(with(&|c| c.evidence.apart[k] = Step::Direction([0.0; 3])).is_err(), "{k}");
        assert!(with(&|c| c.evidence.apart[k] = Step::Needle { needle: true }).is_err(), "{k}");
        assert!(with(&|c| c.evidence.apart[k] = Step::Direction([f64::NAN; 3])).is_err(), "{k}");
        assert!(with(&|c| c.evidence.apart[k] = Step::Halve(3)).is_err(), "{k}");
    }
    assert!(with(&|c| c.evidence.apart.push(Step::Halve(1))).is_err());
    assert!(
        with(&|c| c.evidence = Evidence { crossing: None, touching: None, apart: vec![] }).is_err()
    );
    assert!(with(&|c| c.map[3] += 1e-6).is_err());
    assert!(with(&|c| c.map[0] = f64::NAN).is_err());
    assert!(with(&|c| c.poses[1][3] += 1e-6).is_err());
    assert!(with(&|c| c.poses[0][0] = 2.0).is_err());
    let other = Torus { major_segments: 17, minor_segments: 6, ..Torus::default() };
    let other = Body::new(other.build().unwrap());
    assert!(verify(&apart, &whole, [&ring.triangles, &other.triangles]).is_err());
    let crossing = Evidence { crossing: Some([0, 4_000_000_000]), touching: None, apart: vec![] };
    let cross = Claim { surface: SurfaceVerdict::Cross, solid: true, contained: None };
    let far = Certificate { evidence: crossing, ..whole.clone() };
    assert!(matches!(case.verify(&cross, &far), Err(Refusal::Face { body: 'B', .. })));
}

/// Steps of another pose part these bodies only if they are apart indeed.
#[test]
fn evidence_of_another_pose_proves_nothing_wrong() {
    let (ring, poses) = links();
    let apart = Claim { surface: SurfaceVerdict::None, solid: false, contained: None };
    let case = |shift: f64| {
        let moved = Pose { translation: poses[1].translation + shift * DVec3::X, ..poses[1] };
        Case { bodies: [&ring, &ring], poses: [poses[0], moved] }
    };
    let whole = case(0.0).prove(&apart).unwrap();
    let (mut held, mut refused) = (0, 0);
    for k in 0..60 {
        let there = case(0.01 * f64::from(k));
        let Certificate { poses, frame, map, .. } = match there.prove(&there.claim()) {
            Ok(certificate) => certificate,
            Err(error) => panic!("{k}: {error}"),
        };
        let borrowed = Certificate { poses, frame, map, evidence: whole.evidence.clone() };
        match there.verify(&apart, &borrowed) {
            Ok(()) => {
                assert_eq!(there.claim(), apart, "{k}");
                held += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(held > 0 && refused > 0, "{held} {refused}");
}

/// Components that look inward count by what winds around a place, in any order
/// of filing; what cannot be judged so proves nothing.
#[test]
fn inward_components_make_no_wrong_claim_hold() {
    let [unit, on_top] = [cuboid([0.0; 3], [1.0; 3]), cuboid([0.0, 0.0, 1.0], [1.0, 1.0, 2.0])];
    let (large, far) = (cuboid([-1.0; 3], [2.0; 3]), cuboid([10.0; 3], [14.0; 3]));
    let turned = |&[a, b, c]: &[u32; 3]| [a, c, b];
    let faces = unit.faces().iter().map(turned).collect();
    let inward = Mesh::new(unit.vertices().to_vec(), faces).unwrap();
    let twice = unit.clone().joined(&inward).joined(&large);
    let twice_turned = inward.clone().joined(&unit).joined(&large);
    let beside = far.joined(&inward);
    let touch = |solid, contained| Claim { surface: SurfaceVerdict::Touch, solid, contained };
    let within = touch(true, Some(Contained::AInB));
    let cases = [
        (&unit, &twice, within, false),
        (&unit, &twice_turned, within, false),
        (&on_top, &beside, touch(false, None), true),
        (&unit, &beside, within, true),
    ];
    for (k, (a, b, right, is_judged)) in cases.into_iter().enumerate() {
        let bodies = [a, b].map(|mesh| Body::new(mesh.clone()));
        let flipped = match right.contained {
            Some(Contained::AInB) => Claim { contained: Some(Contained::BInA), ..right },
            _ => right,
        };
        let ways = [([&bodies[0], &bodies[1]], right), ([&bodies[1], &bodies[0]], flipped)];
        for (bodies, right) in ways {
            let case = Case { bodies, poses: [Pose::IDENTITY; 2] };
            let certificate = case.prove(&right).unwrap();
            let held: Vec<Claim> =
                claims().filter(|claim| case.verify(claim, &certificate).is_ok()).collect();
            assert_eq!(held, if is_judged { vec![right] } else { vec![] }, "{k}");
        }
    }
}
