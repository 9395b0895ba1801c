//! Where on two bodies a search looks, face by face: for drawing.

use cranny_geometry::clusters::LANES;
use cranny_geometry::{FaceId, Model};

use crate::answer::Feature;
use crate::observe::{ComparedBoxes, SearchObserver};

/// What searches of a pair compared, by body: A is 0, B is 1.
///
/// An observer of [`query_observed`](crate::query_observed), of one query or of several.
///
/// ```
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Mesh, Model};
/// use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, SearchHeat, query_observed};
///
/// let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
/// let (model, _) = Model::build(Mesh::new(vertices, faces)?, &BuildOptions::default())?;
/// let a = Placed { model: &model, pose: Pose::IDENTITY };
/// let b = Placed { model: &model, pose: Pose::at(DVec3::new(0.5, 0.0, 0.0)) };
/// let mut heat = SearchHeat::of([&model, &model]);
/// let verdict = Query::of(Demand::Intersects);
/// let answer = query_observed(a, b, &verdict, &mut PairMemory::default(), &mut heat)?;
/// assert_eq!(heat.faces(0).iter().sum::<u64>(), answer.counters.triangle_tests);
/// assert!(heat.looked_at(1).iter().all(|times| *times > 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SearchHeat<'m> {
    models: [&'m Model; 2],
    /// By node, those of its lanes; and of the whole body.
    boxes: [Vec<[u64; LANES]>; 2],
    whole: [u64; 2],
    clusters: [Vec<u64>; 2],
    faces: [Vec<u64>; 2],
}

impl<'m> SearchHeat<'m> {
    /// Nothing yet, of the models of A and B.
    #[must_use]
    pub fn of(models: [&'m Model; 2]) -> Self {
        Self {
            models,
            boxes: models.map(|model| vec![[0; LANES]; model.clusters().nodes().len()]),
            whole: [0; 2],
            clusters: models.map(|model| vec![0; model.clusters().clusters().len()]),
            faces: models.map(|model| vec![0; model.mesh().faces().len()]),
        }
    }

    /// How often a box of a body was compared with one of the other's: the same for both bodies.
    /// The sum of [`node_tests`](crate::Counters::node_tests) and
    /// [`front_tested`](crate::Counters::front_tested), without boxes that were compared with
    /// something else.
    ///
    /// # Panics
    ///
    /// If `body` is neither 0 nor 1; so do the others.
    #[must_use]
    pub fn boxes(&self, body: usize) -> u64 {
        self.whole[body] + self.boxes[body].iter().flatten().sum::<u64>()
    }

    /// How often each cluster of a body was compared. The sum is
    /// [`cluster_tests`](crate::Counters::cluster_tests).
    #[must_use]
    pub fn clusters(&self, body: usize) -> &[u64] {
        &self.clusters[body]
    }

    /// How often each face of a body was classified or measured, and the contact of a feature of
    /// it computed; a feature of several faces counts for one of them. The sum is
    /// [`triangle_tests`](crate::Counters::triangle_tests).
    #[must_use]
    pub fn faces(&self, body: usize) -> &[u64] {
        &self.faces[body]
    }

    /// How often each face of a body was looked at: by itself, with its cluster, or in the box of
    /// its cluster. (Larger boxes do not count: what is in them is not looked at yet.)
    #[must_use]
    pub fn looked_at(&self, body: usize) -> Vec<u64> {
        let mut times = self.faces[body].clone();
        let tree = self.models[body].clusters();
        for (node, boxed) in tree.nodes().iter().zip(&self.boxes[body]) {
            let children = node.children.iter().zip(boxed).take(node.count as usize);
            for (child, boxed) in children.filter(|(child, _)| child.is_cluster()) {
                let faces = &tree.clusters()[child.index()].faces;
                for face in &faces.ids[..faces.count as usize] {
                    times[face.index()] += boxed + self.clusters[body][child.index()];
                }
            }
        }
        times
    }
}

impl SearchObserver for SearchHeat<'_> {
    fn boxes(&mut self, boxes: ComparedBoxes) {
        let ComparedBoxes { body, node, lanes, other } = boxes;
        for (lane, times) in self.boxes[body][node as usize].iter_mut().enumerate() {
            *times += u64::from(lanes >> lane & 1);
        }
        let times = match other {
            Some([node, lane]) => &mut self.boxes[1 - body][node as usize][lane as usize],
            None => &mut self.whole[1 - body],
        };
        *times += u64::from(lanes.count_ones());
    }

    fn clusters(&mut self, pair: [u32; 2]) {
        for (times, cluster) in self.clusters.iter_mut().zip(pair) {
            times[cluster as usize] += 1;
        }
    }

    fn faces(&mut self, pair: [FaceId; 2]) {
        for (times, face) in self.faces.iter_mut().zip(pair) {
            times[face.index()] += 1;
        }
    }

    fn features(&mut self, pair: [Feature; 2]) {
        for (body, feature) in pair.into_iter().enumerate() {
            if let Some(face) = feature.faces(self.models[body].topology()).first() {
                self.faces[body][face.index()] += 1;
            }
        }
    }
}
