//! Solids of blocks: the frame of a cube, and a window.

use glamx::DVec3;

use crate::mesh::Mesh;

/// The frame of a cube of 1 m: its twelve edges as square bars of `bar` metres, from 0.01 to 0.4.
pub fn cube_frame(bar: f64) -> Mesh {
    let planes = planes(bar);
    blocks([planes; 3], |cell| {
        cell.iter().filter(|&&c| c != 1).count() >= 2
    })
}

/// A wall of 1 m in x and y and `thickness` metres in z, from 0.001 to 1, with a square window of
/// 0.5 m in its middle.
pub fn window(thickness: f64) -> Mesh {
    let half = 0.5 * thickness.clamp(0.001, 1.0);
    let sides = [-0.5, -0.25, 0.25, 0.5];
    // The wall is the middle one of three layers. The others are empty.
    let across = [-2.0, -half, half, 2.0];
    blocks([sides, sides, across], |[x, y, z]| {
        z == 1 && (x != 1 || y != 1)
    })
}

fn planes(bar: f64) -> [f64; 4] {
    let inner = 0.5 - bar.clamp(0.01, 0.4);
    [-0.5, -inner, inner, 0.5]
}

/// The surface of the solid ones among 3 x 3 x 3 blocks between planes.
fn blocks(planes: [[f64; 4]; 3], is_solid: impl Fn([usize; 3]) -> bool) -> Mesh {
    let solid = |cell: [i32; 3]| {
        let is_there = cell.iter().all(|c| (0..3).contains(c));
        is_there && is_solid(cell.map(|c| c as usize))
    };
    // Numbers of the corners of blocks, x first, once used.
    let mut number = [u32::MAX; 64];
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    let mut vertex = |corner: [i32; 3]| {
        let [x, y, z] = corner.map(|c| c as usize);
        let number = &mut number[(z * 4 + y) * 4 + x];
        if *number == u32::MAX {
            *number = vertices.len() as u32;
            vertices.push(DVec3::new(planes[0][x], planes[1][y], planes[2][z]));
        }
        *number
    };
    for index in 0..27 {
        let cell = [index % 3, index / 3 % 3, index / 9];
        for axis in (0..3).filter(|_| solid(cell)) {
            for side in [0, 1] {
                let mut next = cell;
                next[axis] += 2 * side - 1;
                if solid(next) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let corner = |a: i32, b: i32| {
                    let mut corner = cell;
                    corner[axis] += side;
                    corner[u] += a;
                    corner[v] += b;
                    corner
                };
                let mut face = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                if side == 0 {
                    face.reverse();
                }
                let [a, b, c, d] = face.map(&mut vertex);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    Mesh::new(&vertices, &triangles).expect("blocks have faces")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::tests::{close, volume_of};

    #[test]
    fn frames_and_windows_are_closed_and_have_their_volume() {
        for bar in [0.05, 0.2] {
            let mesh = cube_frame(bar);
            // Twelve bars between the corners, and eight corners.
            let volume = 12.0 * bar * bar * (1.0 - 2.0 * bar) + 8.0 * bar.powi(3);
            close(volume_of(&mesh, 5), volume, 1e-9);
        }
        let mesh = window(0.1);
        close(volume_of(&mesh, 1), 0.075, 1e-9);
    }
}
