//! What `query` prints.

use cranny_geometry::Mesh;
use cranny_shapes::Cuboid;
use serde_json::Value;

use crate::harness::{Folder, Outcome, argument, run};

/// The unit cube along x beside itself, a quarter of its edge aside: apart, face to face,
/// overlapping by half and by three quarters.
const SHIFTS: [f64; 4] = [1.5, 1.0, 0.5, 0.25];

struct Cubes {
    folder: Folder,
    cube: String,
    poses: String,
}

impl Cubes {
    fn new() -> Self {
        let folder = Folder::new();
        let cube = folder.mesh("cube.obj", &Cuboid::default().build().unwrap());
        let pose =
            |x: f64| format!(r#"{{"a": null, "b": [1,0,0,{x}, 0,1,0,0.25, 0,0,1,0.25, 0,0,0,1]}}"#);
        let poses = folder.write("poses.json", format!("[{}]", SHIFTS.map(pose).join(",")));
        Self { folder, cube, poses }
    }

    fn query(&self, options: &[&str]) -> Outcome {
        run(&[&["query", &self.cube, &self.cube, "--poses", &self.poses], options].concat())
    }
}

fn column(lines: &[Value], name: &str) -> Vec<Value> {
    lines.iter().map(|line| line[name].clone()).collect()
}

fn values<T: Into<Value>>(items: impl IntoIterator<Item = T>) -> Vec<Value> {
    items.into_iter().map(Into::into).collect()
}

#[test]
fn every_field_is_there_and_right() {
    let cubes = Cubes::new();
    let outcome = cubes.query(&[]);
    assert_eq!(outcome.stderr, "");
    let lines = outcome.json_lines();
    assert_eq!(column(&lines, "pose"), values([0, 1, 2, 3]));
    assert_eq!(column(&lines, "surface"), values(["none", "touch", "cross", "cross"]));
    assert_eq!(column(&lines, "solid"), values([false, false, true, true]));
    assert_eq!(column(&lines, "distance"), values([0.5, 0.0, 0.0, 0.0]));
    assert_eq!(column(&lines, "closed_a"), values([true; 4]));
    assert_eq!(column(&lines, "closed_b"), values([true; 4]));
    let (a, b) = (&lines[0]["witness_a"], &lines[0]["witness_b"]);
    assert_eq!((&a[0], &b[0]), (&0.5.into(), &1.0.into()));
    assert_eq!(lines[0]["regions"], Value::Array(vec![]));
    let face = &lines[1]["regions"][0];
    assert_eq!(face["normal"], Value::Array(values([1.0, 0.0, 0.0])));
    assert_eq!((&face["depth"], &face["point"][0]), (&0.0.into(), &0.5.into()));
    assert_eq!(face["area"], 0.75 * 0.75);
    assert_eq!(lines[1]["regions"].as_array().unwrap().len(), 1);
    for contact in lines[1]["contacts"].as_array().unwrap() {
        assert_eq!(contact["normal"], face["normal"]);
        assert_eq!((&contact["point_a"][0], &contact["separation"]), (&0.5.into(), &0.0.into()));
    }
    let deep = &lines[2]["regions"][0];
    assert!(deep["depth"].as_f64().unwrap() >= 0.5 && deep["area"].as_f64().unwrap() > 0.0);
    for line in &lines {
        assert!(line["contained"].is_null());
        assert!(line["triangle_pairs"].is_u64() && line["contacts"].is_array());
        assert!(line["tests"].as_u64().unwrap() > 0 && line["micros"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn what_is_not_asked_for_is_null() {
    let cubes = Cubes::new();
    let filled = [
        ("intersects", &[][..]),
        ("distance", &["distance", "witness_a", "witness_b"]),
        ("contacts", &["contacts"]),
    ];
    let full = cubes.query(&[]).json_lines();
    for (demand, filled) in filled {
        let lines = cubes.query(&["--demand", demand]).json_lines();
        for name in ["surface", "solid", "contained", "closed_a", "closed_b"] {
            assert_eq!(column(&lines, name), column(&full, name), "{demand}: {name}");
        }
        for name in ["distance", "witness_a", "witness_b", "contacts", "triangle_pairs", "regions"]
        {
            for line in &lines {
                assert_eq!(line[name].is_null(), !filled.contains(&name), "{demand}: {name}");
            }
        }
    }
}

#[test]
fn cold_and_warm_and_both_methods_say_the_same() {
    let cubes = Cubes::new();
    let without_cost = |mut lines: Vec<Value>| {
        for line in &mut lines {
            for cost in ["micros", "tests"] {
                line.as_object_mut().unwrap().remove(cost);
            }
        }
        lines
    };
    let lines = |demand, more: &[&str]| {
        without_cost(cubes.query(&[&["--demand", demand], more].concat()).json_lines())
    };
    let witnesses = |lines: &[Value]| [column(lines, "witness_a"), column(lines, "witness_b")];
    let full = lines("regions", &[]);
    for demand in ["distance", "regions"] {
        let warm = lines(demand, &[]);
        assert_eq!(warm, lines(demand, &["--cold"]));
        assert_eq!(warm, lines(demand, &["--method", "envelopes"]));
        assert_eq!(witnesses(&warm), witnesses(&full));
    }
}

#[test]
fn scales_apply_to_the_vertices_and_containment_names_the_inner_one() {
    let cubes = Cubes::new();
    let lines = cubes.query(&["--scale-a", "4", "--scale-b", "-0.5"]).json_lines();
    // The small cube's centre is at x = 1.5 at most, its half size 0.25, the large one's 2.
    assert_eq!(column(&lines, "contained"), values(["B_in_A"; 4]));
    assert_eq!(column(&lines, "distance"), values([0.25, 0.75, 1.25, 1.5]));
    assert_eq!(column(&lines, "closed_b"), values([true; 4]));
    let lines = cubes.query(&["--scale-b", "4"]).json_lines();
    assert_eq!(lines[3]["contained"], "A_in_B");
}

#[test]
fn an_open_mesh_says_so() {
    let cubes = Cubes::new();
    let cube = Cuboid::default().build().unwrap();
    let open = Mesh::new(cube.vertices().to_vec(), cube.faces()[..11].to_vec()).unwrap();
    let folder = Folder::new();
    let open = folder.mesh("open.obj", &open);
    let lines = run(&["query", &open, &cubes.cube, "--poses", &cubes.poses]).json_lines();
    assert_eq!(column(&lines, "closed_a"), values([false; 4]));
    assert_eq!(column(&lines, "closed_b"), values([true; 4]));
}

#[test]
fn levels_and_budgets_are_certain_of_what_they_tell() {
    let cubes = Cubes::new();
    let full = cubes.query(&[]).json_lines();
    assert_eq!(column(&full, "verdict"), values(["excluded", "certain", "certain", "certain"]));
    assert!(column(&full, "places").iter().all(Value::is_null));
    for (options, verdicts) in [
        (&["--accuracy", "boxes"][..], ["excluded", "open", "open", "open"]),
        (&["--accuracy", "hulls"], ["excluded", "open", "open", "open"]),
        (&["--accuracy", "caps"], ["excluded", "certain", "certain", "certain"]),
        (&["--accuracy", "tree:9"], ["excluded", "certain", "certain", "certain"]),
        (&["--budget", "0"], ["open"; 4]),
        (&["--budget", "1", "--cold"], ["open"; 4]),
        (&["--budget", "2", "--cold"], ["excluded", "open", "open", "open"]),
        (&["--budget", "5000"], ["excluded", "certain", "certain", "certain"]),
    ] {
        let lines = cubes.query(options).json_lines();
        assert_eq!(column(&lines, "verdict"), values(verdicts), "{options:?}");
        for (line, full) in lines.iter().zip(&full) {
            assert!(line["surface"] == full["surface"] || line["surface"] == "unknown");
            assert!(line["distance"].is_null() && line["regions"].is_null());
            let ends = |line: &Value| [0, 1].map(|i| line["separation"][i].as_f64());
            let ([lo, hi], [least, most]) = (ends(line), ends(full));
            assert!(lo.unwrap() <= most.unwrap(), "{line}");
            assert!(hi.is_none_or(|hi| least.unwrap() <= hi), "{line}");
            // Of bodies whose boxes are apart, no place is left where contact may be.
            let open = line["verdict"] == "open" && line["pose"] != 0;
            assert!(!open || !line["places"].as_array().unwrap().is_empty(), "{line}");
        }
    }
    let text = cubes.query(&["--accuracy", "hulls", "--format", "text"]).stdout;
    assert!(text.contains("unknown") && text.contains("open"), "{text}");
}

#[test]
fn text_has_a_line_a_pose_below_a_heading() {
    let text = Cubes::new().query(&["--format", "text"]);
    let lines: Vec<&str> = text.stdout.lines().collect();
    assert_eq!(lines.len(), 1 + SHIFTS.len());
    assert!(lines[0].contains("surface") && lines[0].contains("distance"));
    assert!(lines[1].contains("none") && lines[1].contains("5.000000000e-1"), "{}", lines[1]);
    let columns = |line: &str| line.chars().count();
    assert!(lines.iter().all(|line| columns(line) == columns(lines[0])), "{}", text.stdout);
}

#[test]
fn contacts_follow_their_pose_in_columns() {
    let text = Cubes::new().query(&["--demand", "contacts", "--format", "text"]);
    let lines: Vec<&str> = text.stdout.lines().collect();
    let heading = lines[1];
    for column in ["feature of A", "feature of B", "separation", "normal x", "point x"] {
        assert!(heading.contains(column), "{column}: {}", text.stdout);
    }
    let contacts: Vec<&str> =
        lines[2..].iter().copied().filter(|line| line.contains(" face ")).collect();
    let width = |line: &str| line.chars().count();
    assert!(contacts.iter().all(|line| width(line) == width(heading)), "{}", text.stdout);
    // Apart there is none; face to face there are the corners of the face that both share.
    assert!(
        lines[2].trim_start().starts_with("0  none")
            && lines[3].trim_start().starts_with("1  touch")
    );
    assert!(lines[4].contains("0.000000000e0") && lines[4].contains("0.5"), "{}", lines[4]);
    let given = Cubes::new().query(&["--demand", "contacts"]).json_lines();
    let given = given.iter().map(|line| line["contacts"].as_array().unwrap().len()).sum::<usize>();
    assert_eq!(lines.len(), 2 + SHIFTS.len() + given, "{}", text.stdout);
}

/// A tetrahedron with a corner in a face of the cube, and no depth.
#[test]
fn a_separation_of_zero_has_no_sign() {
    let cubes = Cubes::new();
    let corner = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    let corner = cubes.folder.write("corner.obj", corner);
    let pose = r#"[{"a": [0,-1,0,0, 1,0,0,0.5, 0,0,1,0, 0,0,0,1]}]"#;
    let poses = cubes.folder.write("corner.json", pose);
    let outcome = run(&["query", &corner, &cubes.cube, "--poses", &poses, "--demand", "contacts"]);
    assert!(outcome.stdout.contains(r#""separation":0.0"#), "{outcome:?}");
    assert!(!outcome.stdout.contains(r#""separation":-0.0"#), "{outcome:?}");
}

/// The picture is beside the answers, which stay what they are.
#[test]
fn heat_is_painted_beside_the_answers() {
    let cubes = Cubes::new();
    let picture = argument(&cubes.folder.path("heat.png"));
    let plain = |mut line: Value| {
        line["micros"] = Value::Null;
        line
    };
    let lines = |options: &[&str]| -> Vec<Value> {
        let outcome = cubes.query(options);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        outcome.json_lines().into_iter().map(plain).collect()
    };
    assert_eq!(lines(&["--heat", &picture]), lines(&[]));
    match std::fs::read(&picture) {
        Ok(png) => assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000),
        Err(error) => println!("skipped: no picture: {error}"),
    }
    cubes
        .query(&["--heat", &picture, "--accuracy", "hulls"])
        .assert_refused(2, &["--heat", "--accuracy"]);
    cubes.query(&["--heat", &picture, "--budget", "9"]).assert_refused(2, &["--heat", "--budget"]);
    cubes.query(&["--heat", "heat.txt"]).assert_refused(2, &["heat.txt", "png"]);
}
