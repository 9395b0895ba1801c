//! A picture in the making: the body's faces with their colours, and what is drawn over them.

use std::collections::BTreeMap;
use std::sync::Arc;

use cranny_concavity::Concavities;
use cranny_exact::{DVec3, Pose};
use cranny_geometry::{EdgeKind, FaceId, Model};
use cranny_render::palette::OVERLAP;
use cranny_render::{
    Color, DrawList, DrawMesh, DrawMeshError, Ground, Instance, Key, Line, Mark, Preset, Section,
    palette,
};

use super::envelope::clip;
use super::{View, coloring};
use crate::picture::{Drawing, PictureView};

/// Of what has no colour of its own.
pub(super) const GREY: Color = Color::rgb(186, 191, 198);
/// Loops and borders.
pub(super) const INK: Color = Color::rgb(28, 32, 40);

const OPEN: Color = Color::rgb(220, 40, 40);
const CONTRADICTORY: Color = Color::rgb(240, 140, 0);
const NON_MANIFOLD: Color = Color::rgb(200, 0, 180);

/// Pixels.
pub(super) const LINE_WIDTH: f32 = 2.5;

/// Opacity with which a line shows through what hides it.
const HIDDEN: u8 = 70;

/// Opacity of caps and envelopes.
const GLASS: u8 = 110;

/// Corners that are nearer to a cut than this share of the body's size lie in it: those of a
/// clipped polygon are off by rounding.
const FLAT: f64 = 1e-12;

/// So many things of one colour are named in a legend; the others are counted.
const SPELT: usize = 4;

/// Half way to white.
pub(super) fn lightened(color: Color) -> Color {
    let [r, g, b] = [color.r, color.g, color.b].map(|channel| channel.midpoint(u8::MAX));
    Color { r, g, b, ..color }
}

/// Colours at most that have keys of their own below a picture.
const KEYS: usize = 8;

/// Width of the edges of caps and facets that are cut, in pixels.
pub(super) const EDGE: f32 = 4.0;

/// What is drawn, and what it means.
pub(super) struct Canvas<'m> {
    pub(super) model: &'m Model,
    pub(super) concavities: &'m Concavities,
    pub(super) faces: Vec<Color>,
    pub(super) list: DrawList,
    pub(super) legend: Vec<String>,
    /// Lines of the legend that have a mark in the picture.
    keys: Vec<Key>,
    /// What stands below the picture: the other lines of the legend.
    caption: Vec<String>,
    glass: (Vec<DVec3>, Vec<[u32; 3]>, Vec<Color>),
    /// Whether a face is drawn as glass; at first none is.
    is_glass: Vec<bool>,
}

impl<'m> Canvas<'m> {
    /// A grey body.
    pub(super) fn new(model: &'m Model, concavities: &'m Concavities) -> Self {
        Self {
            model,
            concavities,
            faces: vec![GREY; model.mesh().faces().len()],
            list: DrawList::new(),
            legend: Vec::new(),
            keys: Vec::new(),
            caption: Vec::new(),
            glass: (Vec::new(), Vec::new(), Vec::new()),
            is_glass: vec![false; model.mesh().faces().len()],
        }
    }

    /// A line of the legend: what a mark means, which is called something in words.
    pub(super) fn explain(&mut self, called: &str, mark: Mark, meaning: impl Into<String>) {
        let meaning = meaning.into();
        self.legend.push(format!("{called}: {meaning}"));
        self.keys.push(Key::new(mark, meaning));
    }

    /// A line of the legend that no mark stands for.
    pub(super) fn remark(&mut self, words: impl Into<String>) {
        let words = words.into();
        self.legend.push(words.clone());
        self.caption.push(words);
    }

    /// Draws only some faces as they are and the others as glass, so that one sees what these
    /// surround.
    pub(super) fn lay_bare(&mut self, shown: impl Fn(FaceId) -> bool) {
        for (face, is_glass) in (0..).map(FaceId).zip(&mut self.is_glass) {
            *is_glass = !shown(face);
        }
    }

    /// Paints each face in the colour of its region, neighbours in different ones; faces of no
    /// region keep their colour. Returns the colours of the regions, as numbers of the palette.
    pub(super) fn paint(
        &mut self,
        region: impl Fn(FaceId) -> Option<u32>,
        regions: usize,
    ) -> Vec<usize> {
        let of_faces: Vec<_> = (0..self.faces.len() as u32).map(|f| region(FaceId(f))).collect();
        let colors = coloring::colors(self.model.topology(), of_faces.clone(), regions);
        for (face, region) in self.faces.iter_mut().zip(of_faces) {
            if let Some(region) = region {
                *face = palette(colors[region as usize]);
            }
        }
        colors
    }

    /// A line of the legend that names the colours of things by their numbers; `what` is one of
    /// them, and many.
    pub(super) fn explain_colors(&mut self, what: [&str; 2], colors: &[usize]) {
        let mut of_color: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (id, &color) in colors.iter().enumerate() {
            of_color.entry(color).or_default().push(id);
        }
        let mut named = Vec::new();
        for (color, ids) in of_color {
            let found: Vec<String> = ids.iter().take(SPELT).map(usize::to_string).collect();
            let more = match ids.len().saturating_sub(SPELT) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let called = what[usize::from(ids.len() > 1)];
            let numbers = format!("{}{more}", found.join(", "));
            named.push(format!("{} {numbers}", coloring::name(color)));
            if named.len() <= KEYS {
                self.keys.push(Key::new(Mark::Body(palette(color)), format!("{called} {numbers}")));
            }
        }
        if !named.is_empty() {
            self.legend.push(format!("{} by number: {}", what[1], named.join("; ")));
        }
    }

    /// Adds a translucent convex polygon, counter-clockwise seen from where it is brightest.
    pub(super) fn add_glass(&mut self, polygon: &[DVec3], color: Color) {
        let (corners, faces, colors) = &mut self.glass;
        let first = corners.len() as u32;
        corners.extend(polygon);
        for i in 2..polygon.len() as u32 {
            faces.push([first, first + i - 1, first + i]);
            colors.push(color);
        }
    }

    /// Adds a closed line.
    pub(super) fn add_loop(&mut self, corners: &[DVec3], color: Color, width: f32) {
        let next = corners.iter().cycle().skip(1);
        for (&from, &to) in corners.iter().zip(next) {
            self.list.push_line(from, to, color, width);
        }
    }

    /// Lets the lines from number `first` on show faintly through what hides them.
    pub(super) fn let_lines_shine_through(&mut self, first: usize) {
        let faint =
            |line: &Line| Line { color: line.color.with_alpha(HIDDEN), on_top: true, ..*line };
        let through: Vec<Line> = self.list.lines[first..].iter().map(faint).collect();
        self.list.lines.extend(through);
    }

    /// Marks the edges that are not sound, and hands over what is drawn, upright and cut as it is
    /// wanted, and its legend.
    pub(super) fn finish(mut self, view: View) -> Result<(Drawing, Vec<String>), DrawMeshError> {
        let View { up, cut, .. } = view;
        self.mark_edges();
        let mesh = self.model.mesh();
        let (mut shown, mut colors) = (Vec::new(), Vec::new());
        for face in (0..mesh.faces().len() as u32).map(FaceId) {
            let color = self.faces[face.index()];
            if self.is_glass[face.index()] {
                self.add_glass(&mesh.triangle(face), color);
            } else {
                shown.push(mesh.faces()[face.index()]);
                colors.push(color);
            }
        }
        let upright = |points: &[DVec3]| points.iter().map(|&p| up.upright(p)).collect::<Vec<_>>();
        let body = upright(mesh.vertices());
        let body = DrawMesh::with_face_colors(&body, &shown, &colors)?;
        self.glass.0 = upright(&self.glass.0);
        for line in &mut self.list.lines {
            (line.from, line.to) = (up.upright(line.from), up.upright(line.to));
        }
        for point in &mut self.list.points {
            point.position = up.upright(point.position);
        }
        if let Some(axis) = up.name_unless_usual() {
            self.remark(format!("{axis} points up"));
        }
        let body = Instance::solid(Arc::new(body), Pose::IDENTITY, Color::WHITE);
        self.list.instances.push(body);
        if let Some(axis) = cut {
            self.cut(up.upright(axis.direction()));
        }
        let (corners, faces, colors) = &self.glass;
        if !faces.is_empty() {
            let glass = Arc::new(DrawMesh::with_face_colors(corners, faces, colors)?);
            let color = Color::WHITE.with_alpha(GLASS);
            self.list.instances.push(Instance::solid(glass, Pose::IDENTITY, color));
        }
        // The shadow of what is taken away would still show it.
        let ground = Ground::under(&self.list.bounds());
        self.list.ground = Some(Ground { shadows: cut.is_none(), ..ground });
        let Self { list, keys, caption, legend, .. } = self;
        let views = vec![PictureView::of(list)];
        Ok((Drawing { views, keys, caption, title: String::new() }, legend))
    }

    /// Takes away all that is before the plane through the body's middle across an axis, on the
    /// side of the viewer.
    fn cut(&mut self, axis: DVec3) {
        let toward = if axis.dot(Preset::Isometric.direction()) < 0.0 { -axis } else { axis };
        let middle = self.list.instances[0].mesh.bounds().center();
        let Some(section) = Section::through(middle, toward, OVERLAP) else { return };
        self.list.section = Some(section);
        for body in &mut self.list.instances {
            body.cut = true;
        }
        self.list.lines.retain_mut(|line| cut_line(&section, line));
        self.list.points.retain(|point| section.before(point.position) <= 0.0);
        let (corners, faces, colors) = std::mem::take(&mut self.glass);
        for (face, color) in faces.into_iter().zip(colors) {
            let mut polygon = face.map(|corner| corners[corner as usize]).to_vec();
            clip(&mut polygon, toward, toward.dot(middle));
            self.add_glass(&polygon, color);
            let edge: Vec<DVec3> = polygon
                .into_iter()
                .filter(|&p| section.before(p).abs() < FLAT * self.size())
                .collect();
            if let [from, to] = edge[..] {
                self.list.push_line(from, to, color, EDGE);
            }
        }
        self.explain("hatched", Mark::Hatched(Color::WHITE), "where the body is cut open");
        if !self.glass.1.is_empty() {
            self.remark("thick lines: where what is translucent is cut");
        }
    }

    fn size(&self) -> f64 {
        self.model.bounds().diagonal()
    }

    fn mark_edges(&mut self) {
        let (mesh, first) = (self.model.mesh(), self.list.lines.len());
        let mut seen = [false; 3];
        for edge in self.model.topology().edges() {
            let (color, kind) = match edge.kind {
                EdgeKind::Manifold => continue,
                EdgeKind::Open => (OPEN, 0),
                EdgeKind::Contradictory => (CONTRADICTORY, 1),
                EdgeKind::Balanced | EdgeKind::Tangled => (NON_MANIFOLD, 2),
            };
            seen[kind] = true;
            let [from, to] = [edge.from, edge.to].map(|vertex| mesh.position(vertex));
            self.list.push_line(from, to, color, LINE_WIDTH);
        }
        self.let_lines_shine_through(first);
        let words = [
            "red lines: open edges",
            "orange lines: edges along which orientations contradict",
            "violet lines: edges of more than two faces",
        ];
        words.into_iter().zip(seen).filter(|w| w.1).for_each(|w| self.remark(w.0));
    }
}

/// Shortens a line to its part behind a section; `false` where it has none.
fn cut_line(section: &Section, line: &mut Line) -> bool {
    let [from, to] = [line.from, line.to].map(|p| section.before(p));
    let crossing = line.from + from / (from - to) * (line.to - line.from);
    match (from > 0.0, to > 0.0) {
        (true, true) => return false,
        (true, false) => line.from = crossing,
        (false, true) => line.to = crossing,
        (false, false) => {}
    }
    true
}
