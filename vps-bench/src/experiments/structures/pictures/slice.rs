//! A slice through the centre of the map, and its stored voxels.

use vps_core::raw::{CELL_EDGE_VOXELS, Store};
use vps_core::{DistanceField, Vec3, Voxelmap};

use super::{Panels, Subject, TEXT};
use crate::figures::render::colors::{self, Color};
use crate::figures::render::figure_sheet::{Anchor, FigureSheet};
use crate::figures::render::view::View;

/// Distance between two contour lines, in metres.
const CONTOUR_STEP_M: f32 = 0.02;

const SIDE: u32 = 520;

pub(super) fn draw(subject: &Subject<'_>) -> Result<FigureSheet, String> {
    let map = &subject.fine.voxelmap;
    let bounds = map.grid().bounds();
    let middle = bounds.min.midpoint(bounds.max);
    let extents = bounds.extents();
    let width = 1.02 * extents.truncate().max_element();
    let view = View::from(0.0, 0.0, middle, width);
    let is_inside = |p: Vec3| {
        (p - middle)
            .abs()
            .truncate()
            .cmple(0.5 * extents.truncate())
            .all()
    };
    let color_map = ColorMap::of(map);

    let mut panels = Panels::new(2, 2, [SIDE, SIDE], 66);
    let mut canvas = panels.canvas();
    let field = map.trilinear();
    let line = 0.5 * width / SIDE as f32;
    canvas.fill_background(&view, |point| {
        if !is_inside(point) {
            return colors::WHITE;
        }
        let value = field.penetration(point, Vec3::ZERO);
        let to_line =
            (value / CONTOUR_STEP_M - (value / CONTOUR_STEP_M).round()).abs() * CONTOUR_STEP_M;
        if value.abs() < 1.5 * line {
            colors::INK
        } else if to_line < 0.5 * line {
            color_map.color(value) * 0.75
        } else {
            color_map.color(value)
        }
    });
    let [nx, ny, nz] = map.grid().dims();
    let title = format!("penetration V, {nx} x {ny} x {nz} voxels");
    panels.push(&title, &canvas)?;

    let mut canvas = panels.canvas();
    canvas.fill_background(&view, |point| {
        if !is_inside(point) {
            return colors::WHITE;
        }
        let voxel = map.grid().voxel_at(point);
        let color = STORED[stored(map.store(), voxel) as usize].0;
        // Lines between cells, and the surface.
        let is_edge = [0, 1]
            .iter()
            .any(|&axis| voxel[axis] % CELL_EDGE_VOXELS == 0);
        if field.penetration(point, Vec3::ZERO).abs() < 1.5 * line {
            colors::INK
        } else if is_edge {
            color * 0.93
        } else {
            color
        }
    });
    panels.push("storage of each cell of 8 x 8 x 8 voxels", &canvas)?;
    let top = SIDE + Panels::HEAD + 8;
    color_map.draw(&mut panels.sheet, [60, top])?;
    let entries = STORED.map(|(color, text)| (color, text.to_owned()));
    panels.legend(&entries, [SIDE + 30, top + 4])?;
    Ok(panels.sheet)
}

/// How densely a voxel is stored.
#[derive(Clone, Copy)]
enum Stored {
    Lattice,
    Refined,
    All,
}

const STORED: [(Color, &str); 3] = [
    (colors::PALE, "1 value"),
    (colors::ORANGE, "28 values"),
    (colors::VERMILION, "every voxel"),
];

fn stored(store: &Store<'_>, voxel: [u32; 3]) -> Stored {
    let (groups, cells) = store.cells();
    if groups.is_empty() {
        return Stored::All;
    }
    let [nx, ny, _] = store.dims().map(|n| n.div_ceil(CELL_EDGE_VOXELS));
    let [x, y, z] = voxel.map(|c| c / CELL_EDGE_VOXELS);
    let cell = (z * ny + y) * nx + x;
    let (group, bit) = (&groups[cell as usize / 64], cell % 64);
    if group.refined >> bit & 1 == 0 {
        return Stored::Lattice;
    }
    let before = (group.refined & !(!0 << bit)).count_ones();
    let [x, y, z] = voxel.map(|c| c % CELL_EDGE_VOXELS / 2);
    let brick = (z * 4 + y) * 4 + x;
    if cells[(group.rank + before) as usize].bricks >> brick & 1 == 1 {
        Stored::All
    } else {
        Stored::Refined
    }
}

/// A colour map of penetrations: blue outside, orange inside.
struct ColorMap {
    min: f32,
    max: f32,
}

impl ColorMap {
    fn of(map: &Voxelmap<'_>) -> Self {
        let [nx, ny, nz] = map.grid().dims();
        let values = (0..ny).flat_map(|y| (0..nx).map(move |x| [x, y, nz / 2]));
        let values = values.map(|voxel| map.center_penetration(voxel));
        let (least, most) = values.fold((0.0_f32, 0.0_f32), |(least, most), v| {
            (least.min(v), most.max(v))
        });
        Self {
            min: (least / CONTOUR_STEP_M).floor() * CONTOUR_STEP_M,
            max: (most / CONTOUR_STEP_M).ceil() * CONTOUR_STEP_M,
        }
    }

    fn color(&self, value: f32) -> Color {
        if value < 0.0 {
            Color::new(0.93, 0.96, 0.98).lerp(colors::BLUE, (value / self.min).min(1.0))
        } else {
            Color::new(0.99, 0.93, 0.80).lerp(colors::VERMILION, (value / self.max).min(1.0))
        }
    }

    /// Draws two bars, since distances inside are much smaller than outside.
    fn draw(&self, sheet: &mut FigureSheet, [left, top]: [u32; 2]) -> Result<(), String> {
        let (length, gap) = (180, 20);
        for (x, from, to) in [(left, self.min, 0.0), (left + length + gap, 0.0, self.max)] {
            for i in 0..length {
                let value = from + (to - from) * (i as f32 + 0.5) / length as f32;
                sheet.rectangle([x + i, top], [1, 18], self.color(value));
            }
            for i in 0..=2 {
                let value = from + (to - from) * i as f32 / 2.0;
                let text = format!("{:.0}", 1e3 * value).replace('-', "−");
                let at = [x + length * i / 2, top + 24];
                sheet.text(&text, at, Anchor::Middle, TEXT)?;
            }
        }
        let unit = [left + 2 * length + gap + 28, top + 24];
        sheet.text("mm", unit, Anchor::Left, TEXT)
    }
}
