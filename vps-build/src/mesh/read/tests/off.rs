use super::*;

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
    // The counts 8 6 0 are not a vertex.
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
