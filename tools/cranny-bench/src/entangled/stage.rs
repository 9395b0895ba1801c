//! Bodies, their poses frame by frame, and the pairs that are queried in each frame.

use cranny_exact::{Aabb, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::Placed;

use super::digest::Digest;

/// Bodies in motion.
pub(super) struct Motion {
    /// Each mesh once.
    pub(super) meshes: Vec<Mesh>,
    /// The mesh of each body.
    pub(super) mesh_of: Vec<usize>,
    /// Pairs of bodies, the first by index before the second.
    pub(super) pairs: Vec<[usize; 2]>,
    /// Poses of all bodies, frame by frame.
    pub(super) frames: Vec<Vec<Pose>>,
    /// Margin of contacts for a solver.
    pub(super) contact_margin: f64,
    /// Margin of regions.
    pub(super) region_margin: f64,
}

impl Motion {
    /// Two bodies, the first at rest at the origin.
    pub(super) fn of_pair(a: Mesh, b: Mesh, poses: Vec<Pose>, contact_margin: f64) -> Self {
        Self {
            meshes: vec![a, b],
            mesh_of: vec![0, 1],
            pairs: vec![[0, 1]],
            frames: poses.into_iter().map(|pose| vec![Pose::IDENTITY, pose]).collect(),
            contact_margin,
            region_margin: 0.0,
        }
    }

    /// Two bodies of one mesh.
    pub(super) fn of_twins(mesh: Mesh, poses: Vec<Pose>, contact_margin: f64) -> Self {
        let mut motion = Self::of_pair(mesh.clone(), mesh, poses, contact_margin);
        motion.meshes.truncate(1);
        motion.mesh_of[1] = 0;
        motion
    }
}

/// A motion with prepared models.
pub(super) struct Stage {
    pub(super) motion: Motion,
    /// The model of each mesh.
    pub(super) models: Vec<Model>,
    /// Indices of the pairs whose boxes overlap within the contact margin, frame by frame.
    pub(super) near: Vec<Vec<usize>>,
}

impl Stage {
    /// # Errors
    ///
    /// A mesh that has no model.
    pub(super) fn new(motion: Motion) -> Result<Self, String> {
        let options = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        let models = motion
            .meshes
            .iter()
            .map(|mesh| Model::build(mesh.clone(), &options).map(|(model, _)| model))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| error.to_string())?;
        let near = motion.frames.iter().map(|poses| near(&motion, &models, poses)).collect();
        Ok(Self { motion, models, near })
    }

    /// Number of frames.
    pub(super) fn len(&self) -> usize {
        self.motion.frames.len()
    }

    /// Both bodies of a pair in a frame.
    pub(super) fn placed(&self, frame: usize, pair: usize) -> [Placed<'_>; 2] {
        self.motion.pairs[pair].map(|body| Placed {
            model: &self.models[self.motion.mesh_of[body]],
            pose: self.motion.frames[frame][body],
        })
    }

    /// Returns the pose of a pair's second body in the frame of the first.
    pub(super) fn a_from_b(&self, frame: usize, pair: usize) -> Pose {
        let [a, b] = self.motion.pairs[pair].map(|body| self.motion.frames[frame][body]);
        let back = a.rotation.conjugate();
        Pose {
            rotation: (back * b.rotation).normalize(),
            translation: back * (b.translation - a.translation),
        }
    }

    /// Meshes of a pair's bodies.
    pub(super) fn mesh_indices(&self, pair: usize) -> [usize; 2] {
        self.motion.pairs[pair].map(|body| self.motion.mesh_of[body])
    }

    /// Returns a hash of all poses. Answers of two revisions compare only if it is the same.
    pub(super) fn pose_hash(&self) -> u64 {
        let mut digest = Digest::default();
        for pose in self.motion.frames.iter().flatten() {
            pose.bits().iter().for_each(|&bits| digest.word(bits));
        }
        digest.value()
    }
}

fn near(motion: &Motion, models: &[Model], poses: &[Pose]) -> Vec<usize> {
    let boxes: Vec<Aabb> = motion
        .mesh_of
        .iter()
        .zip(poses)
        .map(|(&mesh, pose)| pose.world_from_body().bounds(&models[mesh].bounds()))
        .collect();
    let overlaps = |&[a, b]: &[usize; 2]| boxes[a].grown(motion.contact_margin).overlaps(&boxes[b]);
    (0..motion.pairs.len()).filter(|&pair| overlaps(&motion.pairs[pair])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::{DQuat, DVec3};
    use cranny_shapes::Cuboid;

    fn cube() -> Mesh {
        Cuboid { size: [1.0; 3] }.build().unwrap()
    }

    #[test]
    fn pairs_are_queried_where_their_boxes_overlap_within_the_margin() {
        let poses = [0.9, 1.05, 1.2].map(|x| Pose::at(DVec3::X * x)).into();
        let stage = Stage::new(Motion::of_twins(cube(), poses, 0.1)).unwrap();
        assert_eq!(stage.near, [vec![0], vec![0], vec![]]);
        assert_eq!(stage.models.len(), 1);
    }

    #[test]
    fn relative_poses_take_the_first_body_to_the_origin() {
        let mut motion = Motion::of_twins(cube(), vec![Pose::at(DVec3::X)], 0.0);
        let turn = DQuat::from_rotation_z(1.0);
        motion.frames[0][0] = Pose { rotation: turn, translation: DVec3::Y };
        motion.frames[0][1] = Pose { rotation: turn, translation: DVec3::Y + turn * DVec3::X };
        let stage = Stage::new(motion).unwrap();
        let pose = stage.a_from_b(0, 0);
        assert!((pose.translation - DVec3::X).length() < 1e-15);
        assert!(pose.rotation.w > 1.0 - 1e-15);
    }
}
