//! What a region is made of, before it is the caller's.

use cranny_exact::DVec3;
use cranny_geometry::FaceId;

use crate::answer::{Contact, Curve, Region, RegionId};
use crate::contacts::nearer;
use crate::pair::Pair;
use crate::special_position::settled;

/// A region in the pair's frame and order, but for its curves.
pub(crate) struct Found {
    pub(crate) normal: DVec3,
    pub(crate) depth: Option<f64>,
    pub(crate) area: Option<f64>,
    /// The deepest first.
    pub(crate) points: Vec<Contact>,
    /// In world coordinates.
    pub(crate) curves: Vec<Curve>,
    pub(crate) faces: Vec<[FaceId; 2]>,
}

impl Found {
    /// Measures at the pair's own position what was read beside it.
    pub(crate) fn settle(&mut self, pair: &Pair) {
        let points = &mut self.points;
        points.iter_mut().for_each(|contact| *contact = settled(pair, *contact));
        let deepest = (0..points.len()).min_by(|&i, &j| nearer(&points[i], &points[j]));
        points.swap(0, deepest.unwrap_or(0));
        self.depth = self.depth.map(|_| -self.points[0].separation);
    }

    /// Into world coordinates and the caller's order.
    pub(crate) fn finish(self, pair: &Pair) -> Region {
        let Self { normal, depth, area, points, curves, faces } = self;
        let points: Vec<Contact> = points.into_iter().map(|c| pair.world_contact(c)).collect();
        let triangle_pairs = faces.len() as u32;
        Region {
            id: RegionId::default(),
            from: Vec::new(),
            faces: pair.ordered_faces(faces),
            deepest: points[0],
            normal: pair.world_normal(normal),
            depth,
            area,
            points,
            curves,
            triangle_pairs,
        }
    }
}
