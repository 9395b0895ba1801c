//! A page of a moment: all of it beside a section through what touches, and that magnified.

use cranny_narrow_phase::Contact;
use cranny_render::{
    Camera, Color, DrawList, Image, ImageSize, Key, Mark, Panel, Renderer, Sheet, Style, palette,
};

use super::coats::{Coat, Coats};
use super::focus::{Focus, contacts, look_into, nearest};
use super::marks::number;
use super::names::name_touching;
use super::{MeetingPair, Moment, ScenePainter, marks};
use crate::error::SceneAppError;

/// What of a page's width each of its pictures takes: all, the section, and that magnified.
const SHARES: [f64; 3] = [0.46, 0.31, 0.23];

/// Bodies that the legend of a whole scene names at most. More: it is longer than the picture.
const NAMED: usize = 5;

/// Of 255: how a body that is seen through looks in the legend.
const SHEER: u8 = 110;

/// Pixels between pictures.
const GAPS: u32 = 12;

/// Sizes of a page's pictures, from the page's width and their height.
pub(crate) fn panel_sizes(width: u32, height: u32) -> Option<[ImageSize; 3]> {
    let room = f64::from(width.saturating_sub(GAPS));
    let sizes = SHARES.map(|share| ImageSize::new((share * room).round() as u32, height));
    let [Ok(all), Ok(section), Ok(magnified)] = sizes else { return None };
    Some([all, section, magnified])
}

impl ScenePainter {
    /// A moment that explains itself: the scene, what touches cut open, how deep, and in words.
    ///
    /// # Errors
    ///
    /// Where a picture cannot be drawn.
    pub fn page(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        width: u32,
        height: u32,
    ) -> Result<Image, SceneAppError> {
        let (name, camera) = self.cameras[0].clone();
        let failed = |why: String| SceneAppError::Picture { camera: name.clone(), why };
        let sizes = panel_sizes(width, height)
            .ok_or_else(|| failed(format!("a page of {width} x {height} pixels is no picture")))?;
        let mut moment = moment.clone();
        let first = Focus::of(&self.coats, &moment, self.focus.as_ref(), &camera);
        let surely = first.map_or(Vec::new(), |focus| focus.bodies);
        look_into(&self.coats, &mut moment, &surely);
        let lonely = moment.pairs.is_empty();
        let nearest = if lonely { nearest(&self.coats, &moment) } else { None };
        let mut looked_at = moment.clone();
        looked_at.pairs.extend(nearest.clone());
        let focus = Focus::of(&self.coats, &looked_at, self.focus.as_ref(), &camera);
        let mut list = self.view(&moment, &camera);
        if let Some(focus) = &focus {
            marks::ring(&mut list, focus, &camera);
        }
        let mut panels = Vec::new();
        let image = self.render(renderer, &list, &camera, sizes[0]);
        let image = image.map_err(|error| failed(error.to_string()))?;
        panels.push(Panel { image, title: String::new(), scale: Some(scale(&camera, sizes[0])) });
        let beside = self.beside(sizes);
        let close_ups = self.close_ups(&moment, focus.as_ref(), &beside);
        for (list, camera, size, title) in close_ups.map_err(failed)? {
            let image = self.render(renderer, &list, &camera, size);
            let image = image.map_err(|error| failed(error.to_string()))?;
            panels.push(Panel { image, title, scale: Some(scale(&camera, size)) });
        }
        if focus.as_ref().is_some_and(|focus| focus.contact.is_some()) {
            panels[1].title.insert_str(0, "the circle: ");
        }
        let mut keys = self.keys(&moment, focus.as_ref());
        keys.extend(marks::key_of_hidden(&list));
        let caption = vec![caption(
            &self.coats,
            &moment,
            nearest.as_ref(),
            focus.as_ref(),
            self.without_contacts,
        )];
        self.focus = focus;
        let sheet = Sheet { title: self.title.clone(), panels, keys, caption };
        sheet.compose().map_err(|error| failed(error.to_string()))
    }

    /// The section through what touches, alone.
    pub(super) fn section(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        size: ImageSize,
    ) -> Result<Image, SceneAppError> {
        let (name, camera) = self.cameras[0].clone();
        let failed = |why: String| SceneAppError::Picture { camera: name.clone(), why };
        let mut looked_at = moment.clone();
        if looked_at.pairs.is_empty() {
            looked_at.pairs.extend(nearest(&self.coats, moment));
        }
        let focus = Focus::of(&self.coats, &looked_at, self.focus.as_ref(), &camera);
        let views = self.close_ups(moment, focus.as_ref(), &[size, size]).map_err(failed)?;
        let (list, camera, size, title) =
            views.into_iter().next().ok_or_else(|| failed("there is no body".to_owned()))?;
        let mut image = self.render(renderer, &list, &camera, size);
        self.focus = focus;
        if let Ok(image) = &mut image {
            image.write([8, 8], &title, 15.0, palette::INK, Some(palette::PAPER));
        }
        image.map_err(|error| failed(error.to_string()))
    }

    /// Sizes of the pictures beside the whole: without contacts nothing is ever magnified, and the
    /// section takes the place.
    fn beside(&self, [_, section, magnified]: [ImageSize; 3]) -> Vec<ImageSize> {
        let width = section.width() + GAPS / 2 + magnified.width();
        let wide = ImageSize::new(width, section.height()).ok();
        match wide.filter(|_| self.without_contacts.is_some()) {
            Some(wide) => vec![wide],
            None => vec![section, magnified],
        }
    }

    /// The section, and what it shows magnified.
    fn close_ups(
        &self,
        moment: &Moment,
        focus: Option<&Focus>,
        sizes: &[ImageSize],
    ) -> Result<Vec<(DrawList, Camera, ImageSize, String)>, String> {
        let mut views = Vec::new();
        let whole = focus.map(|focus| (focus, focus.radius));
        let magnified = focus.and_then(|focus| Some((focus, focus.magnified()?)));
        for (view, &size) in [whole, magnified].into_iter().zip(sizes) {
            let Some((focus, radius)) = view else { continue };
            let mut list = self.bodies(moment);
            list.section = focus.section();
            list.ground = None;
            let camera = focus.camera(radius).map_err(|error| error.to_string())?;
            marks::contact_of_focus(&mut list, focus, &camera, radius);
            views.push((list, camera, size, self.close_up_title(focus, radius)));
        }
        // A page keeps its size: where nothing is to be magnified, an empty picture.
        while views.len() < sizes.len() {
            let camera = focus.map(|focus| focus.camera(focus.radius));
            let camera = camera.unwrap_or_else(|| Ok(self.cameras[0].1));
            let camera = camera.map_err(|error| error.to_string())?;
            views.push((DrawList::new(), camera, sizes[views.len()], String::new()));
        }
        Ok(views)
    }

    fn close_up_title(&self, focus: &Focus, radius: f64) -> String {
        let name = |id| self.coats.name(id);
        match (&focus.bodies[..], &focus.contact) {
            (&[a, b], Some(_)) if radius == focus.radius => {
                format!("{} and {} cut open", name(a), name(b))
            }
            (_, Some(_)) => {
                format!("its middle, {} x as large", number((focus.radius / radius).round()))
            }
            (bodies, None) => {
                let names: Vec<&str> = bodies.iter().map(|&id| name(id)).collect();
                let why = self.without_contacts.unwrap_or("nothing is near");
                format!("{} cut open; {why}", names.join(" and "))
            }
        }
    }

    /// All of the scene in a style that shows what is inside and behind, with its legend.
    pub(super) fn seen_through(
        &mut self,
        renderer: &mut Renderer,
        moment: &Moment,
        style: Style,
        size: ImageSize,
    ) -> Result<Image, SceneAppError> {
        let (name, camera) = self.cameras[0].clone();
        let failed = |why: String| SceneAppError::Picture { camera: name.clone(), why };
        let mut moment = moment.clone();
        look_into(&self.coats, &mut moment, &[]);
        let mut list = self.view(&moment, &camera);
        list.instances.iter_mut().for_each(|instance| instance.style = style);
        name_touching(&mut list, &self.coats, &moment, (&camera, size));
        let image = self.render(renderer, &list, &camera, size);
        let image = image.map_err(|error| failed(error.to_string()))?;
        let what = if style == Style::XRay { "x-ray" } else { "wireframe" };
        let panel = Panel { image, title: String::new(), scale: Some(scale(&camera, size)) };
        let mut keys = self.keys_of_bodies(&moment, style);
        keys.extend(self.keys_of_marks(&moment));
        keys.extend(marks::key_of_hidden(&list));
        let caption = vec![caption(&self.coats, &moment, None, None, self.without_contacts)];
        let title = format!("{}: {what}", self.title);
        let sheet = Sheet { title, panels: vec![panel], keys, caption };
        sheet.compose().map_err(|error| failed(error.to_string()))
    }

    /// Bodies that move by name, if they are few.
    fn keys_of_bodies(&self, moment: &Moment, style: Style) -> Vec<Key> {
        let (mark, how): (fn(_) -> _, _) = match style {
            Style::XRay => {
                (|color: Color| Mark::Body(color.over(palette::PAPER, SHEER)), "translucent")
            }
            _ => (Mark::Line, "edges"),
        };
        let coats: Vec<&Coat> = self.placed(moment).filter_map(|id| self.coats.get(id)).collect();
        let moving = || coats.iter().filter(|coat| coat.moves());
        let mut keys: Vec<Key> = match moving().count() {
            0..=NAMED => moving().map(|coat| Key::new(mark(coat.color), &*coat.name)).collect(),
            _ => {
                let text = format!("{how}: bodies that move, a colour each");
                moving().take(1).map(|coat| Key::new(mark(coat.color), &*text)).collect()
            }
        };
        if coats.iter().any(|coat| !coat.moves()) {
            keys.push(Key::new(mark(palette::STATIONARY), "stands still"));
        }
        keys
    }

    fn keys_of_marks(&self, moment: &Moment) -> Vec<Key> {
        let mut keys = Vec::new();
        if moment.pairs.iter().any(|pair| pair.answer.depth() > 0.0) {
            let text = "overlap; lines: surfaces cross";
            keys.push(Key::new(Mark::Body(palette::OVERLAP), text));
        }
        keys.extend(self.scales().keys(moment));
        keys
    }

    fn keys(&self, moment: &Moment, focus: Option<&Focus>) -> Vec<Key> {
        let mut keys = Vec::new();
        for id in focus.iter().flat_map(|focus| &focus.bodies) {
            if let Some(coat) = self.coats.get(*id) {
                let still = if coat.moves() { "" } else { " (stands still)" };
                keys.push(Key::new(Mark::Hatched(coat.color), format!("{}{still}", coat.name)));
            }
        }
        let is_grey = |coat: &Coat| !coat.moves() && coat.color == palette::STATIONARY;
        let focused = focus.iter().flat_map(|focus| &focus.bodies);
        let is_named = focused.filter_map(|&id| self.coats.get(id)).any(is_grey);
        if !is_named && self.coats.iter().any(|(_, coat)| is_grey(coat)) {
            keys.push(Key::new(Mark::Body(palette::STATIONARY), "stands still"));
        }
        keys.extend(self.keys_of_marks(moment));
        keys
    }
}

/// Units a pixel, where a camera looks.
pub(super) fn scale(camera: &Camera, size: ImageSize) -> f64 {
    2.0 * camera.distance() * (0.5 * camera.field_of_view()).tan() / f64::from(size.height())
}

/// When, how many contacts, how deep; how near where nothing overlaps; and what is shown, where
/// that is another contact.
fn caption(
    coats: &Coats,
    moment: &Moment,
    nearest: Option<&MeetingPair>,
    focus: Option<&Focus>,
    without_contacts: Option<&str>,
) -> String {
    let points: usize = moment.pairs.iter().map(|pair| contacts(&pair.answer).count()).sum();
    let plural = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let count = match moment.pairs.len() {
        0 => without_contacts.unwrap_or("no contacts").to_owned(),
        pairs => format!("{} of {}", plural(points, "contact"), plural(pairs, "pair")),
    };
    let names = |pair: &MeetingPair| format!("{} and {}", coats.name(pair.a), coats.name(pair.b));
    let all = || moment.pairs.iter().chain(nearest);
    let by_depth = all().max_by(|a, b| a.answer.depth().total_cmp(&b.answer.depth()));
    let by_gap = || all().min_by(|a, b| gap(a).total_cmp(&gap(b)));
    let (extreme, length) = match by_depth.filter(|pair| pair.answer.depth() > 0.0) {
        Some(pair) => {
            let depth = number(pair.answer.depth());
            (format!("; deepest: {}, {depth}", names(pair)), depth)
        }
        None => by_gap().map_or_else(Default::default, |pair| {
            let gap = number(gap(pair).max(0.0));
            (format!("; no overlap; nearest: {}, {gap} apart", names(pair)), gap)
        }),
    };
    let shown = shown_beside(focus.and_then(|focus| focus.contact.as_ref()), &length);
    format!("t = {:.3} s; {count}{extreme}{shown}", moment.time)
}

/// Names a contact that is shown where the extreme one, so deep or so far apart, is another.
fn shown_beside(shown: Option<&Contact>, extreme: &str) -> String {
    let other = shown.filter(|contact| number(contact.separation.abs()) != extreme);
    other.map_or(String::new(), |contact| format!("; shown: {}", marks::how_deep(contact)))
}

fn gap(pair: &MeetingPair) -> f64 {
    contacts(&pair.answer).map(|contact| contact.separation).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::{UNCOMPUTED, UNRECORDED};
    use super::*;
    use cranny_exact::DVec3;
    use cranny_geometry::VertexId;
    use cranny_narrow_phase::Feature;

    #[test]
    fn what_is_not_computed_is_not_said_to_be_absent() {
        let words = |without| caption(&Coats::default(), &Moment::default(), None, None, without);
        assert_eq!(words(None), "t = 0.000 s; no contacts");
        assert_eq!(
            words(Some(UNCOMPUTED)),
            "t = 0.000 s; contacts are not computed: no effect needs them"
        );
        assert_eq!(words(Some(UNRECORDED)), "t = 0.000 s; contacts are not recorded");
    }

    #[test]
    fn a_contact_that_is_not_the_extreme_one_is_named() {
        let vertex = Feature::Vertex(VertexId(0));
        let contact = |separation| Contact {
            id: (vertex, vertex),
            point_a: DVec3::ZERO,
            point_b: separation * DVec3::Z,
            normal: DVec3::Z,
            separation,
        };
        let shown = |separation, extreme| shown_beside(Some(&contact(separation)), extreme);
        assert_eq!(shown(-0.00151, "0.00156"), "; shown: 0.00151 deep");
        assert_eq!(shown(0.00824, "0.00529"), "; shown: 0.00824 apart");
        assert_eq!(shown(-0.00156, "0.00156"), "");
        assert_eq!(shown_beside(None, "0.1"), "");
    }
}
