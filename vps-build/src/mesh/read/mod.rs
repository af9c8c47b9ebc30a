//! Readers of mesh files: OBJ, PLY, STL and OFF.

mod obj;
mod off;
mod ply;
mod polygons;
mod stl;
mod text;
mod triangulate;

use std::path::{Path, PathBuf};

use crate::mesh::{Mesh, MeshError};

/// Why a file cannot be read as a mesh.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// Input failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A line is invalid.
    #[error("{}:{line}: {what}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// The fault.
        what: String,
    },
    /// The file as a whole is invalid.
    #[error("{}: {what}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The fault.
        what: String,
    },
}

/// A fault in the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Fault {
    /// The faulty line, counted from 1, if it is a single one.
    pub line: Option<usize>,
    /// The fault, in one line.
    pub what: String,
}

impl Fault {
    fn of_file(what: impl Into<String>) -> Self {
        Self {
            line: None,
            what: what.into(),
        }
    }

    fn of_line(line: usize, what: impl Into<String>) -> Self {
        Self {
            line: Some(line),
            what: what.into(),
        }
    }

    /// Of a line, or of the whole file if `line` is 0.
    fn at(line: usize, what: impl Into<String>) -> Self {
        Self {
            line: (line > 0).then_some(line),
            what: what.into(),
        }
    }
}

impl From<MeshError> for Fault {
    fn from(error: MeshError) -> Self {
        Self::of_file(error.to_string())
    }
}

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// Stereolithography STL, ASCII or binary.
    Stl,
    /// Object file format OFF.
    Off,
}

impl MeshFormat {
    /// The format of a file by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "stl" => Some(Self::Stl),
            "off" => Some(Self::Off),
            _ => None,
        }
    }
}

/// Reads a mesh in the format of the file's extension. All objects of the file become one mesh, or
/// only the one named `object`; only OBJ has names. Polygons become triangles.
///
/// # Errors
/// When the file cannot be read, is not of its format, or holds no valid mesh. Names the line where
/// there is one.
pub fn read_mesh(path: &Path, object: Option<&str>) -> Result<Mesh, ReadError> {
    let file = |what: &str| ReadError::File {
        path: path.into(),
        what: what.into(),
    };
    let format = MeshFormat::of(path)
        .ok_or_else(|| file("the name must end in .obj, .ply, .stl or .off"))?;
    let bytes = std::fs::read(path).map_err(|source| ReadError::Io {
        path: path.into(),
        source,
    })?;
    parse_mesh(&bytes, format, object).map_err(|fault| match fault {
        Fault {
            line: Some(line),
            what,
        } => ReadError::Line {
            path: path.into(),
            line,
            what,
        },
        Fault { line: None, what } => file(&what),
    })
}

/// Reads a mesh from the bytes of a file, like [`read_mesh`].
///
/// # Errors
/// When the bytes are not of the format, or hold no valid mesh.
pub fn parse_mesh(bytes: &[u8], format: MeshFormat, object: Option<&str>) -> Result<Mesh, Fault> {
    if format != MeshFormat::Obj && object.is_some() {
        return Err(Fault::of_file("only the objects of an OBJ file have names"));
    }
    match format {
        MeshFormat::Obj => obj::parse(bytes, object),
        MeshFormat::Ply => ply::parse(bytes),
        MeshFormat::Stl => stl::parse(bytes),
        MeshFormat::Off => off::parse(bytes),
    }
}

#[cfg(test)]
mod tests;
