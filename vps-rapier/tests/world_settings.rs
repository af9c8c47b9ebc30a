//! A world without the dispatcher, or with tolerances that are too large, is detected. The only test of
//! its process, since each process warns once.

mod support;

use std::sync::Mutex;

use support::asset;
use vps_build::Mesh;
use vps_rapier::rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{VpsDispatcher, VpsShape, WorldError, narrow_phase, set_up};

/// Keeps the logged messages.
struct Log(Mutex<Vec<String>>);

impl log::Log for Log {
    fn enabled(&self, metadata: &log::Metadata<'_>) -> bool {
        metadata.level() <= log::Level::Warn
    }

    fn log(&self, record: &log::Record<'_>) {
        if self.enabled(record.metadata()) && record.target().starts_with("vps_rapier") {
            self.0.lock().unwrap().push(record.args().to_string());
        }
    }

    fn flush(&self) {}
}

static LOG: Log = Log(Mutex::new(Vec::new()));

#[test]
fn a_world_that_spoils_vps_shapes_is_found_out() {
    log::set_logger(&LOG).unwrap();
    log::set_max_level(log::LevelFilter::Warn);
    let logged = || LOG.0.lock().unwrap().clone();
    let check = |world: &PhysicsWorld| {
        vps_rapier::check(
            &world.narrow_phase,
            &world.integration_parameters,
            &world.colliders,
        )
    };
    let block = |size: f64| -> SharedShape {
        VpsShape::new(asset(&Mesh::cuboid([size; 3]).unwrap(), 300)).into()
    };
    let compound = SharedShape::compound(vec![(Pose::IDENTITY, block(0.3))]);
    let mut world = PhysicsWorld::default();
    let ground = ColliderBuilder::cuboid(4.0, 0.1, 4.0);
    world.insert(RigidBodyBuilder::fixed(), ground.clone());
    assert_eq!(check(&world), Ok(()));
    let above = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.3);
    let (_, first) = world.insert(above.clone(), ColliderBuilder::new(block(0.3)));
    let error = check(&world).unwrap_err();
    assert_eq!(error, WorldError::MissingDispatcher { collider: first });
    assert!(error.to_string().contains("vps_rapier::set_up"), "{error}");
    assert!(logged().is_empty());
    for _ in 0..60 {
        world.step();
    }
    let said = logged();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("vps_rapier::set_up"), "{said:?}");
    // So is ours behind parry's, which claims to support meshes and finds nothing.
    let behind = DefaultQueryDispatcher.chain(VpsDispatcher::default());
    world.narrow_phase = NarrowPhase::with_query_dispatcher(behind);
    let error = check(&world).unwrap_err();
    assert_eq!(error, WorldError::MissingDispatcher { collider: first });
    // A part of a compound is enough.
    let mut world = PhysicsWorld::default();
    let (_, second) = world.insert(above, ColliderBuilder::new(compound));
    let error = check(&world).unwrap_err();
    assert_eq!(error, WorldError::MissingDispatcher { collider: second });
    world.narrow_phase = narrow_phase();
    assert_eq!(check(&world), Ok(()));
    world.step();
    assert_eq!(logged().len(), 1);

    // rapier's own tolerances are too large for a body of a centimetre.
    let mut world = PhysicsWorld {
        narrow_phase: narrow_phase(),
        ..PhysicsWorld::default()
    };
    world.insert(RigidBodyBuilder::fixed(), ground);
    let close = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.106);
    let (_, small) = world.insert(close, ColliderBuilder::new(block(0.01)));
    let is_small = |error| match error {
        Err(WorldError::RecycleDistance { collider, .. }) => Some((collider, "kept")),
        Err(WorldError::Prediction { collider, .. }) => Some((collider, "predicted")),
        _ => None,
    };
    assert_eq!(is_small(check(&world)), Some((small, "kept")));
    world
        .integration_parameters
        .normalized_contact_recycle_distance = 1e-4;
    assert_eq!(is_small(check(&world)), Some((small, "predicted")));
    for _ in 0..60 {
        world.step();
    }
    let said = logged();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[1].contains("ahead: call"), "{said:?}");
    set_up(
        &mut world.narrow_phase,
        &mut world.integration_parameters,
        0.01,
    );
    assert_eq!(check(&world), Ok(()));
}
