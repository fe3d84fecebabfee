//! Recipes out of files that linden wrote: each format knows where its files carry them
//! ([`Exporter::recipe`](crate::Exporter::recipe)), and reads no more of a file than that takes.

use std::io::{self, BufRead, ErrorKind, Read, Seek, SeekFrom};

use linden_pipeline::stage::Stage;

use crate::{Exporter, GENERATOR};

/// Bytes that can be read from any place: an open file behind a [`BufReader`](io::BufReader), or a
/// [`Cursor`](io::Cursor).
pub trait Readable: BufRead + Seek {}

impl<T: BufRead + Seek> Readable for T {}

/// No recipe is longer, and no line that may hold one.
const LONGEST: u64 = 16 << 20;
/// Lines that may stand before a recipe.
const MOST_LINES: usize = 100_000;

/// The recipe that a file in one of these formats, or a preview, carries.
pub(crate) fn in_any(exporters: &[&dyn Exporter], file: &mut dyn Readable) -> io::Result<Option<String>> {
    for exporter in exporters {
        file.rewind()?;
        if let Some(recipe) = whole(exporter.recipe(file))? {
            return Ok(Some(recipe));
        }
    }
    file.rewind()?;
    if let Some(recipe) = whole(linden_pipeline::picture::recipe_in_picture(file))? {
        return Ok(Some(recipe));
    }
    file.rewind()?;
    whole(in_svg(file))
}

/// The recipe in the metadata of a flat drawing, which are its second line.
fn in_svg(file: &mut dyn Readable) -> io::Result<Option<String>> {
    if !begins(file, b"<svg ")? || line(file)?.is_none() {
        return Ok(None);
    }
    let Some(metadata) = line(file)? else { return Ok(None) };
    let escaped = metadata
        .strip_prefix(b"<metadata>linden recipe: ")
        .and_then(|rest| rest.strip_suffix(b"</metadata>"));
    Ok(escaped.and_then(text).map(|text| crate::markup::unescaped(&text)))
}

/// What was read, if it is a JSON object; a file that ends early carries none.
fn whole(read: io::Result<Option<String>>) -> io::Result<Option<String>> {
    match read {
        Ok(found) => Ok(found.filter(|text| is_object(text))),
        Err(error) if matches!(error.kind(), ErrorKind::UnexpectedEof | ErrorKind::InvalidData) => Ok(None),
        Err(error) => Err(error),
    }
}

fn is_object(text: &str) -> bool {
    text.starts_with('{') && serde_json::from_str::<serde::de::IgnoredAny>(text).is_ok()
}

/// A line without its end; `None` at the end of the file, and where the line is longer than any of ours.
pub(crate) fn line(file: &mut dyn Readable) -> io::Result<Option<Vec<u8>>> {
    let mut line = Vec::new();
    file.take(LONGEST).read_until(b'\n', &mut line)?;
    if line.pop_if(|last| *last == b'\n').is_none() {
        return Ok(None);
    }
    line.pop_if(|last| *last == b'\r');
    Ok(Some(line))
}

/// The name and the recipe of what is on a stage: of a tree that is alone those of its scene.
pub(crate) fn of_stage<'a>(stage: &'a Stage<'_>) -> (&'a str, &'a str) {
    match stage.finest().next().filter(|_| stage.is_single()) {
        Some((_, scene)) => (&scene.name, &scene.recipe),
        None => (&stage.name, &stage.recipe),
    }
}

/// Where the foot of the one tree on a stage is in the file that it was grown from: three numbers; `None` where
/// there are several trees or it has no place in a file.
pub(crate) fn foot_in_file(stage: &Stage<'_>) -> Option<[f64; 3]> {
    let (_, scene) = stage.finest().next().filter(|_| stage.is_single())?;
    scene.foot_in_file.map(|foot| foot.to_array())
}

/// [`foot_in_file`] as the end of comments, with what begins each of them; nothing where there is none.
pub(crate) fn foot_comment(stage: &Stage<'_>, mark: &str) -> String {
    foot_in_file(stage).map_or_else(String::new, |[x, y, z]| {
        format!("{mark} foot in the file that it was grown from, its axes and units: {x} {y} {z}\n")
    })
}

/// The comments that a text begins with: what wrote it, a name, the recipe as [`in_comments`] finds it, and what its
/// numbers are.
///
/// ```
/// let head = linden_exporters::writing::comments("fir", "{}", "metres, up axis: Y");
/// assert!(head.ends_with("# name: fir\n# recipe: {}\n# units: metres, up axis: Y\n"));
/// ```
pub fn comments(name: &str, recipe: &str, units: &str) -> String {
    let name = linden_pipeline::knob::printable(name);
    format!("# {GENERATOR}\n# name: {name}\n# recipe: {recipe}\n# units: {units}\n")
}

/// The recipe in the comments that a text begins with: the line that starts with `# recipe: `.
///
/// # Errors
/// What reading failed with.
pub fn in_comments(file: &mut dyn Readable) -> io::Result<Option<String>> {
    for _ in 0..MOST_LINES {
        // Looked at before the line is read: what begins otherwise may have no lines at all.
        if file.fill_buf()?.first() != Some(&b'#') {
            return Ok(None);
        }
        let Some(line) = line(file)? else { return Ok(None) };
        if let Some(recipe) = line.strip_prefix(b"# recipe: ") {
            return Ok(text(recipe));
        }
    }
    Ok(None)
}

/// Whether the file goes on like this; if so, it is read past it.
pub(crate) fn begins(file: &mut dyn Readable, opening: &[u8]) -> io::Result<bool> {
    let mut found = Vec::new();
    file.take(opening.len() as u64).read_to_end(&mut found)?;
    Ok(found == opening)
}

pub(crate) fn text(bytes: &[u8]) -> Option<String> {
    String::from_utf8(bytes.to_vec()).ok()
}

/// The lines in which a recipe may stand.
pub(crate) fn lines(file: &mut dyn Readable) -> impl Iterator<Item = io::Result<Vec<u8>>> {
    (0..MOST_LINES).map_while(|_| line(file).transpose())
}

/// What stands behind a beginning in one of the first lines: the first that begins so.
pub(crate) fn line_behind(file: &mut dyn Readable, beginning: &str) -> io::Result<Option<String>> {
    for line in lines(file) {
        if let Some(rest) = line?.strip_prefix(beginning.as_bytes()) {
            return Ok(text(rest));
        }
    }
    Ok(None)
}

/// A number of four bytes, the least first.
pub(crate) fn word(file: &mut dyn Readable) -> io::Result<u32> {
    let mut bytes = [0; 4];
    file.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

/// Goes on so many bytes further.
pub(crate) fn skip(file: &mut dyn Readable, bytes: i64) -> io::Result<()> {
    file.seek(SeekFrom::Current(bytes)).map(drop)
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::{BufReader, Cursor};

    use linden_pipeline::Quiet;
    use linden_pipeline::dress::dress;
    use linden_pipeline::grow::grow;
    use linden_pipeline::preset::builtin;
    use linden_pipeline::recipe::Recipe;
    use linden_pipeline::scene::Scene;
    use linden_pipeline::stage::Stage;

    use super::*;
    use crate::{Bundle, Exporter, Options, REGISTRY, recipe_in};

    /// Counts what is read.
    struct Counted<R>(R, u64);

    impl<R: Read> Read for Counted<R> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.0.read(buffer)?;
            self.1 += count as u64;
            Ok(count)
        }
    }

    impl<R: Seek> Seek for Counted<R> {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.0.seek(to)
        }
    }

    fn scene() -> Scene {
        let mut preset = builtin("fir").unwrap().load().unwrap();
        // A recipe of several lines in a PLY, with letters that each format writes in its way.
        preset.name = "Fünf \"Tannen\" \\ {}".to_owned();
        preset.set("bark_size", "64").unwrap();
        let recipe = Recipe::new(preset);
        dress(&recipe, &grow(&recipe, &Quiet).unwrap(), &Quiet).unwrap()
    }

    fn written(scene: &Scene, exporter: &dyn Exporter, set: &[(&str, &str)]) -> (tempfile::TempDir, File) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("tree");
        let mut options = Options::new(exporter.format());
        for (name, value) in set {
            options.set(name, value).unwrap();
        }
        let mut bundle = Bundle::create(&path).unwrap();
        exporter.write(&Stage::of(scene), &options, &mut bundle, &Quiet).unwrap();
        bundle.commit().unwrap();
        let file = File::open(path).unwrap();
        (dir, file)
    }

    #[test]
    fn every_format_gives_its_recipe_back() {
        let scene = scene();
        for exporter in REGISTRY {
            let id = exporter.format().id;
            let (_dir, mut file) = written(&scene, *exporter, &[]);
            let length = file.metadata().unwrap().len();
            let mut counted = BufReader::new(Counted(&mut file, 0));
            let found = exporter.recipe(&mut counted).unwrap();
            if !exporter.format().holds.recipe {
                assert_eq!(found, None, "{id}");
                assert_eq!(recipe_in(&mut BufReader::new(&mut file)).unwrap(), None, "{id}");
                continue;
            }
            assert_eq!(found.as_deref(), Some(scene.recipe.as_str()), "{id}: a format carries its recipe");
            // The document of a glTF is JSON beside the geometry; all else stands in a header.
            let read = counted.into_inner().1;
            assert!(read < 64 << 10 && read <= length, "{id}: {read} of {length} bytes were read");
            assert_eq!(
                recipe_in(&mut BufReader::new(&mut file)).unwrap().as_ref(),
                Some(&scene.recipe),
                "{id}"
            );
        }
    }

    #[test]
    fn options_do_not_lose_it() {
        let scene = scene();
        for (id, set) in [
            ("obj", &[("lines", "true")][..]),
            ("ply", &[("encoding", "ascii")]),
            ("ply-skeleton", &[("encoding", "ascii")]),
            ("gltf", &[("embed", "true")]),
            ("glb", &[("instances", "true")]),
            ("glb", &[("quantize", "true"), ("compress", "meshopt")]),
            ("usda", &[("skeleton", "false"), ("pictures", "false")]),
            ("usdc", &[("skeleton", "false"), ("pictures", "false")]),
            ("usdz", &[("flavor", "ar")]),
            ("usdz", &[("layer", "binary")]),
        ] {
            let (_dir, file) = written(&scene, crate::find(id).unwrap(), set);
            let found = recipe_in(&mut BufReader::new(file)).unwrap();
            assert_eq!(found.as_ref(), Some(&scene.recipe), "{id} {set:?}");
        }
    }

    #[test]
    fn broken_crate_files_are_no_fault() {
        let (_dir, mut file) = written(&scene(), crate::find("usdc").unwrap(), &[]);
        let mut whole = Vec::new();
        file.read_to_end(&mut whole).unwrap();
        let known = recipe_in(&mut Cursor::new(&whole)).unwrap();
        assert!(known.is_some());
        // Cut anywhere, and each byte of the head, the names and the contents turned.
        for end in (0..whole.len()).step_by(1 + whole.len() / 500) {
            assert_eq!(recipe_in(&mut Cursor::new(&whole[..end])).unwrap(), None, "{end}");
        }
        let sections = whole.windows(7).rposition(|window| window == b"TOKENS\0").unwrap();
        let word = |at: usize| u64::from_le_bytes(*whole[at..].first_chunk().unwrap()) as usize;
        let (tokens, size) = (word(sections + 16), word(sections + 24));
        let places = (0..88).chain(tokens..tokens + size).chain(sections - 8..whole.len());
        for at in places {
            for turned in [0x01, 0x80, 0xff] {
                let mut broken = whole.clone();
                broken[at] ^= turned;
                // What is found may have lost a letter; nothing panics, nothing takes all memory.
                recipe_in(&mut Cursor::new(&broken)).unwrap();
            }
        }
    }

    #[test]
    fn files_of_others_carry_none() {
        let long = [b"# ".as_slice(), &vec![b'a'; 100_000]].concat();
        for bytes in [
            &b""[..],
            b"#",
            b"# recipe: no object\nv 0 0 0\n",
            b"# a comment\nv 0 0 0\n# recipe: {}\n",
            b"ply\nformat ascii 1.0\ncomment recipe: {\nelement vertex 0\nend_header\n",
            b"glTF\x02\0\0\0",
            b"glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON{\"nodes\":[",
            b"glTF\x02\0\0\0\x20\0\0\0\x08\0\0\0BIN\0{}",
            b"PXR-USDC",
            &[&b"PXR-USDC\0\x08\0\0\0\0\0\0"[..], &[0xff; 80]].concat(),
            b"PK\x03\x04",
            b"PK\x03\x04\x0a\0\0\0\0\0\0\0\x21\0\0\0\0\0\0\0\0\0\0\0\0\0\xff\xff\xff\xff",
            b"#usda 1.0\n  string recipe = \"{",
            b"#usda 1.0\n  string recipe = 7\n",
            b"\x89PNG\r\n\x1a\n\xff\xff\xff\xfftEXt",
            b"\xff\xd8\xff\xe1\xff\xffExif\0\0II\x2a\0\x08\0\0\0",
            b"RIFF\xff\xff\xff\xffWEBPEXIF\xff\xff\xff\xff",
            b"{\"nodes\":[{\"extras\":{\"linden\":\"text\"}}]}",
            &long,
            &vec![0; 100_000],
        ] {
            let found = recipe_in(&mut Cursor::new(bytes)).unwrap();
            assert_eq!(found, None, "{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(60)]));
        }
    }
}
