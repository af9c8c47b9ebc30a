//! Files as programs write them, and files with faults.

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

/// What is wrong with some bytes, in one line.
fn fault(bytes: impl AsRef<[u8]>, format: MeshFormat) -> (Option<usize>, String) {
    let Fault { line, what } = parse_mesh(bytes.as_ref(), format, None).unwrap_err();
    assert!(!what.contains('\n'), "{what}");
    (line, what)
}

/// Triangles and volume of what must be a closed mesh.
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
fn obj_as_programs_write_it() {
    let obj = obj();
    let text = |from: &str, to: &str| obj.replace(from, to).into_bytes();
    for (what, bytes) in [
        ("continued", text("f 1 5 7 3", "f 1 \\\n 5 7\\\r\n3")),
        (
            "continued at the end",
            [obj.as_bytes(), b"f 1 5 \\"].concat(),
        ),
        (
            "comments",
            text("f 1 5 7 3", "# \\\nf 1 5 7 3 # front\n#f 1 2 3"),
        ),
        (
            "Latin-1",
            [b"# W\xfcrfel\no W\xfcrfel\n", obj.as_bytes()].concat(),
        ),
        (
            "byte order mark",
            [b"\xef\xbb\xbf", obj.as_bytes()].concat(),
        ),
        (
            "mark before data",
            [b"\xef\xbb\xbf", &obj.as_bytes()[6..]].concat(),
        ),
        ("old Mac", text("\n", "\r")),
        (
            "Windows, tabs",
            text("\n", "\r\n")
                .into_iter()
                .map(|b| if b == b' ' { b'\t' } else { b })
                .collect(),
        ),
        ("colours", text("v 1 2 3", "v 1 2 3 0.1 0.2 0.3")),
        ("numbers", text("v 1 2 3", "v +1. .2d1 3E0 1.0")),
        (
            "other corners",
            text("f 1 5 7 3", "vt .5\nvn 0 0 1\nf 1/1 5//1 7/1/1 3/1/"),
        ),
        ("a corner twice", text("f 1 5 7 3", "f 1 1 5 7 3 1")),
        (
            "groups",
            text("f 2 4", "g a b\ns off\nmg 0\nusemtl x#\\\nlod 0\nf 2 4"),
        ),
        (
            "curves",
            text(
                "f 2 4",
                "vp .5\ncstype bezier\ncurv 0 1 1 2\nend\nl 1 2\np 1\nf 2 4",
            ),
        ),
        ("old keyword", text("f ", "fo ")),
        (
            "unused nonsense",
            [obj.as_bytes(), b"v nan 1e99 0\n"].concat(),
        ),
    ] {
        is_the_box(&bytes, MeshFormat::Obj, what);
    }
}

#[test]
fn relative_vertices_count_from_the_line_of_the_face() {
    let text =
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf -4 -3 -1\nf 2 -1 4\nf 3 4 5\n";
    let (triangles, volume) = closed(text, MeshFormat::Obj, "relative");
    assert_eq!(triangles, 4);
    assert!((volume - 1.0 / 6.0).abs() < 1e-6);
    assert_eq!(fault("v 0 0 0\nf -2 -1 -1\n", MeshFormat::Obj).0, Some(2));
}

#[test]
fn objects_keep_their_groups_and_names_may_be_anything() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no left arm # the first\ng tip\nf 1 2 3\n\
                g grip tip\nf 1 3 4\no \u{d6}se#2\nf 2 3 4\n";
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    for bytes in [text.as_bytes(), &latin] {
        let count = |name| {
            let mesh = parse_mesh(bytes, MeshFormat::Obj, Some(name));
            mesh.unwrap().triangles().len()
        };
        assert_eq!((count("left arm"), count("\u{d6}se#2")), (2, 1));
        // A group goes on until the next.
        assert_eq!((count("grip"), count("tip"), count("grip tip")), (2, 3, 2));
    }
    let none = parse_mesh(b"v 0 0 0\nf 1 1 1\n", MeshFormat::Obj, Some("a")).unwrap_err();
    assert_eq!(none.what, "there is no object `a`: the file names none");
}

#[test]
fn faults_of_obj_files_name_the_line() {
    let line = |text: &str| fault(text, MeshFormat::Obj).0;
    assert_eq!(line("v 0 0 0\nv 1 x 0\n"), Some(2));
    assert_eq!(line("v 0 0 0\nv nan 0 0\nv 1 0 0\nf 1 2 3\n"), Some(2));
    assert_eq!(line("v 0 0 0\nv 1 0 0\n\nv 1e31 0 0\nf 1 2 3\n"), Some(4));
    assert_eq!(line("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n"), Some(4));
    assert_eq!(line("v 0 0 0\rv 1 0 0\r\nv 0 1 0\n\nf 1 2 0\n"), Some(5));
    assert_eq!(
        line("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3 \\\n7x\n"),
        Some(6)
    );
    assert_eq!(line("v 0 0\n"), Some(1));
    assert_eq!(line("v 0 0 0\nf 1 1 9999999999999999999999\n"), Some(2));
    assert_eq!(
        line("# nurbs\nv 0 0 0\ncstype bspline\nsurf 0 1 0 1 1 2 3 4\n"),
        Some(4)
    );
    let what = |text: &str| fault(text, MeshFormat::Obj).1;
    assert!(what("v 0 0 0\nv 1 0 0\nf 1 2\n").contains("no triangles"));
    assert!(what("").contains("no triangles"));
    assert!(what("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("no extent"));
    assert!(what("v 1,5 0 0\n").contains("decimals need a point"));
    assert!(what("call parts.obj\n").contains("one file"));
    let utf_16 = [b"\xff\xfe".as_slice(), b"v\0 \x000\0"].concat();
    assert!(fault(utf_16, MeshFormat::Obj).1.contains("UTF-16"));
}

#[test]
fn off_as_programs_write_it() {
    let off = off();
    let faces = |colour: &str| {
        let (head, faces) = off.split_at(off.find("4 0 4").unwrap());
        head.to_owned() + &faces.replace('\n', &format!("{colour}\n"))
    };
    let vertices = |keyword: &str, more: &str| {
        let (head, faces) = off.split_at(off.find("4 0 4").unwrap());
        let (counts, vertices) = head.split_at(head.find("0 0 0").unwrap());
        let counts = counts.replace("OFF", keyword);
        counts + &vertices.replace('\n', &format!("{more}\n")) + faces
    };
    // The counts 8 6 0 are no vertex.
    let off_counts = |to: &str| off.replacen("OFF\n8 6 0", to, 1);
    for (what, text) in [
        ("face colours", faces(" 255 0 0")),
        ("broken face colours", faces("  .5 .5 .5 1.")),
        ("an index of a colour", faces(" 3")),
        ("COFF", vertices("COFF", " 255 0 0 255")),
        ("NOFF", vertices("NOFF", " 0 0 1")),
        ("STCNOFF", vertices("STCNOFF", " 0 0 1 1 1 1 1 .5 .5")),
        ("counts behind", off_counts("OFF 8 6 0")),
        ("counts without a blank", off_counts("OFF8 6 0")),
        ("no keyword", off_counts("8 6 0")),
        ("no edges", off_counts("OFF\n8 6")),
        ("three dimensions", off_counts("nOFF 3\n8 6 0")),
        (
            "comments",
            off_counts("# a box\n\nOFF # text\n\n8 6 0 # counts\n\n# corners"),
        ),
        ("Windows", off.replace('\n', "\r\n")),
        ("lower case", off_counts("off\n8 6 0")),
        ("one line", off.replace('\n', " ")),
        ("a word on each line", off.replace(' ', "\n")),
        ("an edge as a face", off_counts("OFF\n8 7 0") + "2 0 1\n"),
    ] {
        is_the_box(&text, MeshFormat::Off, what);
    }
    let off = |from: &str, to: &str| fault(off.replacen(from, to, 1), MeshFormat::Off);
    assert_eq!(off("1 2 3\n", "1 x 3\n").0, Some(10));
    let (line, what) = off("4 0 4 6 2", "4 0 4 9 2");
    assert!(line == Some(11) && what.contains("vertex 9"), "{what}");
    assert_eq!(off("4 0 4 6 2", "4 0 4 6").0, Some(11));
    assert_eq!(off("4 0 4 6 2", "4 0 4 -1 2").0, Some(11));
    assert_eq!(off("OFF", "OFF BINARY").0, Some(1));
    assert_eq!(off("OFF", "4OFF").0, Some(1));
    let (line, what) = off("OFF\n", "# four\nnOFF\n4\n");
    assert!(line == Some(3) && what.contains("only 3"), "{what}");
    assert!(off("8 6 0", "999999999999 6 0").1.contains("999999999999 "));
    assert!(off("8 6 0", "8 999999999999 0").1.contains("there are 6"));
    assert!(fault("", MeshFormat::Off).1.contains("empty"));
    assert!(fault("solid x\n", MeshFormat::Off).1.contains("OFF file?"));
}

fn ascii_ply() -> String {
    ply_header("ascii") + &lines(&corners(), "") + &lines(&QUADS, "4 ")
}

#[test]
fn ply_as_programs_write_it() {
    let ply = ascii_ply();
    let more = "element edge 1\nproperty int a\nelement nothing 999999999999\nend_header";
    let with_more = ply.replace("end_header", more) + "7\n";
    let colours = ply.replacen(
        "property float x",
        "property uchar red\nproperty double x",
        1,
    );
    let (head, body) = colours.split_at(colours.find("0 0 0").unwrap());
    let (places, faces) = body.split_at(body.find("4 0 4").unwrap());
    let colours = head.to_owned() + "9 " + &places.trim_end().replace('\n', "\n9 ") + "\n" + faces;
    for (what, text) in [
        (
            "another name",
            ply.replace("vertex_indices", "vertex_index"),
        ),
        ("Windows", ply.replace('\n', "\r\n")),
        ("old Mac", ply.replace('\n', "\r")),
        ("more elements", with_more),
        ("more properties", colours),
    ] {
        is_the_box(&text, MeshFormat::Ply, what);
    }
    // The end of a binary header is that of its line, whatever bytes follow.
    for end in ["\n", "\r\n"] {
        let binary = binary_ply("binary_little_endian", f32::to_le_bytes, i32::to_le_bytes);
        let header = ply_header("binary_little_endian");
        let bytes = [
            header.replace('\n', end).as_bytes(),
            &binary[header.len()..],
        ]
        .concat();
        is_the_box(&bytes, MeshFormat::Ply, end);
    }
}

#[test]
fn strips_of_a_ply_file_turn_at_every_triangle() {
    // A tetrahedron is one strip, or two: begun anew, or sewn together by vertices twice in a row.
    for strip in [
        "6 0 2 1 3 0 2",
        "10 0 2 1 3 -1 1 3 0 2 -1",
        "10 0 2 1 3 3 1 1 3 0 2",
    ] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\n\
             property int z\nelement tristrips 1\nproperty list int int vertex_indices\n\
             end_header\n0 0 0\n6 0 0\n0 6 0\n0 0 6\n{strip}\n"
        );
        let (triangles, volume) = closed(&text, MeshFormat::Ply, strip);
        assert_eq!(triangles, 4);
        assert!((volume - 36.0).abs() < 1e-4);
    }
}

#[test]
fn faults_of_ply_files_are_told() {
    let ply = |from: &str, to: &str| fault(ascii_ply().replacen(from, to, 1), MeshFormat::Ply);
    assert_eq!(ply("1 2 3\n", "1 x 3\n").0, Some(18));
    assert_eq!(ply("1 2 3\n", "1 2\n").0, Some(18));
    let (line, what) = ply("4 0 4 6 2", "4 0 4 9 2");
    assert!(line == Some(19) && what.contains("vertex 9"), "{what}");
    assert_eq!(ply("4 0 4 6 2", "4 0 4 -6 2").0, Some(19));
    assert_eq!(ply("4 0 4 6 2", "4000000000 0 4").0, Some(19));
    assert_eq!(ply("property float z\n", "").0, Some(4));
    assert!(
        ply("vertex_indices", "corners")
            .1
            .contains("vertex_indices")
    );
    assert_eq!(ply("property float z", "property quad z").0, Some(7));
    assert!(
        ply("vertex 8", "vertex 999999999999")
            .1
            .contains("999999999999")
    );
    assert!(
        ply("face 6", "face 18446744073709551615")
            .1
            .contains("18446744073709551615")
    );
    assert_eq!(ply("face 6", "face -6").0, Some(8));
    assert!(
        ply("element face 6", "element wall 6")
            .1
            .contains("point cloud")
    );
    assert!(
        fault("ply\nformat ascii 1.0\n", MeshFormat::Ply)
            .1
            .contains("end_header")
    );
    assert_eq!(fault("OFF\n", MeshFormat::Ply).0, Some(1));
    assert!(!fault("", MeshFormat::Ply).1.is_empty());
    let binary = binary_ply("binary_big_endian", f32::to_be_bytes, i32::to_be_bytes);
    assert!(
        fault(&binary[..binary.len() - 1], MeshFormat::Ply)
            .1
            .contains("ends in number 5")
    );
}

#[test]
fn stl_as_programs_write_it() {
    let text = ascii_stl();
    let halves = text.replacen("endfacet\n", "endfacet\nendsolid\n\nsolid part two\n", 1);
    for (what, text) in [
        (
            "normals that are no numbers",
            text.replace("normal 0 0 0", "normal nan -1.#IND nan"),
        ),
        ("upper case", text.to_uppercase()),
        ("parts", halves),
        (
            "a name of keywords",
            text.replace("solid box", "solid facet vertex 1 2"),
        ),
        ("Windows", text.replace('\n', "\r\n")),
        ("zeros behind", text.clone() + "\0\0\0"),
        ("an end mark", text.clone() + "\x1a"),
        ("one line", text.replace('\n', " ")),
        (
            "a normal of its own line",
            text.replace("normal", "\nnormal"),
        ),
        (
            "few lines",
            text.replace("loop\n", "loop ")
                .replace("0\nouter", "0 outer"),
        ),
    ] {
        is_the_box(&text, MeshFormat::Stl, what);
    }
    let with = |at: usize, bytes: &[u8]| {
        let mut binary = binary_stl();
        binary[at..at + bytes.len()].copy_from_slice(bytes);
        binary
    };
    let mut normals = binary_stl();
    for facet in normals[84..].chunks_mut(50) {
        facet[..12].fill(0xff);
    }
    for (what, bytes) in [
        (
            "a header like text",
            with(0, b"solid x\nfacet normal 0 0 1\nouter loop"),
        ),
        ("a full header", with(0, &[b'x'; 80])),
        ("bytes behind", [binary_stl(), vec![1; 7]].concat()),
        ("normals that are no numbers", normals),
        ("an unknown count", with(80, &[0xff; 4])),
        ("no count", with(80, &[0; 4])),
    ] {
        is_the_box(&bytes, MeshFormat::Stl, what);
    }
    let told = |bytes: Vec<u8>, part: &str| {
        let what = fault(&bytes, MeshFormat::Stl).1;
        assert!(what.contains(part), "{what}");
    };
    told(
        with(80, &[17, 0, 0, 0]),
        "speaks of 17 triangles, but the file holds 12",
    );
    told(
        with(80, &[7, 0, 0, 0]),
        "speaks of 7 triangles, but the file holds 12",
    );
    told(with(80, &[0xff, 0xff, 0xff, 0x7f]), "the file holds 12");
    told(
        with(84 + 50 + 12, &f32::NAN.to_le_bytes()),
        "triangle 1 (counted from 0) is not finite",
    );
    told(with(84 + 12, &1e31_f32.to_le_bytes()), "triangle 0");
    told(vec![], "empty");
    told(vec![0; 3], "empty");
    told(vec![1, 0, 2], "neither text");
    told(b"  \n".to_vec(), "empty");
    let line = |from: &str, to: &str| fault(text.replacen(from, to, 1), MeshFormat::Stl).0;
    assert_eq!(line("vertex 0 0 3", "vertex 0 nan 3"), Some(5));
    assert_eq!(line("vertex 0 0 3", "vertex 0 0"), Some(5));
    assert_eq!(line("vertex 0 0 3\n", ""), Some(7));
    assert_eq!(line("endfacet", "endfact"), Some(8));
    assert_eq!(fault("# not one\n", MeshFormat::Stl).0, Some(1));
    for cut in [text.len() - 14, text.len() / 2] {
        assert!(fault(&text[..cut], MeshFormat::Stl).0.is_some());
    }
}

#[test]
fn polygons_of_all_formats_are_cut_as_they_are() {
    // A prism over a channel; a fan would fill its notch.
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
