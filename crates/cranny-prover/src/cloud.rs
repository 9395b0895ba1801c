//! The vertices of groups of faces, in the frame of the pair.

use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;

use cranny_certificate::{Groups, Triangles};
use cranny_exact::{Aabb, DVec3};

/// The vertices of a group.
#[derive(Debug)]
pub(crate) struct Cloud {
    pub(crate) points: Vec<DVec3>,
    pub(crate) bounds: Aabb,
}

impl Cloud {
    pub(crate) fn of(points: Vec<DVec3>) -> Self {
        let bounds = Aabb::of_points(points.iter().copied());
        Self { points, bounds }
    }

    /// Where the group reaches farthest along a direction.
    pub(crate) fn support(&self, direction: DVec3) -> DVec3 {
        let mut best = (f64::NEG_INFINITY, DVec3::ZERO);
        for &p in &self.points {
            let height = direction.dot(p);
            if height > best.0 {
                best = (height, p);
            }
        }
        best.1
    }
}

/// A body, and the clouds of its groups, each made once.
pub(crate) struct Clouds<'a> {
    positions: Vec<DVec3>,
    faces: &'a [[u32; 3]],
    groups: Groups,
    made: BTreeMap<[usize; 2], Rc<Cloud>>,
}

impl<'a> Clouds<'a> {
    /// Of a body; `place` moves its vertices.
    pub(crate) fn new(filed: &'a Triangles, place: impl Fn(DVec3) -> DVec3) -> Self {
        let position = |&p: &[f64; 3]| place(DVec3::from_array(p));
        Self {
            positions: filed.vertices.iter().map(position).collect(),
            faces: &filed.faces,
            groups: Groups::of(filed),
            made: BTreeMap::new(),
        }
    }

    pub(crate) fn groups(&self) -> &Groups {
        &self.groups
    }

    pub(crate) fn triangle(&self, face: u32) -> [DVec3; 3] {
        self.faces[face as usize].map(|v| self.positions[v as usize])
    }

    pub(crate) fn cloud(&mut self, group: &Range<usize>) -> Rc<Cloud> {
        let key = [group.start, group.end];
        if let Some(cloud) = self.made.get(&key) {
            return Rc::clone(cloud);
        }
        let faces = self.groups.faces(group).iter();
        let mut corners: Vec<u32> = faces.flat_map(|&f| self.faces[f as usize]).collect();
        corners.sort_unstable();
        corners.dedup();
        let points = corners.iter().map(|&v| self.positions[v as usize]).collect();
        let cloud = Rc::new(Cloud::of(points));
        self.made.insert(key, Rc::clone(&cloud));
        cloud
    }
}
