//! How bodies came to where they are: the ways of their middles, where they were before, and where
//! they are going, how fast.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_render::{Camera, DrawList, DrawMesh, Instance, Label, Line, palette};
use cranny_world::BodyId;

use super::Moment;
use super::coats::{Coat, Coats};
use super::marks::number;

/// How many earlier places of a body are drawn. More: they hide each other; fewer: a turn between
/// them is not seen.
const GHOSTS: usize = 4;

/// A ghost is at least this share of its body's size from the next one. Smaller: what hardly moves
/// is buried in its ghosts; larger: what turns on the spot has none.
const APART: f64 = 0.4;

/// Of 255. Higher: ghosts pass for bodies; lower: they are not seen on a light ground.
const GHOST_ALPHA: u8 = 70;

/// Length of the fastest body's arrow, in parts of the picture's height.
const ARROW: f64 = 0.2;

/// Pixels, where a way begins and where the body is.
const WAY: [f32; 2] = [0.8, 3.0];
const SHAFT: f32 = 2.6;

/// Places and shapes in the order of time.
#[derive(Clone, Default)]
pub(super) struct Trails {
    moments: Vec<(f64, BTreeMap<BodyId, Pose>)>,
    /// What a body looked like, from which time on.
    shapes: BTreeMap<BodyId, Vec<(f64, Arc<DrawMesh>)>>,
}

impl Trails {
    /// Takes in where bodies are, and their shapes; a time before the last begins anew.
    pub(super) fn note(&mut self, time: f64, poses: &BTreeMap<BodyId, Pose>, coats: &Coats) {
        match self.moments.last() {
            Some(&(last, _)) if time == last => return,
            Some(&(last, _)) if time < last => *self = Self::default(),
            _ => {}
        }
        self.moments.push((time, poses.clone()));
        for (id, coat) in poses.keys().filter_map(|&id| Some((id, coats.get(id)?))) {
            let shapes = self.shapes.entry(id).or_default();
            if shapes.last().is_none_or(|(_, mesh)| !Arc::ptr_eq(mesh, &coat.mesh)) {
                shapes.push((time, coat.mesh.clone()));
            }
        }
    }

    /// What a body looked like at a time that was noted.
    fn shape(&self, id: BodyId, time: f64) -> Option<&Arc<DrawMesh>> {
        let shapes = self.shapes.get(&id)?;
        let (_, mesh) =
            &shapes[shapes.partition_point(|(since, _)| *since <= time).checked_sub(1)?];
        Some(mesh)
    }

    /// The last moments, so many if there are.
    pub(super) fn last(&self, count: usize) -> Vec<&BTreeMap<BodyId, Pose>> {
        let first = self.moments.len().saturating_sub(count);
        self.moments[first..].iter().map(|(_, poses)| poses).collect()
    }

    /// Where a body was, the last time last.
    fn of(&self, id: BodyId) -> Vec<(f64, Pose)> {
        let places =
            self.moments.iter().filter_map(|(time, poses)| Some((*time, *poses.get(&id)?)));
        places.collect()
    }
}

/// Draws the motion of all that moves up to a moment.
pub(super) fn push(
    list: &mut DrawList,
    trails: &Trails,
    coats: &Coats,
    moment: &Moment,
    camera: &Camera,
) {
    let moving = moment.poses.keys().filter_map(|&id| Some((id, coats.get(id)?)));
    let mut speeds: Vec<(DVec3, DVec3)> = Vec::new();
    for (id, coat) in moving.filter(|(_, coat)| coat.moves()) {
        let places = trails.of(id);
        push_way(list, coat, &places);
        push_ghosts(list, (id, coat), trails, &places);
        speeds.extend(velocity(coat, &places));
    }
    let height = 2.0 * camera.distance() * (0.5 * camera.field_of_view()).tan();
    push_velocities(list, &speeds, ARROW * height);
}

fn push_way(list: &mut DrawList, coat: &Coat, places: &[(f64, Pose)]) {
    let count = places.len().saturating_sub(1).max(1) as f32;
    let width = |k: usize| WAY[0] + (WAY[1] - WAY[0]) * k as f32 / count;
    for (k, ends) in places.windows(2).enumerate() {
        let [from, to] = [0, 1].map(|i| middle(coat, &ends[i].1));
        let (color, width) = (coat.color, [width(k), width(k + 1)]);
        list.lines.push(Line { from, to, color, width, on_top: true });
    }
}

/// At even times of the way, where the body has moved enough between them.
fn push_ghosts(
    list: &mut DrawList,
    (id, coat): (BodyId, &Coat),
    trails: &Trails,
    places: &[(f64, Pose)],
) {
    let Some((_, last)) = places.last() else { return };
    let apart = APART * coat.mesh.bounds().diagonal();
    let mut next = middle(coat, last);
    for k in (0..GHOSTS).rev() {
        let (time, pose) = &places[k * (places.len() - 1) / GHOSTS];
        let here = middle(coat, pose);
        if here.distance(next) >= apart {
            let color = coat.color.with_alpha(GHOST_ALPHA);
            let mesh = trails.shape(id, *time).unwrap_or(&coat.mesh).clone();
            list.instances.push(Instance::solid(mesh, *pose, color));
            next = here;
        }
    }
}

/// Where a body is, and its velocity over the last of its moments.
fn velocity(coat: &Coat, places: &[(f64, Pose)]) -> Option<(DVec3, DVec3)> {
    let [.., (before, from), (now, to)] = places else { return None };
    let [from, to] = [from, to].map(|pose| middle(coat, pose));
    Some((to, (to - from) / (now - before)))
}

/// One scale for all, by the fastest, whose speed is written beside it.
fn push_velocities(list: &mut DrawList, speeds: &[(DVec3, DVec3)], longest: f64) {
    let by_speed = |a: &&(DVec3, DVec3), b: &&(DVec3, DVec3)| a.1.length().total_cmp(&b.1.length());
    let Some(&(at, fastest)) = speeds.iter().max_by(by_speed) else { return };
    let most = fastest.length();
    if most <= 0.0 {
        return;
    }
    for &(from, velocity) in speeds {
        let to = from + velocity * (longest / most);
        list.push_arrow(from, to, palette::INK, SHAFT, true);
    }
    let tip = at + fastest * (longest / most);
    list.labels.push(Label::new(tip, format!("{} units a second", number(most))));
}

fn middle(coat: &Coat, pose: &Pose) -> DVec3 {
    pose.world_from_body().apply(coat.mesh.bounds().center())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_shapes::Cuboid;
    use cranny_world::description::{BodyDescription, BodyKind, Material, Normals};

    fn cube(size: f64) -> BodyDescription {
        BodyDescription {
            name: "cube".into(),
            collision: Arc::new(Cuboid { size: [size; 3] }.build().unwrap()),
            shape: None,
            visual: None,
            color: None,
            kind: BodyKind::Dynamic,
            pose: Pose::IDENTITY,
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            path: None,
            tracker: None,
            material: Material::default(),
            mass: None,
            normals: Normals::default(),
            sensor: false,
            layers: Vec::new(),
            effects: Vec::new(),
        }
    }

    #[test]
    fn a_ghost_has_the_shape_that_the_body_had_there() {
        let (id, mut coats, mut trails) = (BodyId(0), Coats::default(), Trails::default());
        let at = |time: f64| Pose::at(10.0 * time * DVec3::X);
        for time in [0.0, 1.0, 2.0, 3.0, 4.0] {
            if time == 0.0 || time == 2.0 {
                coats.put_described(id, &cube(1.0 + time)).unwrap();
            }
            trails.note(time, &BTreeMap::from([(id, at(time))]), &coats);
        }
        let mut list = DrawList::default();
        push_ghosts(&mut list, (id, coats.get(id).unwrap()), &trails, &trails.of(id));
        let ghost = |ghost: &Instance| {
            let size = ghost.mesh.bounds().diagonal() / 3f64.sqrt();
            (ghost.pose.translation.x, size.round())
        };
        let ghosts: Vec<(f64, f64)> = list.instances.iter().map(ghost).collect();
        assert_eq!(ghosts, [(30.0, 3.0), (20.0, 3.0), (10.0, 1.0), (0.0, 1.0)]);
    }
}
