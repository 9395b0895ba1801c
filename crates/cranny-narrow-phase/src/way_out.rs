//! The way out of a region of overlap: a direction, and the least translation along it that parts
//! the region.
//!
//! Mostly it is the direction of the area that the region's curves enclose. That may lead along
//! sides that overlap by a hair, over the gap between two turns of a thread, or through two places
//! of contact that have grown together: then the region is many times as deep along it as it takes
//! to part it. So where the curves reach as far along that direction as the region is deep, and
//! its vertices have far shorter ways out, the region is looked at again. Where the deepest
//! contact reaches over a gap and the pieces part sooner, what lies beyond the gap does not count.
//! Otherwise other directions are measured as well: the least translation that leads all those
//! vertices out, without the sides that graze and with them, normals of the faces, and what is
//! half-way between it and each of them. One of these counts only if the pieces part along it: rays
//! may miss what lies across. (Whole faces are looked at; of coarse meshes they may hold where the
//! pieces do not.) What is squeezed from both ends parts along none: a tongue in a slot, a thread
//! in a thread that is out of phase. Where the deepest contact reaches over a gap there, or most
//! sides graze, the region is as deep as the deepest vertex or middle of a face, and moving it so
//! far does not part it.

use cranny_exact::{Aabb, DVec3, classify_triangles};

use crate::answer::{Contact, Counters, Feature};
use crate::contacts::nearer;
use crate::depth::{MeasuredRegion, Way};
use crate::inside::is_inside;
use crate::nearest_on::NearestOn;
use crate::pair::Side;
use cranny_geometry::FaceId;
use cranny_geometry::triangle_distance::Prepared;

/// The cosine of how far from a direction a face may look that stops what comes along it: 60
/// degrees.
const LOOKS_ALONG: f64 = 0.5;

/// Faces of a region whose normals are tried as its direction, at most, a side; of more, these are
/// evenly spread. More: the least depth is found more often; fewer: regions of thousands of faces
/// take less time.
const MAX_DIRECTIONS: usize = 64;

/// Cosine of the angle (3 degrees) between directions that are tried. A larger angle: sides that
/// overlap by a hair look as deep as they are high times its sine; a smaller one: more are tried.
const ALIKE: f64 = 0.9986;

/// Two directions up to 9 degrees beyond a right angle have another half-way between them; this is
/// the sine of those 9 degrees. Larger: more are tried; smaller: a corner that is less than a right
/// angle by rounding has no way out (reasoned: with 0 all tests pass).
const ASIDE: f64 = 0.15;

/// A region is looked at from other directions where its curves reach farther along its own than
/// this part of its depth. Larger: regions that have grown together keep a depth of one along
/// another; smaller: what lies in a plane is measured in vain.
const REACHES: f64 = 0.5;

/// Cosine of how nearly opposite to each other two faces are that graze each other, and of how
/// nearly along the region's direction: those there are what has dug in.
const OPPOSITE: f64 = 0.9;

/// By what part of the depth sides that graze each other overlap at most; and to what part of its
/// way a vertex is near another face, where that way leads past it.
const HAIR: f64 = 0.05;

/// How many times deeper a region is along its own direction than along another that takes its
/// place. Smaller: normals jump from step to step; larger: depths are of no use.
const FAR_DEEPER: f64 = 3.0;

/// By how much farther than before the pieces are moved until they are parted, or have been moved
/// too far. Smaller: more tries; larger: what is nearly too deep is not seen to part.
const FARTHER: f64 = 1.25;

/// Rounds in which the least translation is sought that leads all out. More: where many normals lie
/// close to each other it is found better; fewer: it is found sooner.
const ROUNDS: usize = 32;

/// Vertices and faces of a piece that are measured at most; of more, these are evenly spread.
const MAX_SAMPLES: usize = 256;

/// What of a region is wanted beside its deepest contact.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Others {
    None,
    /// Contacts along the way out.
    Along,
    /// For inner vertices, or some of many, their own nearest ways out.
    Nearest,
}

/// The deepest contact of a region along its way out, and others, in the pair's frame.
pub(crate) fn way_out(region: &MeasuredRegion, others: Others) -> (Contact, Vec<Contact>) {
    let keeps = others == Others::Along;
    let own = region.measure(Way::along(own_direction(region)), keeps);
    let nearest = (others == Others::Nearest).then(|| nearest_ways_out(region, &own.0));
    let enough = -own.0.separation / FAR_DEEPER;
    let shallower = shallower(region, &own.0, (nearest.as_deref(), enough));
    let found = shallower.and_then(|shallower| match shallower {
        Shallower::Along(way) => Some(region.measure(way, keeps)),
        Shallower::Inside => {
            let place = deepest_place(region).filter(|c| c.separation > own.0.separation);
            let others = || if keeps { nearest_ways_out(region, &own.0) } else { Vec::new() };
            place.map(|place| (place, others()))
        }
    });
    let (deepest, along) = found.unwrap_or(own);
    (deepest, nearest.unwrap_or(along))
}

/// The direction of the area that the curves enclose; of the least depth where they enclose none.
fn own_direction(region: &MeasuredRegion) -> DVec3 {
    region.outline().normal().unwrap_or_else(|| {
        let [from, to] = Side::BOTH.map(|side| region.pair.bounds(side).center());
        let toward = (to - from).try_normalize().unwrap_or(DVec3::Z);
        let tried = directions(region, Some(toward));
        least_deep(region, tried, f64::INFINITY, |_, _| true).unwrap_or(toward)
    })
}

/// How a region is far less deep than along its own direction.
enum Shallower {
    /// It parts along this way.
    Along(Way),
    /// It parts in no direction that is tried, and is as deep as its deepest place.
    Inside,
}

/// How a region is less deep than `enough`, although its deepest contact `own` is deeper: along the
/// same normal, where that contact reaches over a gap, as from one turn of a thread to another;
/// where it does not part so, in another direction; where it parts in none that is tried, but the
/// contact reaches over a gap or most sides graze, as deep as its deepest place.
fn shallower(
    region: &MeasuredRegion,
    own: &Contact,
    (nearest, enough): (Option<&[Contact]>, f64),
) -> Option<Shallower> {
    let depth = -own.separation;
    if depth <= region.clear() || region.reach_of_curves(own.normal) <= REACHES * depth {
        return None;
    }
    let inside = inside(region, own, (nearest, enough))?;
    let reaches_over_a_gap = region.reaches_over_a_gap(own);
    if reaches_over_a_gap && let Some(most) = parts_at(region, own.normal, (region.clear(), enough))
    {
        return Some(Shallower::Along(Way { normal: own.normal, most }));
    }
    if let Some(n) = parts_along(region, own, &inside, enough) {
        return Some(Shallower::Along(Way::along(n)));
    }
    (reaches_over_a_gap || mostly_grazes(region, own)).then_some(Shallower::Inside)
}

/// Whether a region parts by less than a depth, in whatever direction. `own` is its deepest contact
/// along some direction.
pub(crate) fn parts_within(region: &MeasuredRegion, own: &Contact, depth: f64) -> bool {
    let Some(inside) = inside(region, own, (None, depth)) else { return false };
    let [_, apart] = least_translations(region, own, &inside);
    let tried = apart.try_normalize().map_or(Vec::new(), |n| directions(region, Some(n)));
    tried.into_iter().any(|n| parts_at(region, n, (apart.length(), depth)).is_some())
}

/// The direction in which a region parts by the least, if that is less than `enough`.
fn parts_along(
    region: &MeasuredRegion,
    own: &Contact,
    inside: &[Contact],
    enough: f64,
) -> Option<DVec3> {
    let [out, apart] = least_translations(region, own, inside);
    if out.length() >= enough {
        return None;
    }
    let tried = [out, apart].map(|way| directions(region, way.try_normalize())).concat();
    let parts = |n: DVec3, depth| parts_at(region, n, (depth + region.clear(), enough)).is_some();
    least_deep(region, tried, enough, parts)
}

/// The least translation that leads all vertices out, and the least that also leads apart the
/// sides that graze.
fn least_translations(region: &MeasuredRegion, own: &Contact, inside: &[Contact]) -> [DVec3; 2] {
    let ways = inside.iter().map(|way| (way.normal, region.clear() - way.separation));
    let ways: Vec<LocalWay> = ways.collect();
    [least_translation(&ways), least_translation(&[ways, grazing_sides(region, own)].concat())]
}

/// A direction in which a vertex or a side gets out, and how far that is.
type LocalWay = (DVec3, f64);

/// Of the pieces' vertices and the middles of their faces, or some of many, the deepest, with the
/// nearest point of the other body's surface. A vertex in a corner that is squeezed lies by a hair
/// behind a side; the middles between say how far the body has sunk in.
fn deepest_place(region: &MeasuredRegion) -> Option<Contact> {
    let (pair, counters) = (region.pair, &mut Counters::default());
    let mut deepest: Option<Contact> = None;
    for side in Side::BOTH {
        let mut surface = NearestOn::of(pair, side.other());
        let piece = &region.cut.pieces[side.index()];
        let vertices = piece.vertices.iter().map(|&v| (Feature::Vertex(v), pair.position(side, v)));
        let stride = piece.faces.len().div_ceil(MAX_SAMPLES).max(1);
        let middles = piece.faces.iter().zip(&region.triangles[side.index()]).step_by(stride);
        let middles = middles.map(|(&f, [a, b, c])| (Feature::Face(f), (*a + *b + *c) / 3.0));
        for (own, p) in vertices.chain(middles) {
            let nearest = surface.to(p, counters);
            let features = [own, Feature::Face(nearest.face)];
            let normal = -pair.normal(side.other(), nearest.face);
            let contact = side.contact(features, [p, nearest.foot], normal, -nearest.distance);
            let is_deeper = deepest.is_none_or(|deepest| nearer(&contact, &deepest).is_lt());
            let is_vertex = matches!(own, Feature::Vertex(_));
            if is_deeper && (is_vertex || is_inside(pair, side.other(), p, counters)) {
                deepest = Some(contact);
            }
        }
    }
    deepest
}

/// Vertices inside the other body, with their nearest ways out, which are sought where they are not
/// given. `None` where one is no shorter than `enough`: what leads all out is no shorter than that.
/// A vertex whose nearest way leads past an edge of the piece got a longer one, which does not
/// count.
fn inside(
    region: &MeasuredRegion,
    own: &Contact,
    (nearest, enough): (Option<&[Contact]>, f64),
) -> Option<Vec<Contact>> {
    let found = nearest.is_none().then(|| nearest_ways_out(region, own));
    let mut short = Vec::new();
    for &way in nearest.or(found.as_deref()).into_iter().flatten() {
        if region.clear() - way.separation < enough {
            short.push(way);
        } else if way.separation > own.separation && !leads_past_an_edge(region, &way) {
            return None;
        }
    }
    Some(short)
}

/// Whether a vertex is far nearer to a face of the other body that is none of the piece.
fn leads_past_an_edge(region: &MeasuredRegion, way: &Contact) -> bool {
    let (side, p) = match way.id {
        (Feature::Vertex(_), _) => (Side::First, way.point_a),
        _ => (Side::Second, way.point_b),
    };
    let mut surface = NearestOn::of(region.pair, side.other());
    surface.to(p, &mut Counters::default()).distance < HAIR * -way.separation
}

/// Whether most faces that do not look along a region's direction graze one of the other piece.
/// What overlaps there by a hair reaches as far as these sides do, and nothing has dug in so deep.
pub(crate) fn mostly_grazes(region: &MeasuredRegion, own: &Contact) -> bool {
    let [first, second] = sides(region, own);
    let grazes = |of: &[Plane], others: &[Plane]| {
        of.iter().filter(|face| others.iter().any(|its| hair(face, its, own).is_some())).count()
    };
    let grazing = grazes(&first, &second) + grazes(&second, &first);
    2 * grazing > first.len() + second.len()
}

/// Normals of the first body's faces that graze a face of the other piece, and by how much they
/// lie behind it: they lead out of no vertex, and a region is as deep along them as they are high.
fn grazing_sides(region: &MeasuredRegion, own: &Contact) -> Vec<LocalWay> {
    let [first, second] = sides(region, own);
    let deepest = |face: &Plane| {
        let hairs = second.iter().filter_map(|its| hair(face, its, own));
        Some((face.0, region.clear() + hairs.reduce(f64::max)?))
    };
    first.iter().filter_map(deepest).collect()
}

/// A face's normal and its corners.
type Plane = (DVec3, [DVec3; 3]);

/// Of each piece the faces that do not look along the normal of `own`, evenly spread.
fn sides(region: &MeasuredRegion, own: &Contact) -> [Vec<Plane>; 2] {
    Side::BOTH.map(|side| {
        let faces = region.cut.pieces[side.index()].faces.iter();
        let faces = faces.zip(&region.triangles[side.index()]);
        let planes = faces.map(|(&f, corners)| (region.pair.normal(side, f), *corners));
        let planes: Vec<Plane> =
            planes.filter(|(n, _)| n.dot(own.normal).abs() < OPPOSITE).collect();
        let stride = planes.len().div_ceil(MAX_SAMPLES).max(1);
        planes.into_iter().step_by(stride).collect()
    })
}

/// By how much two faces that face each other lie behind one another where that is most, where
/// their middles do by a hair beside the depth of `own`; no more than that.
fn hair((n, ps): &Plane, (m, qs): &Plane, own: &Contact) -> Option<f64> {
    let most = HAIR * -own.separation;
    let [p, q] = [ps, qs].map(|[a, b, c]| (*a + *b + *c) / 3.0);
    if n.dot(*m) >= -OPPOSITE || (0.5 * (*n - *m).dot(p - q)).abs() >= most {
        return None;
    }
    let behind = |n: &DVec3, p: DVec3, corners: &[DVec3; 3]| {
        corners.iter().map(|corner| n.dot(p - *corner)).fold(0.0, f64::max)
    };
    Some(behind(n, p, qs).max(behind(m, q, ps)).min(most))
}

/// A given direction, the pieces' own face normals, no two of these alike, and what is half-way
/// from the given one to each of them at up to [`ASIDE`] beyond a right angle: out of a corner of
/// two sides (of three none may, which is not tested), where flush sides that overlap lead no
/// vertex off what an edge stands against.
fn directions(region: &MeasuredRegion, given: Option<DVec3>) -> Vec<DVec3> {
    let mut directions: Vec<DVec3> = given.into_iter().collect();
    for side in Side::BOTH {
        let sign = if side == Side::First { 1.0 } else { -1.0 };
        let mut faces = region.cut.pieces[side.index()].faces.clone();
        faces.sort_unstable();
        let stride = faces.len().div_ceil(MAX_DIRECTIONS).max(1);
        for &f in faces.iter().step_by(stride) {
            let n = sign * region.pair.normal(side, f);
            if n != DVec3::ZERO && directions.iter().all(|other| other.dot(n) < ALIKE) {
                directions.push(n);
            }
        }
    }
    let Some(n) = given else { return directions };
    let aside = directions.iter().filter(|m| (-ASIDE..ALIKE).contains(&m.dot(n)));
    let half_way: Vec<DVec3> = aside.filter_map(|m| (n + m).try_normalize()).collect();
    [directions, half_way].concat()
}

/// Of directions the one along which the least translation parts the pieces, if that is less than
/// `enough` and `counts`.
fn least_deep(
    region: &MeasuredRegion,
    mut candidates: Vec<DVec3>,
    enough: f64,
    counts: impl Fn(DVec3, f64) -> bool,
) -> Option<DVec3> {
    // Rays do not measure a piece along a direction that none of its faces looks along.
    if candidates.iter().any(|&n| face_each_other(region, n)) {
        candidates.retain(|&n| face_each_other(region, n));
    }
    let (mut least, mut best) = (enough, None);
    for n in candidates {
        let Some(deepest) = region.deepest_along(n, least) else { continue };
        let depth = -deepest.separation;
        if depth < least && counts(n, depth) {
            (least, best) = (depth, Some(n));
        }
    }
    best
}

/// By how much, between two lengths, the second body is moved along `n` where the faces of the two
/// pieces do not meet any more. Where the least is what the ways of vertices say, a corner that
/// none of them and no side stands for holds beyond it.
fn parts_at(region: &MeasuredRegion, n: DVec3, (least, most): (f64, f64)) -> Option<f64> {
    let boxed = |triangle: [DVec3; 3]| (Aabb::of_points(triangle), triangle);
    let [first, second] = &region.triangles;
    let axis = Aabb::of_points(first.iter().flatten().copied()).half_extents().max_position();
    let mut first: Vec<_> = first.iter().map(|&t| boxed(t)).collect();
    first.sort_unstable_by(|(x, _), (y, _)| x.min[axis].total_cmp(&y.min[axis]));
    let meets = |translation: DVec3, triangle: &[DVec3; 3]| {
        let (place, triangle) = boxed(triangle.map(|p| p + translation));
        let near = first.iter().take_while(|(other, _)| other.min[axis] <= place.max[axis]);
        let mut near = near.filter(|(other, _)| other.overlaps(&place));
        near.any(|(_, other)| classify_triangles(other, &triangle).meets())
    };
    let lengths = std::iter::successors(Some(least), |length| Some(FARTHER * length));
    let mut lengths = lengths.take_while(|length| *length <= most);
    lengths.find(|length| !second.iter().any(|triangle| meets(length * n, triangle)))
}

/// Whether some face of the first body's piece looks along `n`, and some of the second's against
/// it, within 60 degrees.
fn face_each_other(region: &MeasuredRegion, n: DVec3) -> bool {
    Side::BOTH.iter().zip([1.0, -1.0]).all(|(&side, sign)| {
        let faces = &region.cut.pieces[side.index()].faces;
        faces.iter().any(|&f| sign * region.pair.normal(side, f).dot(n) >= LOOKS_ALONG)
    })
}

/// The least translation of the second body that leads it out along each unit normal by a depth, by
/// Hildreth's method (1957): nearly, where normals lie close to each other.
fn least_translation(ways: &[LocalWay]) -> DVec3 {
    let mut pushes = vec![0.0; ways.len()];
    let mut sum = DVec3::ZERO;
    for _ in 0..ROUNDS {
        for ((normal, depth), push) in ways.iter().zip(&mut pushes) {
            let more = (depth - sum.dot(*normal)).max(-*push);
            *push += more;
            sum += more * *normal;
        }
    }
    sum
}

/// For vertices inside the other body the nearest foot on the other's piece: the way out. One that
/// is longer than the depth of `own`, a deepest contact, is left out: no caller counts it.
fn nearest_ways_out(region: &MeasuredRegion, own: &Contact) -> Vec<Contact> {
    let most = region.pair.length_error() - own.separation;
    let mut contacts = Vec::new();
    for side in Side::BOTH {
        let vertices = &region.cut.pieces[side.index()].vertices;
        let stride = vertices.len().div_ceil(MAX_SAMPLES).max(1);
        let other = side.other().index();
        let faces = region.cut.pieces[other].faces.iter().zip(&region.triangles[other]);
        let standing: Vec<Standing> = faces.map(|(&f, corners)| in_ball(f, corners)).collect();
        // Neighbours have their ways out through neighbours: the last one bounds the next.
        let mut last: Option<&Standing> = None;
        for &v in vertices.iter().step_by(stride) {
            let p = region.pair.position(side, v);
            let (mut least, mut reach) = (most * most, most);
            let mut nearest: Option<(&Standing, DVec3)> = None;
            last.into_iter().chain(&standing).for_each(|face| {
                let (id, center, radius, triangle) = face;
                let touching = reach + radius;
                if (*center - p).length_squared() > touching * touching {
                    return;
                }
                let Some(foot) = triangle.foot(p) else { return };
                let squared = (foot - p).length_squared();
                if squared < least || (squared <= least && nearest.is_none_or(|(f, _)| *id < f.0)) {
                    (nearest, least) = (Some((face, foot)), squared);
                    reach = squared.sqrt() + region.pair.length_error();
                }
            });
            let Some((face, q)) = nearest else { continue };
            last = Some(face);
            let features = [Feature::Vertex(v), Feature::Face(face.0)];
            let normal = -region.pair.normal(side.other(), face.0);
            contacts.push(side.contact(features, [p, q], normal, -(q - p).length()));
        }
    }
    contacts
}

/// A face, the middle and the radius of a ball around it, and its planes.
type Standing = (FaceId, DVec3, f64, Prepared);

fn in_ball(face: FaceId, corners: &[DVec3; 3]) -> Standing {
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    let squared = corners.map(|p| (p - center).length_squared());
    let radius = squared[0].max(squared[1]).max(squared[2]).sqrt();
    (face, center, radius, Prepared::of(corners))
}
