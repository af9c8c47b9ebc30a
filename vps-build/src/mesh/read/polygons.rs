//! Vertices and polygons of a file, and their mesh of triangles.

use glamx::DVec3;

use super::Fault;
use super::triangulate::Triangulator;
use crate::mesh::{Mesh, position_fault};

/// Vertices and polygons, each with its line, or 0 in a binary file.
pub(super) struct Polygons {
    vertices: Vec<DVec3>,
    vertex_lines: Vec<u32>,
    corners: Vec<u32>,
    faces: Vec<Face>,
    /// The number of the first vertex in the file.
    first: u32,
}

struct Face {
    /// End of its corners.
    end: usize,
    line: u32,
}

impl Polygons {
    /// No vertices yet. The file counts them from `first`.
    pub(super) fn counted_from(first: u32) -> Self {
        Self {
            vertices: Vec::new(),
            vertex_lines: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            first,
        }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.vertices.len()
    }

    pub(super) fn face_count(&self) -> usize {
        self.faces.len()
    }

    pub(super) fn push_vertex(&mut self, coordinates: [f64; 3], line: usize) {
        self.vertices.push(DVec3::from_array(coordinates));
        self.vertex_lines.push(line as u32);
    }

    /// Adds a corner to the current face, by its vertex index.
    pub(super) fn push_corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends a face. With fewer than three corners there is no face.
    pub(super) fn end_face(&mut self, line: usize) {
        let start = self.faces.last().map_or(0, |face| face.end);
        if self.corners.len() < start + 3 {
            self.corners.truncate(start);
            return;
        }
        self.faces.push(Face {
            end: self.corners.len(),
            line: line as u32,
        });
    }

    /// The mesh of all faces, triangulated. Unused vertices do not matter.
    ///
    /// # Errors
    /// When a face refers to a missing or invalid vertex, or the mesh is invalid.
    pub(super) fn mesh(&self) -> Result<Mesh, Fault> {
        let mut triangles = Vec::with_capacity(self.corners.len());
        let mut triangulator = Triangulator::default();
        let mut start = 0;
        for face in &self.faces {
            let corners = &self.corners[start..face.end];
            start = face.end;
            for &corner in corners {
                self.check(corner, face.line)?;
            }
            triangulator.triangulate(&self.vertices, corners, &mut triangles);
        }
        Ok(Mesh::new(&self.vertices, &triangles)?)
    }

    fn check(&self, corner: u32, line: u32) -> Result<(), Fault> {
        let number = u64::from(corner) + u64::from(self.first);
        let Some(vertex) = self.vertices.get(corner as usize) else {
            let count = self.vertices.len();
            let what = format!("a face refers to vertex {number}, but there are {count}");
            return Err(Fault::at(line as usize, what));
        };
        match position_fault(*vertex) {
            None => Ok(()),
            Some(fault) => {
                let DVec3 { x, y, z } = vertex;
                let what = format!("vertex {number} at ({x:?}, {y:?}, {z:?}) {fault}");
                Err(Fault::at(self.vertex_lines[corner as usize] as usize, what))
            }
        }
    }
}
