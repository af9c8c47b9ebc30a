use super::*;

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
        // A group lasts until the next.
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
