//! Every view, drawn by a software adapter: what it must show, and beside a picture that was looked
//! at.
//!
//! A picture may differ from the kept one by [`MEAN`] in the mean over all channels, and by more
//! than [`STEP`] of 255 in at most [`SHARE`] of its pixels: drivers round, and sample edges, in
//! ways of their own. `CRANNY_KEEP_VIEWS=1 cargo test -p cranny-render --test views` writes new
//! ones.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::path::PathBuf;
use std::sync::Arc;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_render::{
    Camera, Color, DrawList, DrawMesh, Ground, Image, ImageSize, Instance, Key, Label, Mark, Panel,
    Patch, Preset, Ramp, RenderError, Renderer, RendererOptions, Section, Shading, Sheet, Style,
    palette,
};

const MEAN: f64 = 0.8;
const STEP: u8 = 24;
const SHARE: f64 = 0.015;

/// `None` where the machine has no software adapter; any other failure fails the test.
fn renderer() -> Option<Renderer> {
    match Renderer::new(&RendererOptions { software: true, ..RendererOptions::default() }) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter { .. }) => {
            eprintln!("skipped: no software graphics adapter (install mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn size() -> ImageSize {
    ImageSize::new(240, 180).unwrap()
}

type Triangles = (Vec<DVec3>, Vec<[u32; 3]>);

/// A box; inside out where `half` is negative.
fn cuboid(center: DVec3, half: f64) -> Triangles {
    let sign = |i: usize, bit: usize| if i & bit == 0 { -half } else { half };
    let corner = |i| center + DVec3::new(sign(i, 1), sign(i, 2), sign(i, 4));
    let sides =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), faces)
}

fn torus(major: f64, minor: f64) -> Triangles {
    let (n, m) = (48u32, 20u32);
    let turn = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
    let vertex = |k: u32| {
        let (a, b) = (turn(k / m, n), turn(k % m, m));
        let r = major + minor * b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), minor * b.sin())
    };
    let id = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let faces = cells.flat_map(|(i, j)| {
        let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
        [[a, b, c], [a, c, d]]
    });
    ((0..n * m).map(vertex).collect(), faces.collect())
}

fn joined((mut vertices, mut faces): Triangles, other: &Triangles) -> Triangles {
    let first = vertices.len() as u32;
    vertices.extend(&other.0);
    faces.extend(other.1.iter().map(|face| face.map(|i| i + first)));
    (vertices, faces)
}

fn body((vertices, faces): &Triangles, at: DVec3, color: Color) -> Instance {
    let mesh = Arc::new(DrawMesh::new(vertices, faces).unwrap());
    Instance { cut: true, ..Instance::solid(mesh, Pose::at(at), color) }
}

/// White all over, so that whatever is not white was drawn.
fn blank(instances: Vec<Instance>) -> DrawList {
    DrawList { instances, backdrop: [Color::WHITE; 2], ..DrawList::new() }
}

/// Looks along +y from (0, −10, 0).
fn front() -> Camera {
    Camera::look_at(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO).unwrap()
}

fn pixel_at(image: &Image, camera: &Camera, point: DVec3) -> Color {
    let [x, y] = camera.project(point, image.size()).unwrap();
    image.pixel(x as u32, y as u32).unwrap()
}

fn cut_at(y: f64) -> Option<Section> {
    Section::through(DVec3::new(0.0, y, 0.0), DVec3::NEG_Y, palette::OVERLAP)
}

fn is_overlap(c: Color) -> bool {
    c.r > 150 && c.g < 40 && c.b < 90
}

/// Lit faces that look at the camera are lighter than any part of a cut face.
fn cut_faces(color: Color, image: &Image, camera: &Camera, points: &[DVec3]) -> Vec<bool> {
    let [r, g, b] = [color.r, color.g, color.b].map(i32::from);
    let is_cut = |c: Color| {
        // Hatching darkens; the ratio of the channels stays.
        let [x, y, z] = [c.r, c.g, c.b].map(i32::from);
        (x * g - y * r).abs() < 2200 && (y * b - z * g).abs() < 2200 && x <= r && y <= g && z <= b
    };
    points.iter().map(|&p| is_cut(pixel_at(image, camera, p))).collect()
}

#[test]
fn a_cut_face_has_no_hole_but_those_that_the_body_has() {
    let Some(mut renderer) = renderer() else { return };
    let hollow = joined(cuboid(DVec3::ZERO, 1.0), &cuboid(DVec3::ZERO, -0.5));
    let color = Color::rgb(200, 180, 160);
    let mut list = blank(vec![body(&hollow, DVec3::ZERO, color)]);
    list.section = cut_at(0.01);
    let image = renderer.render(&list, &front(), size()).unwrap();
    let grid = |lo: f64, hi: f64| -> Vec<DVec3> {
        let step = |i: i32| lo + (hi - lo) * f64::from(i) / 60.0;
        (0..=60).flat_map(|i| (0..=60).map(move |j| DVec3::new(step(i), 0.01, step(j)))).collect()
    };
    let (inside, wall): (Vec<_>, Vec<_>) = grid(-0.95, 0.95)
        .into_iter()
        .filter(|p| (p.x.abs().max(p.z.abs()) - 0.5).abs() > 0.05)
        .partition(|p| p.x.abs().max(p.z.abs()) < 0.5);
    assert!(cut_faces(color, &image, &front(), &wall).iter().all(|&cut| cut));
    // In the cavity its far wall is seen, at (x, 0.5, z), as an inside that is lit from the front.
    let lit = |p: &DVec3| pixel_at(&image, &front(), *p);
    assert!(inside.iter().all(|p| lit(p) == lit(&inside[0])), "the cavity is smooth");
    let outside = pixel_at(&image, &front(), DVec3::new(1.2, 0.01, 0.0));
    assert_eq!(outside, Color::WHITE);
}

#[test]
fn what_two_cut_bodies_share_has_the_colour_of_overlaps() {
    let Some(mut renderer) = renderer() else { return };
    let cube = cuboid(DVec3::ZERO, 1.0);
    let bodies = [-0.8, 0.8].map(|x| DVec3::new(x, 0.0, 0.0));
    for order in [[0, 1], [1, 0]] {
        let instances = order.map(|i| body(&cube, bodies[i], palette(i))).to_vec();
        let mut list = blank(instances);
        list.section = cut_at(0.2);
        let image = renderer.render(&list, &front(), size()).unwrap();
        for i in -9i32..=9 {
            let at = DVec3::new(0.02 * f64::from(i), 0.2, 0.3);
            assert!(is_overlap(pixel_at(&image, &front(), at)), "{at}");
        }
        for x in [-0.5, 0.5, 1.5] {
            assert!(!is_overlap(pixel_at(&image, &front(), DVec3::new(x, 0.2, 0.3))));
        }
    }
}

#[test]
fn open_meshes_whole_bodies_and_cameras_behind_the_plane_have_no_cut_face() {
    let Some(mut renderer) = renderer() else { return };
    let mut open = cuboid(DVec3::ZERO, 1.0);
    open.1.truncate(10);
    let color = Color::rgb(200, 180, 160);
    let mut list = blank(vec![body(&open, DVec3::ZERO, color)]);
    list.section = cut_at(0.0);
    let image = renderer.render(&list, &front(), size()).unwrap();
    // The far wall's inside: smooth, where a cut face is hatched.
    let along = (-8i32..=8).map(|i| DVec3::new(0.1 * f64::from(i), 0.0, 0.0));
    let seen: Vec<Color> = along.map(|p| pixel_at(&image, &front(), p)).collect();
    assert!(seen.iter().all(|c| *c == seen[0] && c.r < 150), "{seen:?}");
    let closed = body(&cuboid(DVec3::ZERO, 1.0), DVec3::ZERO, color);
    let whole = blank(vec![Instance { cut: false, ..closed.clone() }]);
    let plain = renderer.render(&whole, &front(), size()).unwrap();
    let cut = DrawList { section: cut_at(0.0), ..whole };
    assert_eq!(renderer.render(&cut, &front(), size()).unwrap(), plain);
    let behind = Section::through(DVec3::ZERO, DVec3::Y, palette::OVERLAP);
    let list = DrawList { section: behind, ..blank(vec![closed]) };
    assert_eq!(renderer.render(&list, &front(), size()).unwrap(), plain);
}

#[test]
fn x_rays_look_the_same_in_any_order() {
    let Some(mut renderer) = renderer() else { return };
    let ring = torus(1.0, 0.35);
    let mut instances: Vec<Instance> = (0..3)
        .map(|i| {
            let at = DVec3::new(0.5 * f64::from(i) - 0.5, 0.3 * f64::from(i), 0.0);
            Instance { style: Style::XRay, ..body(&ring, at, palette(i as usize)) }
        })
        .collect();
    let picture = renderer.render(&blank(instances.clone()), &front(), size()).unwrap();
    instances.reverse();
    let reversed = renderer.render(&blank(instances), &front(), size()).unwrap();
    // Eight bits round after each layer.
    assert!(picture.difference(&reversed, 6).unwrap().differing < 0.002);
    assert!(picture.pixels().chunks_exact(4).any(|p| p[0] < 200));
}

#[test]
fn a_patch_is_painted_between_its_loops_and_behind_a_section_only() {
    let Some(mut renderer) = renderer() else { return };
    let square = |half: f64, y: f64| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        corners.map(|(x, z): (f64, f64)| DVec3::new(half * x, y, half * z)).to_vec()
    };
    let loops = vec![square(1.0, 0.0), square(0.5, 0.0)];
    let patch = Patch { loops, color: Color::BLACK, on_top: true };
    let mut list =
        blank(vec![body(&cuboid(DVec3::ZERO, 0.2), DVec3::new(0.7, -2.0, 0.0), palette(0))]);
    list.patches.push(patch.clone());
    let image = renderer.render(&list, &front(), size()).unwrap();
    let black = |image: &Image, x: f64| pixel_at(image, &front(), DVec3::new(x, 0.0, 0.1)).r == 0;
    assert!(
        black(&image, -0.7) && black(&image, 0.7) && !black(&image, 0.2) && !black(&image, 1.1)
    );
    list.patches[0].on_top = false;
    let image = renderer.render(&list, &front(), size()).unwrap();
    assert!(black(&image, -0.7) && !black(&image, 0.7), "the box is in front");
}

#[test]
fn occlusion_darkens_corners_and_nothing_else() {
    let Some(mut renderer) = renderer() else { return };
    if renderer.adapter_name().ends_with("(gl)") {
        eprintln!("skipped: no Vulkan adapter (install mesa-vulkan-drivers)");
        return;
    }
    let floor = body(&cuboid(DVec3::new(0.0, 0.0, -3.0), 3.0), DVec3::ZERO, Color::WHITE);
    let wall = body(&cuboid(DVec3::new(0.0, 1.0, 0.5), 0.5), DVec3::ZERO, Color::WHITE);
    let camera = Camera::look_at(DVec3::new(0.0, -6.0, 5.0), DVec3::ZERO).unwrap();
    let mut list = blank(vec![floor, wall]);
    let plain = renderer.render(&list, &camera, size()).unwrap();
    list.shading.occlusion = true;
    let shaded = renderer.render(&list, &camera, size()).unwrap();
    let change = |p: DVec3| {
        let [a, b] = [&plain, &shaded].map(|image| i32::from(pixel_at(image, &camera, p).g));
        a - b
    };
    let corner = change(DVec3::new(0.0, 0.46, 0.0));
    assert!(corner > 12, "{corner}");
    for open in [DVec3::new(0.0, -1.5, 0.0), DVec3::new(1.8, -1.0, 0.0)] {
        assert!(change(open).abs() < 4, "{}", change(open));
    }
}

/// Two rings that overlap, as every view draws them.
fn views() -> Vec<(&'static str, DrawList, Camera)> {
    let ring = torus(1.0, 0.3);
    let mut rings =
        vec![body(&ring, DVec3::ZERO, palette(0)), body(&ring, DVec3::ZERO, palette(1))];
    rings[1].pose =
        Pose { rotation: DQuat::from_rotation_x(1.57), translation: DVec3::new(1.5, 0.0, 0.0) };
    let mut list = DrawList { instances: rings, ..DrawList::new() };
    list.ground = Some(Ground::under(&list.bounds()));
    let camera = Camera::fitted_to(Preset::Isometric, &list, size()).unwrap();
    let low = Camera::fitted_from(DVec3::new(0.3, -1.0, 0.4), &list.bounds(), size()).unwrap();
    let styled = |styles: [Style; 2]| {
        let mut list = list.clone();
        for (instance, style) in list.instances.iter_mut().zip(styles) {
            instance.style = style;
        }
        list
    };
    let outlined = DrawList { shading: Shading::FULL, ..list.clone() };
    let mut faded = outlined.clone();
    faded.instances[1].color = palette(1).with_alpha(80);
    let mut marked = outlined.clone();
    let circle = |r: f64| {
        let angle = |i: i32| f64::from(i) / 24.0 * std::f64::consts::TAU;
        let at = |i| DVec3::new(0.7 + r * angle(i).cos(), r * angle(i).sin(), 0.0);
        (0..24).map(at).collect::<Vec<_>>()
    };
    let color = palette::OVERLAP.with_alpha(150);
    marked.patches.push(Patch { loops: vec![circle(0.4), circle(0.2)], color, on_top: true });
    marked.push_contact(DVec3::new(0.7, 0.0, 0.0), DVec3::Z, 0.8, palette::OVERLAP);
    marked.labels.push(Label::new(DVec3::new(0.7, 0.0, 0.8), "0.3 deep"));
    let section = DrawList { section: cut_at(1e-4), ..outlined.clone() };
    vec![
        ("solid", list.clone(), camera),
        ("outlined", outlined, camera),
        ("faded", faded, camera),
        ("xray", styled([Style::XRay; 2]), camera),
        ("wireframe", styled([Style::Wireframe, Style::Solid]), camera),
        ("section", section, low),
        ("marks", marked, camera),
    ]
}

fn kept(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/views");
    folder.join(format!("{name}.png"))
}

fn read(name: &str) -> Image {
    let path = kept(name);
    let file = std::fs::File::open(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    Image::from_pixels(ImageSize::new(info.width, info.height).unwrap(), pixels).unwrap()
}

fn compare(name: &str, image: &Image) {
    if std::env::var_os("CRANNY_KEEP_VIEWS").is_some() {
        return image.save_png(&kept(name)).unwrap();
    }
    let difference = read(name).difference(image, STEP).unwrap();
    assert!(difference.mean_error < MEAN && difference.differing < SHARE, "{name}: {difference:?}");
}

#[test]
fn views_look_as_they_did_when_they_were_looked_at() {
    let Some(mut renderer) = renderer() else { return };
    for (name, list, camera) in views() {
        compare(name, &renderer.render(&list, &camera, size()).unwrap());
    }
}

#[test]
fn a_page_has_title_panels_scale_legend_and_caption() {
    let panel = |color: Color, title: &str, scale| {
        let image = Image::filled(ImageSize::new(170, 90).unwrap(), color);
        Panel { image, title: title.to_owned(), scale }
    };
    let keys = [
        (Mark::Body(palette(0)), "nut"),
        (Mark::Hatched(palette(1)), "cut open"),
        (Mark::Line(palette::GAP), "distance"),
        (Mark::Arrow(palette::OVERLAP), "impulse"),
        (Mark::Ramp(Ramp::Depth), "depth 0 to 0.012"),
    ];
    let sheet = Sheet {
        title: "Nut on a bolt".to_owned(),
        panels: vec![
            panel(Color::rgb(220, 225, 230), "main", Some(0.013)),
            panel(Color::rgb(200, 205, 210), "section", None),
        ],
        keys: keys.map(|(mark, text)| Key::new(mark, text)).to_vec(),
        caption: vec!["t = 0.5 s, 12 contacts, 0.012 deep".to_owned()],
    };
    compare("page", &sheet.compose().unwrap());
}
