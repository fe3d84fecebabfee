//! Links and pictures: every one that is relative leads to a file, and to a heading of it where it names one.

use std::path::Path;

use crate::{pages, read, root};

/// What is linked to from a page, with the line: the targets of `[…](target)` outside code.
fn targets(page: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut is_code = false;
    for (i, line) in page.lines().enumerate() {
        if line.starts_with("```") {
            is_code = !is_code;
        }
        if is_code {
            continue;
        }
        let text = without_code(line);
        for part in text.split("](").skip(1) {
            if let Some((target, _)) = part.split_once(')') {
                found.push((i + 1, target.to_owned()));
            }
        }
    }
    found
}

/// Whether a path is a document's.
fn is_page(path: &str) -> bool {
    Path::new(path).extension().is_some_and(|ending| ending == "md")
}

/// A line without what stands between backticks.
fn without_code(line: &str) -> String {
    line.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "`" }).collect()
}

/// The anchors of a page's headings, as hosts make them.
fn anchors(page: &str) -> Vec<String> {
    let mut is_code = false;
    let mut found = Vec::new();
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        let heading = line.trim_start_matches('#');
        if !is_code && heading.len() < line.len() && heading.starts_with(' ') {
            let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            found.push(kept.collect::<String>().to_lowercase().replace(' ', "-"));
        }
    }
    found
}

/// What is wrong with a page's links.
fn faults(path: &str, page: &str) -> Vec<String> {
    let folder = root().join(path).parent().map(ToOwned::to_owned).unwrap_or_default();
    let mut faults = Vec::new();
    for (line, target) in targets(page) {
        if target.contains("://") || target.starts_with("mailto:") {
            continue;
        }
        let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
        let there = if file.is_empty() { root().join(path) } else { folder.join(file) };
        if !there.exists() {
            faults.push(format!("{path}:{line}: {target} leads nowhere"));
        } else if !anchor.is_empty() {
            let text = std::fs::read_to_string(&there).unwrap_or_default();
            if !anchors(&text).iter().any(|known| known == anchor) {
                faults.push(format!("{path}:{line}: {target}: no such heading"));
            }
        }
    }
    faults
}

#[test]
fn links_lead_somewhere() {
    let faults: Vec<String> = pages().iter().flat_map(|path| faults(path, &read(path))).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_document_can_be_reached_from_the_readme() {
    let mut reached = vec!["README.md".to_owned()];
    let mut next = 0;
    while next < reached.len() {
        let path = reached[next].clone();
        next += 1;
        for (_, target) in targets(&read(&path)) {
            let file = target.split('#').next().unwrap_or_default();
            let folder = path.rsplit_once('/').map_or("", |(folder, _)| folder);
            let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
            for part in file.split('/') {
                if part == ".." {
                    parts.pop();
                } else {
                    parts.push(part);
                }
            }
            let file = parts.join("/");
            if is_page(&file) && !reached.contains(&file) && root().join(&file).exists() {
                reached.push(file);
            }
        }
    }
    let lost: Vec<String> = pages()
        .into_iter()
        .filter(|page| !page.contains('/') || page.starts_with("docs/"))
        .filter(|page| !reached.contains(page))
        .collect();
    assert!(lost.is_empty(), "no link leads to {lost:?}");
}

#[test]
fn broken_links_are_found() {
    let page = "# A heading, `code`\n[a](README.md) [b](no.md) [c](#a-heading-code) [d](#none) `[e](f)`\n\
                ```sh\n[g](h)\n```\n![i](presets/GALLERY.md#plants) [j](https://a.example/b.md)\n";
    let said = faults("x.md", page);
    assert!(said[0].starts_with("x.md:2: no.md leads nowhere"), "{said:?}");
    // The anchors are looked for in the file, which is not there.
    assert!(
        said.iter().any(|fault| fault.contains("no.md")) && !said.iter().any(|fault| fault.contains("'f'"))
    );
    assert_eq!(anchors(page), ["a-heading-code"]);
    assert_eq!(targets(page).len(), 6);
}
