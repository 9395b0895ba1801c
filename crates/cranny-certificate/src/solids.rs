//! Whether the insides of two bodies meet whose surfaces do not cross, and which lies in which.
//!
//! Each face is cut along what it shares with the other body. Within a cell all points, but for
//! isolated ones, are alike: inside the other body, outside, or on a face of it, with the inside of
//! the two on the same side or not. Where an inside is, the winding beside the face says, whichever
//! way faces look. The insides meet if and only if some cell lies inside the other body, or on it
//! with the same inside. A lies in B if and only if no cell of A lies outside B or on it with
//! another inside, and no cell of B lies inside A. Faces that share nothing with the other
//! body and hang together over edges are alike: a corner decides.

use std::collections::BTreeMap;

use crate::body::Body;
use crate::cells::{Site, cells, has_area, mean, shared};
use crate::certificate::Contained;
use crate::exact::{Point, normal};
use crate::posed::PosedPair;
use crate::winding::Location;

/// Two bodies as solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Solids {
    pub(crate) solid: bool,
    pub(crate) contained: Option<Contained>,
}

impl Solids {
    /// A plane has A on one side and B on the other.
    pub(crate) const PARTED: Self = Self { solid: false, contained: None };

    /// Of surfaces that cross.
    pub(crate) const CROSSING: Self = Self { solid: true, contained: None };

    /// Of surfaces that do not cross; `touching` are the faces that may touch, all others are
    /// apart.
    ///
    /// # Errors
    ///
    /// Where a cell cannot be judged.
    pub(crate) fn of(pair: &PosedPair, touching: &[[u32; 2]]) -> Result<Self, String> {
        let turned: Vec<[u32; 2]> = touching.iter().map(|&[f, g]| [g, f]).collect();
        let of_a = Sides::of(&pair.a, &pair.b, touching)?;
        let of_b = Sides::of(&pair.b, &pair.a, &turned)?;
        let within = |inner: &Sides, outer: &Sides, body: &Body| {
            (inner.inside || inner.same)
                && !(inner.outside || inner.opposite || outer.inside)
                && body.is_closed()
        };
        let contained = match (within(&of_a, &of_b, &pair.b), within(&of_b, &of_a, &pair.a)) {
            (true, false) => Some(Contained::AInB),
            (false, true) => Some(Contained::BInA),
            // Each in the other: they coincide, and neither is the inner one.
            _ => None,
        };
        Ok(Self { solid: of_a.inside || of_b.inside || of_a.same, contained })
    }
}

/// On which sides of the other body some cell of a body lies.
#[derive(Clone, Copy, Debug, Default)]
struct Sides {
    inside: bool,
    outside: bool,
    same: bool,
    opposite: bool,
}

/// More samples of a cell than this are not tried: as many isolated points would have to lie on the
/// line of its means. Smaller: cells on which many corners stand are not judged.
const MOST_SAMPLES: u32 = 64;

impl Sides {
    fn of(body: &Body, other: &Body, touching: &[[u32; 2]]) -> Result<Self, String> {
        let mut partners: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &[own, its] in touching {
            partners.entry(own).or_default().push(its);
        }
        let mut sides = Self::default();
        for face in body.representatives(|face| !partners.contains_key(&face)) {
            let [corner, ..] = body.triangle(face);
            match other.locate(&Point::at(&corner)) {
                Location::Inside => sides.inside = true,
                Location::Outside => sides.outside = true,
                Location::On => return Err(format!("face {face} touches, and no step says so")),
            }
        }
        for (&face, others) in partners.iter().filter(|&(&f, _)| has_area(&body.triangle(f))) {
            sides.judge(body, other, face, others)?;
        }
        Ok(sides)
    }

    fn judge(
        &mut self,
        body: &Body,
        other: &Body,
        face: u32,
        others: &[u32],
    ) -> Result<(), String> {
        let own = body.triangle(face);
        let with_area: Vec<u32> =
            others.iter().copied().filter(|&g| has_area(&other.triangle(g))).collect();
        let cuts: Vec<Vec<Site>> =
            with_area.iter().map(|&g| shared(&own, &other.triangle(g))).collect();
        for cell in cells(&own, &cuts) {
            self.judge_cell(body, other, face, &cell)?;
        }
        Ok(())
    }

    fn judge_cell(
        &mut self,
        body: &Body,
        other: &Body,
        face: u32,
        cell: &[Site],
    ) -> Result<(), String> {
        for stride in 0..MOST_SAMPLES {
            let sample = Point::rational(&mean(cell, stride));
            match other.locate(&sample) {
                Location::Inside => self.inside = true,
                Location::Outside => self.outside = true,
                // A face that bounds nothing has no inside behind it.
                Location::On if !body.bounds_space(face) => {}
                Location::On => match flush(body, other, face, &sample)? {
                    None => continue,
                    Some(true) => self.same = true,
                    Some(false) => self.opposite = true,
                },
            }
            return Ok(());
        }
        Err(format!("a piece of face {face} cannot be judged"))
    }
}

/// Whether, at a point that is on faces of both bodies, the other body has its inside on that side
/// of a face on which the body has its own. `None` where a face passes through the point askew,
/// which one beside it need not.
///
/// # Errors
///
/// The body has its inside on both sides of its face, or on none.
fn flush(body: &Body, other: &Body, face: u32, sample: &Point) -> Result<Option<bool>, String> {
    let front = normal(&body.triangle(face));
    if [body, other].iter().any(|body| body.passes_through(sample, &front)) {
        return Ok(None);
    }
    let back = front.each_ref().map(|x| -x);
    match [&front, &back].map(|side| body.winds_beside(sample, side)) {
        [true, false] => Ok(Some(other.winds_beside(sample, &front))),
        [false, true] => Ok(Some(other.winds_beside(sample, &back))),
        _ => Err(format!("face {face} cannot be judged: it does not bound its own body there")),
    }
}
