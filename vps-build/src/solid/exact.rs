//! Exact depths of points in a solid, without voxels.

use std::borrow::Cow;

use glamx::DVec3;

use super::fast_winding::FastWinding;
use super::repair::{Repairs, surface};
use super::solid;
use super::winding::ScanlineIndex;
use crate::error::BuildError;
use crate::grid::{grid, voxel_size};
use crate::mesh::sheet::reject_sheet;
use crate::mesh::union_find::UnionFind;
use crate::mesh::{Mesh, frame};
use crate::options::{BuildOptions, Sign};
use crate::spatial::bvh::Bvh;

/// The exact solid of a mesh: distances to its triangles, and winding numbers. The reference for the
/// values of a voxelmap.
pub struct ExactSolid {
    surface: Mesh,
    bvh: Bvh,
    inside: Inside,
    bounds: (DVec3, DVec3),
    parts: Vec<DVec3>,
    repairs: Repairs,
}

/// The classification of inside and outside.
enum Inside {
    Winding(ScanlineIndex<'static>),
    Generalized(FastWinding<'static>),
}

/// How deep a point is in a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// The distance to the surface in metres, positive inside.
    pub penetration_m: f64,
    /// The triangle of [`ExactSolid::surface`] that is closest.
    pub triangle: usize,
}

impl ExactSolid {
    /// The solid of a mesh, which is repaired as for an asset if it is not clean.
    ///
    /// # Errors
    /// When the mesh encloses nothing.
    pub fn new(mesh: &Mesh, sign: Sign) -> Result<Self, BuildError> {
        reject_sheet(mesh)?;
        let options = BuildOptions::default();
        let (local, origin) = frame::to_local(mesh, voxel_size(mesh, &options)?);
        let grid = grid(&local, &options, 0.0)?;
        let solid = solid(&local, sign, &grid, options.memory_limit)?;
        let boundary = solid.mesh.translated(origin);
        // Winding numbers are those of the closed surface, hidden faces included.
        let closed = if solid.is_closed {
            boundary.clone()
        } else {
            surface(&local, sign, &grid, &mut Repairs::default())?.translated(origin)
        };
        let inside = if solid.repairs.left_open {
            Inside::Generalized(FastWinding::of(Cow::Owned(closed)))
        } else {
            Inside::Winding(ScanlineIndex::of(Cow::Owned(closed)))
        };
        Ok(Self {
            bvh: Bvh::new(&boundary),
            bounds: boundary.bounds(),
            parts: a_vertex_of_each_component(&boundary),
            surface: boundary,
            inside,
            repairs: solid.repairs,
        })
    }

    /// The triangles that bound the solid.
    pub fn surface(&self) -> &Mesh {
        &self.surface
    }

    /// A vertex of each connected component of the surface.
    pub fn parts(&self) -> &[DVec3] {
        &self.parts
    }

    /// The repairs made to the mesh.
    pub fn repairs(&self) -> Repairs {
        self.repairs
    }

    /// How deep a point is. `guess` is a triangle of the surface; a close one speeds up the search.
    pub fn penetration(&self, point: DVec3, guess: usize) -> Penetration {
        let guess = guess.min(self.surface.triangles().len() - 1);
        let closest = self.bvh.closest(point, guess as u32);
        let is_inside = self.contains(point);
        Penetration {
            penetration_m: if is_inside {
                closest.distance
            } else {
                -closest.distance
            },
            triangle: closest.triangle as usize,
        }
    }

    /// Whether a point is inside.
    pub fn contains(&self, point: DVec3) -> bool {
        let (low, high) = self.bounds;
        if !(point.cmpge(low).all() && point.cmple(high).all()) {
            return false;
        }
        match &self.inside {
            Inside::Winding(scanlines) => scanlines.winding(point, |_| true) >= 1,
            Inside::Generalized(fast_winding) => fast_winding.winding(point) > 0.5,
        }
    }
}

fn a_vertex_of_each_component(mesh: &Mesh) -> Vec<DVec3> {
    let mut parts = UnionFind::new(mesh.vertices().len());
    for &[a, b, c] in mesh.triangles() {
        parts.join(a, b);
        parts.join(b, c);
    }
    let mut roots: Vec<u32> = mesh.triangles().iter().map(|t| parts.root(t[0])).collect();
    roots.sort_unstable();
    roots.dedup();
    roots.iter().map(|&v| mesh.vertices()[v as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(mesh: &Mesh, by: DVec3) -> Vec<DVec3> {
        mesh.vertices().iter().map(|v| *v + by).collect()
    }

    #[test]
    fn a_box_is_as_deep_as_the_formula_says() {
        let solid = ExactSolid::new(&Mesh::cuboid([2.0, 1.0, 3.0]).unwrap(), Sign::Auto).unwrap();
        assert!(solid.repairs().is_none());
        let half = DVec3::new(1.0, 0.5, 1.5);
        for i in 0..1000 {
            let turn = f64::from(i) * 2.4;
            let p = DVec3::new(turn.sin(), (turn * 1.3).cos(), (turn * 0.7).sin()) * 2.0;
            let beyond = p.abs() - half;
            let outside = beyond.max(DVec3::ZERO).length();
            let expected = -(outside + beyond.max_element().min(0.0));
            let found = solid.penetration(p, i as usize).penetration_m;
            assert!((found - expected).abs() < 1e-12, "{p}: {found}, {expected}");
        }
    }

    #[test]
    fn far_away_it_is_as_exact() {
        let cuboid = Mesh::cuboid([2.0, 1.0, 3.0]).unwrap();
        let at = DVec3::new(5e6, -4e6, 3e6);
        let far = Mesh::new(&moved(&cuboid, at), cuboid.triangles()).unwrap();
        let solid = ExactSolid::new(&far, Sign::Auto).unwrap();
        for (place, expected) in [
            (DVec3::ZERO, 0.5),
            (DVec3::Z * 1.75, -0.25),
            (DVec3::X, 0.0),
        ] {
            let found = solid.penetration(at + place, 0).penetration_m;
            assert!((found - expected).abs() < 1e-8, "{place}: {found}");
        }
        assert_eq!(solid.surface().bounds(), far.bounds());
    }

    #[test]
    fn parts_that_overlap_are_one_solid_and_those_apart_have_a_point_each() {
        let ball = Mesh::icosphere(1.0, 3).unwrap();
        let of_two = |by: f64| {
            let vertices = [ball.vertices(), &moved(&ball, DVec3::X * by)].concat();
            let second = ball.triangles().iter();
            let second: Vec<_> = second
                .map(|t| t.map(|v| v + ball.vertices().len() as u32))
                .collect();
            let triangles = [ball.triangles(), &second].concat();
            ExactSolid::new(&Mesh::new(&vertices, &triangles).unwrap(), Sign::Auto).unwrap()
        };
        let apart = of_two(3.0);
        assert_eq!(apart.parts().len(), 2);
        assert!(!apart.contains(DVec3::X * 1.5));
        let one = of_two(0.5);
        assert!(one.repairs().merged);
        // In both balls, and deep in their union.
        let depth = one.penetration(DVec3::X * 0.25, 0).penetration_m;
        assert!((depth - 0.94).abs() < 0.05, "{depth}");
    }
}
