//! What is on the picture when it is drawn by a real adapter, software or hardware.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::sync::Arc;

use cranny_exact::{DQuat, DVec2, DVec3, Pose};
use cranny_render::{
    Camera, Color, DrawList, DrawMesh, Ground, Image, ImageSize, Instance, Line, Point, Preset,
    RenderError, Renderer, RendererOptions,
};

const RED: Color = Color::rgb(220, 30, 30);
const BLUE: Color = Color::rgb(30, 30, 220);

/// `None` where the machine has no adapter; any other failure fails the test.
fn renderer() -> Option<Renderer> {
    match Renderer::new(&RendererOptions::default()) {
        Ok(renderer) => Some(renderer),
        Err(RenderError::NoAdapter { .. }) => {
            eprintln!("skipped: no graphics adapter (install mesa-vulkan-drivers)");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn size() -> ImageSize {
    ImageSize::new(200, 120).unwrap()
}

fn cube(half: f64) -> Arc<DrawMesh> {
    let sign = |i: usize, bit: usize| if i & bit == 0 { -half } else { half };
    let vertices: Vec<DVec3> =
        (0..8).map(|i| DVec3::new(sign(i, 1), sign(i, 2), sign(i, 4))).collect();
    let sides =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> =
        sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Arc::new(DrawMesh::new(&vertices, &faces).unwrap())
}

fn at(mesh: &Arc<DrawMesh>, position: DVec3, color: Color) -> Instance {
    Instance::solid(mesh.clone(), Pose::at(position), color)
}

/// White all over, so that whatever is not white was drawn.
fn blank() -> DrawList {
    DrawList { backdrop: [Color::WHITE; 2], ..DrawList::new() }
}

/// Looks along +y from (0, −10, 0).
fn front() -> Camera {
    Camera::look_at(DVec3::new(0.0, -10.0, 0.0), DVec3::ZERO).unwrap()
}

/// The pixel on which a world point falls.
fn pixel_at(image: &Image, camera: &Camera, point: DVec3) -> Color {
    let [x, y] = camera.project(point, image.size()).unwrap();
    image.pixel(x as u32, y as u32).unwrap()
}

fn is_reddish(c: Color) -> bool {
    c.r > 100 && c.g < c.r / 2 && c.b < c.r / 2
}

fn is_bluish(c: Color) -> bool {
    c.b > 100 && c.g < c.b / 2 && c.r < c.b / 2
}

/// How dark a pixel is, from 0 (white) to 1 (black), in light.
fn darkness(c: Color) -> f64 {
    1.0 - f64::from(c.to_linear()[0])
}

fn pixels(image: &Image) -> impl Iterator<Item = (u32, u32, Color)> {
    let size = image.size();
    (0..size.height())
        .flat_map(move |y| (0..size.width()).map(move |x| (x, y, image.pixel(x, y).unwrap())))
}

#[test]
fn a_red_box_is_red_where_it_is_projected() {
    let Some(mut renderer) = renderer() else { return };
    let place = DVec3::new(1.5, 0.5, -1.0);
    let mut list = blank();
    list.instances.push(at(&cube(0.4), place, RED));
    let image = renderer.render(&list, &front(), size()).unwrap();
    assert!(is_reddish(pixel_at(&image, &front(), place)));
    for beside in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
        assert_eq!(pixel_at(&image, &front(), place + 0.6 * beside), Color::WHITE);
    }
    assert!(pixels(&image).all(|(_, _, c)| c.a == 255));
}

#[test]
fn the_nearer_body_hides_the_farther_in_any_order() {
    let Some(mut renderer) = renderer() else { return };
    let mesh = cube(0.5);
    let near = at(&mesh, DVec3::new(0.0, -2.0, 0.0), BLUE);
    let far = at(&mesh, DVec3::new(0.0, 2.0, 0.0), RED);
    for instances in [vec![near.clone(), far.clone()], vec![far, near]] {
        let list = DrawList { instances, ..blank() };
        let image = renderer.render(&list, &front(), size()).unwrap();
        assert!(is_bluish(pixel_at(&image, &front(), DVec3::ZERO)));
    }
}

#[test]
fn an_overlay_lets_through_what_is_behind_it_and_is_hidden_by_what_is_before() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    list.instances.push(at(&cube(0.5), DVec3::ZERO, RED));
    let plain = pixel_at(&renderer.render(&list, &front(), size()).unwrap(), &front(), DVec3::ZERO);

    let glass = BLUE.with_alpha(110);
    list.instances.push(at(&cube(1.0), DVec3::ZERO, glass));
    let image = renderer.render(&list, &front(), size()).unwrap();
    let mixed = pixel_at(&image, &front(), DVec3::ZERO);
    assert!(mixed.r < plain.r && mixed.r > 80, "{plain:?} {mixed:?}");
    assert!(mixed.b > plain.b + 40, "{plain:?} {mixed:?}");
    let beside = pixel_at(&image, &front(), DVec3::new(0.8, 0.0, 0.0));
    assert!(beside.b > beside.r + 20 && beside.r > 60, "over white: {beside:?}");

    list.instances[1] = at(&cube(0.2), DVec3::new(0.0, 2.0, 0.0), glass);
    let image = renderer.render(&list, &front(), size()).unwrap();
    assert_eq!(pixel_at(&image, &front(), DVec3::ZERO), plain);
}

#[test]
fn lines_are_as_wide_as_they_say_at_any_distance_and_direction() {
    let Some(mut renderer) = renderer() else { return };
    for (width, depth) in [(1.0f32, 0.0), (3.0, 5.0), (8.0, -5.0)] {
        for along in [DVec3::Z, DVec3::X] {
            let middle = DVec3::new(0.3, depth, 0.2);
            let mut list = blank();
            list.push_line(middle - 20.0 * along, middle + 20.0 * along, Color::BLACK, width);
            let image = renderer.render(&list, &front(), size()).unwrap();
            // Across the picture and the line: how many pixels' worth of black.
            let across =
                |i| if along == DVec3::Z { image.pixel(i, 60) } else { image.pixel(100, i) };
            let covered: f64 = (0..size().width()).filter_map(across).map(darkness).sum();
            // Four samples tell a width to a quarter of a pixel on either side.
            assert!((covered - f64::from(width)).abs() <= 0.5, "{width} {along}: {covered}");
        }
    }
}

#[test]
fn lines_that_pass_the_camera_are_cut_at_the_near_plane() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    // From behind the camera to a point in front of it, and one wholly behind.
    list.push_line(DVec3::new(1.0, -20.0, 0.0), DVec3::ZERO, Color::BLACK, 4.0);
    list.push_line(DVec3::new(-1.0, -20.0, 1.0), DVec3::new(1.0, -15.0, 1.0), RED, 4.0);
    let image = renderer.render(&list, &front(), size()).unwrap();
    // It enters at the right and ends in the middle, on the horizon.
    assert!(darkness(image.pixel(150, 60).unwrap()) > 0.9);
    assert_eq!(image.pixel(50, 60), Some(Color::WHITE));
    assert!(pixels(&image).all(|(_, y, c)| c == Color::WHITE || y.abs_diff(60) < 4));
}

#[test]
fn marks_are_hidden_unless_they_are_on_top() {
    let Some(mut renderer) = renderer() else { return };
    let behind = DVec3::new(0.0, 1.0, 0.0);
    for on_top in [false, true] {
        let mut list = blank();
        list.instances.push(at(&cube(0.5), DVec3::ZERO, RED));
        list.points.push(Point { position: behind, color: BLUE, radius: 4.0, on_top });
        let (from, to) = (behind - 0.2 * DVec3::X, behind + 0.2 * DVec3::X);
        let above = 0.3 * DVec3::Z;
        let width = [4.0; 2];
        list.lines.push(Line { from: from + above, to: to + above, color: BLUE, width, on_top });
        let image = renderer.render(&list, &front(), size()).unwrap();
        for mark in [behind, behind + above] {
            let color = pixel_at(&image, &front(), mark);
            assert!(
                if on_top { is_bluish(color) } else { is_reddish(color) },
                "{on_top}: {color:?}"
            );
        }
    }
}

#[test]
fn marks_on_a_surface_win_against_it() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    list.instances.push(at(&cube(1.0), DVec3::ZERO, RED));
    list.push_line(DVec3::new(-0.9, -1.0, 0.0), DVec3::new(0.9, -1.0, 0.0), BLUE, 3.0);
    let image = renderer.render(&list, &front(), size()).unwrap();
    for i in 0..=16 {
        let on_line = DVec3::new(-0.8 + 0.1 * f64::from(i), -1.0, 0.0);
        assert!(is_bluish(pixel_at(&image, &front(), on_line)), "{on_line}");
    }
}

#[test]
fn a_point_is_a_disc_of_its_radius() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    let (position, radius) = (DVec3::new(0.5, 0.0, 0.5), 12.0f32);
    list.points.push(Point { position, color: Color::BLACK, radius, on_top: false });
    let image = renderer.render(&list, &front(), size()).unwrap();
    let area: f64 = pixels(&image).map(|(_, _, c)| darkness(c)).sum();
    let wanted = std::f64::consts::PI * f64::from(radius).powi(2);
    assert!((area / wanted - 1.0).abs() < 0.03, "{area} for {wanted}");
    let [x, y] = front().project(position, size()).unwrap();
    for (px, py, _) in pixels(&image).filter(|(_, _, c)| *c != Color::WHITE) {
        let away = (f64::from(px) + 0.5 - x).hypot(f64::from(py) + 0.5 - y);
        assert!(away < f64::from(radius) + 1.5);
    }
}

#[test]
fn fitted_cameras_show_everything_and_fill_the_frame() {
    let Some(mut renderer) = renderer() else { return };
    let tilted = DQuat::from_xyzw(0.3, -0.2, 0.5, 0.8).normalize();
    let pose = Pose { rotation: tilted, translation: DVec3::new(30.0, -7.0, 2.0) };
    let mut list = blank();
    list.instances.push(Instance::solid(cube(2.0), pose, Color::BLACK));
    for preset in Preset::ALL {
        let by_box = Camera::fitted(preset, &list.bounds(), size()).unwrap();
        let by_vertices = Camera::fitted_to(preset, &list, size()).unwrap();
        for (camera, least) in [(by_box, 0.4), (by_vertices, 0.83)] {
            let image = renderer.render(&list, &camera, size()).unwrap();
            let drawn = pixels(&image).filter(|(_, _, c)| *c != Color::WHITE);
            let (mut x, mut y) = ([u32::MAX, 0], [u32::MAX, 0]);
            for (px, py, _) in drawn {
                x = [x[0].min(px), x[1].max(px + 1)];
                y = [y[0].min(py), y[1].max(py + 1)];
            }
            let fills = |[start, end]: [u32; 2], all: u32| f64::from(end - start) / f64::from(all);
            let filled = fills(x, size().width()).max(fills(y, size().height()));
            assert!(x[0] > 0 && y[0] > 0 && x[1] < size().width() && y[1] < size().height());
            assert!(filled >= least && filled <= 0.88, "{preset:?}: {filled}");
        }
    }
}

#[test]
fn edges_are_smooth() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    // Lit, even a black body has a highlight; a line has none.
    list.push_line(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, 0.3), Color::BLACK, 9.0);
    let image = renderer.render(&list, &front(), size()).unwrap();
    let between = pixels(&image).filter(|(_, _, c)| (0.1..0.9).contains(&darkness(*c))).count();
    let full = pixels(&image).filter(|(_, _, c)| darkness(*c) > 0.99).count();
    assert!(between > 40 && full > 200, "{between} between, {full} full");
}

#[test]
fn the_inside_of_an_open_surface_is_dimmer() {
    let Some(mut renderer) = renderer() else { return };
    let vertices = [DVec3::ZERO, DVec3::X, DVec3::Z].map(|p| 4.0 * p - DVec3::new(1.0, 0.0, 1.0));
    let mut seen = [[0, 1, 2], [0, 2, 1]].map(|face| {
        let mesh = Arc::new(DrawMesh::new(&vertices, &[face]).unwrap());
        let mut list = blank();
        list.instances.push(at(&mesh, DVec3::ZERO, Color::rgb(200, 200, 200)));
        let image = renderer.render(&list, &front(), size()).unwrap();
        pixel_at(&image, &front(), DVec3::ZERO)
    });
    let [outside, inside] = &mut seen;
    assert!(f64::from(inside.g) < 0.8 * f64::from(outside.g), "{outside:?} {inside:?}");
    assert!(inside.g > 60, "{inside:?}");
}

#[test]
fn faces_have_the_colours_they_were_given() {
    let Some(mut renderer) = renderer() else { return };
    let corner = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let vertices = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    let faces = [[0, 1, 2], [0, 2, 3]];
    let mesh = Arc::new(DrawMesh::with_face_colors(&vertices, &faces, &[RED, BLUE]).unwrap());
    let mut list = blank();
    list.instances.push(at(&mesh, DVec3::ZERO, Color::WHITE));
    let image = renderer.render(&list, &front(), size()).unwrap();
    assert!(is_reddish(pixel_at(&image, &front(), corner(0.5, -0.5))));
    assert!(is_bluish(pixel_at(&image, &front(), corner(-0.5, 0.5))));
}

#[test]
fn the_ground_has_lines_and_shadows_and_hides_nothing() {
    let Some(mut renderer) = renderer() else { return };
    let camera = Camera::look_at(DVec3::new(0.0, -6.0, 6.0), DVec3::ZERO).unwrap();
    let ground =
        Ground { height: 0.0, center: DVec2::ZERO, radius: 40.0, spacing: 1.0, shadows: true };
    let mut list = DrawList { ground: Some(ground), ..blank() };
    let bare = renderer.render(&list, &camera, size()).unwrap();
    assert!(darkness(pixel_at(&bare, &camera, DVec3::ZERO)) > 0.15, "two strong lines cross");
    assert!(darkness(pixel_at(&bare, &camera, DVec3::new(0.5, 0.5, 0.0))) < 0.01);

    list.instances.push(at(&cube(0.5), DVec3::new(0.0, 0.0, 1.0), RED));
    let image = renderer.render(&list, &camera, size()).unwrap();
    // To the right of the box, where it does not hide the ground.
    let shadow = DVec3::new(0.7, 0.3, 0.0);
    let dark = darkness(pixel_at(&image, &camera, shadow));
    assert!((0.1..0.4).contains(&dark), "{dark}");
    // Two bodies one above the other cast one shadow, no darker.
    list.instances.push(at(&cube(0.5), DVec3::new(0.0, 0.0, 1.1), RED));
    let twice = renderer.render(&list, &camera, size()).unwrap();
    assert_eq!(darkness(pixel_at(&twice, &camera, shadow)), dark);

    // Seen from below, the bodies show and shadows do not.
    let below = Camera::look_at(DVec3::new(0.0, -6.0, -6.0), DVec3::ZERO).unwrap();
    let image = renderer.render(&list, &below, size()).unwrap();
    assert!(is_reddish(pixel_at(&image, &below, DVec3::new(0.1, 0.1, 0.5))));
}

#[test]
fn a_picture_depends_neither_on_the_place_nor_on_the_unit_of_length() {
    let Some(mut renderer) = renderer() else { return };
    let mut picture = |scale: f64, offset: DVec3| {
        let mut list = DrawList::new();
        let mesh = cube(scale);
        for (i, x) in [-2.0, 0.0, 2.5].into_iter().enumerate() {
            let place = offset + scale * DVec3::new(x, 0.3 * x, 0.0);
            list.instances.push(at(&mesh, place, cranny_render::palette(i)));
        }
        let camera = Camera::fitted(Preset::Isometric, &list.bounds(), size()).unwrap();
        renderer.render(&list, &camera, size()).unwrap()
    };
    let reference = picture(1.0, DVec3::ZERO);
    for (scale, offset) in [(1e-20, 0.0), (1e20, 0.0), (1.0, 1e8)] {
        let image = picture(scale, DVec3::splat(offset));
        let difference = image.difference(&reference, 8).unwrap();
        assert!(difference.mean_error < 0.1 && difference.differing < 0.005, "{difference:?}");
    }
}

#[test]
fn graphics_interfaces_draw_alike() {
    let mut list = DrawList::new();
    list.instances.push(at(&cube(0.5), DVec3::ZERO, RED));
    list.instances.push(at(&cube(0.4), DVec3::new(1.2, 0.1, 0.2), BLUE));
    list.instances.push(at(&cube(0.8), DVec3::ZERO, BLUE.with_alpha(80)));
    list.push_contact(DVec3::new(0.0, 0.0, 0.5), DVec3::Z, 0.6, Color::BLACK);
    list.push_line(DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.7), Color::BLACK, 2.0);
    list.ground = Some(Ground::under(&list.bounds()));
    let camera = Camera::fitted_to(Preset::Isometric, &list, size()).unwrap();
    let mut pictures = Vec::new();
    for interface in ["vulkan", "gl", "metal", "dx12"] {
        let options = RendererOptions { backends: Some(interface.to_owned()), software: false };
        match Renderer::new(&options) {
            Ok(mut renderer) => pictures.push(renderer.render(&list, &camera, size()).unwrap()),
            Err(RenderError::NoAdapter { .. }) => {}
            Err(error) => panic!("{interface}: {error}"),
        }
    }
    if pictures.len() < 2 {
        eprintln!("skipped: fewer than two graphics interfaces (install mesa-vulkan-drivers)");
    }
    for other in pictures.iter().skip(1) {
        let difference = pictures[0].difference(other, 16).unwrap();
        assert!(difference.mean_error < 0.5 && difference.differing < 0.02, "{difference:?}");
    }
}

#[test]
fn meshes_are_uploaded_once_and_dropped_with_their_last_handle() {
    let Some(mut renderer) = renderer() else { return };
    let mesh = cube(0.5);
    let mut list = blank();
    list.instances.push(at(&mesh, DVec3::ZERO, RED));
    list.instances.push(at(&mesh, DVec3::X, BLUE.with_alpha(90)));
    let first = renderer.render(&list, &front(), size()).unwrap();
    let second = renderer.render(&list, &front(), size()).unwrap();
    assert_eq!(renderer.cached_meshes(), 1);
    assert_eq!(first, second, "the same adapter draws the same picture");
    list.instances.clear();
    drop(mesh);
    renderer.render(&list, &front(), size()).unwrap();
    assert_eq!(renderer.cached_meshes(), 0);
}

#[test]
fn rows_of_any_length_come_back_whole_and_sizes_may_change() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    list.instances.push(at(&cube(0.5), DVec3::ZERO, RED));
    for (width, height) in [(1, 1), (63, 40), (64, 40), (333, 77), (63, 40)] {
        let size = ImageSize::new(width, height).unwrap();
        let image = renderer.render(&list, &front(), size).unwrap();
        assert_eq!(image.size(), size);
        // The samples of a single pixel straddle the box.
        if width > 1 {
            assert!(is_reddish(image.pixel(width / 2, height / 2).unwrap()));
            // The picture is the same left and right: no row is shifted.
            let outline = |x: u32, y: u32| image.pixel(x, y) != Some(Color::WHITE);
            for y in 0..height {
                assert!((0..width).all(|x| outline(x, y) == outline(width - 1 - x, y)));
            }
        }
    }
}

#[test]
fn a_list_that_cannot_be_drawn_leaves_the_renderer_usable() {
    let Some(mut renderer) = renderer() else { return };
    let mut list = blank();
    list.instances.push(at(&cube(0.5), DVec3::NAN, RED));
    let error = renderer.render(&list, &front(), size()).unwrap_err();
    assert!(matches!(error, RenderError::NotFinite { what: "instance", index: 0 }));
    list.instances[0].pose = Pose::IDENTITY;
    let image = renderer.render(&list, &front(), size()).unwrap();
    assert!(is_reddish(pixel_at(&image, &front(), DVec3::ZERO)));
    assert!(!renderer.adapter_name().is_empty());
}
