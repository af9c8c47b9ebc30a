//! A whole query from constant data. Exits with 0 if its result is right.

#![no_std]
#![no_main]

use vps_core::{
    Aabb, Accuracy, Cluster, ContactManifold, DistanceField, Grid, PointSphereTree, Pose3, Query,
    Store, Values, Vec3, Voxelmap,
};

// Only for its start-up code, which calls `main`.
#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// Four corners of a square, facing up into the body above.
static POINTS: [[f32; 3]; 4] = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]];
static NORMALS: [[f32; 3]; 4] = [[0.0, 1.0, 0.0]; 4];
static CLUSTERS: [Cluster; 1] = [Cluster {
    center: [0.0; 3],
    radius: 1.5,
    first: 0,
    count: 4,
    parent_point: 0,
}];
static LEVELS: [u32; 2] = [0, 1];

/// Layers of a floor: two voxels deep, 4 x 4 x 4 voxels of one metre.
static FLOOR: [i16; 64] = floor();

const fn floor() -> [i16; 64] {
    let mut values = [0; 64];
    let mut i = 0;
    while i < 64 {
        let y = i / 4 % 4;
        values[i] = 1 - y as i16;
        i += 1;
    }
    values
}

fn query() -> Option<bool> {
    let tree = PointSphereTree::new(
        POINTS[..].into(),
        NORMALS[..].into(),
        CLUSTERS[..].into(),
        LEVELS[..].into(),
    )
    .ok()?;
    let grid = Grid::new(Vec3::splat(-2.0), 1.0, [4, 4, 4]).ok()?;
    let solid = Aabb {
        min: Vec3::splat(-2.0),
        max: Vec3::new(2.0, -0.5, 2.0),
    };
    let accuracy = Accuracy {
        near_m: 0.01,
        far_m: 0.01,
        band_m: 4.0,
    };
    let values = Values::Integers(FLOOR[..].into());
    let store = Store::dense(grid.dims(), values).ok()?;
    let map = Voxelmap::new(grid, 1.0, solid, accuracy, store).ok()?;
    let field = map.trilinear();
    let pose = Pose3::from_translation(Vec3::new(0.0, -1.0, 0.0));
    let query = Query::new(&tree, &field, pose);
    let mut contacts = [query.deepest()?; 4];
    let mut count = 0;
    query.for_each_contact(|contact| {
        contacts[count] = contact;
        count += 1;
    });
    let manifold = ContactManifold::<4>::spread(&contacts, Vec3::Y, 0.0);
    let wrench = query.wrench(Vec3::ZERO);
    // Four points, each half a metre deep.
    let right = count == 4
        && manifold.contacts().len() == 4
        && (wrench.force - Vec3::new(0.0, 2.0, 0.0)).length() < 1e-5
        && wrench.torque.length() < 1e-5
        && field.signed_distance(Vec3::new(0.0, 1.0, 0.0)) > 0.0;
    Some(right)
}

/// What the C start-up code calls.
#[unsafe(no_mangle)]
pub extern "C" fn main(_argc: i32, _argv: *const *const u8) -> i32 {
    i32::from(query() != Some(true))
}
