//! The picture of `cranny inspect --render`: the body in colours, and what `--show` names
//! with it.

mod canvas;
mod classes;
mod coloring;
mod enclosed;
mod envelope;
mod findings;

use std::path::Path;

use cranny_concavity::Concavities;
use cranny_geometry::{Finding, Model};
use cranny_render::DrawMeshError;

use crate::args::{CutAxis, Show, Up};
use crate::picture::{self, Drawing, Trouble};
use canvas::Canvas;

/// What is drawn, and how it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// What is shown of the model.
    pub(super) show: Show,
    /// Which axis of the model points up.
    pub(super) up: Up,
    /// Across which axis of the model it is cut open.
    pub(super) cut: Option<CutAxis>,
}

/// Refuses a level or a depth at which nothing is, naming the last at which something is.
pub(super) fn check(concavities: &Concavities, show: Show) -> Result<(), String> {
    let (wanted, last, what) = match show {
        Show::Boxes(level) => (level, classes::last_level(concavities), "boxes"),
        Show::Envelope(depth) => (depth, envelope::last_depth(concavities), "envelope"),
        Show::Classes | Show::Patches | Show::Findings => return Ok(()),
    };
    match wanted <= last {
        true => Ok(()),
        false => {
            Err(format!("nothing lies deeper than {what}:{last}, and {what}:{wanted} is wanted"))
        }
    }
}

/// Draws a model of a name and writes the picture as PNG: whole, or not at all. Returns what its
/// colours mean.
pub(super) fn draw(
    model: &Model,
    concavities: &Concavities,
    findings: &[Finding],
    (view, name): (View, &str),
    path: &Path,
) -> Result<Vec<String>, Trouble> {
    let mut said = Vec::new();
    picture::draw(path, || {
        let (drawing, legend) = drawing(model, concavities, findings, view)?;
        said = legend;
        Ok(Drawing { title: format!("{name}: {}", title(view.show)), ..drawing })
    })?;
    Ok(said)
}

/// What a picture shows.
fn title(show: Show) -> String {
    match show {
        Show::Classes => "concavities and their caps".to_owned(),
        Show::Patches => "patches of nearly one normal".to_owned(),
        Show::Boxes(level) => format!("level {level} of the box trees of concavities"),
        Show::Envelope(depth) => format!("layers of envelopes at depth {depth}"),
        Show::Findings => "findings".to_owned(),
    }
}

fn drawing(
    model: &Model,
    concavities: &Concavities,
    findings: &[Finding],
    view: View,
) -> Result<(Drawing, Vec<String>), DrawMeshError> {
    let mut canvas = Canvas::new(model, concavities);
    match view.show {
        Show::Classes => classes::draw_classes(&mut canvas),
        Show::Patches => classes::draw_patches(&mut canvas),
        Show::Boxes(level) => classes::draw_boxes(&mut canvas, level),
        Show::Envelope(layer) => envelope::draw_layer(&mut canvas, layer),
        Show::Findings => findings::draw_findings(&mut canvas, findings),
    }
    canvas.finish(view)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cranny_exact::DVec3;
    use cranny_geometry::{BuildOptions, Mesh};
    use cranny_render::{
        Camera, Color, DrawList, ImageSize, Preset, Renderer, RendererOptions, palette,
    };
    use cranny_shapes::{Cuboid, Cup, GolfBall, Torus};

    fn listed(drawing: Drawing) -> DrawList {
        let Ok([view]) = <[_; 1]>::try_from(drawing.views) else { panic!("one view") };
        view.list
    }

    fn drawn(mesh: Mesh, show: Show) -> (DrawList, Vec<String>) {
        let (model, mut report) = Model::build(mesh, &BuildOptions::default()).unwrap();
        let concavities = Concavities::of(&model);
        report.add(concavities.findings(&model));
        let view = View { show, up: Up::Z, cut: None };
        let (drawing, legend) = drawing(&model, &concavities, &report.findings, view).unwrap();
        (listed(drawing), legend)
    }

    fn cup() -> Mesh {
        Cup { segments: 16, ..Cup::default() }.build().unwrap()
    }

    #[test]
    fn open_edges_and_the_opening_above_them_are_drawn() {
        let vertices = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]]; // one side missing
        let (list, legend) = drawn(Mesh::new(vertices, faces).unwrap(), Show::Classes);
        let red = Color::rgb(220, 40, 40);
        assert_eq!(list.lines.iter().filter(|line| line.color == red).count(), 3);
        assert_eq!(list.lines.iter().filter(|line| line.on_top).count(), 3);
        let [body, caps] = list.instances.as_slice() else { panic!("{legend:?}") };
        assert_eq!((body.mesh.triangle_count(), caps.mesh.triangle_count()), (3, 1));
        assert!(!caps.color.is_opaque());
        assert!(legend.iter().any(|words| words.contains("open edges")), "{legend:?}");
    }

    #[test]
    fn a_cup_has_one_loop_one_lid_and_boxes_by_level() {
        let ink = |list: &DrawList| list.lines.iter().filter(|l| l.color == canvas::INK).count();
        let (list, legend) = drawn(cup(), Show::Classes);
        assert_eq!(ink(&list), 16);
        // The lid, a polygon of 16 corners.
        assert_eq!(list.instances[1].mesh.triangle_count(), 14);
        assert!(legend.contains(&"concavities by number: blue 0".to_owned()), "{legend:?}");
        assert!(legend.contains(&"amber: caps, translucent".to_owned()), "{legend:?}");
        for level in 0..3 {
            let (list, _) = drawn(cup(), Show::Boxes(level));
            let lines = list.lines.iter().filter(|line| line.color == palette(0)).count();
            assert_eq!(lines, 12 << level);
        }
    }

    #[test]
    fn what_matter_encloses_is_seen_through_it() {
        let cube = |size: f64, inward: bool| {
            let mesh = Cuboid { size: [size; 3] }.build().unwrap();
            let turn = |&[a, b, c]: &[u32; 3]| if inward { [a, c, b] } else { [a, b, c] };
            let faces = mesh.faces().iter().map(turn).collect();
            Mesh::new(mesh.vertices().to_vec(), faces).unwrap()
        };
        let hollow = cube(8.0, false).joined(&cube(6.0, true));
        let solid_in_solid = cube(8.0, false).joined(&cube(6.0, false));
        let pebble_in_hollow = hollow.clone().joined(&cube(1.0, false));
        for (mesh, behind_glass) in [(hollow, 12), (solid_in_solid, 12), (pebble_in_hollow, 24)] {
            let shows =
                [Show::Classes, Show::Boxes(0), Show::Patches, Show::Findings, Show::Envelope(0)];
            for show in shows {
                let (list, legend) = drawn(mesh.clone(), show);
                let [body, glass] = list.instances.as_slice() else { panic!("{legend:?}") };
                let count = [body, glass].map(|instance| instance.mesh.triangle_count());
                assert_eq!(count[0], 12, "{show:?}");
                // Facets of envelopes are glass as well.
                let has_facets = matches!(show, Show::Envelope(_));
                assert!(count[1] == behind_glass || has_facets && count[1] > behind_glass);
                assert!(body.color.is_opaque() && !glass.color.is_opaque());
                assert!(legend.iter().any(|words| words.contains("without a lid")), "{legend:?}");
            }
        }
        // A pebble in a cup is seen from above.
        let in_sight = cup().joined(&cube(0.1, false));
        let faces = in_sight.faces().len();
        let (list, _) = drawn(in_sight, Show::Boxes(0));
        assert_eq!(list.instances[0].mesh.triangle_count(), faces);
    }

    #[test]
    fn whatever_axis_points_up_the_ground_lies_below() {
        // A cup is as wide as it is high, its bottom at 0.
        let (model, report) = Model::build(cup(), &BuildOptions::default()).unwrap();
        let concavities = Concavities::of(&model);
        let top = |up| {
            let view = View { show: Show::Classes, up, cut: None };
            let (drawing, _) = drawing(&model, &concavities, &report.findings, view).unwrap();
            let list = listed(drawing);
            let heights = list.lines.iter().flat_map(|line| [line.from.z, line.to.z]);
            (list.bounds().min.z, heights.fold(f64::NEG_INFINITY, f64::max))
        };
        assert_eq!(top(Up::Z), (0.0, 1.0));
        for lying in [Up::X, Up::Y] {
            let (low, high) = top(lying);
            assert!((low + 0.5).abs() < 1e-12 && (high - 0.5).abs() < 1e-12, "{lying:?}");
        }
        for (up, axis) in [(Up::X, DVec3::X), (Up::Y, DVec3::Y), (Up::Z, DVec3::Z)] {
            assert_eq!(up.upright(axis), DVec3::Z);
            let [x, y, z] = DVec3::AXES.map(|axis| up.upright(axis));
            assert_eq!(x.cross(y).dot(z), 1.0, "a turn, no reflection");
        }
    }

    #[test]
    fn what_is_before_a_cut_is_taken_away() {
        let (model, report) = Model::build(cup(), &BuildOptions::default()).unwrap();
        let concavities = Concavities::of(&model);
        for (show, cut) in [(Show::Classes, CutAxis::Y), (Show::Envelope(0), CutAxis::X)] {
            let view = View { show, up: Up::Z, cut: Some(cut) };
            let (drawing, _) = drawing(&model, &concavities, &report.findings, view).unwrap();
            let list = listed(drawing);
            let section = list.section.unwrap();
            assert!(section.normal.dot(cut.direction()).abs() == 1.0, "{section:?}");
            let before = |p: DVec3| section.before(p) > 1e-9;
            let lines = list.lines.iter();
            assert!(lines.clone().count() > 5);
            assert!(lines.clone().all(|line| !before(line.from) && !before(line.to)));
            let [body, glass] = list.instances.as_slice() else { panic!("a body and its caps") };
            assert!(body.cut && !glass.cut);
            // What is cut of caps and facets is half of them, and has an edge in the plane.
            assert!(
                glass.mesh.bounds().max.dot(section.normal)
                    < 1e-6 + section.point.dot(section.normal)
            );
            let within = |p: DVec3| section.before(p).abs() < 1e-9;
            assert!(lines.clone().any(|line| line.width[0].to_bits() == canvas::EDGE.to_bits()
                && within(line.from)
                && within(line.to)));
        }
    }

    #[test]
    fn what_lies_too_deep_is_refused() {
        let torus = Torus { major_segments: 48, ..Default::default() };
        let (model, _) = Model::build(torus.build().unwrap(), &BuildOptions::default()).unwrap();
        let all = Concavities::of(&model);
        let last = [classes::last_level(&all), envelope::last_depth(&all)];
        // Leaves of two faces, layers of sixteen facets: hundreds of faces go deeper than one.
        assert!(last.iter().all(|&last| (1..16).contains(&last)), "{last:?}");
        for (show, of) in [(Show::Boxes as fn(usize) -> Show, last[0]), (Show::Envelope, last[1])] {
            assert!(check(&all, show(of)).is_ok());
            let refused = check(&all, show(of + 1)).unwrap_err();
            assert!(refused.contains(&format!(":{of}, ")), "{refused}");
        }
        // Nothing at all to show: the first level is no error.
        let cube = Cuboid::default().build().unwrap();
        let (model, _) = Model::build(cube, &BuildOptions::default()).unwrap();
        let all = Concavities::of(&model);
        assert!(check(&all, Show::Boxes(0)).is_ok() && check(&all, Show::Boxes(1)).is_err());
        assert!(check(&all, Show::Classes).is_ok());
    }

    #[test]
    #[expect(clippy::print_stdout, reason = "says why it did nothing")]
    fn every_view_of_a_body_is_a_picture_of_its_own() {
        let Ok(mut renderer) = Renderer::new(&RendererOptions::default()) else {
            println!("skipped: no graphics adapter");
            return;
        };
        let size = ImageSize::new(320, 240).unwrap();
        let torus = Torus { major_segments: 24, minor_segments: 8, ..Torus::default() };
        let ball = GolfBall { dimples: 24, triangles: 5_000, coverage: 0.4, ..GolfBall::default() };
        for mesh in [cup(), torus.build().unwrap(), ball.build().unwrap()] {
            let shows =
                [Show::Classes, Show::Patches, Show::Boxes(1), Show::Envelope(0), Show::Findings];
            let pictures = shows.map(|show| {
                let (list, _) = drawn(mesh.clone(), show);
                let camera = Camera::fitted_to(Preset::Isometric, &list, size).unwrap();
                renderer.render(&list, &camera, size).unwrap()
            });
            for (i, picture) in pictures.iter().enumerate() {
                for other in &pictures[..i] {
                    let changed = picture.difference(other, 8).unwrap();
                    assert!(changed.differing > 0.005, "{:?}: {changed:?}", shows[i]);
                }
            }
        }
    }
}
