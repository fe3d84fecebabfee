//! Papers and books, as lists of references have them.

use serde::Serialize;

/// A publication.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Publication {
    /// Names it in a list of references: `runions2007`. Lower-case ASCII letters and digits.
    pub key: &'static str,
    /// What it is.
    pub kind: PublicationKind,
    /// Each as `Family, Given`; at least one.
    pub authors: &'static [&'static str],
    /// As it is printed.
    pub title: &'static str,
    /// When it appeared.
    pub year: u16,
    /// The publisher of a book, the journal, or the conference.
    pub venue: &'static str,
    /// Of the journal, `28`; empty where there is none.
    pub volume: &'static str,
    /// Of the volume, `3`; empty where there is none.
    pub number: &'static str,
    /// `63-70`; empty for whole books.
    pub pages: &'static str,
}

/// What a publication is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PublicationKind {
    /// All of it.
    Book,
    /// In a journal.
    Article,
    /// In the proceedings of a conference.
    InProceedings,
}

impl PublicationKind {
    /// What BibTeX calls it, and the place where it appeared.
    const fn bibtex(self) -> (&'static str, &'static str) {
        match self {
            Self::Book => ("book", "publisher"),
            Self::Article => ("article", "journal"),
            Self::InProceedings => ("inproceedings", "booktitle"),
        }
    }
}

impl Publication {
    /// An entry of a BibTeX file.
    pub fn to_bibtex(&self) -> String {
        let (kind, place) = self.kind.bibtex();
        let (authors, year) = (self.authors.join(" and "), self.year.to_string());
        // Styles lower the letters of titles that are not in braces.
        let title = format!("{{{}}}", self.title);
        let pages = self.pages.replace('-', "--");
        let fields = [
            ("author", &*authors),
            ("title", &title),
            (place, self.venue),
            ("volume", self.volume),
            ("number", self.number),
            ("year", &year),
            ("pages", &pages),
        ];
        let given = fields.iter().filter(|(_, value)| !value.is_empty());
        let lines = given.map(|(name, value)| format!("  {name} = {{{value}}},\n"));
        format!("@{kind}{{{},\n{}}}\n", self.key, lines.collect::<String>())
    }
}

impl std::fmt::Display for Publication {
    /// `Runions, Lane & Prusinkiewicz 2007, Modeling Trees with …. Eurographics …, 63-70`; of a journal
    /// `ACM Transactions on Graphics 28(3), 58:1-58:10`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let families: Vec<&str> =
            self.authors.iter().map(|author| author.split(',').next().unwrap_or(author)).collect();
        let authors = match families.as_slice() {
            [all @ .., before, last] => [all, &[&format!("{before} & {last}")]].concat().join(", "),
            one => one.concat(),
        };
        write!(f, "{authors} {}, {}. {}", self.year, self.title, self.venue)?;
        if !self.volume.is_empty() {
            write!(f, " {}", self.volume)?;
        }
        if !self.number.is_empty() {
            write!(f, "({})", self.number)?;
        }
        if self.pages.is_empty() { Ok(()) } else { write!(f, ", {}", self.pages) }
    }
}

/// Prusinkiewicz & Lindenmayer 1990: L-systems.
pub const ABOP: Publication = Publication {
    key: "prusinkiewicz1990",
    kind: PublicationKind::Book,
    authors: &["Prusinkiewicz, Przemyslaw", "Lindenmayer, Aristid"],
    title: "The Algorithmic Beauty of Plants",
    year: 1990,
    venue: "Springer",
    volume: "",
    number: "",
    pages: "",
};

/// Runions, Lane & Prusinkiewicz 2007: space colonization.
pub const SPACE_COLONIZATION: Publication = Publication {
    key: "runions2007",
    kind: PublicationKind::InProceedings,
    authors: &["Runions, Adam", "Lane, Brendan", "Prusinkiewicz, Przemyslaw"],
    title: "Modeling Trees with a Space Colonization Algorithm",
    year: 2007,
    venue: "Eurographics Workshop on Natural Phenomena",
    volume: "",
    number: "",
    pages: "63-70",
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_has_what_its_kind_asks_for() {
        assert_eq!(
            SPACE_COLONIZATION.to_bibtex(),
            "@inproceedings{runions2007,\n  \
             author = {Runions, Adam and Lane, Brendan and Prusinkiewicz, Przemyslaw},\n  \
             title = {{Modeling Trees with a Space Colonization Algorithm}},\n  \
             booktitle = {Eurographics Workshop on Natural Phenomena},\n  year = {2007},\n  \
             pages = {63--70},\n}\n"
        );
        let book = ABOP.to_bibtex();
        assert!(
            book.starts_with("@book{") && book.contains("publisher = {Springer}") && !book.contains("pages")
        );
    }

    #[test]
    fn volume_and_number_are_fields_of_their_own() {
        let article = Publication {
            kind: PublicationKind::Article,
            venue: "Remote Sensing",
            volume: "11",
            number: "18",
            pages: "2074",
            ..ABOP
        };
        let entry = article.to_bibtex();
        let fields = "  journal = {Remote Sensing},\n  volume = {11},\n  number = {18},\n";
        assert!(entry.starts_with("@article{") && entry.contains(fields), "{entry}");
        assert!(article.to_string().ends_with(". Remote Sensing 11(18), 2074"), "{article}");
        let numbered = Publication { number: "", ..article }.to_string();
        assert!(numbered.ends_with(". Remote Sensing 11, 2074"), "{numbered}");
    }

    #[test]
    fn references_name_all_authors() {
        assert_eq!(
            SPACE_COLONIZATION.to_string(),
            "Runions, Lane & Prusinkiewicz 2007, Modeling Trees with a Space Colonization Algorithm. \
             Eurographics Workshop on Natural Phenomena, 63-70"
        );
        assert_eq!(
            ABOP.to_string(),
            "Prusinkiewicz & Lindenmayer 1990, The Algorithmic Beauty of Plants. Springer"
        );
        let alone = Publication { authors: &["Horton, Robert"], ..ABOP };
        assert!(alone.to_string().starts_with("Horton 1990, "));
    }
}
