use std::error::Error as _;

use glamx::DVec3;
use off_rs::parser::options::{Limits, Options};

use super::{Fault, polygon_mesh};
use crate::Mesh;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let text = std::str::from_utf8(bytes).map_err(|_| Fault::of_file("not text"))?;
    let options = Options {
        limits: Limits::MAX,
        ..Options::default()
    };
    let mesh = off_rs::parse(text, options).map_err(|error| match error {
        off_rs::Error::ParserError(error) => {
            let cause = error.source().map(|s| format!(": {s}")).unwrap_or_default();
            Fault::of_line(error.line_index + 1, format!("{}{cause}", error.kind))
        }
        off_rs::Error::IOError(error) => Fault::of_file(error),
    })?;
    let vertices: Vec<_> = mesh
        .vertices
        .iter()
        .map(|v| {
            let p = v.position;
            DVec3::from_array([p.x, p.y, p.z].map(f64::from))
        })
        .collect();
    let index = |&v: &usize| {
        let count = vertices.len();
        let too_large = || {
            Fault::of_file(format!(
                "a face refers to vertex {v}, but there are {count}"
            ))
        };
        u32::try_from(v).map_err(|_| too_large())
    };
    let polygons: Result<Vec<Vec<u32>>, _> = mesh
        .faces
        .iter()
        .map(|face| face.vertices.iter().map(index).collect())
        .collect();
    polygon_mesh(&vertices, &polygons?)
}
