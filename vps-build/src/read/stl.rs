use std::io::Cursor;

use glamx::DVec3;

use super::Fault;
use crate::Mesh;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let mut vertices = Vec::new();
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(Fault::of_file)?;
    for (i, triangle) in triangles.enumerate() {
        let fault = |e| Fault::of_file(format!("triangle {i}: {e}"));
        let corners = triangle.map_err(fault)?.vertices;
        vertices.extend(corners.map(|v| DVec3::from_array(v.0.map(f64::from))));
    }
    let triangles: Vec<_> = (0..vertices.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    Ok(Mesh::new(&vertices, &triangles)?)
}
