//! Ids of the samples of edges, by which their contacts are recognised in the next step.

use rapier3d::parry::shape::PackedFeatureId;

/// Bits of the number of a sample on its edge.
const SAMPLE_BITS: u32 = 13;

/// Bits of the number of an edge of its element. A circle has the most edges, 64.
const EDGE_BITS: u32 = 6;

/// Bits of a feature id of parry without its kind.
const FEATURE_BITS: u32 = 30;

/// Bits of the number of an element in the feature id of its own shape. Higher bits are in the other.
const ELEMENT_BITS: u32 = FEATURE_BITS - EDGE_BITS;

/// Bits of the coordinate of a voxel along an axis. Voxels further apart have the same number.
const VOXEL_BITS: u32 = 13;

/// Largest number of a sample on its edge.
pub(crate) const MAX_SAMPLE: u32 = (1 << SAMPLE_BITS) - 1;

/// Largest number of an edge of an element.
pub(crate) const MAX_EDGE: u32 = (1 << EDGE_BITS) - 1;

/// Numbers of the elements of a shape or of one part of it: triangles of a mesh, voxels, segments of a
/// polyline, edges of a polyhedron. A shape of a single element has element 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Elements {
    first: u64,
    stride: u64,
}

impl Elements {
    /// Those of a shape as a whole.
    pub(crate) const ALL: Self = Self {
        first: 0,
        stride: 1,
    };

    /// Those of one of `count` parts, which alternate with those of the other parts.
    pub(crate) fn of_part(self, part: usize, count: usize) -> Self {
        Self {
            first: self.number(part as u64),
            stride: self.stride.wrapping_mul(count as u64),
        }
    }

    pub(crate) fn element(self, number: u64) -> Element {
        Element(self.number(number))
    }

    /// The voxel of given coordinates in its grid, in two's complement.
    pub(crate) fn voxel(self, coordinates: [u64; 3]) -> Element {
        let [x, y, z] = coordinates.map(|c| c & ((1 << VOXEL_BITS) - 1));
        self.element(x | y << VOXEL_BITS | z << (2 * VOXEL_BITS))
    }

    fn number(self, element: u64) -> u64 {
        self.first.wrapping_add(self.stride.wrapping_mul(element))
    }
}

/// An element of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element(u64);

impl Element {
    pub(crate) fn edge(self, number: u32) -> EdgeId {
        debug_assert!(number <= MAX_EDGE, "edge {number} of an element");
        EdgeId {
            element: self.0,
            edge: number,
        }
    }
}

/// An edge of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeId {
    element: u64,
    edge: u32,
}

impl EdgeId {
    pub(crate) fn sample(self, number: u32) -> SampleId {
        debug_assert!(number <= MAX_SAMPLE, "sample {number} of an edge");
        SampleId { edge: self, number }
    }
}

/// A sample of an edge of a shape.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleId {
    edge: EdgeId,
    number: u32,
}

impl SampleId {
    /// Feature ids of a contact on the sampled shape, which tells the edge, and on the other shape,
    /// which tells the sample on it. No two samples have the same pair of ids as long as
    /// - a shape has fewer than 2^41 elements, times the number of parts in a compound, and
    /// - the voxels of a grid that are near the other shape are at most 8192 along each axis.
    ///
    /// Two samples with the same ids may swap the impulses the solver starts with, and one of them
    /// may take the place of the other among persistent contacts. Both are contacts all the same.
    pub(crate) fn features(self) -> [PackedFeatureId; 2] {
        let EdgeId { element, edge } = self.edge;
        let low = (element & ((1 << ELEMENT_BITS) - 1)) as u32;
        let high = (element >> ELEMENT_BITS) & ((1 << (FEATURE_BITS - SAMPLE_BITS)) - 1);
        let on_shape = low << EDGE_BITS | edge;
        let on_other = (high as u32) << SAMPLE_BITS | self.number;
        [on_shape, on_other].map(PackedFeatureId::edge)
    }
}
