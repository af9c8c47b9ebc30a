//! Files as programs write them, and invalid files.

mod obj;
mod off;
mod ply;
mod stl;

use super::*;

/// A box of 1 x 2 x 3: eight corners, six quads facing outwards.
fn corners() -> Vec<[f32; 3]> {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1];
    let size = |c: [u32; 3]| [c[0] as f32, 2.0 * c[1] as f32, 3.0 * c[2] as f32];
    (0..8).map(|i| size(corner(i))).collect()
}

const QUADS: [[u32; 4]; 6] = [
    [0, 4, 6, 2],
    [1, 3, 7, 5],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 2, 3, 1],
    [4, 5, 7, 6],
];

fn lines<const N: usize, T: ToString>(rows: &[[T; N]], before: &str) -> String {
    let row = |r: &[T; N]| {
        let words: Vec<_> = r.iter().map(ToString::to_string).collect();
        format!("{before}{}\n", words.join(" "))
    };
    rows.iter().map(row).collect()
}

fn triangles() -> Vec<[[f32; 3]; 3]> {
    let corners = corners();
    let halves = QUADS
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    halves.map(|t| t.map(|v| corners[v as usize])).collect()
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a box\nelement vertex 8\nproperty float x\n\
         property float y\nproperty float z\nelement face 6\n\
         property list uchar int vertex_indices\nend_header\n"
    )
}

fn binary_ply(format: &str, f: fn(f32) -> [u8; 4], i: fn(i32) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = ply_header(format).into_bytes();
    for c in corners().into_iter().flatten() {
        bytes.extend(f(c));
    }
    for quad in QUADS {
        bytes.push(4);
        bytes.extend(quad.into_iter().flat_map(|v| i(v as i32)));
    }
    bytes
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(12_u32.to_le_bytes());
    for triangle in triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.into_iter().flatten().flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii_stl() -> String {
    let mut text = String::from("solid box\n");
    for triangle in triangles() {
        text += "facet normal 0 0 0\nouter loop\n";
        text += &lines(&triangle, "vertex ");
        text += "endloop\nendfacet\n";
    }
    text + "endsolid box\n"
}

fn off() -> String {
    format!(
        "OFF\n8 6 0\n{}{}",
        lines(&corners(), ""),
        lines(&QUADS, "4 ")
    )
}

fn obj() -> String {
    let quads = QUADS.map(|q| q.map(|v| v + 1));
    format!("o box\n{}{}", lines(&corners(), "v "), lines(&quads, "f "))
}

#[test]
fn all_formats_give_the_same_mesh() {
    let ascii_ply = ply_header("ascii") + &lines(&corners(), "") + &lines(&QUADS, "4 ");
    let little = binary_ply("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes);
    let big = binary_ply("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes);
    for (i, (bytes, format)) in [
        (obj().into_bytes(), MeshFormat::Obj),
        (ascii_ply.into_bytes(), MeshFormat::Ply),
        (little, MeshFormat::Ply),
        (big, MeshFormat::Ply),
        (binary_stl(), MeshFormat::Stl),
        (ascii_stl().into_bytes(), MeshFormat::Stl),
        (off().into_bytes(), MeshFormat::Off),
    ]
    .into_iter()
    .enumerate()
    {
        let mesh = parse_mesh(&bytes, format, None).unwrap_or_else(|e| panic!("{i}: {e:?}"));
        assert_eq!(
            (mesh.vertices().len(), mesh.triangles().len()),
            (8, 12),
            "{i}"
        );
        assert_eq!(mesh.open_edges(), 0, "{i}");
        let volume = crate::mass_properties(&mesh).unwrap().volume;
        assert!((volume - 6.0).abs() < 1e-5, "{i}: {volume}");
    }
}

#[test]
fn objects_are_merged_or_chosen_by_name() {
    let text = "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\no b\nv 0 0 1\nf 1//1 -1 2\n";
    let parse = |object| parse_mesh(text.as_bytes(), MeshFormat::Obj, object);
    assert_eq!(parse(None).unwrap().triangles().len(), 3);
    assert_eq!(parse(None).unwrap().vertices().len(), 5);
    assert_eq!(parse(Some("a")).unwrap().triangles().len(), 2);
    assert_eq!(parse(Some("b")).unwrap().triangles().len(), 1);
    let missing = parse(Some("c")).unwrap_err();
    assert_eq!(missing.what, "there is no object `c`, but `a`, `b`");
    let other = parse_mesh(off().as_bytes(), MeshFormat::Off, Some("a"));
    assert!(other.unwrap_err().what.contains("OBJ"));
}

/// The fault of a file, in one line.
fn fault(bytes: impl AsRef<[u8]>, format: MeshFormat) -> (Option<usize>, String) {
    let Fault { line, what } = parse_mesh(bytes.as_ref(), format, None).unwrap_err();
    assert!(!what.contains('\n'), "{what}");
    (line, what)
}

/// Triangles and volume of a closed mesh.
fn closed(bytes: impl AsRef<[u8]>, format: MeshFormat, what: &str) -> (usize, f64) {
    let mesh = parse_mesh(bytes.as_ref(), format, None);
    let mesh = mesh.unwrap_or_else(|e| panic!("{what}: {e:?}"));
    assert_eq!(mesh.open_edges(), 0, "{what}");
    let volume = crate::mass_properties(&mesh).unwrap().volume;
    (mesh.triangles().len(), f64::from(volume))
}

fn is_the_box(bytes: impl AsRef<[u8]>, format: MeshFormat, what: &str) {
    let (triangles, volume) = closed(bytes, format, what);
    assert_eq!(triangles, 12, "{what}");
    assert!((volume - 6.0).abs() < 1e-5, "{what}: {volume}");
}

#[test]
fn polygons_of_all_formats_are_cut_as_they_are() {
    // A prism over a channel. A fan would fill its notch.
    let channel = [
        [1, 3],
        [0, 3],
        [0, 0],
        [4, 0],
        [4, 3],
        [3, 3],
        [3, 1],
        [1, 1],
    ];
    let at = |z: i32| channel.map(|[x, y]| [x, y, z]);
    let places = [at(0), at(2)].concat();
    let mut faces = vec![(0..8).rev().collect::<Vec<_>>(), (8..16).collect()];
    faces.extend((0..8).map(|i| vec![i, (i + 1) % 8, (i + 1) % 8 + 8, i + 8]));
    let row = |face: &[usize], first: usize| {
        let words = face.iter().map(|v| (v + first).to_string());
        words.collect::<Vec<_>>().join(" ")
    };
    let counted = |f: &Vec<usize>| format!("{} {}\n", f.len(), row(f, 0));
    let obj_face = |f: &Vec<usize>| format!("f {}\n", row(f, 1));
    let counted: String = faces.iter().map(counted).collect();
    let obj = lines(&places, "v ") + &faces.iter().map(obj_face).collect::<String>();
    let off = format!("OFF\n16 10 0\n{}{counted}", lines(&places, ""));
    let header = ply_header("ascii")
        .replace("vertex 8", "vertex 16")
        .replace("face 6", "face 10");
    let ply = header + &lines(&places, "") + &counted;
    for (text, format) in [
        (obj, MeshFormat::Obj),
        (off, MeshFormat::Off),
        (ply, MeshFormat::Ply),
    ] {
        let (triangles, volume) = closed(&text, format, "channel");
        assert_eq!(triangles, 28);
        assert!((volume.abs() - 16.0).abs() < 1e-5, "{format:?}: {volume}");
        let mesh = parse_mesh(text.as_bytes(), format, None).unwrap();
        assert!(
            (mesh.area() - (16.0 + 2.0 * 18.0)).abs() < 1e-9,
            "{format:?}"
        );
    }
}

#[test]
fn the_ending_tells_the_format() {
    assert_eq!(MeshFormat::of(Path::new("a/B.STL")), Some(MeshFormat::Stl));
    assert_eq!(MeshFormat::of(Path::new("a.vps")), None);
    let error = read_mesh(Path::new("a.fbx"), None).unwrap_err().to_string();
    assert_eq!(
        error,
        "a.fbx: the name must end in .obj, .ply, .stl or .off"
    );
}
