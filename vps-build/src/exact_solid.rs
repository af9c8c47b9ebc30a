use std::borrow::Cow;

use glamx::DVec3;

use crate::build::{grid, voxel_size};
use crate::bvh::Bvh;
use crate::flat::refuse_sheet;
use crate::health::UnionFind;
use crate::solid::{solid, surface};
use crate::solid_angle::SolidAngle;
use crate::winding::Lines;
use crate::{BuildError, BuildOptions, Mesh, Repairs, Sign, frame};

/// The solid a mesh means, as exactly as it is known before any voxel: distances to its triangles,
/// and winding numbers. It is what the values of a voxelmap are measured against.
pub struct ExactSolid {
    surface: Mesh,
    bvh: Bvh,
    inside: Inside,
    bounds: (DVec3, DVec3),
    parts: Vec<DVec3>,
    repairs: Repairs,
}

/// What tells inside from outside.
enum Inside {
    Winding(Lines<'static>),
    Generalized(SolidAngle<'static>),
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
        refuse_sheet(mesh)?;
        let options = BuildOptions::default();
        let (local, origin) = frame::local(mesh, voxel_size(mesh, &options)?);
        let grid = grid(&local, &options, 0.0)?;
        let solid = solid(&local, sign, &grid, options.memory_limit)?;
        let shown = solid.mesh.moved(origin);
        // Winding numbers are those of the closed surface, with what is hidden within the solid.
        let closed = if solid.is_closed {
            shown.clone()
        } else {
            surface(&local, sign, &grid, &mut Repairs::default())?.moved(origin)
        };
        let inside = if solid.repairs.left_open {
            Inside::Generalized(SolidAngle::of(Cow::Owned(closed)))
        } else {
            Inside::Winding(Lines::of(Cow::Owned(closed)))
        };
        Ok(Self {
            bvh: Bvh::new(&shown),
            bounds: shown.bounds(),
            parts: a_point_of_each_part(&shown),
            surface: shown,
            inside,
            repairs: solid.repairs,
        })
    }

    /// The triangles that bound the solid.
    pub fn surface(&self) -> &Mesh {
        &self.surface
    }

    /// A corner of each part of the surface that hangs together.
    pub fn parts(&self) -> &[DVec3] {
        &self.parts
    }

    /// What was done to the mesh first.
    pub fn repairs(&self) -> Repairs {
        self.repairs
    }

    /// How deep a point is; `guess` is a triangle that may be close.
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
            Inside::Winding(lines) => lines.winding(point, |_| true) >= 1,
            Inside::Generalized(angle) => angle.winding(point) > 0.5,
        }
    }
}

fn a_point_of_each_part(mesh: &Mesh) -> Vec<DVec3> {
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
        assert!(one.repairs().united);
        // In both balls, and deep in what they are together.
        let depth = one.penetration(DVec3::X * 0.25, 0).penetration_m;
        assert!((depth - 0.94).abs() < 0.05, "{depth}");
    }
}
