//! What takes part: meshes, and what each kind of shape makes of them.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use rapier3d::prelude::*;
use vps_build::models::{Thread, bolt, gear, link, nut, peg, torus};
use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build, read_mesh};
use vps_compare::{CollisionAlgorithm, ConvexDecomposition, Ground, Scene, Trimesh};
use vps_core::Asset;
use vps_rapier::VpsShape;

/// What a body collides as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// VPS with few points.
    VpsCoarse,
    /// VPS.
    Vps,
    /// VPS with a contact for each segment of a level of the shell's tree.
    VpsSegments,
    /// Convex parts by VHACD.
    Decomposition,
    /// A triangle mesh of parry.
    Trimesh,
}

/// All kinds that every model has.
pub(crate) const KINDS: [Kind; 3] = [Kind::Vps, Kind::Decomposition, Kind::Trimesh];
/// The same, and VPS by segments.
pub(crate) const KINDS_AND_SEGMENTS: [Kind; 4] = [
    Kind::Vps,
    Kind::VpsSegments,
    Kind::Decomposition,
    Kind::Trimesh,
];
/// All kinds.
pub(crate) const ALL_KINDS: [Kind; 5] = [
    Kind::VpsCoarse,
    Kind::Vps,
    Kind::VpsSegments,
    Kind::Decomposition,
    Kind::Trimesh,
];
/// Level of the segments, the top being 1.
pub(crate) const SEGMENTS_LEVEL: u32 = 3;
/// The kinds a bunny has.
pub(crate) const BUNNY_KINDS: [Kind; 4] = [
    Kind::VpsCoarse,
    Kind::Vps,
    Kind::Decomposition,
    Kind::Trimesh,
];

/// The kinds played with other settings and from other starts.
pub(crate) const VARIED: [Kind; 3] = [Kind::VpsCoarse, Kind::Vps, Kind::Decomposition];

impl Kind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::VpsCoarse => "VPS, coarse",
            Self::Vps => "VPS",
            Self::VpsSegments => "VPS, segments",
            Self::Decomposition => "convex decomposition",
            Self::Trimesh => "triangle mesh",
        }
    }

    pub(crate) fn is_vps(self) -> bool {
        matches!(self, Self::VpsCoarse | Self::Vps | Self::VpsSegments)
    }
}

/// A body of one kilogram, in the frame of its mesh.
pub(crate) struct Model {
    /// Also what tells how deep bodies are, whatever they collide as.
    pub(crate) asset: Arc<Asset<'static>>,
    coarse: Option<Arc<Asset<'static>>>,
    decomposition: SharedShape,
    trimesh: SharedShape,
}

impl Model {
    fn new(mesh: &Mesh, options: &BuildOptions, coarse: Option<u32>, parts: usize) -> Self {
        let asset = |options: &BuildOptions| {
            Arc::new(build(mesh, options, &|_| ()).expect("a solid").asset)
        };
        let scene = Scene {
            body: mesh,
            ground: Ground::Cuboid([1.0; 3]),
        };
        let decomposition = ConvexDecomposition {
            parts,
            vertices: 100,
            resolution: 64,
        };
        let shape = |algorithm: &dyn CollisionAlgorithm| {
            algorithm.prepare(&scene).expect("a sound mesh").body
        };
        Self {
            asset: asset(options),
            coarse: coarse.map(|points| {
                asset(&BuildOptions {
                    points: PointCount::About(points),
                    ..options.clone()
                })
            }),
            decomposition: shape(&decomposition),
            trimesh: shape(&Trimesh),
        }
    }

    /// A mesh made by code, with what `vps-build` makes of it unless asked otherwise.
    fn made(mesh: &Mesh, scale: f64) -> Self {
        let mesh = mesh.scaled(scale).expect("a sound scale");
        Self::new(&mesh, &BuildOptions::default(), None, MADE_PARTS)
    }

    fn bunny(scale: f64) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../.cache/models/bunny.obj");
        let bunny = read_mesh(&path, None).expect("the bunny: `just fetch` brings it");
        let bunny = bunny.scaled(scale).expect("a sound scale");
        let options = BuildOptions {
            resolution: Resolution::VoxelSize(0.00256 / 0.135 * scale),
            points: PointCount::About(35_596),
            ..BuildOptions::default()
        };
        Self::new(&bunny, &options, Some(799), BUNNY_PARTS)
    }

    pub(crate) fn shape(&self, kind: Kind) -> SharedShape {
        match kind {
            Kind::VpsCoarse => {
                let coarse = self.coarse.as_ref().expect("a model with a coarse shell");
                VpsShape::new(coarse.clone()).into()
            }
            Kind::Vps | Kind::VpsSegments => VpsShape::new(self.asset.clone()).into(),
            Kind::Decomposition => self.decomposition.clone(),
            Kind::Trimesh => self.trimesh.clone(),
        }
    }

    /// Those of the solid, for one kilogram.
    pub(crate) fn mass(&self) -> MassProperties {
        let mass = self.asset.mass;
        MassProperties::with_inertia_matrix(mass.center(), 1.0, mass.inertia_tensor(1.0))
    }

    /// How far the surface reaches from the centre of mass, at most, in metres.
    pub(crate) fn reach(&self) -> f32 {
        let solid = self.asset.voxelmap.solid();
        let aside = (solid.center() - self.asset.mass.center()).length();
        aside + 0.5 * solid.extents().length()
    }
}

/// Most parts of the bunny's decomposition, as in the experiment of the paper.
pub(crate) const BUNNY_PARTS: usize = 8;
/// Most parts of other decompositions.
pub(crate) const MADE_PARTS: usize = 32;

/// 0.27 m wide.
pub(crate) static BUNNY: LazyLock<Model> = LazyLock::new(|| Model::bunny(0.135));
/// 2 mm wide.
pub(crate) static SMALL_BUNNY: LazyLock<Model> = LazyLock::new(|| Model::bunny(0.001));

/// Radius of the ball in metres.
pub(crate) const BALL_RADIUS: f32 = 0.1;
/// 5120 triangles.
pub(crate) static BALL: LazyLock<Model> =
    LazyLock::new(|| Model::made(&Mesh::icosphere(0.1, 4).expect("a ball"), 1.0));

/// How much smaller than a metre the gear of 16 teeth is.
pub(crate) const GEAR_SCALE: f32 = 0.3;
/// 16 teeth.
pub(crate) static GEAR: LazyLock<Model> = LazyLock::new(|| Model::made(&gear(16), 0.3));
/// 12 teeth as large as those of [`GEAR`].
pub(crate) static SMALL_GEAR: LazyLock<Model> =
    LazyLock::new(|| Model::made(&gear(12), 0.3 * 12.0 / 16.0));

/// How much smaller than a metre the bolt is.
pub(crate) const SCREW_SCALE: f32 = 0.3;
/// 0.3 m long, around the z axis.
pub(crate) static BOLT: LazyLock<Model> =
    LazyLock::new(|| Model::made(&bolt(Thread::default(), 1.0, 48), 0.3));
/// 60 mm high with 2.4 mm of room.
pub(crate) static NUT: LazyLock<Model> =
    LazyLock::new(|| Model::made(&nut(Thread::default(), 0.2, 0.008, 48), 0.3));

/// Its hole is 0.2 m wide, around the z axis.
pub(crate) static RING: LazyLock<Model> = LazyLock::new(|| Model::made(&torus(48), 0.5));
/// 0.6 m high and 0.12 m thick, along the z axis.
pub(crate) static PEG: LazyLock<Model> = LazyLock::new(|| Model::made(&peg(48), 0.6));

/// How much smaller than a metre a link is.
pub(crate) const LINK_SCALE: f32 = 0.2;
/// 0.2 m long, of a rod of 28 mm, along the x axis.
pub(crate) static LINK: LazyLock<Model> = LazyLock::new(|| Model::made(&link(32), 0.2));

/// Thickness of the plate in metres.
pub(crate) const PLATE_THICKNESS: f32 = 0.002;
/// 0.5 m wide, with voxels half as large as it is thick.
pub(crate) static PLATE: LazyLock<Model> = LazyLock::new(|| {
    let mesh = Mesh::cuboid([0.5, 0.002, 0.5]).expect("a box");
    let options = BuildOptions {
        resolution: Resolution::VoxelSize(0.001),
        ..BuildOptions::default()
    };
    Model::new(&mesh, &options, None, MADE_PARTS)
});
