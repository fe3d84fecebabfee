//! Tells what a file is by what it holds; its name only decides between what the content leaves open.

use super::table::Layout;
use super::{InputError, cylinders, geotiff, grid, lines, mat, ply, ptx, text_of, xyz};

/// What a file is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// A preset: TOML.
    Preset,
    /// A recipe: JSON.
    Recipe,
    /// A grammar in the older text format.
    Grammar,
    /// Parameters of a tree by Weber and Penn: XML of Arbaro, lines of names and values, Python literals.
    TreeParameters,
    /// An OBJ mesh: a crown envelope.
    ObjMesh,
    /// A PLY file with faces: a crown envelope.
    PlyMesh,
    /// A PLY file without faces: attraction points.
    PlyPoints,
    /// Rows of numbers, CSV and PTS among them: attraction points.
    XyzPoints,
    /// LAS or LAZ: points of a survey.
    LasPoints,
    /// E57: the stands of a scanner.
    E57Points,
    /// PCD: points of the Point Cloud Library.
    PcdPoints,
    /// PTX: the stands of a scanner as text.
    PtxPoints,
    /// Esri's ASCII grid, or `GeoTIFF`: heights of a canopy.
    HeightGrid,
    /// A table of cylinders: a tree that was measured or grown elsewhere.
    Cylinders {
        /// Whether it has a radius for each end.
        tapered: bool,
    },
}

/// Openings of files of points that are told by them alone.
const CLOUDS: &[(&[u8], InputKind)] = &[
    (b"LASF", InputKind::LasPoints),
    (b"ASTM-E57", InputKind::E57Points),
    (b"# .PCD", InputKind::PcdPoints),
    (b"VERSION 0.7\nFIELDS", InputKind::PcdPoints),
    (b"VERSION .7\nFIELDS", InputKind::PcdPoints),
];

const TIFF: &str = "is a TIFF picture that does not say where its pixels lie on the ground; heights of a canopy need that \
                    (GeoTIFF), and for a leaf or bark save it as PNG, JPEG, WebP or TGA";

/// Openings of files that users may try, and what to say.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"glTF", "is a glTF binary; export the mesh as OBJ or PLY"),
    (b"Kaydara FBX", "is an FBX file; export the mesh as OBJ or PLY"),
    (b"BLENDER", "is a Blender file; export the mesh as OBJ or PLY"),
    (b"PXR-USDC", "is a USD file; export the mesh as OBJ or PLY"),
    (b"#usda", "is a USD file; export the mesh as OBJ or PLY"),
    (b"solid ", "is an STL mesh; export it as OBJ or PLY"),
    (b"OFF\n", "is an OFF mesh; export it as OBJ or PLY"),
    (b"<", "is XML or HTML, not a preset, a grammar, a mesh or points"),
    (b"\x89PNG", "is a picture"),
    (b"\xff\xd8\xff", "is a picture"),
    (b"RIFF", "is a picture (WebP) or a sound"),
    (b"GIF8", "is a picture; for a leaf or bark save it as PNG, JPEG, WebP or TGA"),
    (b"II*\0", TIFF),
    (b"MM\0*", TIFF),
    (b"II+\0", TIFF),
    (b"MM\0+", TIFF),
    (b"\x1f\x8b", "is compressed; unpack it first"),
    (b"PK\x03\x04", "is compressed; unpack it first"),
    (b"\x28\xb5\x2f\xfd", "is compressed; unpack it first"),
    (b"%PDF", "is a PDF document"),
];

/// Tells what a file is. `file_name` (a name or path, or empty) decides only where the content fits
/// two kinds, such as a file of nothing but `angle=20`.
///
/// Whether the file is whole and right is for its reader to say.
///
/// # Errors
/// [`InputError`]: empty, binary or otherwise unknown content, text that is not UTF-8, a broken PLY
/// header.
pub fn sniff(bytes: &[u8], file_name: &str) -> Result<InputKind, InputError> {
    if bytes.is_empty() {
        return Err(InputError::Empty);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        let faces = ply::announces_faces(bytes)?;
        return Ok(if faces { InputKind::PlyMesh } else { InputKind::PlyPoints });
    }
    if let Some((_, kind)) = CLOUDS.iter().find(|(opening, _)| bytes.starts_with(opening)) {
        return Ok(*kind);
    }
    if bytes.starts_with(mat::OPENING) || bytes.starts_with(mat::OPENING_HDF5) {
        return Ok(InputKind::Cylinders { tapered: false });
    }
    if geotiff::is_geotiff(bytes) {
        return Ok(InputKind::HeightGrid);
    }
    if is_arbaro(bytes) {
        return Ok(InputKind::TreeParameters);
    }
    if let Some((_, looks)) = FOREIGN.iter().find(|(opening, _)| bytes.starts_with(opening)) {
        return Err(InputError::Unknown { looks });
    }
    let is_utf16 = matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]);
    if bytes.contains(&0) && !is_utf16 {
        return Err(InputError::Unknown { looks: "is binary data of no kind that linden reads" });
    }
    let text = text_of(bytes)?;
    if let Some(rest) = text.trim_start().strip_prefix('{') {
        // JSON has no single quotes: this is a dict of Python's.
        let is_dict = rest.trim_start().starts_with('\'');
        return Ok(if is_dict { InputKind::TreeParameters } else { InputKind::Recipe });
    }
    if ptx::is_ptx(text) {
        return Ok(InputKind::PtxPoints);
    }
    if grid::is_grid(text) {
        return Ok(InputKind::HeightGrid);
    }
    if is_cpfg(text) {
        return Err(InputError::Unknown { looks: CPFG });
    }
    let mut assigns = false;
    for (_, line) in lines(text) {
        let line = line.trim();
        if line.is_empty() || xyz::is_comment(line) {
            continue;
        }
        match evidence(line) {
            Evidence::For(kind) => return Ok(kind),
            Evidence::PresetOrGrammar => assigns = true,
            Evidence::None => {}
        }
    }
    if !assigns {
        let looks = "is text, but no preset, grammar, OBJ or PLY mesh, nor rows of three numbers";
        return Err(InputError::Unknown { looks });
    }
    match extension(file_name).as_str() {
        "txt" | "l" => Ok(InputKind::Grammar),
        _ => Ok(InputKind::Preset),
    }
}

const CPFG: &str = "is an L-system of cpfg (L-studio); write 'axiom=F' for 'Axiom: F', 'number of derivations=5' for \
                    'derivation length: 5', a line 'angle=25', and '->' for '-->' (docs/grammar.md has a table)";

/// Whether this is an L-system of cpfg: its keys, each with a colon behind it.
fn is_cpfg(text: &str) -> bool {
    const KEYS: [&str; 3] = ["lsystem:", "derivation length:", "axiom:"];
    let begins =
        |line: &str, key: &str| line.get(..key.len()).is_some_and(|found| found.eq_ignore_ascii_case(key));
    let is_there = |key: &str| lines(text).any(|(_, line)| begins(line.trim(), key));
    KEYS.into_iter().filter(|key| is_there(key)).count() >= 2
}

/// Whether these are parameters of Arbaro's: XML with its tag.
fn is_arbaro(bytes: &[u8]) -> bool {
    const OPENING: usize = 4096;
    let opening = &bytes[..bytes.len().min(OPENING)];
    let blank = opening
        .iter()
        .take_while(|byte| byte.is_ascii_whitespace() || [0xef, 0xbb, 0xbf].contains(byte))
        .count();
    let has = |tag: &[u8]| opening.windows(tag.len()).any(|part| part == tag);
    opening.get(blank) == Some(&b'<') && (has(b"<arbaro") || has(b"<species"))
}

enum Evidence {
    For(InputKind),
    PresetOrGrammar,
    None,
}

fn evidence(line: &str) -> Evidence {
    // Before points: their reader takes a table's first numbers for a place.
    if let Some(tapered) = cylinders::header_tells(line) {
        return Evidence::For(InputKind::Cylinders { tapered });
    }
    if xyz::position(line).is_ok() || !line.contains('=') && Layout::of_header(line).is_some() {
        return Evidence::For(InputKind::XyzPoints);
    }
    let (keyword, rest) = line.split_once([' ', '\t']).unwrap_or((line, ""));
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let starts_with_number = rest.split_ascii_whitespace().next().is_some_and(is_number);
    match keyword {
        "v" | "vt" | "vn" | "vp" if starts_with_number => return Evidence::For(InputKind::ObjMesh),
        "f" if rest.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '-') => {
            return Evidence::For(InputKind::ObjMesh);
        }
        "mtllib" | "usemtl" if !rest.trim_start().starts_with('=') => {
            return Evidence::For(InputKind::ObjMesh);
        }
        _ => {}
    }
    if line.starts_with('[') {
        return Evidence::For(InputKind::Preset);
    }
    let Some((key, value)) = line.split_once('=') else { return Evidence::None };
    let (key, value) = (key.trim(), value.trim());
    // A module of Python's; names as Weber and Penn write them, of a level or of the tree.
    let is_of_level = key.starts_with(|c: char| c.is_ascii_digit())
        && key[1..].starts_with(|c: char| c.is_ascii_uppercase())
        && value.parse::<f64>().is_ok();
    if key == "params" && value.starts_with('{') || is_of_level || key == "RatioPower" || key == "BaseSize" {
        return Evidence::For(InputKind::TreeParameters);
    }
    let is_quoted = value.starts_with(['"', '\'']);
    match key {
        // TOML knows no bare words as values and no spaces in bare keys.
        "axiom" if !is_quoted => Evidence::For(InputKind::Grammar),
        "number of derivations" => Evidence::For(InputKind::Grammar),
        // A rule with its probability: `F=(0.5)FF`.
        _ if value.starts_with('(') => Evidence::For(InputKind::Grammar),
        _ if is_quoted || value.starts_with(['[', '{']) || value == "true" || value == "false" => {
            Evidence::For(InputKind::Preset)
        }
        _ => Evidence::PresetOrGrammar,
    }
}

fn extension(file_name: &str) -> String {
    file_name.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> InputKind {
        sniff(text.as_bytes(), "misleading.png").unwrap()
    }

    #[test]
    fn an_l_system_of_cpfg_is_told_what_to_write() {
        let text = "Lsystem: 1\n#define r 0.5\nderivation length: 4\nAxiom: A(1)\nA(x) --> F(x)[+A(x*r)]\nendlsystem\n";
        for name in ["tree.l", "tree.txt", "tree"] {
            let said = sniff(text.as_bytes(), name).unwrap_err().to_string();
            assert!(said.contains("cpfg") && said.contains("'axiom=F'"), "{said}");
        }
        assert_eq!(kind("axiom=F\nangle=20\nnumber of derivations=2\nF=FF\n"), InputKind::Grammar);
    }

    #[test]
    fn content_decides() {
        use InputKind::{
            Cylinders, E57Points, Grammar, LasPoints, ObjMesh, PcdPoints, PlyMesh, PlyPoints, Preset,
            PtxPoints, Recipe, TreeParameters, XyzPoints,
        };
        let ply = "ply\nformat ascii 1.0\nelement vertex 0\nelement face ";
        for (text, expected) in [
            ("# a preset\nname = \"oak\"\n[growth]\n", Preset),
            ("angle = 20.0\naxiom = \"F\"\n", Preset),
            ("[a]\naxiom = 'F'\n", Preset),
            ("\u{feff}\n  {\"linden\": 1}", Recipe),
            ("// tree A (pag. 25)\n// number of derivations => MIN\n\naxiom=F\nangle=25.7\n", Grammar),
            ("angle=22.5\r\nnumber of derivations=3\r\naxiom=F\r\n", Grammar),
            ("angle=20\nF=(1)FF-[-F+F+F]\n", Grammar),
            ("<?xml version=\"1.0\"?>\n<!-- a --><arbaro>\n", TreeParameters),
            ("{'levels': 3}", TreeParameters),
            ("\"\"\" OAK \"\"\"\nparams = {\n    'shape': 7,\n", TreeParameters),
            ("# a\nShape=1\n1DownAngle=60\n", TreeParameters),
            ("# Blender\nmtllib a.mtl\no Cube\nv 1 1 -1\n", ObjMesh),
            ("o x\nf -3 -2 -1\n", ObjMesh),
            (&format!("{ply}0\nend_header\n"), PlyPoints),
            (&format!("{ply}1\nend_header\n"), PlyMesh),
            ("ply\r\nformat ascii 1.0\r\nelement vertex 9\r\nend_header\r\n", PlyPoints),
            ("1 2 3\n", XyzPoints),
            ("//X;Y;Z\n1;2;3;4\n", XyzPoints),
            ("12\na title\n1.0 2.0 3.0\n", XyzPoints),
            ("x,y,z\n1,2,3\n", XyzPoints),
            ("tree;x;y;z\noak;1,5;2;3\n", XyzPoints),
            (
                "id,parent,start_x_m,start_y_m,start_z_m,axis_x,axis_y,axis_z,length_m,radius_m\n",
                Cylinders { tapered: false },
            ),
            ("x,y,z,radius,parent_id\n1,2,3,4,-1\n", Cylinders { tapered: false }),
            ("x,y,z,radius\n1,2,3,4\n", XyzPoints),
            ("LASF\0\0", LasPoints),
            ("ASTM-E57\u{1}\0", E57Points),
            ("# .PCD v0.7\nFIELDS x y z\n", PcdPoints),
            ("2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n", PtxPoints),
        ] {
            assert_eq!(kind(text), expected, "{text}");
        }
    }

    #[test]
    fn the_name_breaks_ties_only() {
        assert_eq!(sniff(b"angle=20\n", "a/b.TXT"), Ok(InputKind::Grammar));
        assert_eq!(sniff(b"angle=20\n", "b.toml"), Ok(InputKind::Preset));
        assert_eq!(sniff(b"1 2 3\n", "b.toml"), Ok(InputKind::XyzPoints));
    }

    #[test]
    fn what_cannot_be_read_is_said() {
        assert_eq!(sniff(b"", "a.obj"), Err(InputError::Empty));
        assert_eq!(sniff(b"\n \n", "a.obj"), Err(InputError::Empty));
        for (bytes, part) in [
            (&b"\x01\x02\0\x03"[..], "binary"),
            (b"hello world\nhow are you\n", "is text"),
            (b"\xff\xfe1\0 \0", "UTF-16"),
            (b"glTF\x02\0\0\0", "glTF"),
            (b"axiom=F\n\xff", "not UTF-8"),
            (b"ply\nelephant\n", "end_header"),
            (b"ply\n", "end_header"),
        ] {
            let error = sniff(bytes, "a.obj").unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
