use super::*;

#[test]
fn stl_as_programs_write_it() {
    let text = ascii_stl();
    let halves = text.replacen("endfacet\n", "endfacet\nendsolid\n\nsolid part two\n", 1);
    for (what, text) in [
        (
            "normals that are not numbers",
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
        ("normals that are not numbers", normals),
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
        "declares 17 triangles, but the file holds 12",
    );
    told(
        with(80, &[7, 0, 0, 0]),
        "declares 7 triangles, but the file holds 12",
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
