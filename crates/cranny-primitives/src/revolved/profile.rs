//! The core of a solid of revolution in a half-plane through its axis: x is the distance from the
//! axis, y the height.

use cranny_exact::DVec2;

/// What of a core's surface holds a point, by number from the bottom up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum CorePart {
    /// A corner of the profile: an edge all around, or a point on the axis.
    Corner(u8),
    /// A side of the profile, its ends left out: a flat end, or the lateral surface.
    Side(u8),
}

/// Corners at most.
const MOST: usize = 4;

/// A share of the profile's size. Nearer to a corner than that, the way from it is rounding, and
/// the mean of the sides' normals takes its place. Smaller: directions are noise; larger: they are
/// not those of the nearest point.
const AT_CORNER: f64 = 1e-13;

/// A convex profile: corners from the axis, or from the lowest one, upwards along the outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Profile {
    corners: [DVec2; MOST],
    count: usize,
    /// From each corner to the next.
    sides: [Side; MOST - 1],
    middle: f64,
    extent: f64,
}

/// As [`super::CoreFoot`], in the half-plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    pub(super) signed: f64,
    pub(super) point: DVec2,
    pub(super) outward: DVec2,
    pub(super) part: CorePart,
}

/// A side: from a corner, along, with its length.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    number: u8,
    start: DVec2,
    along: DVec2,
    length: f64,
}

impl Side {
    fn outward(&self) -> DVec2 {
        DVec2::new(self.along.y, -self.along.x)
    }

    fn height_of(&self, p: DVec2) -> f64 {
        self.outward().dot(p - self.start)
    }

    /// How far along the side a point is, from 0 to the length; the ends stand for what is beyond.
    fn place_of(&self, p: DVec2) -> f64 {
        self.along.dot(p - self.start).clamp(0.0, self.length)
    }

    fn at(&self, place: f64) -> DVec2 {
        self.start + self.along * place
    }
}

impl Profile {
    /// Of at most four corners with radii and heights that go round a convex polygon; those that
    /// repeat the last one are left out.
    pub(super) fn of(corners: &[[f64; 2]]) -> Self {
        let mut profile = Self {
            corners: [DVec2::ZERO; MOST],
            count: 0,
            sides: [Side::default(); MOST - 1],
            middle: 0.0,
            extent: 0.0,
        };
        for corner in corners.iter().take(MOST).map(|&c| DVec2::from_array(c)) {
            if profile.corners().last() != Some(&corner) {
                profile.corners[profile.count] = corner;
                profile.count += 1;
            }
        }
        for i in 1..profile.count {
            let [start, end] = [profile.corners[i - 1], profile.corners[i]];
            let length = start.distance(end);
            let along = (end - start) / length;
            profile.sides[i - 1] = Side { number: i as u8 - 1, start, along, length };
        }
        profile.middle = profile.height_of_middle();
        let middle = DVec2::new(0.0, profile.middle);
        let far = profile.corners().iter().map(|corner| corner.distance(middle));
        profile.extent = far.fold(0.0, f64::max);
        profile
    }

    pub(super) fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }

    fn sides(&self) -> &[Side] {
        &self.sides[..self.count.saturating_sub(1)]
    }

    /// Whether it bounds no area.
    pub(super) fn is_thin(&self) -> bool {
        let flat = |k: usize| self.corners().iter().all(|c| c[k] == self.corners[0][k]);
        flat(0) || flat(1)
    }

    /// The height of the core's middle.
    pub(super) fn middle(&self) -> f64 {
        self.middle
    }

    /// The radius of a ball around the middle that holds the core.
    pub(super) fn extent(&self) -> f64 {
        self.extent
    }

    /// Half-way, or the height of the centre of the largest circle inside where there is a slanted
    /// side.
    fn height_of_middle(&self) -> f64 {
        let (first, last) = (self.corners[0].y, self.corners[self.count - 1].y);
        let half_way = 0.5 * (first + last);
        match self.corners() {
            // The circle's radius is its height above the base, and its distance from the slanted
            // side.
            [_, rim, apex] if apex.y > rim.y => {
                rim.y + rim.x * (apex.y - rim.y) / (rim.distance(*apex) + rim.x)
            }
            _ => half_way,
        }
    }

    /// Flat ends: 1 or -1 along the axis, outward, and their rim.
    pub(super) fn caps(&self) -> impl Iterator<Item = (f64, DVec2)> + '_ {
        self.sides().iter().filter(|side| side.along.y == 0.0).map(|side| {
            let rim = if side.along.x > 0.0 { side.at(side.length) } else { side.start };
            (-side.along.x, rim)
        })
    }

    /// The corner that is farthest in a direction, and how far; the first of several.
    pub(super) fn farthest(&self, direction: DVec2) -> (usize, f64) {
        let mut best = (0, f64::NEG_INFINITY);
        for (i, corner) in self.corners().iter().enumerate() {
            let reach = corner.dot(direction);
            if reach > best.1 {
                best = (i, reach);
            }
        }
        best
    }

    /// Of a point (x >= 0).
    pub(super) fn foot(&self, p: DVec2) -> Foot {
        let mut highest: Option<(f64, &Side)> = None;
        for side in self.sides() {
            let height = side.height_of(p);
            if highest.is_none_or(|(most, _)| height > most) {
                highest = Some((height, side));
            }
        }
        match highest {
            // Inside of every side; where the profile bounds no area, no point is.
            Some((height, side)) if height < 0.0 => Foot {
                signed: height,
                point: side.at(side.place_of(p)),
                outward: side.outward(),
                part: CorePart::Side(side.number),
            },
            _ => self.foot_from_outside(p),
        }
    }

    fn foot_from_outside(&self, p: DVec2) -> Foot {
        let mut best: Option<(f64, &Side, f64)> = None;
        for side in self.sides() {
            let place = side.place_of(p);
            let distance = p.distance(side.at(place));
            // Of the two sides of a disc, the one that the point is on.
            let nearer = best.as_ref().is_none_or(|(least, other, _)| {
                distance < *least || (distance == *least && side.height_of(p) > other.height_of(p))
            });
            if nearer {
                best = Some((distance, side, place));
            }
        }
        let Some((distance, side, place)) = best else {
            return self.foot_at(0, p);
        };
        if place <= 0.0 {
            return self.foot_at(usize::from(side.number), p);
        }
        if place >= side.length {
            return self.foot_at(usize::from(side.number) + 1, p);
        }
        Foot {
            signed: distance,
            point: side.at(place),
            outward: side.outward(),
            part: CorePart::Side(side.number),
        }
    }

    fn foot_at(&self, corner: usize, p: DVec2) -> Foot {
        let at = self.corners[corner];
        let distance = p.distance(at);
        let outward = if distance > AT_CORNER * (self.extent + at.y.abs()) {
            (p - at) / distance
        } else {
            self.amid(corner)
        };
        Foot { signed: distance, point: at, outward, part: CorePart::Corner(corner as u8) }
    }

    /// The mean of the normals at a corner.
    fn amid(&self, corner: usize) -> DVec2 {
        if self.corners[corner].x == 0.0 {
            return DVec2::new(0.0, if corner == 0 { -1.0 } else { 1.0 });
        }

        let meets = |side: &Side| [corner, corner.wrapping_sub(1)].contains(&side.number.into());
        let sum: DVec2 = self.sides().iter().filter(|s| meets(s)).map(Side::outward).sum();
        // The rim of a disc has opposite ones.
        sum.try_normalize().unwrap_or(DVec2::X)
    }
}
