//! The collision algorithms, one adapter per file.

mod parry_pair;
mod registry;
mod simplify_hull;

use registry::registry;

// A line for each algorithm. `cargo fmt` does not find modules of a macro: `just check` names them.
registry! {
    vps: Vps,
    vps_both: VpsBoth,
    convex_hull: ConvexHull,
    convex_decomposition: ConvexDecomposition,
    trimesh: Trimesh,
    voxels: Voxels,
    ball: Ball,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_checked() {
        for algorithm in Algorithm::all() {
            let text = serde_json::to_string(&algorithm).unwrap();
            let read: Algorithm = serde_json::from_str(&text).unwrap();
            assert_eq!(serde_json::to_string(&read).unwrap(), text);
            let named: Algorithm = serde_json::from_value(algorithm.key().into()).unwrap();
            assert_eq!(serde_json::to_string(&named).unwrap(), text);
        }
        let message = |text: &str| {
            let read = serde_json::from_str::<Algorithm>(text);
            read.unwrap_err().to_string()
        };
        assert!(message(r#""hulls""#).contains("`hulls`"));
        assert!(message(r#"{ "voxels": { "parts": 3 } }"#).contains("`parts`"));
        assert!(message(r#"{ "voxels": {}, "trimesh": {} }"#).contains("`trimesh`"));
        assert!(message("{}").contains("the key of an algorithm"));
        let few = r#"{ "convex_decomposition": { "vertices": 41 } }"#;
        assert!(message(few).contains("convex_decomposition.vertices must be at least 42"));
        assert!(message(r#"{ "vps_both": { "segments": 0 } }"#).contains("vps_both.segments"));
    }

    #[test]
    fn algorithms_are_told_apart_by_key_label_and_color() {
        let all = Algorithm::all();
        for (i, a) in all.iter().enumerate() {
            for b in &all[..i] {
                assert_ne!(a.key(), b.key());
                assert_ne!(a.label(), b.label());
                assert_ne!(a.color(), b.color());
            }
        }
    }
}
