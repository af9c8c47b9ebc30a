//! Meshes from files: OBJ, PLY, STL and OFF.

mod obj;
mod off;
mod ply;
mod stl;

use std::path::{Path, PathBuf};

use glamx::DVec3;

use crate::{Mesh, MeshError};

/// Why a file is not a mesh.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A line is not what the format wants.
    #[error("{}:{line}: {what}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// The file as a whole is no mesh.
    #[error("{}: {what}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// What is wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Fault {
    /// The line that is to blame, counted from 1, if it is one.
    pub line: Option<usize>,
    /// What is wrong, in one line.
    pub what: String,
}

impl Fault {
    /// Readers may say it in several lines; here it is one.
    fn new(line: Option<usize>, what: &impl ToString) -> Self {
        let what = what.to_string();
        let words: Vec<_> = what.split_whitespace().collect();
        Self {
            line,
            what: words.join(" "),
        }
    }

    fn of_file(what: impl ToString) -> Self {
        Self::new(None, &what)
    }

    fn of_line(line: usize, what: impl ToString) -> Self {
        Self::new(Some(line), &what)
    }
}

impl From<MeshError> for Fault {
    fn from(error: MeshError) -> Self {
        Self::of_file(error)
    }
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// Stereolithography STL, ASCII or binary.
    Stl,
    /// Object file format OFF.
    Off,
}

impl MeshFormat {
    /// The format of a file by the ending of its name.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }
}

/// Reads a mesh in the format the ending of its name tells. All objects of the file become one
/// mesh, or only the one named `object` (OBJ alone has names); polygons become triangles.
///
/// # Errors
/// When the file cannot be read, is not of its format, or holds no sound mesh; with the line where
/// there is one to blame.
pub fn read_mesh(path: &Path, object: Option<&str>) -> Result<Mesh, ReadError> {
    let file = |what: &str| ReadError::File {
        path: path.into(),
        what: what.into(),
    };
    let format = MeshFormat::of(path)
        .ok_or_else(|| file("the name must end in .obj, .ply, .stl or .off"))?;
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io {
        path: path.into(),
        source,
    })?;
    parse_mesh(&bytes, format, object).map_err(|fault| match fault {
        Fault {
            line: Some(line),
            what,
        } => ReadError::Line {
            path: path.into(),
            line,
            what,
        },
        Fault { line: None, what } => file(&what),
    })
}

/// Reads a mesh from the bytes of a file, like [`read_mesh`].
///
/// # Errors
/// When the bytes are not of the format, or hold no sound mesh.
pub fn parse_mesh(bytes: &[u8], format: MeshFormat, object: Option<&str>) -> Result<Mesh, Fault> {
    if format != MeshFormat::Obj && object.is_some() {
        return Err(Fault::of_file("only the objects of an OBJ file have names"));
    }
    match format {
        MeshFormat::Obj => obj::parse(bytes, object),
        MeshFormat::Ply => ply::parse(bytes),
        MeshFormat::Stl => stl::parse(bytes),
        MeshFormat::Off => off::parse(bytes),
    }
}

/// A mesh of polygons, each cut into triangles from its first corner.
fn polygon_mesh(vertices: &[DVec3], polygons: &[Vec<u32>]) -> Result<Mesh, Fault> {
    let mut triangles = Vec::with_capacity(polygons.len());
    for polygon in polygons {
        let [first, rest @ ..] = polygon.as_slice() else {
            continue;
        };
        triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
    }
    Ok(Mesh::new(vertices, &triangles)?)
}

#[cfg(test)]
mod tests {
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
        let text =
            "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\no b\nv 0 0 1\nf 1//1 -1 2\n";
        let parse = |object| parse_mesh(text.as_bytes(), MeshFormat::Obj, object);
        assert_eq!(parse(None).unwrap().triangles().len(), 3);
        assert_eq!(parse(None).unwrap().vertices().len(), 5);
        assert_eq!(parse(Some("a")).unwrap().triangles().len(), 2);
        assert_eq!(parse(Some("b")).unwrap().triangles().len(), 1);
        assert_eq!(parse(Some("c")).unwrap_err().what, "there is no object `c`");
        let other = parse_mesh(off().as_bytes(), MeshFormat::Off, Some("a"));
        assert!(other.unwrap_err().what.contains("OBJ"));
    }

    fn fault(text: &str, format: MeshFormat) -> (Option<usize>, String) {
        let Fault { line, what } = parse_mesh(text.as_bytes(), format, None).unwrap_err();
        assert!(!what.contains('\n'), "{what}");
        (line, what)
    }

    #[test]
    fn faults_of_obj_files_name_the_line() {
        let line = |text: &str| fault(text, MeshFormat::Obj).0;
        assert_eq!(line("v 0 0 0\nv 1 x 0\n"), Some(2));
        assert_eq!(line("v 0 0 0\nv nan 0 0\nv 1 0 0\nf 1 2 3\n"), Some(2));
        assert_eq!(line("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n"), Some(4));
        assert_eq!(line("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 0\n"), Some(5));
        assert_eq!(line("v 0 0\n"), Some(1));
        let what = |text: &str| fault(text, MeshFormat::Obj).1;
        assert!(what("v 0 0 0\nv 1 0 0\nf 1 2\n").contains("no triangles"));
        assert!(what("").contains("no triangles"));
        assert!(what("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("no extent"));
    }

    #[test]
    fn faults_of_other_files_are_told() {
        let off = |from: &str, to: &str| fault(&off().replacen(from, to, 1), MeshFormat::Off);
        assert_eq!(off("1 2 3\n", "1 x 3\n").0, Some(10));
        assert!(off("4 0 4 6 2", "4 0 4 9 2").1.contains('9'));
        assert!(fault("", MeshFormat::Off).1.len() > 3);
        let ascii = ply_header("ascii") + &lines(&corners(), "") + &lines(&QUADS, "4 ");
        let ply = |from: &str, to: &str| fault(&ascii.replacen(from, to, 1), MeshFormat::Ply);
        assert_eq!(ply("1 2 3\n", "1 x 3\n").0, Some(18));
        assert!(ply("4 0 4 6 2", "4 0 4 9 2").1.contains("vertex 9"));
        assert!(ply("property float z\n", "").1.len() > 3);
        assert!(
            ply("vertex_indices", "corners")
                .1
                .contains("vertex_indices")
        );
        assert!(fault("solid x\nfacet normal\n", MeshFormat::Stl).1.len() > 3);
        let mut short = binary_stl();
        short.truncate(300);
        assert!(parse_mesh(&short, MeshFormat::Stl, None).is_err());
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
}
