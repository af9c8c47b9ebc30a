//! Solids of exactly known penetration.

use rapier3d::glamx::{DQuat, DVec2, DVec3};
use serde::{Deserialize, Serialize};
use vps_build::{Mesh, models};
use vps_core::{Aabb, DistanceField, FieldFn, Vec3};

/// A solid around the origin, 0.2 m wide.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Shape {
    /// Constant curvature.
    Ball,
    /// Flat with sharp edges, rotated against the voxel grid.
    Cuboid,
    /// Convex outside and saddle-shaped around its hole.
    Torus,
}

/// Half of the width of all shapes, in metres.
pub(super) const SIZE: f64 = 0.1;
const HALF_EXTENTS: DVec3 = DVec3::new(0.08, 0.05, 0.035);
const RING: f64 = 0.07;
const TUBE: f64 = 0.03;

impl Shape {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Ball => "ball",
            Self::Cuboid => "cuboid",
            Self::Torus => "torus",
        }
    }

    /// The solid as a mesh whose vertices are on the surface and whose triangles are within 5 µm of
    /// it.
    pub(super) fn mesh(self) -> Result<Mesh, String> {
        let mesh = match self {
            Self::Ball => Mesh::icosphere(SIZE, 7),
            Self::Cuboid => Mesh::cuboid((2.0 * HALF_EXTENTS).to_array()).and_then(|mesh| {
                let turned: Vec<_> = mesh
                    .vertices()
                    .iter()
                    .map(|v| cuboid_rotation() * *v)
                    .collect();
                Mesh::new(&turned, mesh.triangles())
            }),
            Self::Torus => models::torus(512).scaled(0.2),
        };
        mesh.map_err(|e| e.to_string())
    }

    /// The penetration of a point in metres, positive inside.
    pub(super) fn penetration(self, point: DVec3) -> f64 {
        match self {
            Self::Ball => SIZE - point.length(),
            Self::Cuboid => {
                let beyond = (cuboid_rotation().inverse() * point).abs() - HALF_EXTENTS;
                -(beyond.max(DVec3::ZERO).length() + beyond.max_element().min(0.0))
            }
            Self::Torus => TUBE - DVec2::new(point.truncate().length() - RING, point.z).length(),
        }
    }

    /// The direction of increasing penetration, of length one.
    pub(super) fn inward(self, point: DVec3) -> DVec3 {
        const STEP: f64 = 1e-7;
        let along = |axis: DVec3| {
            self.penetration(point + axis * STEP) - self.penetration(point - axis * STEP)
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z)).normalize_or_zero()
    }

    /// The support function: the extent of the solid in a direction of length one.
    pub(super) fn support(self, direction: DVec3) -> f64 {
        match self {
            Self::Ball => SIZE,
            Self::Cuboid => HALF_EXTENTS.dot((cuboid_rotation().inverse() * direction).abs()),
            Self::Torus => RING * direction.truncate().length() + TUBE,
        }
    }

    /// The exact field, in 32 bits.
    pub(super) fn field(self) -> impl DistanceField {
        let bounds = Aabb {
            min: Vec3::splat(-SIZE as f32),
            max: Vec3::splat(SIZE as f32),
        };
        let penetration = move |p: Vec3| self.penetration(p.as_dvec3()) as f32;
        FieldFn::new(penetration, 1.0, bounds, 1e-7)
    }
}

/// The rotation of the cuboid: no face is parallel to the grid.
fn cuboid_rotation() -> DQuat {
    DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Shape; 3] = [Shape::Ball, Shape::Cuboid, Shape::Torus];

    #[test]
    fn triangles_are_on_the_surface() {
        for shape in ALL {
            let mesh = shape.mesh().unwrap();
            assert_eq!(mesh.open_edges(), 0);
            for v in mesh.vertices() {
                let penetration = shape.penetration(*v);
                assert!(penetration.abs() < 1e-9, "{shape:?}: {penetration}");
            }
            if shape == Shape::Cuboid {
                continue;
            }
            for t in (0..mesh.triangles().len()).step_by(7) {
                let middle = mesh.corners(t).into_iter().sum::<DVec3>() / 3.0;
                let penetration = shape.penetration(middle);
                assert!(penetration.abs() < 5e-6, "{shape:?}: {penetration}");
            }
        }
    }

    #[test]
    fn the_support_is_that_of_the_vertices() {
        for shape in ALL {
            let mesh = shape.mesh().unwrap();
            for direction in [DVec3::X, DVec3::Z, DVec3::new(-1.0, 2.0, 0.5).normalize()] {
                let along = mesh.vertices().iter().map(|v| v.dot(direction));
                let furthest = along.fold(f64::NEG_INFINITY, f64::max);
                let reach = shape.support(direction);
                assert!((reach - furthest).abs() < 2e-5, "{shape:?}: {reach}");
            }
        }
    }

    #[test]
    fn a_step_inwards_is_deeper_by_its_length() {
        for shape in ALL {
            let point = DVec3::new(0.061, 0.033, 0.027);
            let inward = shape.inward(point);
            let gained = shape.penetration(point + inward * 1e-4) - shape.penetration(point);
            assert!((gained - 1e-4).abs() < 1e-9, "{shape:?}: {gained}");
        }
    }
}
