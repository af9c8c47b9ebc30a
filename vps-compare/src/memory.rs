use rapier3d::parry::shape::{Compound, ConvexPolyhedron, Shape};

/// Memory of shapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Size in bytes.
    pub bytes: usize,
    /// Whether the size is estimated from the numbers of elements of a parry shape.
    pub is_estimate: bool,
}

impl Memory {
    /// The memory of a shape of parry. Triangle meshes and voxels are counted by parry, hulls and
    /// compounds by their accessible elements; any other shape has the size of its type.
    pub fn of_parry(shape: &dyn Shape) -> Self {
        let estimate = if let Some(mesh) = shape.as_trimesh() {
            Some(mesh.total_memory_size())
        } else if let Some(voxels) = shape.as_voxels() {
            Some(voxels.total_memory_size())
        } else if let Some(hull) = shape.as_convex_polyhedron() {
            Some(of_hull(hull))
        } else {
            shape.as_compound().map(of_compound)
        };
        Self {
            bytes: estimate.unwrap_or(size_of_val(shape)),
            is_estimate: estimate.is_some(),
        }
    }

    /// The memory of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            bytes: self.bytes + other.bytes,
            is_estimate: self.is_estimate || other.is_estimate,
        }
    }
}

fn of_compound(compound: &Compound) -> usize {
    let parts = compound.shapes().iter();
    let parts: usize = parts
        .map(|part| size_of_val(part) + Memory::of_parry(&*part.1).bytes)
        .sum();
    size_of_val(compound)
        + parts
        + size_of_val(compound.aabbs())
        + compound.bvh().heap_memory_size()
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

#[cfg(test)]
mod tests {
    use rapier3d::math::Vector;
    use rapier3d::parry::shape::SharedShape;

    use super::*;

    #[test]
    fn larger_shapes_take_more_memory() {
        let cuboid = Memory::of_parry(&*SharedShape::cuboid(1.0, 1.0, 1.0));
        assert_eq!(
            (cuboid.bytes, cuboid.is_estimate),
            (size_of::<Vector>(), false)
        );
        let corners: Vec<_> = (0..8)
            .map(|i| Vector::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
            .collect();
        let hull = SharedShape::convex_hull(&corners).unwrap();
        let one = Memory::of_parry(&*hull);
        assert!(one.is_estimate && one.bytes > 8 * size_of::<Vector>());
        let at = |x: f32| (rapier3d::math::Pose::translation(x, 0.0, 0.0), hull.clone());
        let two = Memory::of_parry(&*SharedShape::compound(vec![at(0.0), at(2.0)]));
        assert!(two.is_estimate && two.bytes > 2 * one.bytes);
        assert_eq!(one.and(cuboid).bytes, one.bytes + cuboid.bytes);
    }
}
