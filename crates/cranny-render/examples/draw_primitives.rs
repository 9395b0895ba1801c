//! A picture of everything that a draw list can hold: bodies, an open surface, a translucent
//! overlay, class colours, contact marks, lines, ground and shadows.
//!
//! `cargo run -p cranny-render --example draw_primitives [PICTURE.png [ANIMATION.png [SHEET.png]]]`
#![allow(clippy::print_stdout, reason = "an example talks to its user")]

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use cranny_exact::{DQuat, DVec3, Pose};
use cranny_render::{
    Animation, Camera, Color, DrawList, DrawMesh, DrawMeshError, Ground, ImageSize, Instance,
    Preset, Renderer, RendererOptions, contact_sheet, palette,
};

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let picture = paths.next().unwrap_or_else(|| PathBuf::from("primitives.png"));

    let size = ImageSize::new(960, 540)?;
    let list = scene()?;
    let camera = Camera::fitted_to(Preset::Isometric, &list, size)?;
    let mut renderer = Renderer::new(&RendererOptions::default())?;
    println!("adapter: {}", renderer.adapter_name());
    let start = std::time::Instant::now();
    renderer.render(&list, &camera, size)?.save_png(&picture)?;
    println!("{} ({} ms)", picture.display(), start.elapsed().as_millis());

    if let Some(path) = paths.next() {
        let small = ImageSize::new(480, 270)?;
        let mut animation = Animation::new(80);
        for step in 0..24 {
            let angle = f64::from(step) * TAU / 24.0;
            let direction = DVec3::new(angle.cos(), angle.sin(), 0.6);
            let camera = Camera::fitted_from(direction, &list.bounds(), small)?;
            animation.push(renderer.render(&list, &camera, small)?)?;
        }
        animation.save(&path)?;
        println!("{} ({} frames)", path.display(), animation.frame_count());
    }
    if let Some(path) = paths.next() {
        let mut views = Vec::new();
        for preset in Preset::ALL {
            let camera = Camera::fitted_to(preset, &list, size)?;
            views.push(renderer.render(&list, &camera, size)?.scaled_down(480));
        }
        contact_sheet(&views, 2, 6, Color::WHITE)?.save_png(&path)?;
        println!("{}", path.display());
    }
    Ok(())
}

fn scene() -> Result<DrawList, DrawMeshError> {
    let torus = Arc::new(torus(1.0, 0.3, 64, 24)?);
    let cube = Arc::new(cuboid(DVec3::splat(0.5))?);
    let ball = Arc::new(sphere(0.6, 40, 20, PI, None)?);
    let bowl = Arc::new(sphere(0.7, 40, 12, 0.55 * PI, None)?);
    let classes = Arc::new(sphere(0.6, 24, 12, PI, Some(&[palette(2), palette(3), palette(6)]))?);
    let upright = DQuat::from_rotation_x(0.5 * PI);
    let flipped = DQuat::from_rotation_x(PI);

    let mut list = DrawList::new();
    let mut place = |mesh: &Arc<DrawMesh>, x, y, z, rotation, color| {
        let pose = Pose { rotation, translation: DVec3::new(x, y, z) };
        list.instances.push(Instance::solid(mesh.clone(), pose, color));
    };
    let flat = DQuat::IDENTITY;
    place(&torus, -2.0, 0.0, 0.3, flat, palette(0));
    place(&torus, -1.0, 0.0, 1.3, upright, palette(1));
    place(&cube, 1.2, -1.4, 0.5, DQuat::from_rotation_z(0.3), palette(4));
    place(&cube, 1.3, -1.3, 1.5, DQuat::from_rotation_z(0.9), palette(5));
    place(&ball, 2.0, 0.8, 0.6, flat, palette(7));
    place(&bowl, 0.2, 2.2, 0.7, flipped, palette(3));
    place(&classes, -1.8, -2.2, 0.6, flat, Color::WHITE);
    let hull = Arc::new(cuboid(DVec3::splat(0.75))?);
    place(&hull, 2.0, 0.8, 0.75, flat, palette(7).with_alpha(70));

    let mark = Color::rgb(215, 30, 40);
    list.push_contact(DVec3::new(-1.0, 0.0, 0.3), DVec3::Z, 0.5, mark);
    for (x, y) in [(0.85, -1.65), (1.6, -1.65), (1.6, -1.0), (0.9, -1.0)] {
        list.push_contact(DVec3::new(x, y, 1.0), DVec3::Z, 0.4, mark);
    }
    list.push_contact(DVec3::new(2.0, 0.8, 0.0), DVec3::Z, 0.4, mark);
    // A boundary loop on the torus, and the box of the open bowl.
    let on_loop = |i: u32| {
        let angle = f64::from(i) * TAU / 96.0;
        DVec3::new(-2.0 + angle.cos(), angle.sin(), 0.6)
    };
    for i in 0..96 {
        list.push_line(on_loop(i), on_loop(i + 1), Color::rgb(20, 25, 35), 3.0);
    }
    let bounds = bowl.bounds();
    let offset = DVec3::new(0.2, 2.2, 0.7);
    let around = cranny_exact::Aabb {
        min: offset + DVec3::new(bounds.min.x, bounds.min.y, -bounds.max.z),
        max: offset + DVec3::new(bounds.max.x, bounds.max.y, -bounds.min.z),
    };
    list.push_box(&around, Color::rgb(60, 70, 85), 1.5);
    list.ground = Some(Ground::under(&list.bounds()).at_height(0.0));
    Ok(list)
}

fn cuboid(half: DVec3) -> Result<DrawMesh, DrawMeshError> {
    let sign = |i: usize, bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
    let corner = |i| half * DVec3::new(sign(i, 1), sign(i, 2), sign(i, 4));
    let vertices: Vec<DVec3> = (0..8).map(corner).collect();
    let sides =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> =
        sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    DrawMesh::new(&vertices, &faces)
}

/// Quads of a grid that is closed in `u` and, where stated, in `v`, split into triangles.
fn grid_faces(u: u32, v: u32, closed: bool) -> Vec<[u32; 3]> {
    let columns = if closed { v } else { v + 1 };
    let at = |i: u32, j: u32| (i % u) * columns + if closed { j % v } else { j };
    let quad = |i, j| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..u).flat_map(|i| (0..v).flat_map(move |j| quad(i, j))).collect()
}

fn torus(major: f64, minor: f64, u: u32, v: u32) -> Result<DrawMesh, DrawMeshError> {
    let point = |i: u32, j: u32| {
        let (a, b) = (f64::from(i) * TAU / f64::from(u), f64::from(j) * TAU / f64::from(v));
        let r = major + minor * b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), minor * b.sin())
    };
    let vertices: Vec<DVec3> = (0..u).flat_map(|i| (0..v).map(move |j| point(i, j))).collect();
    DrawMesh::new(&vertices, &grid_faces(u, v, true))
}

/// A sphere from the upper pole down to the polar angle `until`, with bands of the given colours.
fn sphere(
    radius: f64,
    u: u32,
    v: u32,
    until: f64,
    bands: Option<&[Color]>,
) -> Result<DrawMesh, DrawMeshError> {
    let point = |i: u32, j: u32| {
        let (a, b) = (f64::from(i) * TAU / f64::from(u), f64::from(j) * until / f64::from(v));
        radius * DVec3::new(b.sin() * a.cos(), b.sin() * a.sin(), b.cos())
    };
    let vertices: Vec<DVec3> = (0..u).flat_map(|i| (0..=v).map(move |j| point(i, j))).collect();
    // Counter-clockwise seen from outside: the polar angle runs downward.
    let faces: Vec<[u32; 3]> =
        grid_faces(u, v, false).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    match bands {
        None => DrawMesh::new(&vertices, &faces),
        Some(colors) => {
            let per_face: Vec<Color> =
                (0..faces.len()).map(|f| colors[(f / 2 % v as usize) / 2 % colors.len()]).collect();
            DrawMesh::with_face_colors(&vertices, &faces, &per_face)
        }
    }
}
