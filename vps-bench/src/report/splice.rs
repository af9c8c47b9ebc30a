//! Splicing tables into a text between marks.

/// Replaces the text between the marks of each table; marks of some tables may be missing.
pub(crate) fn splice_all(text: &str, tables: &[(String, String)]) -> Result<String, String> {
    let mut all = None;
    for (name, table) in tables {
        if let Some(new) = splice(all.as_deref().unwrap_or(text), name, table) {
            all = Some(new);
        }
    }
    let name = tables.first().map_or("NAME", |(name, _)| name);
    all.ok_or_else(|| {
        format!("there are no marks such as `<!-- {name} -->` and `<!-- /{name} -->`")
    })
}

/// Replaces the text between the marks `<!-- name -->` and `<!-- /name -->`; `None` without them.
fn splice(text: &str, name: &str, content: &str) -> Option<String> {
    let (open, close) = (format!("<!-- {name} -->"), format!("<!-- /{name} -->"));
    let start = text.find(&open)? + open.len();
    let end = start + text[start..].find(&close)?;
    Some(format!(
        "{}\n\n{}\n\n{}",
        &text[..start],
        content.trim(),
        &text[end..]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_stands_between_the_marks_is_replaced() {
        let text = "a <!-- t -->old<!-- /t --> b";
        let new = splice(text, "t", "new\n").unwrap();
        assert_eq!(new, "a <!-- t -->\n\nnew\n\n<!-- /t --> b");
        assert_eq!(splice(&new, "t", "new").unwrap(), new);
        assert!(splice(text, "u", "new").is_none());
        assert!(splice("<!-- t -->", "t", "new").is_none());
    }
}
