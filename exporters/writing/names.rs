//! Names that readers take: what a user calls a tree may hold blanks, quotes and any letter.

/// A name of one word: letters and digits of any script, `-`, `_` and `.`; all else becomes `_`.
///
/// ```
/// assert_eq!(linden_exporters::writing::one_word("Ölbaum 3/b"), "Ölbaum_3_b");
/// ```
pub fn one_word(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}

/// A name of lower-case ASCII letters, digits and `_`.
///
/// ```
/// assert_eq!(linden_exporters::writing::identifier("Norway spruce"), "norway_spruce");
/// ```
pub fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect()
}
