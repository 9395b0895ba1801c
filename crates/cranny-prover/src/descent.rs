//! All pairs of faces, by halves: parted one after the other, or found to cross.

use std::ops::Range;

use cranny_certificate::{Parting, Parts, PosedPair, Step, halves};
use cranny_exact::{DVec3, Meeting, classify_triangles};
use cranny_geometry::triangle_distance::triangle_distance;

use crate::cloud::{Cloud, Clouds};
use crate::plane::{parting_direction, parts};

/// A group of A's faces and one of B's.
pub(crate) type GroupPair = [Range<usize>; 2];

/// What the descent found.
#[derive(Debug, Default)]
pub(crate) struct Parted {
    pub(crate) steps: Vec<Step>,
    /// The first pair of faces that touch.
    pub(crate) touching: Option<[u32; 2]>,
}

/// Two faces that meet more than the verdict allows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contradiction {
    pub(crate) faces: [u32; 2],
    pub(crate) meeting: Meeting,
}

/// How many touching faces are tried for a plane that parts the whole bodies. Fewer: a
/// body that stands on another is parted face by face. More: each costs a look at all vertices.
const ASKED_FOR_A_PLANE: usize = 3;

/// Two bodies.
pub(crate) struct Descent<'a> {
    pub(crate) pair: &'a PosedPair,
    pub(crate) clouds: [Clouds<'a>; 2],
}

impl Descent<'_> {
    fn all(&self) -> GroupPair {
        self.clouds.each_ref().map(|clouds| clouds.groups().all())
    }

    fn singles(&self, groups: &GroupPair) -> Option<[u32; 2]> {
        let faces = |i: usize| match self.clouds[i].groups().faces(&groups[i]) {
            [face] => Some(*face),
            _ => None,
        };
        Some([faces(0)?, faces(1)?])
    }

    fn clouds_of(&mut self, groups: &GroupPair) -> [std::rc::Rc<Cloud>; 2] {
        let [a, b] = &mut self.clouds;
        [a.cloud(&groups[0]), b.cloud(&groups[1])]
    }

    /// Which group is halved: the larger one.
    fn side_to_halve(&mut self, groups: &GroupPair) -> usize {
        let clouds = self.clouds_of(groups);
        let size = |i: usize| match groups[i].len() {
            1 => f64::NEG_INFINITY,
            _ => clouds[i].bounds.diagonal(),
        };
        usize::from(size(1) > size(0))
    }

    /// Two faces that cross, of groups whose boxes meet.
    pub(crate) fn find_crossing(&mut self) -> Option<[u32; 2]> {
        let mut open = vec![self.all()];
        while let Some(groups) = open.pop() {
            let [a, b] = self.clouds_of(&groups);
            if !a.bounds.overlaps(&b.bounds) {
                continue;
            }
            if let Some(faces) = self.singles(&groups) {
                if self.meeting(faces) == Meeting::Cross {
                    return Some(faces);
                }
                continue;
            }
            let side = self.side_to_halve(&groups);
            open.extend(halved(&groups, side));
        }
        None
    }

    fn meeting(&self, [f, g]: [u32; 2]) -> Meeting {
        classify_triangles(&self.clouds[0].triangle(f), &self.clouds[1].triangle(g))
    }

    /// Parts all faces of A from all of B.
    pub(crate) fn part(&mut self, may_touch: bool) -> Result<Parted, Contradiction> {
        let mut found = Parted::default();
        let mut open = vec![(self.all(), DVec3::ZERO)];
        let mut asked = 0;
        while let Some((groups, mut guess)) = open.pop() {
            let [a, b] = self.clouds_of(&groups);
            if let Some(direction) = parting_direction(&a, &b, &mut guess) {
                found.steps.push(Step::Direction(direction.to_array()));
                continue;
            }
            if let Some(faces) = self.singles(&groups) {
                let (step, parting) = self.part_faces(faces)?;
                if parting == Parting::Touching && !may_touch {
                    return Err(Contradiction { faces, meeting: Meeting::Touch });
                }
                found.steps.push(step);
                if parting == Parting::Touching {
                    if self.meeting(faces) == Meeting::Touch {
                        found.touching = found.touching.or(Some(faces));
                    }
                    if asked < ASKED_FOR_A_PLANE
                        && let Some(step) = self.plane_of_all(faces)
                    {
                        found.steps = vec![step];
                        found.touching = found.touching.or_else(|| self.find_touching());
                        return Ok(found);
                    }
                    asked += 1;
                }
                continue;
            }
            let side = self.side_to_halve(&groups);
            found.steps.push(Step::Halve(side as u8 + 1));
            open.extend(halved(&groups, side).map(|groups| (groups, guess)));
        }
        Ok(found)
    }

    /// Two faces that touch.
    fn find_touching(&mut self) -> Option<[u32; 2]> {
        let mut open = vec![self.all()];
        while let Some(groups) = open.pop() {
            let [a, b] = self.clouds_of(&groups);
            if !a.bounds.overlaps(&b.bounds) {
                continue;
            }
            match self.singles(&groups) {
                Some(faces) if self.meeting(faces).meets() => return Some(faces),
                Some(_) => {}
                None => {
                    let side = self.side_to_halve(&groups);
                    open.extend(halved(&groups, side));
                }
            }
        }
        None
    }

    /// The step that parts two faces, and how.
    fn part_faces(&self, faces: [u32; 2]) -> Result<(Step, Parting), Contradiction> {
        let meeting = self.meeting(faces);
        if meeting == Meeting::Cross {
            return Err(Contradiction { faces, meeting });
        }
        if let Some(direction) = self.nearest_way(faces) {
            return Ok((Step::Direction(direction.to_array()), Parting::Apart));
        }
        let exactly = |parts: Parts| (Step::Parts(parts), self.pair.parting_of_faces(faces, parts));
        let best = Parts::all().map(exactly).max_by_key(|&(_, parting)| parting);
        match best {
            Some((step, parting)) if parting != Parting::None => Ok((step, parting)),
            _ if self.pair.has_needle(faces) => {
                Ok((Step::Needle { needle: true }, Parting::Touching))
            }
            _ => Err(Contradiction { faces, meeting }),
        }
    }

    /// The way between the nearest points, where it parts the faces in spite of rounding.
    fn nearest_way(&self, [f, g]: [u32; 2]) -> Option<DVec3> {
        let (a, b) = (self.clouds[0].triangle(f), self.clouds[1].triangle(g));
        let [p, q] = triangle_distance(&a, &b).points;
        let way = q - p;
        parts(&Cloud::of(a.to_vec()), &Cloud::of(b.to_vec()), way).then_some(way)
    }

    /// A direction between parts of two touching faces that parts the bodies as wholes.
    fn plane_of_all(&mut self, faces: [u32; 2]) -> Option<Step> {
        let all = self.all();
        let [a, b] = self.clouds_of(&all);
        if a.bounds.center() == b.bounds.center() {
            return None;
        }
        let parts = Parts::all()
            .filter(|&parts| self.pair.parting_of_faces(faces, parts) == Parting::Touching)
            .find(|&parts| self.pair.parting_by(&all, faces, parts) != Parting::None)?;
        Some(Step::PartsOf { faces, parts })
    }
}

/// In the order in which the verifier takes them: the last one is next.
fn halved(groups: &GroupPair, side: usize) -> [GroupPair; 2] {
    halves(&groups[side]).map(|half| {
        let mut parts = groups.clone();
        parts[side] = half;
        parts
    })
}
