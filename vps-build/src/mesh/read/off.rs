//! OFF: counts, vertices and faces, usually each on a line of its own.

use super::Fault;
use super::polygons::Polygons;
use super::text::{Lines, coordinates, integer, printable, text};
use crate::mesh::Mesh;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Fault> {
    let text = text(bytes)?;
    // The format has no lines, but optional colours end with the line.
    by_lines(text).or_else(|fault| by_words(text).ok_or(fault))
}

/// `OFF`, counts of vertices, faces and edges, coordinates, and faces without colours, on any
/// lines. `None` if anything else follows.
fn by_words(text: &[u8]) -> Option<Mesh> {
    let mut lines = Lines::new(text);
    let lines = std::iter::from_fn(|| lines.next_words());
    let mut words = lines.flat_map(|(line, words)| words.map(move |word| (line, word)));
    if !words.next()?.1.eq_ignore_ascii_case(b"OFF") {
        return None;
    }
    let mut count = || integer(words.next()?.1);
    let [vertices, faces, _edges] = [count()?, count()?, count()?];
    let mut polygons = Polygons::counted_from(0);
    for _ in 0..vertices {
        let mut line = 0;
        let position = words.by_ref().take(3).map(|(at, word)| {
            line = at;
            word
        });
        let position = coordinates(0, position).ok()?;
        polygons.push_vertex(position, line);
    }
    for _ in 0..faces {
        let (line, corners) = words.next()?;
        for _ in 0..integer(corners)? {
            let vertex = integer(words.next()?.1)?;
            polygons.push_corner(u32::try_from(vertex).ok()?);
        }
        polygons.end_face(line);
    }
    if words.next().is_some() {
        return None;
    }
    polygons.mesh().ok()
}

/// A vertex or a face on each line, with optional further values.
fn by_lines(text: &[u8]) -> Result<Mesh, Fault> {
    let mut lines = Lines::new(text);
    let [vertices, faces] = counts(&mut lines)?;
    let mut polygons = Polygons::counted_from(0);
    for i in 0..vertices {
        let (line, words) = lines.next_words().ok_or_else(|| {
            Fault::of_file(format!(
                "the header declares {vertices} vertices, but there are {i}"
            ))
        })?;
        polygons.push_vertex(coordinates(line, words)?, line);
    }
    for i in 0..faces {
        let (line, mut words) = lines.next_words().ok_or_else(|| {
            Fault::of_file(format!(
                "the header declares {faces} faces, but there are {i}"
            ))
        })?;
        let fault = |what: String| Fault::of_line(line, what);
        let count = words.next().and_then(integer);
        let count = count
            .filter(|&n| n >= 0)
            .ok_or_else(|| fault("a face must begin with the number of its corners".into()))?;
        for corner in 0..count {
            let word = words
                .next()
                .ok_or_else(|| fault(format!("a face of {count} corners names only {corner}")))?;
            let vertex = integer(word).and_then(|v| u32::try_from(v).ok());
            polygons.push_corner(vertex.ok_or_else(|| {
                fault(format!(
                    "`{}` is not a vertex, counted from 0",
                    printable(word)
                ))
            })?);
        }
        // Colours follow.
        polygons.end_face(line);
    }
    polygons.mesh()
}

/// Reads the header: the numbers of vertices and faces.
fn counts(lines: &mut Lines<'_>) -> Result<[u64; 2], Fault> {
    let Some((mut line, words)) = lines.next_words() else {
        return Err(Fault::of_file(
            "no counts of vertices and faces: the file is empty",
        ));
    };
    let mut words: Vec<_> = words.collect();
    let keyword = keyword(line, words[0])?;
    // Counts may follow the keyword, even without a blank.
    if keyword == words[0] {
        words.remove(0);
    } else {
        words[0] = &words[0][keyword.len()..];
    }
    if words
        .first()
        .is_some_and(|w| w.eq_ignore_ascii_case(b"BINARY"))
    {
        return Err(Fault::of_line(
            line,
            "binary OFF cannot be read: save it as text",
        ));
    }
    let mut next_line = |line: &mut usize| {
        let (number, words) = lines
            .next_words()
            .ok_or_else(|| Fault::of_line(*line, "the file ends before its counts"))?;
        *line = number;
        Ok::<Vec<_>, Fault>(words.collect())
    };
    if keyword.contains(&b'n') {
        if words.is_empty() {
            words = next_line(&mut line)?;
        }
        let dimension = words.remove(0);
        if dimension != b"3" {
            let what = format!(
                "vertices of {} coordinates: only 3 can be read",
                printable(dimension)
            );
            return Err(Fault::of_line(line, what));
        }
    }
    if words.is_empty() {
        words = next_line(&mut line)?;
    }
    let count = |i: usize| {
        words
            .get(i)
            .and_then(|w| integer(w))
            .and_then(|n| u64::try_from(n).ok())
    };
    match [count(0), count(1)] {
        [Some(vertices), Some(faces)] => Ok([vertices, faces]),
        _ => Err(Fault::of_line(line, "no counts of vertices and faces")),
    }
}

/// The keyword at the start of the first word, which may be missing.
fn keyword(line: usize, word: &[u8]) -> Result<&[u8], Fault> {
    if word[0].is_ascii_digit() && integer(word).is_some() {
        return Ok(&[]);
    }
    let Some(end) = word
        .windows(3)
        .position(|w| w.eq_ignore_ascii_case(b"OFF"))
        .map(|start| start + 3)
    else {
        let what = format!("`{}` instead of OFF: is this an OFF file?", printable(word));
        return Err(Fault::of_line(line, what));
    };
    let (keyword, behind) = word.split_at(end);
    let is_known = keyword[..end - 3].iter().all(|b| b"STCN4n".contains(b));
    if !is_known || !behind.iter().all(u8::is_ascii_digit) {
        let what = format!("`{}` is not a kind of OFF", printable(word));
        return Err(Fault::of_line(line, what));
    }
    if keyword.contains(&b'4') {
        let what = "4OFF, vertices of four coordinates: only three can be read";
        return Err(Fault::of_line(line, what));
    }
    Ok(keyword)
}
