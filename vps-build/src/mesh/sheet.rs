//! Sheets: meshes of no thickness.

use glamx::DVec3;

use super::Mesh;
use super::triangle::{area, normal};
use crate::error::BuildError;

/// Thickness of a sheet at most, relative to its longest side: the rounding of six-digit numbers.
pub(crate) const SHEET_THICKNESS: f64 = 1e-5;

/// Rejects sheets.
///
/// # Errors
/// When the mesh lies in a plane of any orientation, and so bounds no solid.
pub(crate) fn reject_sheet(mesh: &Mesh) -> Result<(), BuildError> {
    let triangles = (0..mesh.triangles().len()).map(|t| mesh.corners(t));
    let largest = triangles.max_by(|&s, &t| area(s).total_cmp(&area(t)));
    let largest = largest.unwrap_or_else(|| mesh.corners(0));
    let (across, on) = (normal(largest), largest[0]);
    let (low, high) = mesh.bounds();
    let heights = mesh.vertices().iter().map(|&v| (v - on).dot(across));
    let (lowest, highest) = heights.fold((0.0_f64, 0.0_f64), |(lowest, highest), height| {
        (lowest.min(height), highest.max(height))
    });
    let longest_m = DVec3::max_element(high - low);
    let thickness_m = highest - lowest;
    if thickness_m <= SHEET_THICKNESS * longest_m {
        return Err(BuildError::Sheet {
            thickness_m,
            longest_m,
        });
    }
    Ok(())
}

/// Whether the mean thickness of a closed mesh is that of a sheet.
pub(crate) fn encloses_sheet(mesh: &Mesh) -> bool {
    let (low, high) = mesh.bounds();
    2.0 * mesh.volume() <= SHEET_THICKNESS * (high - low).max_element() * mesh.area()
}

#[cfg(test)]
mod tests {
    use glamx::DQuat;

    use super::*;

    #[test]
    fn sheets_of_any_orientation_are_refused_and_plates_are_not() {
        let turns = [
            DQuat::IDENTITY,
            DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
            DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(0.3),
        ];
        let is_sheet = |mesh: &Mesh| matches!(reject_sheet(mesh), Err(BuildError::Sheet { .. }));
        let sheet = Mesh::cuboid([2.0, 1.0, 0.0]).unwrap();
        let plate = Mesh::cuboid([2.0, 1.0, 1e-4]).unwrap();
        for turn in turns {
            let turned = |mesh: &Mesh| {
                let vertices: Vec<_> = mesh.vertices().iter().map(|&v| turn * v + 3.0).collect();
                Mesh::new(&vertices, mesh.triangles()).unwrap()
            };
            assert!(is_sheet(&turned(&sheet)));
            assert!(!is_sheet(&turned(&plate)));
            let one_side = Mesh::new(turned(&sheet).vertices(), &sheet.triangles()[8..9]).unwrap();
            assert!(is_sheet(&one_side));
        }
        // On a slanted line.
        let line = [DVec3::ZERO, DVec3::ONE, DVec3::splat(2.0)];
        let line = Mesh::new(&line, &[[0, 1, 2]]).unwrap();
        assert!(is_sheet(&line));
    }
}
