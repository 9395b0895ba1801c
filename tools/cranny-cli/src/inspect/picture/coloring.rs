//! Colours for regions of a surface, such that neighbours differ.

use std::collections::{BTreeSet, VecDeque};

use cranny_geometry::{EdgeId, FaceId, HalfEdgeId, Topology};

/// Colours that are distinguished at a glance, and their names.
const HUES: [&str; 8] = ["blue", "orange", "green", "red", "violet", "cyan", "yellow", "pink"];

/// Colours before they repeat.
const COLORS: usize = 3 * HUES.len();

/// The name of colour `index` of [`cranny_render::palette`].
pub(super) fn name(index: usize) -> String {
    let shade = ["", "dark ", "darker "][(index / HUES.len()) % 3];
    format!("{shade}{}", HUES[index % HUES.len()])
}

/// A colour for each of `regions` regions, by number. Regions count as neighbours where no other
/// is nearer to what lies between them, so that the dimples of a golf ball have neighbours, too.
///
/// Cost: O(n), and for each region what it has of neighbours.
pub(super) fn colors(
    topology: &Topology,
    region_of_face: Vec<Option<u32>>,
    regions: usize,
) -> Vec<usize> {
    let nearest = spread(topology, region_of_face);
    let mut neighbours = vec![BTreeSet::new(); regions];
    for edge in (0..topology.edges().len() as u32).map(EdgeId) {
        let around = topology.half_edges(edge);
        let mut met = around.iter().filter_map(|h| nearest[h.face().index()]);
        if let Some(first) = met.next() {
            for other in met.filter(|&other| other != first) {
                neighbours[first as usize].insert(other);
                neighbours[other as usize].insert(first);
            }
        }
    }
    let mut chosen: Vec<usize> = Vec::with_capacity(regions);
    for (region, around) in neighbours.iter().enumerate() {
        let earlier = around.iter().filter_map(|&other| chosen.get(other as usize));
        let taken: BTreeSet<usize> = earlier.copied().collect();
        // Regions that are far from each other differ too, as far as colours go.
        let hues = (0..HUES.len()).map(|k| (region + k) % HUES.len());
        let mut candidates = hues.chain(HUES.len()..COLORS);
        let free = candidates.find(|color| !taken.contains(color));
        chosen.push(free.unwrap_or(region % COLORS));
    }
    chosen
}

/// Gives each face the region that is fewest edges away, where there is one.
fn spread(topology: &Topology, mut region: Vec<Option<u32>>) -> Vec<Option<u32>> {
    let within = |f: &u32| region[*f as usize].is_some();
    let mut front: VecDeque<u32> = (0..region.len() as u32).filter(within).collect();
    while let Some(face) = front.pop_front() {
        for corner in 0..3 {
            let edge = topology.edge_of(HalfEdgeId::of(FaceId(face), corner));
            for other in topology.half_edges(edge).iter().map(|h| h.face()) {
                if region[other.index()].is_none() {
                    region[other.index()] = region[face as usize];
                    front.push_back(other.0);
                }
            }
        }
    }
    region
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_geometry::Mesh;
    use cranny_shapes::Sphere;

    #[test]
    fn regions_that_would_meet_if_they_grew_differ() {
        let strip: Vec<_> = (0..12)
            .map(|i| cranny_exact::DVec3::new(f64::from(i), f64::from(i % 2), 0.0))
            .collect();
        let faces = (0..10).map(|i| if i % 2 == 0 { [i, i + 2, i + 1] } else { [i, i + 1, i + 2] });
        let topology = Topology::of(&Mesh::new(strip, faces.collect()).unwrap());
        // Regions 0 and 8 begin with one colour, with faces of neither between them.
        let mut regions = vec![None; 10];
        regions[1] = Some(0);
        regions[8] = Some(8);
        let colors = colors(&topology, regions, 9);
        assert_ne!(colors[0], colors[8]);
        assert_eq!(colors[1], 1);
    }

    #[test]
    fn each_face_of_a_sphere_differs_from_its_neighbours() {
        let mesh = Sphere::default().build().unwrap();
        let topology = Topology::of(&mesh);
        let count = mesh.faces().len();
        let colors = colors(&topology, (0..count as u32).map(Some).collect(), count);
        for edge in (0..topology.edges().len() as u32).map(EdgeId) {
            let [a, b] = topology.half_edges(edge) else { panic!("a sphere is closed") };
            assert_ne!(colors[a.face().index()], colors[b.face().index()]);
        }
        assert!(colors.iter().all(|&color| color < HUES.len()));
        assert_eq!(
            (name(3), name(8), name(17)),
            ("red".into(), "dark blue".into(), "darker orange".into())
        );
    }
}
