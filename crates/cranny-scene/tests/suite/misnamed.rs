//! Files that begin with a byte order mark, and files whose name says what they are not.

use cranny_geometry::{BuildOptions, Mesh, Model};
use cranny_scene::mesh_file::{Looks, MeshFormat, Problem, decode_mesh};
use cranny_scene::{LoadOptions, encode_obj, parse_scene, read_robot};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const OFF: &str = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const STL: &str = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
const DAE: &str = r##"<COLLADA><asset><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array>0 0 0 1 0 0 0 1 0</float_array></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries></COLLADA>"##;
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA","byteLength":36}]}"#;

const TEXTS: [(&str, MeshFormat); 6] = [
    (OBJ, MeshFormat::Obj),
    (OFF, MeshFormat::Off),
    (PLY, MeshFormat::Ply),
    (STL, MeshFormat::Stl),
    (DAE, MeshFormat::Collada),
    (GLTF, MeshFormat::Gltf),
];

#[test]
fn a_text_file_loses_nothing_of_a_mesh() {
    for (text, format) in TEXTS {
        let plain = decode_mesh(text.as_bytes(), format).unwrap();
        let marked = decode_mesh(format!("\u{feff}{text}").as_bytes(), format).unwrap();
        assert_eq!(marked, plain, "{format:?}");
        assert_eq!(plain.mesh.faces().len(), 1, "{format:?}");
    }
    for (_, format) in MeshFormat::EXTENSIONS {
        let error = decode_mesh("\u{feff}\n".as_bytes(), format).unwrap_err();
        assert_eq!(error.problem, Problem::Empty);
    }
}

#[test]
fn a_text_file_loses_nothing_of_a_scene_or_robot() {
    let scene = "\u{feff}(bodies: [(name: \"a\", shape: Generator(Torus(major_radius: 1)))])";
    let options = LoadOptions::default();
    let loaded = parse_scene(scene.to_owned(), "s.ron".as_ref(), &options).unwrap();
    assert_eq!(loaded.description.bodies[0].name, "a");

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.urdf");
    std::fs::write(
        &path,
        "\u{feff}<?xml version=\"1.0\"?><robot name=\"r\"><link name=\"base\"/></robot>",
    )
    .unwrap();
    assert_eq!(read_robot(&path).unwrap().links.len(), 1);
}

#[test]
fn a_mesh_under_the_name_of_another_format_is_told_apart() {
    for (text, is) in TEXTS {
        for (_, named) in TEXTS {
            if named == is {
                continue;
            }
            let error = decode_mesh(text.as_bytes(), named).unwrap_err();
            assert_eq!(error.problem, Problem::Misnamed { looks: Looks::Mesh(is) }, "{error}");
        }
    }
    let error = decode_mesh(OBJ.as_bytes(), MeshFormat::Stl).unwrap_err().to_string();
    assert!(error.contains("this is OBJ content. Give it the extension .obj"), "{error}");
}

#[test]
fn a_binary_stl_under_the_name_of_another_format_is_told_apart() {
    // One face: its normal, its corners, two bytes of attributes.
    let corners = [0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes = [&[b'x'; 80][..], &1u32.to_le_bytes()].concat();
    bytes.extend(corners.iter().flat_map(|c| c.to_le_bytes()));
    bytes.extend([0, 0]);
    assert_eq!(decode_mesh(&bytes, MeshFormat::Stl).unwrap().mesh.faces().len(), 1);
    for (_, named) in TEXTS.into_iter().filter(|&(_, named)| named != MeshFormat::Stl) {
        let error = decode_mesh(&bytes, named).unwrap_err();
        assert!(error.to_string().contains("this is STL content. Give it the extension .stl"));
    }
}

#[test]
fn text_that_is_no_stl_is_not_called_a_binary_file() {
    let text = "once upon a time there was a mesh\n".repeat(20);
    let error = decode_mesh(text.as_bytes(), MeshFormat::Stl).unwrap_err();
    assert!(matches!(error.problem, Problem::OtherText { .. }), "{error}");
    assert!(error.to_string().contains("begins with \"once upon a time"), "{error}");
}

#[test]
fn a_saved_model_is_known_whatever_its_name() {
    let mesh: Mesh = decode_mesh(OBJ.as_bytes(), MeshFormat::Obj).unwrap().mesh;
    assert!(encode_obj(&mesh).starts_with("v 0 0 0"));
    let (model, _) = Model::build(mesh, &BuildOptions::default()).unwrap();
    for (_, format) in MeshFormat::EXTENSIONS {
        let error = decode_mesh(&model.encode(), format).unwrap_err();
        assert_eq!(error.problem, Problem::Misnamed { looks: Looks::Model });
        assert!(error.to_string().contains(".cranny"), "{error}");
    }
}
