//! Meshes from files: OBJ, PLY, STL and OFF.

mod obj;
mod off;
mod ply;
mod polygons;
mod stl;
mod text;
mod triangulate;

use std::path::{Path, PathBuf};

use crate::{Mesh, MeshError};

/// Why a file is not a mesh.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A line is not what the format wants.
    #[error("{}:{line}: {what}", path.display())]
    Line {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong with it.
        what: String,
    },
    /// The file as a whole is no mesh.
    #[error("{}: {what}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

/// What is wrong with the content of a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Fault {
    /// The line that is to blame, counted from 1, if it is one.
    pub line: Option<usize>,
    /// What is wrong, in one line.
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

    /// Of a line, or of the whole file if it is 0.
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
    /// The format of a file by the ending of its name.
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

/// Reads a mesh in the format the ending of its name tells. All objects of the file become one
/// mesh, or only the one named `object` (OBJ alone has names); polygons become triangles.
///
/// # Errors
/// When the file cannot be read, is not of its format, or holds no sound mesh; with the line where
/// there is one to blame.
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
/// When the bytes are not of the format, or hold no sound mesh.
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
