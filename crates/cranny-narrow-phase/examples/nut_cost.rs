//! Driver.
use cranny_exact::{DQuat, DVec3, Pose};
use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, query};
use cranny_shapes::{GolfBall, IsoBolt, IsoNut};
use std::f64::consts::TAU;

#[inline(never)]
fn asked(a: Placed, b: Placed, q: &Query, m: &mut PairMemory) -> cranny_narrow_phase::Answer {
    query(a, b, q, m).unwrap()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let frames: u32 = args[1].parse().unwrap();
    let degrees: f64 = args[2].parse().unwrap();
    let what = args[3].as_str();
    let margin: f64 = args[4].parse().unwrap();
    let drop: f64 = args.get(5).map_or(0.0, |s| s.parse().unwrap());
    let skip: u32 = std::env::var("SKIP").map_or(0, |s| s.parse().unwrap());
    let golf = args.get(6).is_some_and(|s| s == "golf");
    let recorded: Option<Vec<Pose>> = args.get(6).filter(|s| *s != "golf").map(|f| {
        let text = std::fs::read_to_string(f).unwrap();
        text.lines()
            .map(|l| {
                let v: Vec<f64> = l.split(' ').map(|x| x.parse().unwrap()).collect();
                Pose {
                    rotation: DQuat::from_xyzw(v[1], v[2], v[3], v[4]).normalize(),
                    translation: DVec3::new(v[5], v[6], v[7]),
                }
            })
            .collect()
    });
    let build = |m: Mesh| {
        let o = BuildOptions { self_intersections: false, ..BuildOptions::default() };
        Model::build(m, &o).unwrap().0
    };
    let (bolt, nut) = if golf {
        let ball = GolfBall {
            triangles: 10_000,
            dimples: 336,
            radius: 0.5,
            dimple_depth: 0.015,
            ..GolfBall::default()
        };
        let m = ball.build().unwrap();
        (build(m.clone()), build(m))
    } else {
        (build(IsoBolt::default().build().unwrap()), build(IsoNut::default().build().unwrap()))
    };
    let demand = match what {
        "contacts" => Demand::Contacts { margin },
        "intersects" => Demand::Intersects,
        "distance" => Demand::Distance { below: None },
        _ => Demand::Regions { margin },
    };
    let mut memory = PairMemory::default();
    for frame in 0..frames {
        let angle = (degrees * f64::from(frame)).to_radians();
        let pose = if let Some(p) = &recorded {
            p[frame as usize]
        } else if golf {
            let axis = DVec3::new(1.0, 2.0, 3.0).normalize();
            Pose {
                rotation: DQuat::from_axis_angle(axis, angle).normalize(),
                translation: (1.0 - 0.02) * DVec3::new(0.6, 0.64, 0.48),
            }
        } else {
            Pose {
                rotation: DQuat::from_axis_angle(DVec3::Z, angle).normalize(),
                translation: (12.0 + 2.0 * angle / TAU - drop) * DVec3::Z,
            }
        };
        let a = Placed { model: &bolt, pose: Pose::IDENTITY };
        let b = Placed { model: &nut, pose };
        let t = std::time::Instant::now();
        let r = if frame < skip { query(a, b, &Query::of(demand), &mut memory).unwrap() } else { asked(a, b, &Query::of(demand), &mut memory) };
        let us = t.elapsed().as_micros();
        let c = r.counters;
        let mut h = 0u64;
        for k in &r.contacts {
            for x in [k.point_a.x, k.point_b.y, k.normal.z, k.separation] {
                h = (h ^ x.to_bits()).wrapping_mul(0x100000001b3).rotate_left(17);
            }
            h = h.wrapping_add(format!("{:?}", k.id).bytes().fold(0, |a, b| a * 31 + u64::from(b)));
        }
        println!(
            "{frame}: {us} us {:?} {:?} contacts {} pairs {} hash {h:016x} first {:?} last {:?} {c:?}",
            r.surface,
            r.solid,
            r.contacts.len(),
            r.triangle_pairs,
            r.contacts.first().map(|c| c.separation),
            r.contacts.last().map(|c| c.separation)
        );
    }
    println!("bytes {}", memory.bytes());
}
