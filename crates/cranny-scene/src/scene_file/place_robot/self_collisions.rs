//! Which pairs of a robot's bodies never meet.

use std::collections::BTreeSet;

use cranny_exact::Pose;
use cranny_world::{Arrangement, ArrangementError, Wanted};

use super::{Placing, listed, pairs_that_meet};
use crate::scene_file::syntax::SelfCollisionsFile;

impl Placing<'_> {
    /// Pairs of scene bodies that never meet: of one group, or disabled; as `self_collisions` says,
    /// also those joined by a joint and those that meet at rest, or all.
    pub(super) fn excluded(
        &mut self,
        disabled: &[[String; 2]],
    ) -> Result<Vec<(usize, usize)>, String> {
        let count = self.bodies.len();
        let pairs = (0..count).flat_map(|j| (0..j).map(move |i| (i, j)));
        let in_scene = |(i, j): (usize, usize)| (self.first + i, self.first + j);
        let mut excluded: Vec<(usize, usize)> = pairs
            .clone()
            .filter(|&(i, j)| self.group_of_body[i] == self.group_of_body[j])
            .map(in_scene)
            .collect();
        let named = |a: &str, b: &str| {
            disabled.iter().any(|[x, y]| (x == a && y == b) || (x == b && y == a))
        };
        let name = |body: usize| self.link_name(body);
        excluded.extend(pairs.clone().filter(|&(i, j)| named(name(i), name(j))).map(in_scene));
        let adjacent = self.joints.iter().map(|j| (j.parent.min(j.child), j.parent.max(j.child)));
        match self.file.self_collisions {
            SelfCollisionsFile::All => return Ok(excluded),
            SelfCollisionsFile::None => return Ok(pairs.map(in_scene).collect()),
            SelfCollisionsFile::Adjacent => excluded.extend(adjacent),
            SelfCollisionsFile::Apart => {
                excluded.extend(adjacent);
                let meeting = self.meeting(&excluded).map_err(|error| error.to_string())?;
                if !meeting.is_empty() {
                    let names: Vec<String> = meeting
                        .iter()
                        .map(|&(i, j)| format!("{} - {}", name(i), name(j)))
                        .collect();
                    self.warnings.push(format!(
                        "{} where the robot starts, never to collide: {}. `self_collisions: Adjacent` keeps them",
                        pairs_that_meet(names.len()),
                        listed(&names)
                    ));
                }
                excluded.extend(meeting.into_iter().map(|(i, j)| (self.first + i, self.first + j)));
            }
        }
        Ok(excluded)
    }

    /// Pairs of bodies that touch or overlap where the robot starts, beside those excluded.
    fn meeting(
        &self,
        excluded: &[(usize, usize)],
    ) -> Result<Vec<(usize, usize)>, ArrangementError> {
        let poses: Vec<Pose> = self.bodies.iter().map(|body| body.pose).collect();
        Ok(self.arrangement(excluded).at(&poses, Wanted::Meeting)?.meeting)
    }

    /// The bodies, and all of their pairs beside those excluded.
    pub(super) fn arrangement(&self, excluded: &[(usize, usize)]) -> Arrangement {
        let in_robot = |&(a, b): &(usize, usize)| (a - self.first, b - self.first);
        let excluded: BTreeSet<_> = excluded.iter().map(in_robot).collect();
        let shapes =
            self.bodies.iter().map(|body| body.shape.clone().filter(|_| !body.layers.is_empty()));
        let pairs = (0..self.bodies.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
        Arrangement::new(shapes.collect(), pairs.filter(|pair| !excluded.contains(pair)))
    }

    /// The name of the link that a body is.
    pub(super) fn link_name(&self, body: usize) -> &str {
        &self.robot.links[self.link_of_body[body]].name
    }
}
