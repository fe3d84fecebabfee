//! Text between the tags of XML and HTML.

/// Text as it stands between tags, or in quotes within one.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// What [`escaped`] was given.
pub(crate) fn unescaped(text: &str) -> String {
    text.replace("&quot;", "\"").replace("&gt;", ">").replace("&lt;", "<").replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_escaped_comes_back() {
        for text in ["{\"a\":\"<&>\"}", "&quot;", "plain"] {
            assert_eq!(unescaped(&escaped(text)), text);
        }
    }
}
