//! The macro behind the list of algorithms.

/// Declares the module of each algorithm and defines [`Algorithm`](super::Algorithm). A line is the
/// module, which is also the key in the command, TOML and CSV files, and the type in it. The order of
/// the lines is that of help and tables.
macro_rules! registry {
    ($($key:ident: $Type:ident,)+) => {
        use std::fmt;
        use std::ops::{Deref, DerefMut};

        use serde::de::{Error, MapAccess, Visitor};
        use serde::{Deserialize, Deserializer, Serialize, Serializer};

        use crate::algorithm::CollisionAlgorithm;

        $(
            mod $key;
            pub use $key::$Type;
        )+

        /// One of the registered algorithms, with its options. It dereferences to
        /// [`CollisionAlgorithm`].
        ///
        /// serde reads and writes it as its key, or as a table of its options by its key; options
        /// that are left out have their defaults, and all are [checked](CollisionAlgorithm::check).
        ///
        /// ```
        /// use vps_compare::Algorithm;
        ///
        /// for algorithm in Algorithm::all() {
        ///     println!("{}: {}", algorithm.key(), algorithm.about());
        /// }
        /// let parts = r#"{ "convex_decomposition": { "parts": 4 } }"#;
        /// let parts: Algorithm = serde_json::from_str(parts)?;
        /// assert_eq!(parts.key(), "convex_decomposition");
        /// # Ok::<(), serde_json::Error>(())
        /// ```
        #[derive(Clone, Debug)]
        pub enum Algorithm {
            $(
                #[doc = concat!("The key `", stringify!($key), "`.")]
                $Type($Type),
            )+
        }

        impl Algorithm {
            /// The keys of all algorithms.
            pub const KEYS: &'static [&'static str] = &[$(stringify!($key)),+];

            /// All algorithms with their default options.
            pub fn all() -> Vec<Self> {
                vec![$(Self::$Type($Type::default())),+]
            }

            /// The key in the command, TOML and CSV files.
            pub fn key(&self) -> &'static str {
                match self {
                    $(Self::$Type(_) => stringify!($key),)+
                }
            }
        }

        impl Deref for Algorithm {
            type Target = dyn CollisionAlgorithm;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$Type(algorithm) => algorithm,)+
                }
            }
        }

        impl DerefMut for Algorithm {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$Type(algorithm) => algorithm,)+
                }
            }
        }

        impl Serialize for Algorithm {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                match self {
                    $(
                        // Without options.
                        Self::$Type(_) if size_of::<$Type>() == 0 => {
                            serializer.serialize_str(stringify!($key))
                        }
                        Self::$Type(options) => {
                            serializer.collect_map([(stringify!($key), options)])
                        }
                    )+
                }
            }
        }

        impl<'de> Deserialize<'de> for Algorithm {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(KeyOrOptions)
            }
        }

        /// Reads an [`Algorithm`].
        struct KeyOrOptions;

        impl<'de> Visitor<'de> for KeyOrOptions {
            type Value = Algorithm;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the key of an algorithm, or a table of its options by its key")
            }

            fn visit_str<E: Error>(self, key: &str) -> Result<Algorithm, E> {
                let mut all = Algorithm::all().into_iter();
                let named = all.find(|algorithm| algorithm.key() == key);
                named.ok_or_else(|| E::unknown_variant(key, Algorithm::KEYS))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Algorithm, A::Error> {
                let none = || A::Error::invalid_length(0, &self);
                let key: String = map.next_key()?.ok_or_else(none)?;
                let algorithm = match key.as_str() {
                    $(stringify!($key) => Algorithm::$Type(map.next_value()?),)+
                    _ => return Err(A::Error::unknown_variant(&key, Algorithm::KEYS)),
                };
                if let Some(other) = map.next_key::<String>()? {
                    let message = format!("`{other}` beside `{key}`: one algorithm is needed");
                    return Err(A::Error::custom(message));
                }
                match algorithm.check() {
                    Ok(()) => Ok(algorithm),
                    Err(why) => Err(A::Error::custom(format!("{key}.{why}"))),
                }
            }
        }
    };
}

pub(super) use registry;
