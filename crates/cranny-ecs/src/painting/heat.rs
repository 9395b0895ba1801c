//! What the search of the narrow phase looks at, painted on the bodies as heat: from nothing, and
//! with what the frames before have left.
//!
//! The queries are its own, on an observed copy of the search: the run knows nothing of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_exact::Pose;
use cranny_geometry::Model;
use cranny_narrow_phase::{
    Counters, Demand, PairMemory, Placed, Query, SearchHeat, query_observed,
};
use cranny_primitives::BodyShape;
use cranny_render::palette::COLD;
use cranny_render::{
    Camera, CameraError, Color, DrawList, DrawMesh, Image, ImageSize, Key, Mark, Panel, Ramp,
    RenderError, Renderer, Sheet,
};
use cranny_world::BodyId;

use super::coats::Coats;
use super::focus::{Focus, contacts};
use super::marks::number;
use super::page::scale;
use super::{MeetingPair, Moment, ScenePainter, marks};
use crate::error::SceneAppError;

/// Frames before the one that is shown which memory goes through. Fewer: what motion has spent is
/// not yet what it mostly is; more: nothing changes but the time.
const FRAMES_BEFORE: usize = 12;

/// Pairs at most whose search is painted: with more, bodies are too small to be seen.
const PAIRS: usize = 64;

/// Title of what lies around the deepest contact.
const MAGNIFIED: &str = "the circle, magnified";

/// What searches of pairs at a moment looked at.
#[derive(Default)]
struct Heat {
    /// How often each face was looked at.
    of_faces: BTreeMap<BodyId, Vec<u64>>,
    work: Counters,
}

impl Heat {
    fn add(&mut self, bodies: [BodyId; 2], heat: &SearchHeat, work: Counters) {
        self.work += work;
        for (body, id) in bodies.into_iter().enumerate() {
            let times = heat.looked_at(body);
            let all = self.of_faces.entry(id).or_insert_with(|| vec![0; times.len()]);
            all.iter_mut().zip(times).for_each(|(all, times)| *all += times);
        }
    }

    fn hottest(&self) -> u64 {
        self.of_faces.values().flatten().copied().max().unwrap_or(0)
    }

    /// Bodies in the colours of their faces.
    fn paint(&self, coats: &Coats, list: &mut DrawList, ids: &[BodyId], hottest: u64) {
        for (id, instance) in ids.iter().zip(&mut list.instances) {
            instance.color = COLD;
            let Some((model, times)) = model(coats, *id).zip(self.of_faces.get(id)) else {
                continue;
            };
            let color = |&times: &u64| Ramp::Heat.color_of_count(times, hottest);
            let colors: Vec<Color> = times.iter().map(color).collect();
            let mesh = model.mesh();
            let drawn = DrawMesh::with_face_colors(mesh.vertices(), mesh.faces(), &colors);
            if let Ok(drawn) = drawn {
                instance.mesh = Arc::new(drawn);
                instance.color = Color::WHITE;
            }
        }
    }

    /// The total in words.
    fn in_words(&self) -> String {
        let boxes = self.work.node_tests + self.work.front_tested;
        let Counters { cluster_tests, triangle_tests, .. } = self.work;
        format!(
            "{} pairs of boxes, {} of clusters, {} of faces or features",
            grouped(boxes),
            grouped(cluster_tests),
            grouped(triangle_tests)
        )
    }
}

/// Digits in groups of three.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn model(coats: &Coats, id: BodyId) -> Option<&Model> {
    coats.get(id)?.shape.as_ref().and_then(BodyShape::model)
}

/// Searches a pair at the last of several moments: from nothing, and after those before.
fn search(
    coats: &Coats,
    bodies: [BodyId; 2],
    moments: &[&BTreeMap<BodyId, Pose>],
    question: &Query,
    heats: &mut [Heat; 2],
) -> Option<()> {
    let [Some(a), Some(b)] = bodies.map(|id| model(coats, id)) else { return None };
    let placed = |poses: &BTreeMap<BodyId, Pose>| {
        let [pose_a, pose_b] = bodies.map(|id| poses.get(&id).copied());
        Some([Placed { model: a, pose: pose_a? }, Placed { model: b, pose: pose_b? }])
    };
    let (now, before) = moments.split_last()?;
    let mut memory = PairMemory::default();
    for poses in before {
        placed(poses).and_then(|placed| ask(placed, question, &mut memory));
    }
    let now = placed(now)?;
    for (heat, memory) in heats.iter_mut().zip([&mut PairMemory::default(), &mut memory]) {
        let (work, found) = ask(now, question, memory)?;
        heat.add(bodies, &found, work);
    }
    Some(())
}

fn ask<'m>(
    [a, b]: [Placed<'m>; 2],
    question: &Query,
    memory: &mut PairMemory,
) -> Option<(Counters, SearchHeat<'m>)> {
    let mut heat = SearchHeat::of([a.model, b.model]);
    let answer = query_observed(a, b, question, memory, &mut heat).ok()?;
    Some((answer.counters, heat))
}

impl ScenePainter {
    /// The scene twice, painted by how often faces are looked at: by a search from nothing, and by
    /// one of the next frame; each with what lies around the deepest contact.
    pub(super) fn heat(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        [width, height]: [u32; 2],
    ) -> Result<Image, SceneAppError> {
        self.follow(moment.time, &moment.poses);
        let (name, _) = self.cameras[0].clone();
        let failed = |why: String| SceneAppError::Picture { camera: name.clone(), why };
        let sizes = panel_sizes(width, height)
            .ok_or_else(|| failed(format!("{width} x {height} pixels are no picture")))?;
        let (question, what) = question(&moment.pairs);
        let moments = self.trails.last(FRAMES_BEFORE + 1);
        let mut heats = [Heat::default(), Heat::default()];
        let searched = pairs(&self.coats, moment)
            .into_iter()
            .filter_map(|pair| search(&self.coats, pair, &moments, &question, &mut heats));
        let words = match searched.count() {
            0 => "no two meshes are near each other: nothing is searched".to_owned(),
            1 => format!("the search for {what} of 1 pair"),
            n => format!("the search for {what} of {n} pairs"),
        };
        let before = moments.len() - 1;
        let hottest = heats.iter().map(Heat::hottest).max().unwrap_or(0);
        let panels = self.heat_panels(renderer, moment, &heats, sizes);
        let panels = panels.map_err(|error| failed(error.to_string()))?;
        let [cold, warm] = &heats;
        let mut caption = vec![format!("t = {:.3} s; {words}", moment.time)];
        let mut keys = vec![Key::new(Mark::Body(COLD), "not looked at")];
        if hottest > 0 {
            let most = grouped(hottest);
            keys.push(Key::new(
                Mark::Ramp(Ramp::Heat),
                format!("compared 1 to {most} times (logarithmic): the face, its cluster of at most eight, or the box of that"),
            ));
            caption.push(format!("from nothing: {}", cold.in_words()));
            caption.push(format!(
                "next frame, with what the {before} before have left: {}",
                warm.in_words()
            ));
        }
        let title = format!("{}: heat of the search", self.title);
        let sheet = Sheet { title, panels, keys, caption };
        sheet.compose().map_err(|error| failed(error.to_string()))
    }
}

impl ScenePainter {
    /// For each heat the scene, and what lies around its deepest contact, where there is one.
    fn heat_panels(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        heats: &[Heat; 2],
        [whole, close]: [ImageSize; 2],
    ) -> Result<Vec<Panel>, RenderError> {
        let (_, camera) = self.cameras[0].clone();
        let focus = Focus::of(&self.coats, moment, self.focus.as_ref(), &camera)
            .filter(|focus| focus.contact.is_some());
        let close_up = focus.as_ref().and_then(|focus| around(focus, &camera).ok());
        // Alone, it takes the room of both.
        let both = ImageSize::new(whole.width() + close.width(), whole.height()).unwrap_or(whole);
        let whole = if close_up.is_some() { whole } else { both };
        let close_up = close_up.map(|close_up| (close_up, MAGNIFIED, close));
        let hottest = heats.iter().map(Heat::hottest).max().unwrap_or(0);
        let ids: Vec<BodyId> = self.placed(moment).collect();
        let mut panels = Vec::new();
        for (heat, title) in heats.iter().zip(["from nothing", "next frame"]) {
            let mut painted = self.bodies(moment);
            heat.paint(&self.coats, &mut painted, &ids, hottest);
            for (camera, title, size) in [(camera, title, whole)].into_iter().chain(close_up) {
                let mut list = painted.clone();
                match &focus {
                    Some(_) if title == MAGNIFIED => list.ground = None,
                    Some(focus) => marks::ring(&mut list, focus, &camera),
                    None => {}
                }
                let image = self.render(renderer, &list, &camera, size)?;
                let (title, scale) = (title.to_owned(), Some(scale(&camera, size)));
                panels.push(Panel { image, title, scale });
            }
        }
        self.focus = focus;
        Ok(panels)
    }
}

/// What of a page's width the scene takes, and what lies around its deepest contact; both twice.
const SHARES: [f64; 2] = [0.28, 0.22];

/// Sizes of a page's pictures, from the page's width and their height.
pub(super) fn panel_sizes(width: u32, height: u32) -> Option<[ImageSize; 2]> {
    let sizes = SHARES.map(|share| ImageSize::new((share * f64::from(width)) as u32, height));
    let [Ok(whole), Ok(close)] = sizes else { return None };
    Some([whole, close])
}

/// The same way as a camera looks, at what is in the ring.
fn around(focus: &Focus, camera: &Camera) -> Result<Camera, CameraError> {
    let half = 0.5 * Camera::FIELD_OF_VIEW.to_radians();
    Camera::look_at(focus.point + focus.radius / half.tan() * camera.axes()[2], focus.point)
}

/// Pairs that met; where none did, those of which the boxes do.
fn pairs(coats: &Coats, moment: &Moment) -> Vec<[BodyId; 2]> {
    if !moment.pairs.is_empty() {
        return moment.pairs.iter().map(|pair| [pair.a, pair.b]).take(PAIRS).collect();
    }
    let placed = coats.iter().filter_map(|(id, coat)| Some((id, coat, moment.poses.get(&id)?)));
    let boxed: Vec<_> =
        placed.map(|(id, coat, pose)| (id, coat.moves(), coat.bounds(pose))).collect();
    let each =
        boxed.iter().enumerate().flat_map(|(k, a)| boxed[k + 1..].iter().map(move |b| (a, b)));
    let near = each.filter(|(a, b)| (a.1 || b.1) && a.2.overlaps(&b.2));
    near.map(|(a, b)| [a.0, b.0]).take(PAIRS).collect()
}

/// What is searched for, in words too: contacts as far as those that were found, or the distance
/// where there are none.
fn question(pairs: &[MeetingPair]) -> (Query, String) {
    if pairs.is_empty() {
        return (Query::of(Demand::Distance { below: None }), "the distance".to_owned());
    }
    let margin = margin(pairs);
    (Query::of(Demand::contacts(margin)), format!("contacts within {}", number(margin)))
}

/// As far as the contacts go that were found.
fn margin(pairs: &[MeetingPair]) -> f64 {
    let gaps = pairs.iter().flat_map(|pair| contacts(&pair.answer)).map(|c| c.separation);
    gaps.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_by_three() {
        let texts = [0, 999, 1_000, 12_345_678].map(grouped);
        assert_eq!(texts, ["0", "999", "1,000", "12,345,678"]);
    }
}
