//! How contacts look: patches with their curves, points by depth, one arrow a pair.

use cranny_exact::DVec3;
use cranny_narrow_phase::{Contact, Region};
use cranny_render::{
    Anchor, Camera, Color, DrawList, Key, Label, Line, Mark, Patch, Point, Ramp, palette,
};

use super::coats::Coats;
use super::focus::{Focus, contacts, middle, mover_of};
use super::hiding::Sight;
use super::{MeetingPair, Moment};

/// Contacts beyond these many are not marked: a picture of more shows nothing but marks.
pub const MARKS_MAX: usize = 2_000;

/// Length of the longest arrow, in parts of the picture's height.
const ARROW: f64 = 0.16;

/// An arrow is at least this part of the longest: shorter ones are heads without a shaft.
const SHORTEST: f64 = 0.25;

/// Pixels.
const POINT: f32 = 3.4;
/// Of more than [`CROWD`] contacts: they bury what they mark.
const CROWDED: f32 = 2.2;
const CROWD: usize = 60;
/// Of more contacts than this, those across a gap are left out.
const THRONG: usize = 250;
const CURVE: f32 = 2.2;
const THIN: f32 = 1.4;
const SHAFT: f32 = 2.4;

/// Alpha of marks behind a surface, of 255. Higher: they look painted on what hides them; lower:
/// they are not seen on dark bodies.
const BEHIND: u8 = 105;

/// A mark that lies no deeper beneath a surface than this part of the picture's height is on it, as
/// contacts between two bodies are.
const ON_SURFACE: f64 = 0.008;

/// Dashes of curves behind a surface, and what is between them: parts of the picture's height.
const DASH: f64 = 0.014;

/// Pieces at most that a segment is divided into: all of its dashes, where it is in the picture.
const PIECES_MAX: f64 = 256.0;

/// Segments of curves, at most, that are tested for being hidden; with more, all are drawn alike.
const SEGMENTS_MAX: usize = 20_000;

/// What colours and lengths are measured by.
pub(super) struct Scales<'a> {
    pub(super) impulse: f64,
    pub(super) depth: f64,
    pub(super) coats: &'a Coats,
}

impl Scales<'_> {
    fn point_color(&self, contact: &Contact) -> Color {
        match contact.separation > 0.0 {
            true => palette::GAP,
            false if self.depth > 0.0 => Ramp::Depth.color(-contact.separation / self.depth),
            false => Ramp::Depth.color(0.0),
        }
    }

    /// Of the longest arrow, how much a pair's is.
    fn share(&self, pair: &MeetingPair) -> f64 {
        let share = match self.impulse > 0.0 {
            true => pair.impulse / self.impulse,
            false if self.depth > 0.0 => pair.answer.depth() / self.depth,
            false => 0.0,
        };
        if share > 0.0 { share.clamp(SHORTEST, 1.0) } else { 0.0 }
    }

    /// Whether pairs have arrows: beside no other pair's, that of a depth says nothing.
    fn has_arrows(&self, moment: &Moment) -> bool {
        let of_pairs = moment.pairs.iter().filter(|pair| self.share(pair) > 0.0).count();
        of_pairs > usize::from(self.impulse <= 0.0)
    }

    /// What the marks of these pictures mean.
    pub(super) fn keys(&self, moment: &Moment) -> Vec<Key> {
        let all = || moment.pairs.iter().flat_map(|pair| contacts(&pair.answer));
        let mut keys = Vec::new();
        if all().any(|c| c.separation <= 0.0) {
            let text = format!("contact, by depth: 0 to {}", number(self.depth));
            keys.push(Key::new(Mark::Ramp(Ramp::Depth), text));
        }
        if all().count() <= THRONG && all().any(|c| c.separation > 0.0) {
            keys.push(Key::new(Mark::Body(palette::GAP), "contact across a gap"));
        }
        if self.has_arrows(moment) {
            let text = match self.impulse > 0.0 {
                true => format!("impulse of a step; the longest: {}", number(self.impulse)),
                false => format!("depth of a pair, enlarged; the longest: {}", number(self.depth)),
            };
            keys.push(Key::new(Mark::Arrow(palette::INK), text));
        }
        keys
    }
}

/// A number as people write it.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        a if (1e-4..1e4).contains(&a) => {
            let digits = (2 - a.log10().floor() as i32).clamp(0, 6) as usize;
            let text = format!("{x:.digits$}");
            let tail = if text.contains('.') { text.trim_end_matches('0') } else { &text };
            tail.trim_end_matches('.').to_owned()
        }
        _ => format!("{x:.1e}"),
    }
}

/// Marks all contacts of a moment.
pub(super) fn push_contacts(
    list: &mut DrawList,
    moment: &Moment,
    scales: &Scales<'_>,
    camera: &Camera,
) {
    let height = 2.0 * camera.distance() * (0.5 * camera.field_of_view()).tan();
    let sight = Sight::of(scales.coats, moment, camera.eye(), ON_SURFACE * height);
    let behind = |at: DVec3| sight.hides(at);
    let regions = || moment.pairs.iter().flat_map(|pair| &pair.answer.regions);
    let segments: usize = regions().flat_map(|r| &r.curves).map(|c| c.points.len()).sum();
    for region in regions() {
        push_region(list, region, |at| segments <= SEGMENTS_MAX && behind(at), DASH * height);
    }
    let count: usize = moment.pairs.iter().map(|pair| contacts(&pair.answer).count()).sum();
    let radius = if count > CROWD { CROWDED } else { POINT };
    let points = moment.pairs.iter().flat_map(|pair| contacts(&pair.answer)).take(MARKS_MAX);
    let mut points: Vec<Contact> =
        points.filter(|contact| count <= THRONG || contact.separation <= 0.0).collect();
    // The deepest are drawn over what is beside them.
    points.sort_by(|a, b| b.separation.total_cmp(&a.separation));
    for contact in points {
        let color = faint_if(behind(middle(&contact)), scales.point_color(&contact));
        list.points.push(Point { position: middle(&contact), color, radius, on_top: true });
    }
    for pair in moment.pairs.iter().filter(|_| scales.has_arrows(moment)) {
        push_arrow(list, pair, scales, ARROW * height, behind);
    }
}

fn faint_if(is_behind: bool, color: Color) -> Color {
    if is_behind { color.with_alpha(BEHIND) } else { color }
}

/// What fainter marks mean, where there are any.
pub(super) fn key_of_hidden(list: &DrawList) -> Option<Key> {
    let is_faint = |color: Color| color.a == BEHIND;
    let points = list.points.iter().any(|point| is_faint(point.color));
    let any = points || list.lines.iter().any(|line| is_faint(line.color));
    let faint = palette::INK.over(palette::PAPER, BEHIND);
    any.then(|| Key::new(Mark::Arrow(faint), "fainter, dashed: behind a surface"))
}

/// The area that a region's curves enclose; of a region across a gap, what its points surround.
fn push_region(list: &mut DrawList, region: &Region, behind: impl Fn(DVec3) -> bool, dash: f64) {
    let closed = region.curves.iter().filter(|curve| curve.closed && curve.points.len() > 2);
    let loops: Vec<Vec<DVec3>> = closed.map(|curve| curve.points.clone()).collect();
    if !loops.is_empty() {
        let color = palette::OVERLAP.with_alpha(120);
        list.patches.push(Patch { loops, color, on_top: true });
    } else if region.points.len() > 2 {
        let color = palette::GAP.with_alpha(90);
        list.patches.push(Patch { loops: vec![surrounding(region)], color, on_top: true });
    }
    for curve in &region.curves {
        let ends = curve.points.windows(2).map(|ends| [ends[0], ends[1]]);
        let last = curve.closed.then(|| [curve.points.last(), curve.points.first()]);
        let last = last.and_then(|[a, b]| Some([*a?, *b?]));
        let mut along = 0.0;
        for [from, to] in ends.chain(last) {
            match behind(0.5 * (from + to)) {
                true => push_dashes(list, [from, to], along, dash),
                false => {
                    let (color, width) = (palette::OVERLAP, [CURVE; 2]);
                    list.lines.push(Line { from, to, color, width, on_top: true });
                }
            }
            along += from.distance(to);
        }
    }
}

/// What of a segment lies in dashes of a curve: `along` is how far along it the segment begins.
fn push_dashes(list: &mut DrawList, [from, to]: [DVec3; 2], along: f64, dash: f64) {
    let length = from.distance(to);
    let pieces = (length / dash).ceil().clamp(1.0, PIECES_MAX);
    for k in 0..pieces as u32 {
        let [start, end] = [k, k + 1].map(|k| f64::from(k) / pieces);
        let middle = along + 0.5 * (start + end) * length;
        if (middle / dash) % 2.0 < 1.0 {
            let [from, to] = [start, end].map(|t| from.lerp(to, t));
            let (color, width) = (palette::OVERLAP.with_alpha(BEHIND), [THIN; 2]);
            list.lines.push(Line { from, to, color, width, on_top: true });
        }
    }
}

/// The points of a region around their middle, by their angle about its normal.
fn surrounding(region: &Region) -> Vec<DVec3> {
    let points: Vec<DVec3> = region.points.iter().map(middle).collect();
    let center = points.iter().sum::<DVec3>() / points.len() as f64;
    let u = region.normal.normalize_or(DVec3::Z).any_orthonormal_vector();
    let v = region.normal.normalize_or(DVec3::Z).cross(u);
    let angle = |p: &DVec3| (*p - center).dot(v).atan2((*p - center).dot(u));
    let mut around = points;
    around.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    around
}

/// The way the moving body is pushed, from where the pair meets deepest.
fn push_arrow(
    list: &mut DrawList,
    pair: &MeetingPair,
    scales: &Scales<'_>,
    longest: f64,
    behind: impl Fn(DVec3) -> bool,
) {
    let share = scales.share(pair);
    let least = contacts(&pair.answer).min_by(|a, b| a.separation.total_cmp(&b.separation));
    let Some(contact) = least.filter(|_| share > 0.0) else { return };
    let towards = if mover_of(scales.coats, pair) == pair.a { -1.0 } else { 1.0 };
    let from = middle(&contact);
    let to = from + towards * share * longest * contact.normal;
    let color = faint_if(behind(0.5 * (from + to)), palette::INK);
    list.push_arrow(from, to, color, SHAFT, true);
}

/// How far beside a contact its label stands, in parts of what the view reaches. Smaller: it covers
/// what it measures; larger: it leaves narrow pictures.
const BESIDE: f64 = 0.2;

/// Cosine between the way to a label and the picture's right from which on the text goes on that
/// way. Smaller: text beneath a contact runs over what leans; larger: it leaves narrow pictures.
const SIDEWAYS: f64 = 0.5;

/// Marks the contact that a close-up looks at: where, which way, how deep or how far apart.
pub(super) fn contact_of_focus(list: &mut DrawList, focus: &Focus, camera: &Camera, radius: f64) {
    let Some(contact) = &focus.contact else { return };
    let (point, normal) = (focus.point, contact.normal);
    let color = if contact.separation > 0.0 { palette::GAP } else { palette::OVERLAP };
    list.push_line(contact.point_a, contact.point_b, color, 2.5);
    if let Some(line) = list.lines.last_mut() {
        line.on_top = true;
    }
    // From outside, as a dimension is drawn: from within the bodies across a gap, else from beyond.
    let outward = if contact.separation > 0.0 { 1.0 } else { -1.0 };
    for (side, to) in [(-outward, contact.point_a), (outward, contact.point_b)] {
        let from = to + side * 0.3 * radius * normal;
        list.push_arrow(from, to + side * 0.03 * radius * normal, palette::INK, 1.6, true);
    }
    list.points.push(Point { position: point, color, radius: POINT, on_top: true });
    // Across the arrows, where neither they nor the surfaces' gap are.
    let [right, up, _] = camera.axes();
    let across = normal.cross(focus.plane).normalize_or(right);
    let aside = if across.dot(right) < 0.0 { -across } else { across };
    let anchor = match (aside.dot(right) > SIDEWAYS, aside.dot(up) > 0.0) {
        (true, _) => Anchor::Right,
        (false, true) => Anchor::Above,
        (false, false) => Anchor::Below,
    };
    let at = point + BESIDE * radius * aside;
    let (from, color) = (point + 0.2 * BESIDE * radius * aside, palette::INK.with_alpha(150));
    list.lines.push(Line { from, to: at, color, width: [1.0; 2], on_top: true });
    list.labels.push(Label { anchor, ..Label::new(at, how_deep(contact)) });
}

/// In words.
pub(super) fn how_deep(contact: &Contact) -> String {
    match contact.separation {
        s if s < 0.0 => format!("{} deep", number(-s)),
        0.0 => "touching".to_owned(),
        s => format!("{} apart", number(s)),
    }
}

/// A ring around what a close-up shows.
pub(super) fn ring(list: &mut DrawList, focus: &Focus, camera: &Camera) {
    let [right, up, _] = camera.axes();
    let at = |i: i32| {
        let angle = f64::from(i) / 48.0 * std::f64::consts::TAU;
        focus.point + focus.radius * (angle.cos() * right + angle.sin() * up)
    };
    for i in 0..48 {
        let (from, to) = (at(i), at(i + 1));
        let color = palette::INK.with_alpha(190);
        list.lines.push(Line { from, to, color, width: [1.4; 2], on_top: true });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_a_curve_behind_a_surface_is_drawn_however_it_is_divided() {
        for count in [1, 7, 400] {
            let mut list = DrawList::new();
            let at = |k: usize| DVec3::X * (k as f64 / count as f64);
            for k in 0..count {
                push_dashes(&mut list, [at(k), at(k + 1)], at(k).x, 0.1);
            }
            let drawn: f64 = list.lines.iter().map(|line| line.from.distance(line.to)).sum();
            assert!((0.4..0.6).contains(&drawn), "{count} segments: {drawn}");
            assert!(list.lines.iter().all(|line| line.color.a == BEHIND));
            assert!(key_of_hidden(&list).is_some());
        }
        assert_eq!(key_of_hidden(&DrawList::new()), None);
    }

    #[test]
    fn numbers_are_short_and_keep_three_digits() {
        let pairs = [
            (0.0, "0"),
            (0.012_34, "0.0123"),
            (9.87e-4, "0.000987"),
            (5.0, "5"),
            (1234.5, "1234"),
            (0.5, "0.5"),
        ];
        for (x, text) in pairs {
            assert_eq!(number(x), text);
        }
        assert_eq!((number(1.5e-7), number(3e9)), ("1.5e-7".to_owned(), "3.0e9".to_owned()));
        assert_eq!(number(100.0), "100");
    }
}
