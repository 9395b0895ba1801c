//! One `<mesh>` of a COLLADA file: positions and polygons, before any transform.

use cranny_exact::DVec3;
use roxmltree::Node;

use super::{FORMAT, NUMBER, element, elements, id_of, line_of, malformed, numbers};
use crate::mesh_file::problem::{DecodeError, Problem, excerpt};

/// What the numbers of polygons mean.
const INTEGER: &str = "an index or a count";

/// Positions and polygons of at least three corners, all in range.
pub(super) struct Geometry {
    pub(super) positions: Vec<DVec3>,
    pub(super) polygons: Vec<Vec<u32>>,
    /// Groups of points, lines and holed polygons that were left out.
    pub(super) skipped: usize,
}

impl Geometry {
    pub(super) fn read(mesh: Node<'_, '_>) -> Result<Self, DecodeError> {
        let positions = read_positions(mesh)?;
        let mut geometry = Self { positions, polygons: Vec::new(), skipped: 0 };
        for group in mesh.children().filter(Node::is_element) {
            match group.tag_name().name() {
                "triangles" => geometry
                    .add_lists(group, |corners| corners.chunks(3).map(<[u32]>::to_vec).collect())?,
                "polygons" => geometry.add_polygons(group)?,
                "polylist" => geometry.add_polylist(group)?,
                "tristrips" => geometry.add_lists(group, strip)?,
                "trifans" => geometry.add_lists(group, |corners| {
                    corners.windows(2).skip(1).map(|w| vec![corners[0], w[0], w[1]]).collect()
                })?,
                "lines" | "linestrips" => geometry.skipped += 1,
                _ => {}
            }
        }
        Ok(geometry)
    }

    /// Groups whose every `<p>` holds triangles in some order.
    fn add_lists(
        &mut self,
        group: Node<'_, '_>,
        triangles: impl Fn(&[u32]) -> Vec<Vec<u32>>,
    ) -> Result<(), DecodeError> {
        for p in elements(group, "p") {
            let corners = self.corners(group, p)?;
            self.add(p, triangles(&corners))?;
        }
        Ok(())
    }

    fn add_polygons(&mut self, group: Node<'_, '_>) -> Result<(), DecodeError> {
        self.skipped += elements(group, "ph").count();
        for p in elements(group, "p") {
            let corners = self.corners(group, p)?;
            self.add(p, vec![corners])?;
        }
        Ok(())
    }

    fn add_polylist(&mut self, group: Node<'_, '_>) -> Result<(), DecodeError> {
        let Some(p) = element(group, "p") else { return Ok(()) };
        let corners = self.corners(group, p)?;
        let counts: Option<Vec<usize>> =
            element(group, "vcount").map(|node| numbers(node, INTEGER)).transpose()?;
        let mut rest = corners.as_slice();
        let mut polygons = Vec::new();
        for count in counts.unwrap_or_default() {
            let Some((polygon, after)) = rest.split_at_checked(count) else {
                return Err(malformed(
                    p,
                    format!("{} corners", corners.len()),
                    "as many as vcount asks for",
                ));
            };
            polygons.push(polygon.to_vec());
            rest = after;
        }
        if !rest.is_empty() {
            let found = format!("{} corners more than vcount asks for", rest.len());
            return Err(malformed(p, found, "as many as it asks for"));
        }
        self.add(p, polygons)
    }

    fn add(&mut self, p: Node<'_, '_>, polygons: Vec<Vec<u32>>) -> Result<(), DecodeError> {
        if let Some(short) = polygons.iter().find(|polygon| polygon.len() < 3) {
            return Err(malformed(
                p,
                format!("a polygon of {} corners", short.len()),
                "at least three",
            ));
        }
        self.polygons.extend(polygons);
        Ok(())
    }

    /// The position indices among the interleaved ones of a `<p>`.
    fn corners(&self, group: Node<'_, '_>, p: Node<'_, '_>) -> Result<Vec<u32>, DecodeError> {
        let mut stride = 1;
        let mut at = None;
        for input in elements(group, "input") {
            let text = input.attribute("offset").unwrap_or("0");
            // More than this many interleaved inputs are a broken file, not a mesh.
            let offset = text.trim().parse().ok().filter(|&offset: &usize| offset < 1 << 16);
            let offset = offset.ok_or_else(|| malformed(input, excerpt(text), "an offset"))?;
            stride = stride.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                at = Some(offset);
            }
        }
        let at = at.ok_or_else(|| {
            malformed(group, "no input VERTEX".to_owned(), "an input with the semantic VERTEX")
        })?;
        let indices: Vec<usize> = numbers(p, INTEGER)?;
        if !indices.len().is_multiple_of(stride) {
            let found = format!("{} indices", indices.len());
            return Err(malformed(
                p,
                found,
                &format!("a multiple of {stride}, one for each input"),
            ));
        }
        let vertices = self.positions.len();
        indices
            .chunks_exact(stride)
            .map(|corner| {
                let index = corner[at];
                u32::try_from(index).ok().filter(|&i| (i as usize) < vertices).ok_or_else(|| {
                    let problem = Problem::Index { index: index as i64, vertices, first: 0 };
                    DecodeError { format: FORMAT, place: line_of(p), problem }
                })
            })
            .collect()
    }
}

/// Every second triangle of a strip is turned, so that all face the same way.
fn strip(corners: &[u32]) -> Vec<Vec<u32>> {
    corners
        .windows(3)
        .enumerate()
        .map(|(k, w)| if k % 2 == 0 { w.to_vec() } else { vec![w[0], w[2], w[1]] })
        .collect()
}

/// Positions: mesh → `<vertices>` → its input POSITION → a `<source>` of floats.
fn read_positions(mesh: Node<'_, '_>) -> Result<Vec<DVec3>, DecodeError> {
    let Some(vertices) = element(mesh, "vertices") else { return Ok(Vec::new()) };
    let input = elements(vertices, "input")
        .find(|input| input.attribute("semantic") == Some("POSITION"))
        .ok_or_else(|| {
            malformed(
                vertices,
                "no input POSITION".to_owned(),
                "an input with the semantic POSITION",
            )
        })?;
    let reference = input.attribute("source").unwrap_or_default();
    let id = id_of(reference);
    let source = elements(mesh, "source")
        .find(|source| source.attribute("id") == Some(id))
        .ok_or_else(|| {
            malformed(input, format!("the source {}", excerpt(reference)), "a source of this mesh")
        })?;
    let array = element(source, "float_array").ok_or_else(|| {
        malformed(source, "no float_array".to_owned(), "a float_array of positions")
    })?;
    let values = numbers(array, NUMBER)?;
    let accessor = element(source, "technique_common").and_then(|t| element(t, "accessor"));
    let attribute = |name, default: usize| match accessor.and_then(|a| a.attribute(name)) {
        None => Ok(default),
        Some(text) => text
            .trim()
            .parse()
            .map_err(|_| malformed(source, excerpt(text), "a whole number in its accessor")),
    };
    let stride = attribute("stride", 3)?;
    let offset = attribute("offset", 0)?;
    if stride < 3 {
        return Err(malformed(source, format!("a stride of {stride}"), "at least 3 (x, y, z)"));
    }
    let count = attribute("count", values.len().saturating_sub(offset) / stride)?;
    let needed = match count {
        0 => 0,
        n => (n - 1).saturating_mul(stride).saturating_add(offset).saturating_add(3),
    };
    if needed > values.len() {
        let found = format!("{} numbers", values.len());
        return Err(malformed(array, found, &format!("{needed} for {count} positions")));
    }
    let at = |k: usize| &values[offset + k * stride..];
    Ok((0..count).map(|k| DVec3::new(at(k)[0], at(k)[1], at(k)[2])).collect())
}
