//! Contact manifolds of a torus on a box as an engine asks for them, by algorithm.
//!
//! `cargo bench -p vps-compare` needs no model. What is reported is measured by
//! `vps-bench run queries`.

use criterion::Criterion;
use rapier3d::math::{Pose, Rotation, Vector};
use vps_build::models;
use vps_compare::{Algorithm, Contacts, Ground, Scene};

/// Edge lengths of the box in metres.
const BOX: [f64; 3] = [2.0, 0.2, 2.0];
/// How far ahead contacts are asked for in metres: rapier's default.
const PREDICTION: f32 = 0.02;

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let body = models::torus(44).scaled(0.3).expect("a positive scale");
    let scene = Scene {
        body: &body,
        ground: Ground::Cuboid(BOX),
    };
    // Rolls on its rim, 1 mm deep.
    let height = (0.5 * BOX[1] + 0.3 * 0.5 - 0.001) as f32;
    let poses: Vec<_> = (0..20)
        .map(|i| {
            let turn = Rotation::from_scaled_axis(Vector::new(0.0, 0.0, 0.1 * i as f32));
            Pose::from_parts(Vector::new(0.0, height, 0.0), turn)
        })
        .collect();
    let mut group = criterion.benchmark_group("manifolds");
    for algorithm in Algorithm::all()
        .into_iter()
        .filter(|a| a.is_in_default_set())
    {
        let prepared = algorithm.prepare(&scene).expect("a closed mesh");
        group.bench_function(algorithm.key(), |bencher| {
            bencher.iter(|| {
                let mut contacts = Contacts::default();
                for pose in &poses {
                    prepared
                        .query(pose, PREDICTION, &mut contacts)
                        .expect("a supported pair of shapes");
                }
                contacts.count_and_deepest()
            });
        });
    }
    group.finish();
    criterion.final_summary();
}
