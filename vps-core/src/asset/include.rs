//! Aligned bytes, for assets in constant memory.

/// Bytes at an address that is a multiple of 64, where
/// [`Asset::from_bytes`](crate::Asset::from_bytes) can read them in place: a buffer to receive a file
/// in, or the static that [`include_asset!`](crate::include_asset) puts a file into.
///
/// ```
/// use vps_core::{Aligned, Asset, FormatError};
///
/// let mut buffer = Aligned([0; 65536]);
/// let received = &mut buffer.0[..1024];
/// assert!(matches!(Asset::from_bytes(received), Err(FormatError::Foreign)));
/// ```
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub struct Aligned<B: ?Sized>(pub B);

/// The bytes of a file, as `include_bytes!` gives them, but at an address that is a multiple of 64:
/// for a `.vps` file in the constant memory of a program, which
/// [`Asset::from_bytes`](crate::Asset::from_bytes) reads in place.
///
/// The path is relative to the source file. The bytes are a `&'static [u8]`.
///
/// ```ignore
/// static TOOL: &[u8] = vps_core::include_asset!("tool.vps");
///
/// let tool = Asset::from_bytes(TOOL)?;
/// ```
///
/// Any file will do:
///
/// ```
/// let bytes = vps_core::include_asset!(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md"));
/// assert!(bytes.as_ptr().addr().is_multiple_of(64));
/// ```
#[macro_export]
macro_rules! include_asset {
    ($path:expr $(,)?) => {{
        static BYTES: &$crate::Aligned<[u8]> = &$crate::Aligned(*::core::include_bytes!($path));
        &BYTES.0
    }};
}

#[cfg(test)]
mod tests {
    #[test]
    fn included_bytes_equal_the_file_and_are_aligned() {
        static FILES: [&[u8]; 2] = [include_asset!("include.rs"), include_asset!("../lib.rs")];
        let expected: [&[u8]; 2] = [include_bytes!("include.rs"), include_bytes!("../lib.rs")];
        for (bytes, expected) in FILES.into_iter().zip(expected) {
            assert_eq!(bytes, expected);
            assert_eq!(bytes.as_ptr().addr() % 64, 0);
        }
    }
}
