//! Stanford PLY: a header that describes the elements, then the elements as text or binary.

use super::Fault;
use super::polygons::Polygons;
use super::text::{Lines, number, printable, text, words};
use crate::mesh::Mesh;

/// Names of the list of a face's corners.
const CORNERS: [&[u8]; 3] = [b"vertex_indices", b"vertex_index", b"vertex_indexes"];

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let (encoding, elements, lines) = header(text(bytes)?)?;
    let mut body = match encoding {
        Encoding::Text => Body::Text(lines),
        Encoding::Binary { big_endian } => Body::Binary {
            rest: lines.rest(),
            big_endian,
        },
    };
    let mut polygons = Polygons::counted_from(0);
    let mut has_faces = false;
    for element in &elements {
        match element.name {
            b"vertex" => vertices(&mut body, element, &mut polygons)?,
            b"face" => {
                has_faces = true;
                faces(&mut body, element, &mut polygons)?;
            }
            b"tristrips" => {
                has_faces = true;
                strips(&mut body, element, &mut polygons)?;
            }
            _ => body.skip(element)?,
        }
    }
    if !has_faces {
        return Err(Fault::of_file(
            "no triangles: the file is a point cloud, make a mesh of it first",
        ));
    }
    polygons.mesh()
}

enum Encoding {
    Text,
    Binary { big_endian: bool },
}

/// A sequence of elements of one kind.
struct Element<'t> {
    name: &'t [u8],
    count: u64,
    properties: Vec<Property<'t>>,
    /// Its line in the header.
    line: usize,
}

struct Property<'t> {
    name: &'t [u8],
    kind: Scalar,
    /// The type of the item count, if it is a list.
    list: Option<Scalar>,
}

#[derive(Clone, Copy)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number in these bytes, which are as many as its size.
    fn value(self, bytes: &[u8], big_endian: bool) -> f64 {
        fn array<const N: usize>(bytes: &[u8], big_endian: bool) -> [u8; N] {
            std::array::from_fn(|i| bytes[if big_endian { N - 1 - i } else { i }])
        }
        let big = big_endian;
        match self {
            Self::I8 => i8::from_le_bytes(array(bytes, big)).into(),
            Self::U8 => bytes[0].into(),
            Self::I16 => i16::from_le_bytes(array(bytes, big)).into(),
            Self::U16 => u16::from_le_bytes(array(bytes, big)).into(),
            Self::I32 => i32::from_le_bytes(array(bytes, big)).into(),
            Self::U32 => u32::from_le_bytes(array(bytes, big)).into(),
            Self::F32 => f32::from_le_bytes(array(bytes, big)).into(),
            Self::F64 => f64::from_le_bytes(array(bytes, big)),
        }
    }
}

impl Element<'_> {
    /// The index of the property with one of these names.
    fn find(&self, names: &[&[u8]]) -> Option<usize> {
        self.properties.iter().position(|p| names.contains(&p.name))
    }
}

/// Reads the header. The remaining lines are the body.
fn header(bytes: &[u8]) -> Result<(Encoding, Vec<Element<'_>>, Lines<'_>), Fault> {
    let mut lines = Lines::new(bytes);
    if lines
        .next()
        .is_none_or(|(_, line)| line.trim_ascii() != b"ply")
    {
        let what = "the first line is not `ply`: is this a PLY file?";
        return Err(Fault::of_line(1, what));
    }
    let mut encoding = None;
    let mut elements: Vec<Element<'_>> = Vec::new();
    while let Some((line, content)) = lines.next() {
        let fault = || {
            let what = format!(
                "`{}` is not a line of a PLY header",
                printable(content.trim_ascii())
            );
            Fault::of_line(line, what)
        };
        let words: Vec<_> = words(content).collect();
        match words.as_slice() {
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", b"ascii", ..] => encoding = Some(Encoding::Text),
            [
                b"format",
                order @ (b"binary_little_endian" | b"binary_big_endian"),
                ..,
            ] => {
                let big_endian = *order == b"binary_big_endian";
                encoding = Some(Encoding::Binary { big_endian });
            }
            [b"element", name, count] => elements.push(Element {
                name,
                count: str::from_utf8(count)
                    .ok()
                    .and_then(|c| c.parse().ok())
                    .ok_or_else(fault)?,
                properties: Vec::new(),
                line,
            }),
            [b"property", described @ ..] => {
                let kind = |word: &[u8]| Scalar::of(word).ok_or_else(fault);
                let property = match described {
                    [b"list", count, item, name] => Property {
                        name,
                        kind: kind(item)?,
                        list: Some(kind(count)?),
                    },
                    [scalar, name] => Property {
                        name,
                        kind: kind(scalar)?,
                        list: None,
                    },
                    _ => return Err(fault()),
                };
                elements
                    .last_mut()
                    .ok_or_else(fault)?
                    .properties
                    .push(property);
            }
            [b"end_header"] => {
                let encoding = encoding
                    .ok_or_else(|| Fault::of_line(line, "the header has no line `format`"))?;
                return Ok((encoding, elements, lines));
            }
            _ => return Err(fault()),
        }
    }
    Err(Fault::of_line(
        lines.number(),
        "the header has no line `end_header`",
    ))
}

/// The elements after the header.
enum Body<'t> {
    Text(Lines<'t>),
    Binary { rest: &'t [u8], big_endian: bool },
}

impl Body<'_> {
    /// Reads the n-th element: calls `visit` with the property and the value of each number.
    /// Returns its line, or 0 in a binary file.
    fn read(
        &mut self,
        element: &Element<'_>,
        n: u64,
        mut visit: impl FnMut(usize, f64),
    ) -> Result<usize, Fault> {
        let cut_off = || {
            let (count, name) = (element.count, printable(element.name));
            Fault::of_file(format!(
                "the header declares {count} elements `{name}`, but the file ends in number {n}"
            ))
        };
        match self {
            Self::Text(lines) => {
                let (line, content) = lines
                    .find(|(_, content)| !content.trim_ascii().is_empty())
                    .ok_or_else(cut_off)?;
                let mut words = words(content);
                for (p, property) in element.properties.iter().enumerate() {
                    let mut next = || {
                        let name = || printable(property.name);
                        let word = words.next().ok_or_else(|| {
                            Fault::of_line(line, format!("no number for `{}`", name()))
                        })?;
                        number(word).ok_or_else(|| {
                            let what =
                                format!("`{}` is not a number for `{}`", printable(word), name());
                            Fault::of_line(line, what)
                        })
                    };
                    if property.list.is_some() {
                        let count = next()?;
                        let items = whole(count).ok_or_else(|| {
                            Fault::of_line(line, format!("a list cannot have {count} items"))
                        })?;
                        for _ in 0..items {
                            visit(p, next()?);
                        }
                    } else {
                        visit(p, next()?);
                    }
                }
                Ok(line)
            }
            Self::Binary { rest, big_endian } => {
                let mut take = |scalar: Scalar| {
                    let (bytes, behind) =
                        rest.split_at_checked(scalar.size()).ok_or_else(cut_off)?;
                    *rest = behind;
                    Ok::<_, Fault>(scalar.value(bytes, *big_endian))
                };
                for (p, property) in element.properties.iter().enumerate() {
                    if let Some(counter) = property.list {
                        let count = take(counter)?;
                        let items = whole(count).ok_or_else(|| {
                            let name = printable(element.name);
                            let what = format!("in `{name}` {n}, a list cannot have {count} items");
                            Fault::of_file(what)
                        })?;
                        for _ in 0..items {
                            visit(p, take(property.kind)?);
                        }
                    } else {
                        visit(p, take(property.kind)?);
                    }
                }
                Ok(0)
            }
        }
    }

    /// Skips elements that do not matter for the shape.
    fn skip(&mut self, element: &Element<'_>) -> Result<(), Fault> {
        // Without properties, elements take no bytes.
        let count = if element.properties.is_empty() {
            0
        } else {
            element.count
        };
        for n in 0..count {
            self.read(element, n, |_, _| ())?;
        }
        Ok(())
    }
}

/// A number as a count or an index.
fn whole(number: f64) -> Option<u32> {
    let is_whole = number >= 0.0 && number < f64::from(u32::MAX) && number.fract() == 0.0;
    is_whole.then_some(number as u32)
}

fn vertices(
    body: &mut Body<'_>,
    element: &Element<'_>,
    polygons: &mut Polygons,
) -> Result<(), Fault> {
    let [Some(x), Some(y), Some(z)] = [b"x", b"y", b"z"].map(|name| element.find(&[name])) else {
        let what = "a vertex needs the properties x, y and z";
        return Err(Fault::of_line(element.line, what));
    };
    for n in 0..element.count {
        let mut position = [0.0; 3];
        let line = body.read(element, n, |property, value| {
            for (coordinate, wanted) in position.iter_mut().zip([x, y, z]) {
                if property == wanted {
                    *coordinate = value;
                }
            }
        })?;
        polygons.push_vertex(position, line);
    }
    Ok(())
}

/// The list of corners of a face or a strip.
fn corners(element: &Element<'_>) -> Result<usize, Fault> {
    let list = element.find(&CORNERS);
    let list = list.filter(|&p| element.properties[p].list.is_some());
    list.ok_or_else(|| {
        let what = format!("`{}` needs a list vertex_indices", printable(element.name));
        Fault::of_line(element.line, what)
    })
}

fn missing_vertex(line: usize, element: &Element<'_>, n: u64, value: f64) -> Fault {
    let name = printable(element.name);
    let what = format!("{name} {n} (counted from 0) refers to vertex {value}");
    Fault::at(line, what)
}

fn faces(body: &mut Body<'_>, element: &Element<'_>, polygons: &mut Polygons) -> Result<(), Fault> {
    let list = corners(element)?;
    for n in 0..element.count {
        let mut bad = None;
        let line = body.read(element, n, |property, value| {
            if property == list {
                match whole(value) {
                    Some(vertex) => polygons.push_corner(vertex),
                    None => bad = Some(value),
                }
            }
        })?;
        if let Some(value) = bad {
            return Err(missing_vertex(line, element, n, value));
        }
        polygons.end_face(line);
    }
    Ok(())
}

/// Triangle strips: every second triangle is reversed, and -1 restarts the strip.
fn strips(
    body: &mut Body<'_>,
    element: &Element<'_>,
    polygons: &mut Polygons,
) -> Result<(), Fault> {
    let list = corners(element)?;
    for n in 0..element.count {
        let mut strip = Vec::new();
        let line = body.read(element, n, |property, value| {
            if property == list {
                strip.push(value);
            }
        })?;
        for strip in strip.split(|&vertex| vertex == -1.0) {
            for (i, triangle) in strip.windows(3).enumerate() {
                let turned = if i % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] };
                // A repeated vertex makes no triangle, but reverses the next one.
                if triangle[0] == triangle[1]
                    || triangle[1] == triangle[2]
                    || triangle[0] == triangle[2]
                {
                    continue;
                }
                for value in turned.map(|i| triangle[i]) {
                    let vertex = whole(value);
                    polygons.push_corner(
                        vertex.ok_or_else(|| missing_vertex(line, element, n, value))?,
                    );
                }
                polygons.end_face(line);
            }
        }
    }
    Ok(())
}
