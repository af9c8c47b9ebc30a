//! The algorithms of a comparison, with the options the command gives them.

use clap::builder::PossibleValue;
use serde_json::{Map, Value};
use vps_compare::{Algorithm, Sizes};

/// The named algorithms or, without a name, those of the default set: each once, in the order of the
/// table. `settings` are texts such as `voxels.resolution=50`.
pub(super) fn algorithms(
    names: &[String],
    sizes: &Sizes,
    settings: &[String],
) -> Result<Vec<Algorithm>, String> {
    let mut all = all(sizes);
    for setting in settings {
        set(&mut all, setting).map_err(|why| format!("--set {setting}: {why}"))?;
    }
    all.retain(|algorithm| match names {
        [] => algorithm.is_in_default_set(),
        names => names.iter().any(|name| name == algorithm.key()),
    });
    Ok(all)
}

/// The names of all algorithms, with a line of help and the options of each.
pub(super) fn help(sizes: &Sizes) -> Vec<PossibleValue> {
    let value = |algorithm: Algorithm| {
        let mut help = algorithm.about().to_owned();
        let options = options_of(&algorithm).unwrap_or_default();
        let options = options.iter().map(|(name, value)| match value {
            Value::Null => name.clone(),
            Value::String(text) => format!("{name}={text}"),
            value => format!("{name}={value}"),
        });
        let options: Vec<_> = options.collect();
        if !options.is_empty() {
            help += &format!(" [{}]", options.join(", "));
        }
        if !algorithm.is_in_default_set() {
            help += "; only if it is named";
        }
        PossibleValue::new(algorithm.key()).help(help)
    };
    all(sizes).into_iter().map(value).collect()
}

fn all(sizes: &Sizes) -> Vec<Algorithm> {
    let mut all = Algorithm::all();
    for algorithm in &mut all {
        algorithm.set_sizes(sizes);
    }
    all
}

/// The options of an algorithm by name; `None` if it has none.
fn options_of(algorithm: &Algorithm) -> Option<Map<String, Value>> {
    let mut written = serde_json::to_value(algorithm).ok()?;
    match written.get_mut(algorithm.key())?.take() {
        Value::Object(options) => Some(options),
        _ => None,
    }
}

/// Changes one option of one algorithm.
fn set(all: &mut [Algorithm], setting: &str) -> Result<(), String> {
    let parts = setting.split_once('=');
    let parts = parts.and_then(|(path, value)| Some((path.split_once('.')?, value)));
    let ((name, option), value) = parts.ok_or("not like NAME.OPTION=VALUE")?;
    let algorithm = all.iter_mut().find(|algorithm| algorithm.key() == name);
    let algorithm = algorithm.ok_or_else(|| format!("there is no algorithm `{name}`"))?;
    let mut options = options_of(algorithm).ok_or_else(|| format!("`{name}` has no options"))?;
    let value = serde_json::from_str(value).unwrap_or_else(|_| value.into());
    options.insert(option.into(), value);
    let written = Value::Object(Map::from_iter([(name.into(), Value::Object(options))]));
    *algorithm = serde_json::from_value(written).map_err(|e| e.to_string())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_set_by_name() {
        let sizes = Sizes {
            points: 500,
            voxels: 40,
            parts: 3,
        };
        let mut all = all(&sizes);
        for setting in [
            "convex_decomposition.resolution=32",
            "vps.sampling=local",
            "vps.voxel_size_m=0.5",
            "vps.segments=2",
        ] {
            set(&mut all, setting).unwrap();
        }
        let of = |key: &str| {
            let algorithm = all.iter().find(|a| a.key() == key).unwrap();
            options_of(algorithm).unwrap()
        };
        assert_eq!(of("convex_decomposition")["resolution"], 32);
        assert_eq!(of("convex_decomposition")["parts"], 3);
        assert_eq!(of("voxels")["resolution"], 40);
        assert_eq!(of("vps_both")["points"], 500);
        assert_eq!(of("vps")["sampling"], "local");
        assert_eq!(of("vps")["voxel_size_m"], 0.5);
        assert_eq!(of("vps")["segments"], 2);
        assert_eq!(of("vps_both")["segments"], Value::Null);
        let mut fails = |setting: &str, why: &str| {
            let message = set(&mut all, setting).unwrap_err();
            assert!(message.contains(why), "{message}");
        };
        fails("voxels.resolution", "NAME.OPTION=VALUE");
        fails("resolution=3", "NAME.OPTION=VALUE");
        fails("hull.points=3", "no algorithm `hull`");
        fails("trimesh.points=3", "`trimesh` has no options");
        fails("voxels.parts=3", "unknown field `parts`");
        fails("voxels.resolution=many", "many");
        fails("convex_decomposition.vertices=8", "at least 42");
    }
}
