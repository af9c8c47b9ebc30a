//! STL: triangles, as text or as 50 bytes each. Normals are ignored.

use super::Fault;
use super::polygons::Polygons;
use super::text::{Lines, coordinates, printable, text, words};
use crate::mesh::{Mesh, position_fault};

/// Bytes of a binary header: 80 of any content, then the number of triangles.
const HEAD: usize = 84;

/// Bytes of a triangle: a normal, three corners, and two attributes.
const TRIANGLE: usize = 50;

/// Triangle counts that some programs write if the number is not known in advance.
const UNKNOWN: [u32; 2] = [0, u32::MAX];

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    // A binary header may be any text. But text has no zero bytes, and a count of triangles has
    // some.
    let used = bytes
        .iter()
        .rposition(|&b| b != 0)
        .map_or(0, |last| last + 1);
    if bytes[..used].trim_ascii().is_empty() {
        return Err(Fault::of_file("no triangles: the file is empty"));
    }
    if bytes[..used].contains(&0) {
        binary(bytes)
    } else {
        ascii(&bytes[..used])
    }
}

fn binary(bytes: &[u8]) -> Result<Mesh, Fault> {
    let (Some(count), Some(data)) = (bytes.get(HEAD - 4..HEAD), bytes.get(HEAD..)) else {
        return Err(Fault::of_file(format!(
            "{} bytes are neither text nor the {HEAD} that a binary STL file begins with",
            bytes.len()
        )));
    };
    let declared = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    let present = data.len() / TRIANGLE;
    let is_whole = data.len().is_multiple_of(TRIANGLE);
    let count = if is_whole && UNKNOWN.contains(&declared) {
        present
    } else {
        declared as usize
    };
    if count > present || is_whole && count < present {
        // Unless it is UTF-16 text.
        text(bytes)?;
        return Err(Fault::of_file(format!(
            "the header declares {declared} triangles, but the file holds {present}: export it again"
        )));
    }
    let mut polygons = Polygons::counted_from(0);
    for (i, triangle) in data.chunks_exact(TRIANGLE).take(count).enumerate() {
        for corner in triangle[12..48].chunks_exact(12) {
            let coordinate = |a: usize| {
                let bytes = [0, 1, 2, 3].map(|i| corner[4 * a + i]);
                f64::from(f32::from_le_bytes(bytes))
            };
            let position = [0, 1, 2].map(coordinate);
            if let Some(fault) = position_fault(position.into()) {
                let what =
                    format!("a corner of triangle {i} (counted from 0) {fault}: {position:?}");
                return Err(Fault::of_file(what));
            }
            polygons.push_corner(polygons.vertex_count() as u32);
            polygons.push_vertex(position, 0);
        }
        polygons.end_face(0);
    }
    polygons.mesh()
}

/// Whether a facet follows.
fn is_facet<'t>(words: &(impl Iterator<Item = &'t [u8]> + Clone)) -> bool {
    let mut ahead = words.clone();
    let mut is_next = |word: &[u8]| ahead.next().is_some_and(|w| w.eq_ignore_ascii_case(word));
    is_next(b"facet") && is_next(b"normal")
}

/// Skips anything before the loop.
fn skip_normal<'t>(words: &mut (impl Iterator<Item = &'t [u8]> + Clone)) {
    let mut ahead = words.clone();
    while ahead
        .next()
        .is_some_and(|w| !w.eq_ignore_ascii_case(b"outer"))
    {
        *words = ahead.clone();
    }
}

/// `facet normal x y z outer loop vertex x y z ... endloop endfacet`, on any number of lines,
/// within `solid name` and `endsolid name`.
fn ascii(bytes: &[u8]) -> Result<Mesh, Fault> {
    let mut lines = Lines::new(text(bytes)?);
    let mut polygons = Polygons::counted_from(0);
    // The line and the number of corners of the open facet.
    let mut facet: Option<(usize, usize)> = None;
    let mut is_solid = false;
    for (line, content) in lines.by_ref() {
        let mut words = words(content);
        while let Some(word) = words.next() {
            let fault = |what: &str| Err(Fault::of_line(line, what));
            match (word.to_ascii_lowercase().as_slice(), &mut facet) {
                (b"solid", None) => {
                    is_solid = true;
                    // A name of any number of words.
                    while !is_facet(&words) && words.next().is_some() {}
                }
                (b"endsolid", None) => {
                    is_solid = false;
                    break;
                }
                (b"facet", None) => {
                    facet = Some((line, 0));
                    skip_normal(&mut words);
                }
                (b"normal", Some((_, 0))) => skip_normal(&mut words),
                (b"outer" | b"loop" | b"endloop", Some(_)) => {}
                (b"vertex", Some((_, corners))) => {
                    let position = coordinates(line, words.by_ref().take(3))?;
                    polygons.push_corner(polygons.vertex_count() as u32);
                    polygons.push_vertex(position, line);
                    *corners += 1;
                }
                (b"endfacet", &mut Some((_, corners))) => {
                    if corners < 3 {
                        return fault("a facet has fewer than three vertices");
                    }
                    polygons.end_face(line);
                    facet = None;
                }
                (b"solid" | b"endsolid" | b"facet", Some(_)) => {
                    return fault("the facet before has no `endfacet`");
                }
                (b"vertex" | b"outer" | b"loop" | b"endloop" | b"endfacet", None) => {
                    return fault("this belongs into a `facet`");
                }
                _ => {
                    let what = format!(
                        "`{}` is not a word of STL: is this an STL file?",
                        printable(word)
                    );
                    return fault(&what);
                }
            }
        }
    }
    if facet.is_some() || is_solid {
        let missing = if facet.is_some() {
            "endfacet"
        } else {
            "endsolid"
        };
        let what = format!("the file ends without `{missing}`: it was cut off");
        return Err(Fault::of_line(lines.number(), what));
    }
    polygons.mesh()
}
