//! What a picture of 400,000 triangles costs on this machine's adapter: processor and wall time of
//! each view, at 1280 x 720. `cargo run --release -p cranny-render --example cost [TRIANGLES]`
#![allow(clippy::print_stdout, reason = "it is what the program is for")]

use std::sync::Arc;
use std::time::Instant;

use cpu_time::ProcessTime;
use cranny_exact::{DVec3, Pose};
use cranny_render::{
    Camera, DrawList, DrawMesh, Ground, ImageSize, Instance, Preset, Renderer, RendererOptions,
    Section, Shading, Style, palette,
};

/// Bodies that share the triangles.
const BODIES: usize = 25;

/// Pictures of each view; the least of their times counts.
const PICTURES: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: usize = std::env::args().nth(1).map_or(Ok(400_000), |n| n.parse())?;
    let mut renderer = Renderer::new(&RendererOptions::default())?;
    let mesh = torus((((wanted / BODIES) as f64 / 4.0).sqrt() as u32).max(3))?;
    let mut list = DrawList::new();
    for i in 0..BODIES {
        let at = 2.9 * DVec3::new((i % 5) as f64, (i / 5) as f64, 0.0);
        let body = Instance::solid(mesh.clone(), Pose::at(at), palette(i));
        list.instances.push(Instance { cut: true, ..body });
    }
    println!("{}, {} triangles", renderer.adapter_name(), BODIES * mesh.triangle_count());
    let size = ImageSize::new(1280, 720)?;
    let camera = Camera::fitted_to(Preset::Isometric, &list, size)?;
    let ground = DrawList { ground: Some(Ground::under(&list.bounds())), ..list.clone() };
    let outlined = Shading { outlines: true, occlusion: false };
    let shaded = Shading { outlines: false, occlusion: true };
    let middle = DVec3::new(5.8, 5.8, 0.01);
    let mut xray = list.clone();
    xray.instances.iter_mut().for_each(|instance| instance.style = Style::XRay);
    let section = Section::through(middle, DVec3::Z, palette::OVERLAP);
    let views = [
        ("plain", list.clone()),
        ("with shadows", ground.clone()),
        ("with outlines", DrawList { shading: outlined, ..list.clone() }),
        ("with occlusion", DrawList { shading: shaded, ..list.clone() }),
        ("x-ray", xray),
        ("section", DrawList { section, ..list.clone() }),
        ("everything", DrawList { shading: Shading::FULL, section, ..ground }),
    ];
    for (name, list) in views {
        renderer.render(&list, &camera, size)?;
        let mut least = [f64::INFINITY; 2];
        for _ in 0..PICTURES {
            let (cpu, wall) = (ProcessTime::now(), Instant::now());
            renderer.render(&list, &camera, size)?;
            let spent = [cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64()];
            least = [0, 1].map(|i| least[i].min(spent[i]));
        }
        println!("{name:<15} {:.3} s of processor, {:.3} s", least[0], least[1]);
    }
    Ok(())
}

/// Of `2 n` by `n` quads.
fn torus(n: u32) -> Result<Arc<DrawMesh>, Box<dyn std::error::Error>> {
    let turn = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
    let vertex = |k: u32| {
        let (a, b) = (turn(k / n, 2 * n), turn(k % n, n));
        let r = 1.0 + 0.4 * b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), 0.4 * b.sin())
    };
    let id = |i: u32, j: u32| (i % (2 * n)) * n + j % n;
    let cells = (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces: Vec<[u32; 3]> = cells
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let vertices: Vec<DVec3> = (0..2 * n * n).map(vertex).collect();
    Ok(Arc::new(DrawMesh::new(&vertices, &faces)?))
}
