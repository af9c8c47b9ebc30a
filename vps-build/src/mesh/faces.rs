//! Triangles as triples of vertex indices.

/// Whether the three vertices are distinct.
pub(crate) fn has_distinct_corners(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// The rotation of a triangle that starts at its lowest vertex. Keeps the orientation.
pub(crate) fn canonical_rotation([a, b, c]: [u32; 3]) -> [u32; 3] {
    [[a, b, c], [b, c, a], [c, a, b]]
        .into_iter()
        .fold([a, b, c], Ord::min)
}
