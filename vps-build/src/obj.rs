//! Wavefront OBJ files.

use std::io::BufReader;
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
    /// A line is not OBJ.
    #[error("{}:{line}: {what}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// The lines are OBJ, but no mesh.
    #[error("{}: {what}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// Reads all objects of an OBJ file as one mesh; polygons become triangles.
///
/// # Errors
/// When the file cannot be read, is not OBJ, or holds no sound mesh; with the line where there is
/// one to blame.
pub fn read(path: &Path) -> Result<Mesh, ReadError> {
    let text = std::fs::read(path).map_err(|source| ReadError::Io {
        path: path.into(),
        source,
    })?;
    parse(&text).map_err(|error| {
        let path = path.to_owned();
        match first_bad_line(&text) {
            Some((line, what)) => ReadError::Line { path, line, what },
            None => ReadError::Mesh {
                path,
                what: error.to_string(),
            },
        }
    })
}

#[derive(Debug, thiserror::Error)]
enum ParseError {
    #[error("{0}")]
    Obj(#[from] tobj::LoadError),
    #[error("{0}")]
    Mesh(#[from] MeshError),
}

fn parse(text: &[u8]) -> Result<Mesh, ParseError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials say nothing about shape.
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(text), &options, no_materials)?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for model in models {
        let offset = vertices.len() as u32;
        let coordinate = |c: &[f32]| DVec3::from_array([c[0], c[1], c[2]].map(f64::from));
        vertices.extend(model.mesh.positions.chunks_exact(3).map(coordinate));
        let corners = model.mesh.indices.chunks_exact(3);
        triangles.extend(corners.map(|t| [t[0], t[1], t[2]].map(|v| v + offset)));
    }
    Ok(Mesh::new(&vertices, &triangles)?)
}

/// The first line with a vertex or a face that cannot be used, to tell the user where to look:
/// the reader itself gives no lines.
fn first_bad_line(text: &[u8]) -> Option<(usize, String)> {
    let text = match std::str::from_utf8(text) {
        Ok(text) => text,
        Err(error) => {
            let before = &text[..error.valid_up_to()];
            let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
            return Some((line, "not text: is this an OBJ file?".into()));
        }
    };
    let vertex_count = text
        .lines()
        .filter(|l| l.trim_start().starts_with("v "))
        .count();
    let mut seen = 0_i64;
    for (i, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        let complaint = match words.next() {
            Some("v") => {
                seen += 1;
                bad_vertex(words)
            }
            Some("f") => bad_face(words, seen, vertex_count as i64),
            _ => None,
        };
        if let Some(what) = complaint {
            return Some((i + 1, what));
        }
    }
    None
}

fn bad_vertex<'t>(words: impl Iterator<Item = &'t str>) -> Option<String> {
    let words: Vec<_> = words.take(3).collect();
    if words.len() < 3 {
        return Some("a vertex needs three coordinates".into());
    }
    words
        .into_iter()
        .find(|word| !word.parse::<f32>().is_ok_and(f32::is_finite))
        .map(|word| format!("`{word}` is not a finite coordinate"))
}

fn bad_face<'t>(
    words: impl Iterator<Item = &'t str>,
    seen: i64,
    vertex_count: i64,
) -> Option<String> {
    for word in words {
        let index = word.split('/').next().unwrap_or_default();
        match index.parse::<i64>() {
            Err(_) => return Some(format!("`{word}` is not a vertex of a face")),
            Ok(0) => return Some("a face refers to vertex 0: they are counted from 1".into()),
            Ok(i) if i > vertex_count || -i > seen => {
                return Some(format!(
                    "a face refers to vertex {i}, but there are {vertex_count}"
                ));
            }
            Ok(_) => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(text: &str) -> String {
        static NEXT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let name = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("vps-obj-{}-{name}.obj", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let message = read(&path).unwrap_err().to_string();
        std::fs::remove_file(&path).unwrap();
        let shown = path.display().to_string();
        assert!(message.starts_with(&shown), "{message}");
        message[shown.len()..].to_owned()
    }

    #[test]
    fn quads_and_several_objects_become_one_mesh() {
        let text =
            "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\no b\nv 0 0 1\nf 1//1 -1 2\n";
        let mesh = parse(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles().len(), 3);
        assert_eq!(mesh.vertices().len(), 5);
    }

    #[test]
    fn errors_name_the_line() {
        assert!(error("v 0 0 0\nv 1 x 0\n").starts_with(":2: `x`"));
        assert!(error("v 0 0 0\nv nan 0 0\nv 1 0 0\nf 1 2 3\n").starts_with(":2: `nan`"));
        assert!(error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n").starts_with(":4: "));
        assert!(error("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 0\n").starts_with(":5: "));
        assert!(error("v 0 0\n").starts_with(":1: "));
        assert!(error("v 0 0 0\nv 1 0 0\nf 1 2\n").contains("no triangles"));
        assert!(error("").contains("no triangles"));
        assert!(error("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("no extent"));
    }
}
