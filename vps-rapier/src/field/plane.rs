//! A surface that is one plane, as far as it matters.

use vps_core::{Aabb, Vec3};

use super::bounds::clip_segment;
use super::facet::Facet;

/// The plane all facets near a box lie in.
pub(crate) struct Plane {
    /// Unit normal out of the side the facets face.
    pub(crate) normal: Vec3,
    /// Height of the plane above the origin, along the normal, in metres.
    offset: f32,
}

impl Plane {
    /// The common plane of all facets, if they end nowhere within `reach` of the box `region`, and the
    /// box reaches no deeper below them than they are known to be solid.
    pub(crate) fn of_facets(
        facets: &[Facet],
        region: &Aabb,
        [reach, thickness]: [f32; 2],
        error: f32,
    ) -> Option<Self> {
        let first = facets.first()?;
        let normal = first.normal;
        let within = Aabb {
            min: region.min - reach,
            max: region.max + reach,
        };
        let is_coplanar = |f: &Facet| {
            let is_on = |corner: Vec3| first.height(corner).abs() <= error;
            f.corners.into_iter().all(is_on) && f.normal.dot(normal) > 0.0
        };
        let ends = |f: &Facet| {
            let meets = |i: usize| {
                let (start, end) = (f.corners[i], f.corners[(i + 1) % 3]);
                clip_segment(start, end - start, &within).is_some()
            };
            (0..3).any(|i| f.edges[i].is_border && meets(i))
        };
        let half = 0.5 * region.extents();
        let lowest = first.height(region.center()) - half.dot(normal.abs());
        let is_plane = facets.iter().all(is_coplanar)
            && lowest >= -reach.min(thickness)
            && !facets.iter().any(ends);
        is_plane.then(|| Self {
            normal,
            offset: first.corners[0].dot(normal),
        })
    }

    #[inline]
    pub(crate) fn penetration(&self, point: Vec3) -> f32 {
        self.offset - point.dot(self.normal)
    }
}
