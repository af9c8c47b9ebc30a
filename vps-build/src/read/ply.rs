use glamx::DVec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{Fault, polygon_mesh};
use crate::Mesh;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let parser = Parser::<DefaultElement>::new();
    let ply = parser.read_ply(&mut &*bytes).map_err(|error| {
        let what = error.to_string();
        // The line has a place of its own.
        let prefix = error.line().map(|line| format!("Line {line}: "));
        let what = prefix.and_then(|p| what.strip_prefix(&p)).unwrap_or(&what);
        Fault::new(error.line(), &what)
    })?;
    let elements = |name: &str| ply.payload.get(name).map(Vec::as_slice).unwrap_or_default();
    let mut vertices = Vec::new();
    for (i, vertex) in elements("vertex").iter().enumerate() {
        let coordinate = |name: &str| match vertex.get(name) {
            Some(Property::Double(c)) => Some(*c),
            Some(other) => other.to_f32_lossy().map(f64::from),
            None => None,
        };
        match [coordinate("x"), coordinate("y"), coordinate("z")] {
            [Some(x), Some(y), Some(z)] => vertices.push(DVec3::new(x, y, z)),
            _ => return Err(Fault::of_file(format!("vertex {i} has no x, y and z"))),
        }
    }
    let mut polygons = Vec::new();
    for (i, face) in elements("face").iter().enumerate() {
        let list = face
            .get("vertex_indices")
            .or_else(|| face.get("vertex_index"));
        let polygon = list.and_then(Property::to_u32_list);
        polygons.push(polygon.ok_or_else(|| {
            Fault::of_file(format!("face {i} has no list vertex_indices of vertices"))
        })?);
    }
    polygon_mesh(&vertices, &polygons)
}
