//! A world without the dispatcher is detected. The only test of its process, since each process warns
//! once.

mod support;

use std::sync::Mutex;

use support::asset;
use vps_build::Mesh;
use vps_rapier::rapier3d::parry::query::{DefaultQueryDispatcher, QueryDispatcher};
use vps_rapier::rapier3d::prelude::*;
use vps_rapier::{MissingDispatcher, VpsDispatcher, VpsShape, check, narrow_phase};

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
fn a_world_without_our_dispatcher_is_found_out() {
    log::set_logger(&LOG).unwrap();
    log::set_max_level(log::LevelFilter::Warn);
    let logged = || LOG.0.lock().unwrap().clone();
    let block: SharedShape = VpsShape::new(asset(&Mesh::cuboid([0.3; 3]).unwrap(), 300)).into();
    let compound = SharedShape::compound(vec![(Pose::IDENTITY, block.clone())]);
    let mut world = PhysicsWorld::default();
    let ground = ColliderBuilder::cuboid(4.0, 0.1, 4.0);
    world.insert(RigidBodyBuilder::fixed(), ground);
    assert_eq!(check(&world.narrow_phase, &world.colliders), Ok(()));
    let above = RigidBodyBuilder::dynamic().translation(Vector::Y * 0.3);
    let (_, first) = world.insert(above.clone(), ColliderBuilder::new(block));
    let error = check(&world.narrow_phase, &world.colliders).unwrap_err();
    assert_eq!(error, MissingDispatcher(first));
    assert!(
        error.to_string().contains("vps_rapier::narrow_phase()"),
        "{error}"
    );
    assert!(logged().is_empty());
    for _ in 0..60 {
        world.step();
    }
    let said = logged();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("vps_rapier::narrow_phase()"), "{said:?}");
    // So is ours behind parry's, which claims to support meshes and finds nothing.
    let behind = DefaultQueryDispatcher.chain(VpsDispatcher::default());
    world.narrow_phase = NarrowPhase::with_query_dispatcher(behind);
    let error = check(&world.narrow_phase, &world.colliders).unwrap_err();
    assert_eq!(error, MissingDispatcher(first));
    // A part of a compound is enough.
    let mut world = PhysicsWorld::default();
    let (_, second) = world.insert(above, ColliderBuilder::new(compound));
    let error = check(&world.narrow_phase, &world.colliders).unwrap_err();
    assert_eq!(error, MissingDispatcher(second));
    world.narrow_phase = narrow_phase();
    assert_eq!(check(&world.narrow_phase, &world.colliders), Ok(()));
    world.step();
    assert_eq!(logged().len(), 1);
}
