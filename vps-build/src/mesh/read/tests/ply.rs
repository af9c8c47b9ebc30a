use super::*;

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
    // A binary header ends with its line, whatever bytes follow.
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
    // A tetrahedron is one strip, or two: restarted, or joined by repeated vertices.
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
