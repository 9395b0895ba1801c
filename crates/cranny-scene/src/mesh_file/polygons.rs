//! Faces with more than three corners: kept as read, split at the end, and what is to be said of
//! it.

use cranny_exact::DVec3;
use cranny_geometry::{Flatness, Mesh, split_polygon};

use super::problem::{Place, counted};

/// Polygons as read, among the triangles. A file may name corners before it lists them.
#[derive(Default)]
pub(super) struct Polygons {
    /// Of all polygons, one after another.
    corners: Vec<u32>,
    polygons: Vec<Polygon>,
}

struct Polygon {
    /// How many triangles stand before it in the file.
    before: usize,
    /// Where its corners end.
    end: usize,
    place: Place,
}

impl Polygons {
    pub(super) fn add(&mut self, before: usize, corners: &[u32], place: Place) {
        self.corners.extend_from_slice(corners);
        self.polygons.push(Polygon { before, end: self.corners.len(), place });
    }

    /// All faces in the file's order, polygons split among the triangles. An index out of range is
    /// left for the mesh to refuse.
    pub(super) fn split(
        self,
        vertices: &[DVec3],
        triangles: Vec<[u32; 3]>,
    ) -> (Vec<[u32; 3]>, Splits) {
        let mut splits = Splits { count: self.polygons.len(), ..Splits::default() };
        if self.polygons.is_empty() {
            return (triangles, splits);
        }
        let mut faces = Vec::with_capacity(triangles.len() + self.corners.len());
        let (mut taken, mut start) = (0, 0);
        let mut positions = Vec::new();
        for Polygon { before, end, place } in self.polygons {
            faces.extend_from_slice(&triangles[taken..before]);
            taken = before;
            let corners = &self.corners[start..end];
            start = end;
            positions.clear();
            positions.extend(corners.iter().map_while(|&k| vertices.get(k as usize)));
            if positions.len() < corners.len() {
                faces.extend(corners.windows(2).skip(1).map(|w| [corners[0], w[0], w[1]]));
                continue;
            }
            let split = split_polygon(&positions);
            faces.extend(split.triangles.iter().map(|t| t.map(|k| corners[k as usize])));
            if !split.simple {
                splits.crossed.add(&place);
            }
            if split.thickness > 0.0 {
                splits.thick.push((split.thickness, place));
            }
        }
        faces.extend_from_slice(&triangles[taken..]);
        (faces, splits)
    }
}

/// What became of the polygons of a file.
#[derive(Default)]
pub(super) struct Splits {
    count: usize,
    crossed: Tally,
    /// Polygons whose corners lie off their plane, by rounding or truly, and by how much.
    thick: Vec<(f64, Place)>,
}

impl Splits {
    /// One sentence each. What the coordinates' rounding explains, as of facets of the hull, is
    /// flat.
    pub(super) fn notes(&self, mesh: &Mesh) -> Vec<String> {
        let mut notes = Vec::new();
        if self.count > 0 {
            let polygons = counted(self.count, "polygon");
            let were = if self.count == 1 { "was" } else { "were" };
            notes.push(format!(
                "{polygons} with more than three corners {were} split into triangles"
            ));
        }
        if let Some((polygons, first)) = self.crossed.summary() {
            notes.push(format!(
                "{polygons} of these: sides cross, corners lie on sides, or there is no area (first: {first}); split as well as can be, triangles may overlap or lack an area"
            ));
        }
        let mut bent = Tally::default();
        let mut most = 0f64;
        if !self.thick.is_empty() {
            let flat = Flatness::Auto.distance(mesh);
            for (thickness, place) in self.thick.iter().filter(|(t, _)| *t > flat) {
                bent.add(place);
                most = most.max(*thickness);
            }
        }
        if let Some((polygons, first)) = bent.summary() {
            notes.push(format!(
                "{polygons} of these: corners lie off their common plane, by up to {most:.3e} (first: {first}); where the surface runs between them depends on the split"
            ));
        }
        notes
    }
}

/// How many, and the place of the first.
#[derive(Default)]
struct Tally {
    count: usize,
    first: Option<Place>,
}

impl Tally {
    fn add(&mut self, place: &Place) {
        self.count += 1;
        self.first.get_or_insert_with(|| place.clone());
    }

    fn summary(&self) -> Option<(String, &Place)> {
        self.first.as_ref().map(|first| (counted(self.count, "polygon"), first))
    }
}
