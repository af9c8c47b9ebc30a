//! Pictures of an asset, in the order of the paper's figures.

mod fall;
mod levels;
mod parts;
mod shells;
mod slice;
mod traverse;
mod voxels;

use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use vps_build::{BuildOptions, Mesh};
use vps_core::{Asset, Pose3, Vec3};

use super::Settings;
use crate::data::number_format::group_digits;
use crate::figures::render::canvas::Canvas;
use crate::figures::render::colors::Color;
use crate::figures::render::figure_sheet::{Anchor, FigureSheet};
use crate::figures::render::view::View;
use crate::harness::context::{Body, Context};

/// A picture and its caption.
pub(super) struct Picture {
    /// File name without extension.
    pub(super) stem: &'static str,
    pub(super) caption: &'static str,
    draw: fn(&Subject<'_>) -> Result<FigureSheet, String>,
}

/// All pictures. Numbers that depend on a run are in the pictures themselves.
pub(super) const PICTURES: [Picture; 8] = [
    Picture {
        stem: "shells",
        caption: "The mesh and its pointshells, coarse and fine",
        draw: shells::draw,
    },
    Picture {
        stem: "voxels",
        caption: "Layers of a voxelmap with larger voxels than in the experiments (Fig. 1). Left: the \
                  surface voxels, layer 0. Right: the front half taken away, with the inner layers",
        draw: voxels::draw,
    },
    Picture {
        stem: "slice",
        caption: "A slice through the voxelmap of the experiments. Left: its values, with a line \
                  every 20 mm. Right: which of them a sparse store holds; all others are \
                  interpolated",
        draw: slice::draw,
    },
    Picture {
        stem: "point_levels",
        caption: "Points by level of the tree: those that stand for the clusters of a level (Fig. 2)",
        draw: levels::points,
    },
    Picture {
        stem: "sphere_levels",
        caption: "Spheres by level of the tree: each is the smallest that holds all points of its \
                  cluster, on the visible side of the mesh (Fig. 2b)",
        draw: levels::spheres,
    },
    Picture {
        stem: "traverse",
        caption: "One traverse of the coarse shell against the ground, seen from the side (Figs. 3 \
                  and 4, Algorithm 1)",
        draw: traverse::draw,
    },
    Picture {
        stem: "fall",
        caption: "The falling body, simulated with the algorithm of the fine shell (Fig. 7)",
        draw: fall::draw,
    },
    Picture {
        stem: "parts",
        caption: "Shapes of the algorithms for the mesh: one convex hull, a convex decomposition, the \
                  segments of the fine shell (Fig. 9). A colour each; colours come again",
        draw: parts::draw,
    },
];

/// Draws all pictures into a folder.
pub(super) fn draw(settings: &Settings, context: &Context, folder: &Path) -> Result<(), String> {
    let subject = Subject::new(settings, context)?;
    for picture in &PICTURES {
        let sheet = (picture.draw)(&subject)?;
        sheet.write(&folder.join(format!("{}.png", picture.stem)))?;
    }
    Ok(())
}

/// The subject of the pictures.
struct Subject<'s> {
    settings: &'s Settings,
    context: &'s Context,
    body: Rc<Body>,
    coarse: Arc<Asset<'static>>,
    fine: Arc<Asset<'static>>,
    /// Poses of the fall, one for each step, and the time of a step.
    poses: Vec<Pose3>,
    step_s: f64,
}

impl<'s> Subject<'s> {
    fn new(settings: &'s Settings, context: &'s Context) -> Result<Self, String> {
        let body = context.body(&settings.model, settings.scale)?;
        let shell = |name: Option<&String>| {
            let name = name.map_or("", String::as_str);
            cached(
                context,
                &body.mesh,
                &context.algorithms.vps(name)?.build_options(),
            )
        };
        let (coarse, fine) = (
            shell(settings.shells.first())?,
            shell(settings.shells.last())?,
        );
        let (poses, step_s) = (settings.fall.trace(context, 0)?, settings.fall.step_s());
        Ok(Self {
            settings,
            context,
            body,
            coarse,
            fine,
            poses,
            step_s,
        })
    }

    /// The pose of a step of the fall.
    fn pose(&self, step: u32) -> Result<Pose3, String> {
        let pose = self.poses.get(step as usize).copied();
        pose.ok_or_else(|| format!("structures.fall_steps: there is no step {step}"))
    }

    /// The centre of the mesh and its longest side.
    fn center_and_size(&self) -> (Vec3, f32) {
        let (low, high) = self.body.mesh.bounds();
        let longest = (high - low).max_element() as f32;
        (low.midpoint(high).as_vec3(), longest)
    }

    /// A view of the whole mesh from the front, right and above. The picture is `width` times as
    /// wide as the mesh is long.
    fn view(&self, width: f32) -> View {
        let (middle, longest) = self.center_and_size();
        View::from(25.0, 15.0, middle, width * longest)
    }
}

fn cached(
    context: &Context,
    mesh: &Mesh,
    options: &BuildOptions,
) -> Result<Arc<Asset<'static>>, String> {
    let cached = context.assets.get(mesh, options, &|_| ());
    Ok(cached.map_err(|e| e.to_string())?.asset)
}

/// The corners of a mesh's triangles, posed.
fn triangles(mesh: &Mesh, pose: Pose3) -> impl Iterator<Item = [Vec3; 3]> {
    let count = mesh.triangles().len();
    (0..count).map(move |t| mesh.corners(t).map(|v| pose * v.as_vec3()))
}

fn draw_mesh(canvas: &mut Canvas, view: &View, mesh: &Mesh, pose: Pose3, color: Color) {
    for corners in triangles(mesh, pose) {
        canvas.triangle(view, corners, color);
    }
}

/// Size of a title in pixels.
const TITLE: u32 = 18;
/// Size of other text in pixels.
const TEXT: u32 = 16;

/// A grid of panels with titles above them, and space below.
struct Panels {
    sheet: FigureSheet,
    columns: u32,
    size: [u32; 2],
    placed: u32,
}

impl Panels {
    fn new(count: u32, columns: u32, size: [u32; 2], below: u32) -> Self {
        let rows = count.div_ceil(columns);
        let height = rows * (size[1] + Self::HEAD) + below;
        Self {
            sheet: FigureSheet::new(columns * size[0], height),
            columns,
            size,
            placed: 0,
        }
    }

    /// Height of the title of a panel in pixels.
    const HEAD: u32 = TITLE + 12;

    /// Distance of two panels in pixels.
    const GAP: u32 = 8;

    fn canvas(&self) -> Canvas {
        Canvas::new(self.size[0] - Self::GAP, self.size[1])
    }

    /// Places the next panel.
    fn push(&mut self, title: &str, canvas: &Canvas) -> Result<(), String> {
        let (column, row) = (self.placed % self.columns, self.placed / self.columns);
        let left = column * self.size[0];
        let top = row * (self.size[1] + Self::HEAD);
        self.sheet
            .place(canvas, [left + Self::GAP / 2, top + Self::HEAD]);
        let at = [left + self.size[0] / 2, top + 8];
        self.placed += 1;
        self.sheet.text(title, at, Anchor::Middle, TITLE)
    }

    /// Draws a legend of colours in a line at a position.
    fn legend(&mut self, entries: &[(Color, String)], [left, top]: [u32; 2]) -> Result<(), String> {
        let mut x = left;
        for (color, text) in entries {
            self.sheet.rectangle([x, top - 2], [14, 14], *color);
            self.sheet.text(text, [x + 20, top], Anchor::Left, TEXT)?;
            // Letters are about half as wide as high.
            x += 48 + text.chars().count() as u32 * TEXT / 2;
        }
        Ok(())
    }
}

/// A count with its digits in groups.
fn count(n: usize) -> String {
    group_digits(&n.to_string())
}
