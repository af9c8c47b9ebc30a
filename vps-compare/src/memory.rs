use rapier3d::parry::shape::{ConvexPolyhedron, Shape};

/// What shapes take in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// In bytes.
    pub bytes: usize,
    /// Whether that is counted from outside, by the numbers of things a shape of parry holds.
    pub is_estimate: bool,
}

impl Memory {
    /// What is known to the byte.
    pub(crate) fn exact(bytes: usize) -> Self {
        Self {
            bytes,
            is_estimate: false,
        }
    }

    /// Of a shape of parry: as parry counts its triangle meshes and voxels, and by what they can be
    /// asked for otherwise.
    pub(crate) fn estimated(shape: &dyn Shape) -> Self {
        Self {
            bytes: bytes(shape),
            is_estimate: true,
        }
    }

    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            bytes: self.bytes + other.bytes,
            is_estimate: self.is_estimate || other.is_estimate,
        }
    }
}

fn bytes(shape: &dyn Shape) -> usize {
    if let Some(mesh) = shape.as_trimesh() {
        return mesh.total_memory_size();
    }
    if let Some(voxels) = shape.as_voxels() {
        return voxels.total_memory_size();
    }
    if let Some(hull) = shape.as_convex_polyhedron() {
        return of_hull(hull);
    }
    if let Some(compound) = shape.as_compound() {
        let parts = compound.shapes().iter();
        let parts: usize = parts.map(|part| size_of_val(part) + bytes(&*part.1)).sum();
        return size_of_val(compound)
            + parts
            + size_of_val(compound.aabbs())
            + compound.bvh().heap_memory_size();
    }
    size_of_val(shape)
}

fn of_hull(hull: &ConvexPolyhedron) -> usize {
    size_of_val(hull)
        + size_of_val(hull.points())
        + size_of_val(hull.vertices())
        + size_of_val(hull.edges())
        + size_of_val(hull.faces())
        + size_of_val(hull.vertices_adj_to_face())
        + size_of_val(hull.edges_adj_to_face())
        + size_of_val(hull.faces_adj_to_vertex())
}
