//! The poses at which all methods answer: of pairs of bodies, each pair's one after another.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use cranny_ecs::{ContactFields, Detector, PictureOptions, PluginOptions, RunOptions, SceneApp};
use cranny_geometry::Model;
use cranny_scene::LoadedScene;
use cranny_world::description::Effect;
use cranny_world::{Body, BodyId};

use super::truth::{Truth, truths};
use super::visits::centers;
use crate::failure::Failure;
use crate::pose_file::PosePair;
use crate::progress;
use crate::simulation::failure;

/// Steps of a scene whose poses are taken, at most; of a longer run they are stretches, evenly
/// spread. Fewer: rare events of a run are not seen; more: exact answers at all of them take
/// minutes.
const STEPS: u64 = 480;

/// Consecutive steps of a stretch. Fewer: memory is led from afar too often; more: fewer places of
/// the run are seen.
const STRETCH: u64 = 24;

/// Pairs that were near each other, and where.
type NearPairs = BTreeMap<(BodyId, BodyId), ([Model; 2], Vec<PosePair>)>;

/// Pairs of bodies, and the poses of each in the order of its motion.
pub(super) struct Motion {
    pairs: Vec<[Model; 2]>,
    /// Pair by pair.
    at: Vec<(usize, PosePair)>,
}

/// A motion and what is so at each of its poses.
pub(super) struct Judged {
    pub(super) motion: Motion,
    pub(super) truths: Vec<Truth>,
}

/// A pair at a pose.
#[derive(Clone, Copy)]
pub(super) struct Posed<'a> {
    pub(super) pair: usize,
    pub(super) models: [&'a Model; 2],
    pub(super) poses: PosePair,
}

impl Posed<'_> {
    /// From corner to corner of the smaller body's box: what errors are compared with.
    pub(super) fn size(&self) -> f64 {
        let [a, b] = self.models.map(|model| model.bounds().diagonal());
        a.min(b)
    }
}

impl Motion {
    /// Of one pair.
    pub(super) fn of_pair(models: [Model; 2], poses: &[PosePair]) -> Self {
        Self { pairs: vec![models], at: poses.iter().map(|&poses| (0, poses)).collect() }
    }

    /// Of all pairs whose boxes overlap, while a scene runs under our detector; and the run's
    /// preview, which is written to `picture`, or why there is none.
    ///
    /// # Errors
    ///
    /// A scene that cannot be simulated, or in which no two bodies come near each other.
    pub(super) fn of_scene(
        scene: &LoadedScene,
        duration: Option<f64>,
        picture: &Path,
    ) -> Result<(Self, Result<Vec<u8>, String>), Failure> {
        let mut description = scene.description.clone();
        // All near pairs are looked at, also those that the scene does not report.
        if !description.effects.iter().any(|effect| matches!(effect, Effect::Contacts { .. })) {
            description.effects.push(Effect::Contacts { margin: 0.0 });
        }
        let options = RunOptions {
            plugins: PluginOptions {
                contact_fields: ContactFields { depth: Some(0.0), ..ContactFields::NONE },
                ..PluginOptions::default()
            },
            duration,
            pictures: PictureOptions {
                preview: Some(picture.to_owned()),
                ..PictureOptions::default()
            },
            ..RunOptions::default()
        };
        // That of an earlier report would pass for this run's.
        let _ = fs::remove_file(picture);
        let mut app = SceneApp::new(&description, &options).map_err(failure)?;
        let total = app.steps_total();
        let bar = progress::bar(total, "simulating");
        let mut near: NearPairs = BTreeMap::new();
        for step in 0..total {
            app.step().map_err(failure)?;
            bar.inc(1);
            if is_taken(step, total) {
                take(&mut app, &mut near);
            }
        }
        bar.finish_and_clear();
        let summary = app.finish().map_err(failure)?;
        let missing = || {
            let skipped = summary.skipped.iter().map(|skip| format!("{}: {}", skip.what, skip.why));
            format!("There is no picture. {}", skipped.collect::<Vec<_>>().join("; "))
        };
        let drawn = fs::read(picture).map_err(|_| missing());
        let mut motion = Self { pairs: Vec::new(), at: Vec::new() };
        for (models, poses) in near.into_values() {
            motion.at.extend(poses.into_iter().map(|poses| (motion.pairs.len(), poses)));
            motion.pairs.push(models);
        }
        if motion.at.is_empty() {
            return Err(Failure::input(format!(
                "scene file {}: no two of its bodies come near each other, so there is nothing to measure",
                scene.path.display()
            )));
        }
        Ok((motion, drawn))
    }

    /// Poses of all pairs.
    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    pub(super) fn pairs(&self) -> &[[Model; 2]] {
        &self.pairs
    }

    pub(super) fn posed(&self, index: usize) -> Posed<'_> {
        let (pair, poses) = self.at[index];
        Posed { pair, models: self.pairs[pair].each_ref(), poses }
    }

    /// Whether the pose before is another pair's.
    pub(super) fn begins(&self, index: usize) -> bool {
        index == 0 || self.at[index - 1].0 != self.at[index].0
    }

    /// With exact answers at all poses.
    ///
    /// # Errors
    ///
    /// A pose that cannot be queried, in words.
    pub(super) fn judged(self) -> Result<Judged, String> {
        let truths = truths(&self)?;
        Ok(Judged { motion: self, truths })
    }
}

/// Whether the poses of a step are taken.
fn is_taken(step: u64, total: u64) -> bool {
    if total <= STEPS {
        return true;
    }
    let mut starts = centers((total - STRETCH + 1) as usize, (STEPS / STRETCH) as usize);
    starts.any(|start| (start as u64..start as u64 + STRETCH).contains(&step))
}

/// Adds the poses of the pairs that are near each other after a step.
fn take(app: &mut SceneApp, near: &mut NearPairs) {
    let Some(mut detector) = app.app_mut().world_mut().get_resource_mut::<Detector>() else {
        return;
    };
    let world = detector.world();
    // Primitives have no levels.
    let placed = |(id, body): (BodyId, &'_ Body)| {
        let (pose, model) = (body.pose(), body.shape().model()?.clone());
        Some((id, pose.world_from_body().bounds(&model.bounds()), model, pose))
    };
    let all: Vec<_> = world.bodies().filter_map(placed).collect();
    for (i, (a, a_box, a_model, a_pose)) in all.iter().enumerate() {
        for (b, b_box, b_model, b_pose) in &all[i + 1..] {
            if a_box.overlaps(b_box) && world.may_meet(*a, *b).is_ok_and(|can| can) {
                let (_, poses) = near
                    .entry((*a, *b))
                    .or_insert_with(|| ([a_model.clone(), b_model.clone()], Vec::new()));
                poses.push([*a_pose, *b_pose]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_long_runs_stretches_are_taken_and_of_short_ones_all() {
        assert!((0..STEPS).all(|step| is_taken(step, STEPS)));
        let taken: Vec<u64> = (0..5_000).filter(|&step| is_taken(step, 5_000)).collect();
        assert_eq!(taken.len() as u64, STEPS);
        let breaks = taken.windows(2).filter(|w| w[1] != w[0] + 1).count();
        assert_eq!(breaks as u64, STEPS / STRETCH - 1);
        assert!(taken[0] > 0 && taken[0] < 300 && taken[taken.len() - 1] > 4_700);
    }
}
