use std::io::BufReader;
use std::path::Path;

use glamx::DVec3;

use super::Fault;
use crate::{Mesh, MeshError};

pub(super) fn parse(bytes: &[u8], object: Option<&str>) -> Result<Mesh, Fault> {
    parse_objects(bytes, object).map_err(|error| {
        let blamed = match error {
            // The file is fine.
            ObjError::NoObject(_) => None,
            _ => first_bad_line(bytes),
        };
        match blamed {
            Some((line, what)) => Fault::of_line(line, what),
            None => Fault::of_file(error),
        }
    })
}

#[derive(Debug, thiserror::Error)]
enum ObjError {
    #[error("{0}")]
    Obj(#[from] tobj::LoadError),
    #[error("{0}")]
    Mesh(#[from] MeshError),
    #[error("there is no object `{0}`")]
    NoObject(String),
}

fn parse_objects(bytes: &[u8], object: Option<&str>) -> Result<Mesh, ObjError> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials say nothing about shape.
    let no_materials = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let (mut models, _) = tobj::load_obj_buf(&mut BufReader::new(bytes), &options, no_materials)?;
    if let Some(name) = object {
        models.retain(|model| model.name == name);
        if models.is_empty() {
            return Err(ObjError::NoObject(name.into()));
        }
    }
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
