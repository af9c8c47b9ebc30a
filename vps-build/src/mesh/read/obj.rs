//! Wavefront OBJ: vertices and faces, one statement per line.

use std::collections::BTreeSet;

use super::Fault;
use super::polygons::Polygons;
use super::text::{Lines, coordinates, integer, printable, text, without_comment, words};
use crate::mesh::Mesh;

/// Statements whose last argument is a name, with any characters.
const NAMES: [&[u8]; 7] = [
    b"o", b"g", b"usemtl", b"mtllib", b"usemap", b"maplib", b"matlib",
];

pub(super) fn parse(bytes: &[u8], object: Option<&str>) -> Result<Mesh, Fault> {
    let mut lines = Lines::new(text(bytes)?);
    let mut polygons = Polygons::counted_from(1);
    let mut objects = Objects::new(object);
    let mut statement = Vec::new();
    while next_statement(&mut lines, &mut statement) {
        let Some((&(line, keyword), arguments)) = statement.split_first() else {
            continue;
        };
        match keyword {
            b"v" => {
                let words = arguments.iter().map(|&(_, word)| word);
                polygons.push_vertex(coordinates(line, words)?, line);
            }
            b"f" | b"fo" if objects.is_chosen() => face(&mut polygons, line, arguments)?,
            b"o" | b"g" => objects.begin(keyword, arguments),
            b"surf" => {
                let what = "a curved surface: only polygons can be read, export it as a mesh";
                return Err(Fault::of_line(line, what));
            }
            b"call" => {
                let what = "`call` of another file: put all into one file";
                return Err(Fault::of_line(line, what));
            }
            // Normals, materials, curves and so on do not matter for the solid.
            _ => {}
        }
    }
    if polygons.face_count() == 0 {
        objects.check()?;
        if polygons.vertex_count() == 0 {
            return Err(Fault::of_file(
                "no triangles, nor any vertices: is this a Wavefront OBJ file?",
            ));
        }
    }
    polygons.mesh()
}

/// Splits the next statement into words, each with its line. A backslash at the end of a line
/// continues the statement. The name of an object or a group is one word.
fn next_statement<'t>(lines: &mut Lines<'t>, statement: &mut Vec<(usize, &'t [u8])>) -> bool {
    statement.clear();
    for (number, line) in lines.by_ref() {
        let data = without_comment(line).trim_ascii_end();
        let keyword = words(data).next();
        if statement.is_empty() && keyword.is_some_and(|k| NAMES.contains(&k)) {
            let (start, line) = (keyword.unwrap_or_default(), line.trim_ascii());
            statement.push((number, start));
            statement.push((number, line[start.len()..].trim_ascii()));
            return true;
        }
        let (data, goes_on) = match data {
            [data @ .., b'\\'] => (data, true),
            _ => (data, false),
        };
        statement.extend(words(data).map(|word| (number, word)));
        if !goes_on {
            return true;
        }
    }
    !statement.is_empty()
}

/// Adds a face. Each corner starts with a vertex; further indices follow slashes.
fn face(polygons: &mut Polygons, line: usize, corners: &[(usize, &[u8])]) -> Result<(), Fault> {
    for &(line, word) in corners {
        let vertex = word.split(|&b| b == b'/').next().and_then(integer);
        let fault = |what: String| Err(Fault::of_line(line, what));
        let count = polygons.vertex_count() as i64;
        let position = match vertex {
            None => return fault(format!("`{}` is not a vertex of a face", printable(word))),
            Some(0) => {
                return fault("a face refers to vertex 0: they are counted from 1".into());
            }
            Some(v) if v < 0 => v.checked_add(count).filter(|&v| v >= 0),
            Some(v) => Some(v - 1),
        };
        let Some(position) = position.and_then(|position| u32::try_from(position).ok()) else {
            return fault(format!(
                "a face refers to vertex {}, but there are {count}",
                printable(word)
            ));
        };
        polygons.push_corner(position);
    }
    polygons.end_face(line);
    Ok(())
}

/// The objects and groups of a file, and the selected one.
struct Objects<'a> {
    wanted: Option<&'a str>,
    in_object: bool,
    in_group: bool,
    /// Whether the selected one has begun anywhere.
    found: bool,
    names: BTreeSet<String>,
}

impl<'a> Objects<'a> {
    fn new(wanted: Option<&'a str>) -> Self {
        Self {
            wanted,
            in_object: false,
            in_group: false,
            found: false,
            names: BTreeSet::new(),
        }
    }

    /// Whether a face here belongs to the selected object.
    fn is_chosen(&self) -> bool {
        self.wanted.is_none() || self.in_object || self.in_group
    }

    /// Begins an object (`o`) or a group (`g`, which may have several names).
    fn begin(&mut self, keyword: &[u8], arguments: &[(usize, &[u8])]) {
        let Some(wanted) = self.wanted else { return };
        let line = arguments.first().map_or(&[][..], |&(_, word)| word);
        let whole = decoded(line);
        let mut is_wanted = whole == wanted || decoded(uncommented_name(line)) == wanted;
        if keyword == b"o" {
            self.in_object = is_wanted;
        } else {
            is_wanted |= words(line).any(|name| decoded(name) == wanted);
            self.in_group = is_wanted;
        }
        self.found |= is_wanted;
        if !whole.is_empty() {
            self.names.insert(whole);
        }
    }

    /// # Errors
    /// When the selected object does not exist.
    fn check(&self) -> Result<(), Fault> {
        const SHOWN: usize = 8;
        let Some(wanted) = self.wanted.filter(|_| !self.found) else {
            return Ok(());
        };
        let quoted = |name: &String| format!("`{}`", printable(name.as_bytes()));
        let names: Vec<_> = self.names.iter().take(SHOWN).map(quoted).collect();
        let more = if self.names.len() > SHOWN {
            ", ..."
        } else {
            ""
        };
        let hint = if names.is_empty() {
            ": the file names none".into()
        } else {
            format!(", but {}{more}", names.join(", "))
        };
        Err(Fault::of_file(format!(
            "there is no object `{wanted}`{hint}"
        )))
    }
}

/// A name without a trailing comment. A `#` within a word belongs to it.
fn uncommented_name(line: &[u8]) -> &[u8] {
    let comment = line
        .windows(2)
        .position(|w| w[0].is_ascii_whitespace() && w[1] == b'#');
    line[..comment.unwrap_or(line.len())].trim_ascii()
}

/// Decodes UTF-8, or Latin-1 if it is invalid.
fn decoded(name: &[u8]) -> String {
    match str::from_utf8(name) {
        Ok(name) => name.into(),
        Err(_) => name.iter().map(|&b| char::from(b)).collect(),
    }
}
