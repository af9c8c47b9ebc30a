//! Lines, words and numbers of text files of any origin.

use super::Fault;

/// The text without its byte order mark.
///
/// # Errors
/// When the text is UTF-16.
pub(super) fn text(bytes: &[u8]) -> Result<&[u8], Fault> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(Fault::of_file("UTF-16 text: save it as UTF-8 or ASCII"));
    }
    Ok(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
}

/// The lines of a text, numbered from 1. A line ends with `\n`, `\r\n` or `\r`.
#[derive(Clone)]
pub(super) struct Lines<'t> {
    rest: &'t [u8],
    number: usize,
}

impl<'t> Lines<'t> {
    pub(super) fn new(text: &'t [u8]) -> Self {
        Self {
            rest: text,
            number: 0,
        }
    }

    /// The text after the lines taken so far.
    pub(super) fn rest(&self) -> &'t [u8] {
        self.rest
    }

    /// The number of the last line taken.
    pub(super) fn number(&self) -> usize {
        self.number
    }

    /// The next line with a word before any comment, as words.
    pub(super) fn next_words(
        &mut self,
    ) -> Option<(usize, impl Iterator<Item = &'t [u8]> + use<'t>)> {
        self.find_map(|(number, line)| {
            let line = without_comment(line).trim_ascii();
            (!line.is_empty()).then(|| (number, words(line)))
        })
    }
}

impl<'t> Iterator for Lines<'t> {
    type Item = (usize, &'t [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r');
        let (line, rest) = match end {
            Some(end) => (&self.rest[..end], &self.rest[end..]),
            None => (self.rest, &[][..]),
        };
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        self.number += 1;
        Some((self.number, line))
    }
}

/// A line up to a `#`, unless it is part of a number such as `1.#INF`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let begins = |&i: &usize| line[i] == b'#' && (i == 0 || line[i - 1] != b'.');
    let end = (0..line.len()).find(begins);
    &line[..end.unwrap_or(line.len())]
}

/// Words separated by blanks. The end-of-file mark of some systems counts as a blank.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(|b| b.is_ascii_whitespace() || matches!(b, 0x0b | 0x1a))
        .filter(|word| !word.is_empty())
}

/// A number as written by C, C++ or Fortran. May be infinite or NaN.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| {
        // NaN as written by C libraries.
        let lower = text.trim_start_matches(['-', '+']).to_ascii_lowercase();
        if lower.starts_with("nan(") || lower.starts_with("1.#") {
            return Some(f64::NAN);
        }
        // Fortran's double-precision exponents.
        let is_double = text.contains(['d', 'D']) && !text.contains(['n', 'N']);
        let text = is_double.then(|| text.replace(['d', 'D'], "e"))?;
        text.parse().ok()
    })
}

/// Three coordinates at the start of a line. Further values do not matter for the shape.
pub(super) fn coordinates<'t>(
    line: usize,
    words: impl Iterator<Item = &'t [u8]>,
) -> Result<[f64; 3], Fault> {
    let mut position = [0.0; 3];
    let mut words = words;
    for (i, coordinate) in position.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| {
            Fault::of_line(line, format!("a vertex needs three coordinates, not {i}"))
        })?;
        *coordinate = number(word).ok_or_else(|| {
            let hint = if word.contains(&b',') {
                ": decimals need a point"
            } else {
                ""
            };
            let what = format!("`{}` is not a coordinate{hint}", printable(word));
            Fault::of_line(line, what)
        })?;
    }
    Ok(position)
}

/// An integer.
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    str::from_utf8(word).ok()?.parse().ok()
}

/// A word for a message: shortened, without control characters.
pub(super) fn printable(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let start = String::from_utf8_lossy(&word[..word.len().min(LONGEST)]);
    let more = if word.len() > LONGEST { "..." } else { "" };
    format!("{}{more}", start.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_as_on_any_system() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\nc\r\rd").collect();
        let expected: [(usize, &[u8]); 5] = [(1, b"a"), (2, b"b"), (3, b"c"), (4, b""), (5, b"d")];
        assert_eq!(lines, expected);
        assert!(text(b"\xff\xfev\0 \0").is_err());
        assert_eq!(text(b"\xef\xbb\xbfv").unwrap(), b"v");
    }

    #[test]
    fn numbers_as_programs_write_them() {
        for (word, value) in [
            ("1.", 1.0),
            (".5", 0.5),
            ("-.5e-1", -0.05),
            ("+3", 3.0),
            ("1E5", 1e5),
            ("1.5D+02", 150.0),
            ("2d0", 2.0),
        ] {
            assert_eq!(number(word.as_bytes()), Some(value), "{word}");
        }
        assert!(number(b"-inf").unwrap() < 0.0);
        for word in ["NaN", "-nan(ind)", "-1.#IND", "1.#QNAN", "1.#INF"] {
            assert!(number(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
        assert_eq!(without_comment(b"v 1.#INF 2 # place"), b"v 1.#INF 2 ");
        for word in ["1,5", "0x10", "d", "", "1e", "end", "nano"] {
            assert_eq!(number(word.as_bytes()), None, "{word}");
        }
    }
}
