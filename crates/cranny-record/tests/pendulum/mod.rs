//! A run to record: a cube swings through a fixed ring and past a post, as prescribed (no physics).

use std::path::Path;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_record::{
    Frame, LogLevel, RecordError, RecordedAttachment, RecordedBody, Recorder, RecordingInfo,
};
use cranny_shapes::{Cuboid, Torus};
use cranny_world::description::{BodyKind, Effect};
use cranny_world::{BodyId, BodySpec, World};

/// Duration of a step, seconds.
pub(crate) const DT: f64 = 1.0 / 240.0;

/// Names of the bodies, in the order of their ids.
pub(crate) const BODIES: [&str; 3] = ["ring", "post", "bob"];

/// A picture of four red pixels.
pub(crate) const PNG: &[u8] = &[
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd, 0xd4, 0x9a,
    0x73, 0x00, 0x00, 0x00, 0x10, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x38, 0x61, 0xa3, 0x01,
    0x44, 0x0c, 0x10, 0x0a, 0x00, 0x23, 0x5e, 0x04, 0xb1, 0x86, 0x02, 0xd1, 0x93, 0x00, 0x00, 0x00,
    0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
];

/// The world and its one moving body.
pub(crate) struct Pendulum {
    pub(crate) world: World,
    pub(crate) bob: BodyId,
    meshes: Vec<Mesh>,
}

impl Pendulum {
    pub(crate) fn new() -> Self {
        let meshes = vec![
            Torus::default().build().unwrap(),
            Cuboid { size: [0.25, 0.25, 2.0] }.build().unwrap(),
            Cuboid { size: [0.5; 3] }.build().unwrap(),
        ];
        let mut world = World::new();
        world.set_scene_effects(&[Effect::Contacts { margin: 0.05 }]).unwrap();
        let places = [DVec3::ZERO, DVec3::new(1.9, 0.0, 0.0), DVec3::new(-3.0, 0.0, 0.0)];
        let mut bob = BodyId(0);
        for ((name, mesh), place) in BODIES.iter().zip(&meshes).zip(places) {
            let model = Model::build(mesh.clone(), &BuildOptions::default()).unwrap().0;
            let kind = if *name == "bob" { BodyKind::Kinematic } else { BodyKind::Fixed };
            let spec = BodySpec { kind, pose: Pose::at(place), ..BodySpec::new(*name, model) };
            bob = world.insert(spec).unwrap();
        }
        Self { world, bob, meshes }
    }

    pub(crate) fn info() -> RecordingInfo {
        RecordingInfo {
            scene: "pendulum".into(),
            scene_hash: "0123".into(),
            seed: 7,
            attachments: vec![RecordedAttachment {
                name: "pendulum.ron".into(),
                media_type: "text/plain".into(),
                data: b"(version: 1)".to_vec(),
            }],
            ..RecordingInfo::new(DT)
        }
    }

    /// From far on the left, through the ring's tube, past the post, to far on the right; turning.
    pub(crate) fn pose(step: u64, steps: u64) -> Pose {
        let phase = step as f64 / steps.max(2).saturating_sub(1) as f64;
        let turn = DQuat::from_xyzw(0.3, 0.4 - phase, 0.1, 1.0).normalize();
        Pose { rotation: turn, translation: DVec3::new(6.0 * phase - 3.0, 0.1 * phase, 1.0 / 3.0) }
    }

    pub(crate) fn tell_bodies(&self, recorder: &mut Recorder) -> Result<(), RecordError> {
        let color = [0.6, 0.7, 0.8, 1.0];
        let bodies: Vec<RecordedBody> = BODIES
            .iter()
            .zip(&self.meshes)
            .map(|(name, mesh)| RecordedBody {
                name,
                mesh,
                color,
                color_is_stated: false,
                number: None,
                sensor: false,
                model: None,
                primitive: None,
                kind: None,
            })
            .collect();
        recorder.bodies(0, &bodies)
    }

    /// Makes a step and records it.
    pub(crate) fn step(&mut self, recorder: &mut Recorder, steps: u64) -> Result<(), RecordError> {
        let pose = Self::pose(self.world.steps(), steps);
        self.world.set_pose(self.bob, pose).unwrap();
        let report = self.world.step().unwrap();
        let mut frame = Frame::of_step(&self.world, &report)?;
        frame.measures = vec![("swing", pose.translation.x)];
        recorder.frame(&frame)
    }
}

/// Opens a recording, names the bodies, and records so many steps, one picture and one line.
pub(crate) fn record(path: &Path, steps: u64) -> Result<(Recorder, Pendulum), RecordError> {
    let mut recorder = Recorder::create(path, &Pendulum::info())?;
    let mut pendulum = Pendulum::new();
    pendulum.tell_bodies(&mut recorder)?;
    for _ in 0..steps {
        pendulum.step(&mut recorder, steps)?;
    }
    recorder.image("main", steps.saturating_sub(1), PNG)?;
    recorder.log(LogLevel::Info, "swung")?;
    Ok((recorder, pendulum))
}
