//! Which pairs of a robot's bodies never meet.

use std::collections::BTreeMap;

use cranny_world::description::Effect;
use cranny_world::{BodyId, BodySpec, World, WorldError};

use super::{Placing, listed};
use crate::scene_file::syntax::SelfCollisionsFile;

impl Placing<'_> {
    /// Pairs of scene bodies that never meet: of one group; unless all are asked for, joined by a
    /// joint, disabled, or meeting at rest.
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
        let name = |body: usize| self.robot.links[self.link_of_body[body]].name.as_str();
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
                        "{} pairs of links meet where the robot starts and never collide: {}. `self_collisions: Adjacent` keeps them",
                        names.len(), listed(&names)
                    ));
                }
                excluded.extend(meeting.into_iter().map(|(i, j)| (self.first + i, self.first + j)));
            }
        }
        Ok(excluded)
    }

    /// Pairs of bodies that touch or overlap where the robot starts, beside those excluded.
    fn meeting(&self, excluded: &[(usize, usize)]) -> Result<Vec<(usize, usize)>, WorldError> {
        let mut world = World::new();
        world.set_scene_effects(&[Effect::Trigger])?;
        let mut ids: BTreeMap<BodyId, usize> = BTreeMap::new();
        for (index, body) in self.bodies.iter().enumerate() {
            let Some(model) = body.model.clone().filter(|_| !body.layers.is_empty()) else {
                continue;
            };
            let spec = BodySpec { pose: body.pose, ..BodySpec::new(&body.name, model) };
            ids.insert(world.insert(spec)?, index);
        }
        let id_of: BTreeMap<usize, BodyId> = ids.iter().map(|(&id, &index)| (index, id)).collect();
        for &(a, b) in excluded {
            if let (Some(&a), Some(&b)) =
                (id_of.get(&(a - self.first)), id_of.get(&(b - self.first)))
            {
                world.exclude_pair(a, b)?;
            }
        }
        let touching = world.step()?.touching;
        Ok(touching.iter().map(|(a, b)| (ids[a], ids[b])).collect())
    }
}
