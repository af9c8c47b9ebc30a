//! The reader of STL files takes any bytes.

#![no_main]

use libfuzzer_sys::fuzz_target;
use vps_build::{MeshFormat, parse_mesh};

fuzz_target!(|bytes: &[u8]| {
    let _ = parse_mesh(bytes, MeshFormat::Stl, None);
});
