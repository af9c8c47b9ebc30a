//! The voxels of a coarse map, coloured by layer.

use vps_build::{BuildOptions, Density, Encoding, PointCount, Resolution};
use vps_core::{Vec3, Voxelmap};

use super::{Panels, Subject, TEXT, cached};
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::{Anchor, FigureSheet};
use crate::figures::render::view::View;

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let options = BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(subject.settings.drawn_voxels),
        // The surface may reach into the first layer around it.
        margin: 2,
        points: PointCount::About(1),
        encoding: Encoding::Layers,
        density: Density::Dense,
        ..BuildOptions::default()
    };
    let asset = cached(subject.context, &subject.body.mesh, &options)?;
    let map = &asset.voxelmap;
    let view = subject.view(1.42);
    let [nx, ny, nz] = map.grid().dims();
    let voxels =
        || (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let deepest = voxels().map(|voxel| layer(map, voxel)).max().unwrap_or(0);
    let color = |layer: i32| {
        if layer == 0 {
            colors::SKY
        } else {
            colors::ramp(1.0 - (layer - 1) as f32 / (deepest - 1).max(1) as f32)
        }
    };
    let mut panels = Panels::new(2, 2, [520, 470], 60);
    let halves = [
        ("surface voxels", nz),
        ("surface and inner layers, cut open", nz / 2),
    ];
    for (title, end) in halves {
        let mut canvas = panels.canvas();
        let is_drawn = |[x, y, z]: [u32; 3]| z < end && layer(map, [x, y, z]) >= 0;
        for voxel in voxels().filter(|v| is_drawn(*v)) {
            let color = color(layer(map, voxel));
            cube(&mut canvas, &view, map, voxel, color, &is_drawn);
        }
        panels.push(title, &canvas)?;
    }
    // One rectangle for each layer.
    let top = 470 + Panels::HEAD + 8;
    let each = 26;
    let left = 520 - each * (deepest as u32 + 1) / 2;
    panels
        .sheet
        .text("layer v", [left - 70, top + 3], Anchor::Left, TEXT)?;
    for v in 0..=deepest {
        let x = left + each * v as u32;
        panels.sheet.rectangle([x, top], [each - 3, 20], color(v));
        let at = [x + each / 2, top + 24];
        panels
            .sheet
            .text(&v.to_string(), at, Anchor::Middle, TEXT)?;
    }
    Ok(panels.sheet)
}

fn layer(map: &Voxelmap<'_>, voxel: [u32; 3]) -> i32 {
    map.store().value(voxel).round() as i32
}

/// Shading of the faces of voxels by axis; the faces of the cut have the colours of the legend.
const SHADES: [f32; 3] = [0.7, 0.88, 1.0];

/// Draws the visible faces of a voxel, a little smaller so that voxels can be told apart.
fn cube(
    canvas: &mut Canvas,
    view: &View,
    map: &Voxelmap<'_>,
    voxel: [u32; 3],
    color: Color,
    is_drawn: &dyn Fn([u32; 3]) -> bool,
) {
    let half = 0.5 * map.grid().voxel_size();
    let center = map.grid().center(voxel);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let mut next = voxel;
            // The outermost layer of the map is never drawn, so that every face has a neighbour.
            next[axis] = next[axis].wrapping_add_signed(side as i32);
            if is_drawn(next) {
                continue;
            }
            let mut out = Vec3::ZERO;
            out[axis] = side * half;
            let (mut a, mut b) = (Vec3::ZERO, Vec3::ZERO);
            a[(axis + 1) % 3] = half;
            b[(axis + 2) % 3] = half;
            let square = |inner: f32, lift: f32| {
                let (a, b) = (a * inner, b * inner);
                let middle = center + out * lift;
                [
                    middle + a + b,
                    middle - a + b,
                    middle - a - b,
                    middle + a - b,
                ]
            };
            let color = color * SHADES[axis];
            for ([p, q, r, s], color) in [
                (square(1.0, 1.0), color * 0.55),
                (square(0.86, 1.02), color),
            ] {
                canvas.unlit_triangle(view, [p, q, r], color);
                canvas.unlit_triangle(view, [p, r, s], color);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use vps_build::{Mesh, build};

    use super::*;

    /// The layer increases by one with each voxel inwards.
    #[test]
    fn no_layer_is_missing() {
        let mesh = Mesh::cuboid([0.21; 3]).unwrap();
        // Some multiples of this voxel size are rounded down in 32 bits. Only a dense map holds
        // every layer: a sparse one interpolates them inside.
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(41),
            margin: 2,
            points: PointCount::About(1),
            encoding: Encoding::Layers,
            density: Density::Dense,
            ..BuildOptions::default()
        };
        let asset = build(&mesh, &options, &|_| ()).unwrap().asset;
        let [nx, ny, nz] = asset.voxelmap.grid().dims();
        let row = (0..nx).map(|x| layer(&asset.voxelmap, [x, ny / 2, nz / 2]));
        let row: Vec<_> = row.collect();
        // Once on the way in and once on the way out.
        let deepest = row.iter().copied().max().unwrap();
        assert!(deepest >= 19, "{row:?}");
        for inner in 1..=deepest {
            let count = row.iter().filter(|v| **v == inner).count();
            assert!((1..=2).contains(&count), "layer {inner}: {row:?}");
        }
    }
}
