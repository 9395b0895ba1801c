//! What is in a picture, in world coordinates: bodies, lines, points and the ground.

use std::sync::Arc;

use cranny_exact::{Aabb, DVec2, DVec3, Pose};

use crate::color::Color;
use crate::label::Label;
use crate::mesh::DrawMesh;
use crate::patch::Patch;
use crate::section::Section;
use crate::style::{Shading, Style};

/// Everything that one picture shows. World coordinates are right-handed with z up.
///
/// Drawn in this order: backdrop, shadows on the ground, opaque instances, cut faces of the
/// section, ground grid, translucent instances (far to near), x-rays, patches, lines, points; then
/// what is marked `on_top`, which nothing hides; then labels. Within a kind the later entry is
/// drawn later.
#[derive(Clone, Debug)]
pub struct DrawList {
    /// Bodies.
    pub instances: Vec<Instance>,
    /// Segments of a width in pixels.
    pub lines: Vec<Line>,
    /// Discs of a radius in pixels.
    pub points: Vec<Point>,
    /// Areas that loops bound.
    pub patches: Vec<Patch>,
    /// Words at places.
    pub labels: Vec<Label>,
    /// A plane that cuts instances open; `None` cuts nothing.
    pub section: Option<Section>,
    /// What makes form and depth readable.
    pub shading: Shading,
    /// Grid and shadows below the bodies; `None` draws neither.
    pub ground: Option<Ground>,
    /// The colours of the background at the top and at the bottom of the picture.
    pub backdrop: [Color; 2],
}

/// A mesh at a pose.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Shared; hand the same handle to each frame.
    pub mesh: Arc<DrawMesh>,
    /// `world_from_body`.
    pub pose: Pose,
    /// Multiplies the mesh's face colours. An alpha below 255 makes the instance a translucent
    /// overlay: drawn after everything opaque, hidden by it, hiding nothing, casting no shadow.
    /// Overlays that interleave are ordered by their centres only.
    pub color: Color,
    /// What of it is drawn.
    pub style: Style,
    /// Whether the list's [section](DrawList::section) cuts it open.
    pub cut: bool,
}

impl Instance {
    /// The faces of a mesh at a pose, whole.
    #[must_use]
    pub fn solid(mesh: Arc<DrawMesh>, pose: Pose, color: Color) -> Self {
        Self { mesh, pose, color, style: Style::Solid, cut: false }
    }

    /// Whether its faces hide what is behind them.
    #[must_use]
    pub fn is_opaque(&self) -> bool {
        self.style == Style::Solid && self.color.is_opaque()
    }
}

/// A segment in space, drawn with a width in pixels, so that it can be seen at any distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Start.
    pub from: DVec3,
    /// End.
    pub to: DVec3,
    /// Colour; its alpha blends.
    pub color: Color,
    /// Width in pixels at the start and at the end. The ends are squared off half the lesser
    /// width beyond the points, so that chained segments leave no gap; a tip of width 0 is sharp.
    pub width: [f32; 2],
    /// Whether the line shows through what hides it.
    pub on_top: bool,
}

/// A point in space, drawn as a disc with a darker rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Where.
    pub position: DVec3,
    /// Colour; its alpha blends.
    pub color: Color,
    /// Radius in pixels.
    pub radius: f32,
    /// Whether the point shows through whatever hides it.
    pub on_top: bool,
}

/// A horizontal grid that fades with distance from its centre, on which opaque bodies above it cast
/// a soft-toned shadow. It is drawn over, never in place of, what lies below it: it hides nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ground {
    /// Height (z) of the plane.
    pub height: f64,
    /// Where the grid is strongest (x, y). The lines themselves pass through whole multiples of
    /// `spacing`, so they stand still when the centre moves.
    pub center: DVec2,
    /// Distance from the centre at which the grid has faded away.
    pub radius: f64,
    /// Distance of neighbouring lines; every tenth is stronger.
    pub spacing: f64,
    /// Whether opaque bodies cast shadows. Costs a second pass over their triangles.
    pub shadows: bool,
}

impl Default for DrawList {
    fn default() -> Self {
        Self {
            instances: Vec::new(),
            lines: Vec::new(),
            points: Vec::new(),
            patches: Vec::new(),
            labels: Vec::new(),
            section: None,
            shading: Shading::PLAIN,
            ground: None,
            backdrop: Self::BACKDROP,
        }
    }
}

impl DrawList {
    /// The default background: a light, neutral grey that darkens towards the bottom.
    pub const BACKDROP: [Color; 2] = [Color::rgb(240, 243, 246), Color::rgb(205, 211, 218)];

    /// An empty picture.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A box that holds all instances, lines and points (not the ground); empty where there are
    /// none. An instance counts with its posed bounding box, so the result may be larger than
    /// needed.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let bodies = self.instances.iter().flat_map(|i| {
            let world_from_body = i.pose.world_from_body();
            box_corners(&i.mesh.bounds()).map(move |p| world_from_body.apply(p))
        });
        let lines = self.lines.iter().flat_map(|l| [l.from, l.to]);
        let points = self.points.iter().map(|p| p.position);
        Aabb::of_points(bodies.chain(lines).chain(points))
    }

    /// Every vertex of the instances, and the ends of lines and points, in world coordinates.
    pub(crate) fn vertices(&self) -> impl Iterator<Item = DVec3> {
        let bodies = self.instances.iter().flat_map(|i| {
            let world_from_body = i.pose.world_from_body();
            i.mesh.positions().map(move |p| world_from_body.apply(p))
        });
        let lines = self.lines.iter().flat_map(|l| [l.from, l.to]);
        bodies.chain(lines).chain(self.points.iter().map(|p| p.position))
    }

    /// The same with widths, radii and letters so many times as large: for a larger picture.
    #[must_use]
    pub fn enlarged(&self, times: f32) -> Self {
        let mut list = self.clone();
        list.lines.iter_mut().for_each(|line| line.width = line.width.map(|w| times * w));
        list.points.iter_mut().for_each(|point| point.radius *= times);
        list.labels.iter_mut().for_each(|label| label.size *= times);
        list
    }

    /// Adds a line of even width, hidden by what is in front of it.
    pub fn push_line(&mut self, from: DVec3, to: DVec3, color: Color, width: f32) {
        self.lines.push(Line { from, to, color, width: [width; 2], on_top: false });
    }

    /// Adds an arrow: a shaft of the given width in pixels, and a head three times as wide over the
    /// last third. An arrow shows through whatever hides it if `on_top` says so.
    pub fn push_arrow(&mut self, from: DVec3, to: DVec3, color: Color, width: f32, on_top: bool) {
        let neck = from + (to - from) * (2.0 / 3.0);
        self.lines.push(Line { from, to: neck, color, width: [width; 2], on_top });
        let head = [(3.0 * width).max(width + 4.0), 0.0];
        self.lines.push(Line { from: neck, to, color, width: head, on_top });
    }

    /// Adds a contact mark: a point with an arrow of the given length (world units) along `normal`
    /// (unit), both on top, because contacts lie between bodies where nothing would show them.
    pub fn push_contact(&mut self, point: DVec3, normal: DVec3, length: f64, color: Color) {
        self.push_arrow(point, point + length * normal, color, 2.0, true);
        self.points.push(Point { position: point, color, radius: 4.5, on_top: true });
    }

    /// Adds the twelve edges of a box; none for an empty box.
    pub fn push_box(&mut self, bounds: &Aabb, color: Color, width: f32) {
        let corners: Vec<DVec3> = box_corners(bounds).collect();
        for (i, &from) in corners.iter().enumerate() {
            for axis in [1, 2, 4].into_iter().filter(|axis| i & axis == 0) {
                self.push_line(from, corners[i | axis], color, width);
            }
        }
    }
}

/// The eight corners, x varying fastest; none for an empty box.
pub(crate) fn box_corners(bounds: &Aabb) -> impl Iterator<Item = DVec3> + use<> {
    let Aabb { min, max } = *bounds;
    let count = if bounds.is_empty() { 0 } else { 8 };
    (0..count).map(move |i| {
        let pick = |bit: i32, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
        DVec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
    })
}

impl Ground {
    /// A ground for a scene of this size: at the bottom of the box, its centre below the box's,
    /// faded out two diagonals away, with a spacing of 1, 2 or 5 times a power of ten that divides
    /// the diagonal in 6 to 15. An empty or point-like box counts as one of diagonal 1.
    #[must_use]
    pub fn under(bounds: &Aabb) -> Self {
        let (center, height) = match bounds.is_empty() {
            true => (DVec2::ZERO, 0.0),
            false => (bounds.center().truncate(), bounds.min.z),
        };
        let diagonal = if bounds.diagonal().is_normal() { bounds.diagonal() } else { 1.0 };
        Self {
            height,
            center,
            radius: 2.0 * diagonal,
            spacing: round_length(0.1 * diagonal),
            shadows: true,
        }
    }

    /// The same ground at another height, for scenes with a floor of their own.
    #[must_use]
    pub fn at_height(self, height: f64) -> Self {
        Self { height, ..self }
    }
}

/// The number nearest to `length > 0`, by ratio, among 1, 2 and 5 times the powers of ten.
pub(crate) fn round_length(length: f64) -> f64 {
    let decade = 10f64.powf(length.log10().floor());
    let ratio = |candidate: f64| (candidate / length).ln().abs();
    [1.0, 2.0, 5.0, 10.0]
        .map(|step| step * decade)
        .into_iter()
        .min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)))
        .unwrap_or(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Aabb {
        Aabb { min: DVec3::ZERO, max: DVec3::ONE }
    }

    #[test]
    fn bounds_hold_posed_instances_lines_and_points() {
        let mesh = DrawMesh::new(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]).unwrap();
        let mut list = DrawList::new();
        assert!(list.bounds().is_empty());
        let pose = Pose::at(DVec3::new(10.0, 0.0, 0.0));
        list.instances.push(Instance::solid(Arc::new(mesh), pose, Color::WHITE));
        assert_eq!(list.bounds().min, DVec3::new(10.0, 0.0, 0.0));
        list.push_line(DVec3::NEG_Z, DVec3::ZERO, Color::BLACK, 1.0);
        list.push_contact(DVec3::new(0.0, 7.0, 0.0), DVec3::Y, 2.0, Color::BLACK);
        assert_eq!(list.bounds().min, DVec3::new(0.0, 0.0, -1.0));
        assert_eq!(list.bounds().max, DVec3::new(11.0, 9.0, 0.0));
    }

    #[test]
    fn a_box_has_twelve_axis_parallel_edges() {
        let mut list = DrawList::new();
        list.push_box(&unit_box(), Color::BLACK, 1.0);
        assert_eq!(list.lines.len(), 12);
        assert!(list.lines.iter().all(|l| (l.to - l.from).length() == 1.0));
        list.push_box(&Aabb::EMPTY, Color::BLACK, 1.0);
        assert_eq!(list.lines.len(), 12);
    }

    #[test]
    fn grid_spacing_is_a_round_number_near_a_tenth_of_the_scene() {
        for (length, spacing) in [(1.0, 1.0), (1.6, 2.0), (0.31, 0.2), (0.33, 0.5), (740.0, 1000.0)]
        {
            let got = round_length(length);
            assert!((got / spacing - 1.0).abs() < 1e-12, "{length}: {got}");
        }
        let ground = Ground::under(&unit_box());
        assert_eq!(ground.height, 0.0);
        assert!((ground.spacing - 0.2).abs() < 1e-12);
        let nothing = Ground::under(&Aabb::EMPTY);
        assert!(nothing.spacing > 0.0 && nothing.radius > 0.0);
    }
}
