//! Mass properties of a solid at density one.

use glamx::{DMat3, DVec3};
use rayon::prelude::*;
use vps_core::{MassProperties, Voxelmap};

use super::Mesh;
use crate::error::BuildError;

/// Volume, centre of mass and inertia at density one. Exact for a closed mesh that faces outwards:
/// sums over the tetrahedra between an inner point and each triangle.
///
/// # Errors
/// When the mesh is open or has no positive volume.
pub fn mass_properties(mesh: &Mesh) -> Result<MassProperties, BuildError> {
    match mesh.open_edges() {
        0 => mass_of_mesh(mesh),
        open => Err(BuildError::Open(open)),
    }
}

/// As [`mass_properties`], for a mesh known to be closed.
pub(crate) fn mass_of_mesh(mesh: &Mesh) -> Result<MassProperties, BuildError> {
    let (low, high) = mesh.bounds();
    let origin = low.midpoint(high);
    let (mut volume, mut moment, mut covariance) = (0.0, DVec3::ZERO, DMat3::ZERO);
    for t in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.corners(t).map(|v| v - origin);
        let six_volumes = a.dot(b.cross(c));
        let sum = a + b + c;
        volume += six_volumes / 6.0;
        moment += six_volumes / 24.0 * sum;
        // ∫ p pᵀ over the tetrahedron.
        let products = [a, b, c, sum].map(|v| outer(v, v));
        let all = products[0] + products[1] + products[2] + products[3];
        covariance += all * (six_volumes / 120.0);
    }
    properties(origin, volume, moment, covariance)
}

/// The mass properties of a solid given by its field, for a surface that is open or overlaps: sums
/// over voxels, with partial volumes at the surface.
pub(crate) fn mass_of_field(map: &Voxelmap<'_>) -> Result<MassProperties, BuildError> {
    let grid = map.grid();
    let origin = grid.bounds().center().as_dvec3();
    let size = f64::from(grid.voxel_size());
    let [nx, ny, nz] = grid.dims();
    let slice = |z: u32| {
        let (mut volume, mut moment, mut covariance) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for voxel in (0..ny).flat_map(|y| (0..nx).map(move |x| [x, y, z])) {
            let depth = f64::from(map.center_penetration(voxel)) / size;
            let part = (depth + 0.5).clamp(0.0, 1.0) * size.powi(3);
            let at = grid.center(voxel).as_dvec3() - origin;
            volume += part;
            moment += at * part;
            covariance += (outer(at, at) + DMat3::IDENTITY * (size * size / 12.0)) * part;
        }
        (volume, moment, covariance)
    };
    let slices: Vec<_> = (0..nz).into_par_iter().map(slice).collect();
    let nothing = (0.0, DVec3::ZERO, DMat3::ZERO);
    let (volume, moment, covariance) = slices
        .into_iter()
        .fold(nothing, |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
    properties(origin, volume, moment, covariance)
}

/// From the volume, ∫ p and ∫ p pᵀ about `origin`.
fn properties(
    origin: DVec3,
    volume: f64,
    moment: DVec3,
    mut covariance: DMat3,
) -> Result<MassProperties, BuildError> {
    let center = moment / volume;
    covariance -= outer(center, center) * volume;
    let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
    let diagonal = |i: usize| trace - covariance.col(i)[i];
    let inertia = [
        diagonal(0),
        diagonal(1),
        diagonal(2),
        -covariance.col(0)[1],
        -covariance.col(0)[2],
        -covariance.col(1)[2],
    ];
    let sound = volume > 0.0 && (0..3).all(|i| inertia[i] > 0.0);
    if !sound {
        return Err(BuildError::NotSolid);
    }
    let fits = |value: f64| (value as f32).is_finite() && (value as f32) > 0.0;
    if !(fits(volume) && inertia[..3].iter().all(|&i| fits(i))) {
        return Err(BuildError::Size { volume_m3: volume });
    }
    Ok(MassProperties {
        volume: volume as f32,
        center_of_mass: (origin + center).as_vec3().to_array(),
        inertia: inertia.map(|i| i as f32),
    })
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_and_a_ball_have_the_textbook_values() {
        let properties = mass_properties(&Mesh::cuboid([1.0, 2.0, 3.0]).unwrap()).unwrap();
        assert!((properties.volume - 6.0).abs() < 1e-6);
        for (value, expected) in properties
            .inertia
            .iter()
            .zip([6.5, 5.0, 2.5, 0.0, 0.0, 0.0])
        {
            assert!((value - expected).abs() < 1e-5, "{value} {expected}");
        }
        let ball = mass_properties(&Mesh::icosphere(0.5, 5).unwrap()).unwrap();
        let volume = std::f32::consts::PI / 6.0;
        assert!((ball.volume / volume - 1.0).abs() < 2e-3);
        assert!((ball.inertia[0] / (0.1 * volume) - 1.0).abs() < 4e-3);
    }

    #[test]
    fn moving_changes_only_the_centre() {
        let mesh = Mesh::cuboid([1.0, 2.0, 3.0]).unwrap();
        let moved: Vec<_> = mesh
            .vertices()
            .iter()
            .map(|&v| v + DVec3::new(5.0, -7.0, 9.0))
            .collect();
        let moved = Mesh::new(&moved, mesh.triangles()).unwrap();
        let [a, b] = [mesh, moved].map(|m| mass_properties(&m).unwrap());
        assert_eq!(b.center_of_mass, [5.0, -7.0, 9.0]);
        for (a, b) in a.inertia.iter().zip(b.inertia) {
            assert!((a - b).abs() < 1e-4);
        }
    }

    #[test]
    fn sizes_beyond_32_bits_are_refused() {
        for size in [1e9, 1e-12] {
            let mesh = Mesh::cuboid([size; 3]).unwrap();
            let error = mass_properties(&mesh).unwrap_err();
            assert!(matches!(error, BuildError::Size { .. }), "{error}");
        }
    }

    #[test]
    fn an_open_sheet_has_none() {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let sheet = Mesh::new(&v, &[[0, 1, 2]]).unwrap();
        assert_eq!(mass_properties(&sheet), Err(BuildError::Open(3)));
    }
}
