//! A layer as it is written: statements and arrays become specs.

use linden_pipeline::Monitor;

use super::build::{Build, ROOT, SpecKind};
use super::kind::{Kind, Scalar, half};
use super::literal::{Literal, Piece, Statements};
use super::values::{Listed, Rep, Values, number};
use crate::ExportError;

type Fields = Vec<(&'static str, Rep)>;

/// A crate file that is being written. It is held whole: its first bytes say where its last ones are.
pub(crate) struct Crate<'m> {
    build: Build,
    /// The layer, and the prims and variants that are open.
    open: Vec<Open>,
    monitor: &'m dyn Monitor,
}

/// A spec whose brace has not been closed.
struct Open {
    path: u32,
    kind: SpecKind,
    /// Of a set of variants.
    set: String,
    fields: Fields,
    properties: Vec<Property>,
    /// Tokens of prims, of sets, of variants.
    prims: Vec<u32>,
    sets: Vec<u32>,
    variants: Vec<u32>,
}

struct Property {
    name: String,
    kind: SpecKind,
    fields: Fields,
}

/// What stands before a property's value.
struct Declaration {
    is_custom: bool,
    is_uniform: bool,
    /// `None` for a relationship.
    kind: Option<Kind>,
    /// As fields have it: `float3[]`.
    type_name: String,
    is_array: bool,
    name: String,
}

impl<'m> Crate<'m> {
    pub fn new(monitor: &'m dyn Monitor) -> Self {
        Self { build: Build::new(), open: vec![Open::of(ROOT, SpecKind::Layer)], monitor }
    }

    /// Statements, as text has them.
    pub fn statements(&mut self, text: &str) -> Result<(), ExportError> {
        self.monitor.check()?;
        let read = Statements::of(text).and_then(|mut statements| {
            while !statements.is_empty() {
                self.statement(&mut statements)?;
            }
            Some(())
        });
        read.ok_or_else(|| unknown(text))
    }

    /// An attribute of many elements: `elements` are their numbers as they lie in memory, of halfs as floats. Its shape
    /// is its interpolation, and how many elements are of each vertex.
    pub fn array(
        &mut self,
        declaration: &str,
        count: usize,
        shape: (Option<&str>, u32),
        elements: Vec<u8>,
    ) -> Result<(), ExportError> {
        self.monitor.check()?;
        let added = self.add_array(declaration, count, shape, elements);
        added.ok_or_else(|| unknown(declaration))
    }

    /// The whole file.
    pub fn finish(mut self) -> Vec<u8> {
        while !self.open.is_empty() {
            self.close();
        }
        self.build.finish()
    }

    fn add_array(
        &mut self,
        declaration: &str,
        count: usize,
        (interpolation, size): (Option<&str>, u32),
        elements: Vec<u8>,
    ) -> Option<()> {
        let declared = Declaration::read(&mut Statements::of(declaration)?)?;
        let kind = declared.kind.filter(|_| declared.is_array)?;
        let elements = if kind.scalar == Scalar::Half { halves(kind, &elements) } else { elements };
        let value = self.build.values.array(kind, count, &elements);
        let mut fields = vec![("default", value)];
        if size > 1 {
            fields.push(("elementSize", Values::inlined(number::INT, size)));
        }
        if let Some(word) = interpolation {
            fields.push(("interpolation", self.build.values.token_value(word)));
        }
        self.add(&declared, fields)
    }

    fn statement(&mut self, read: &mut Statements<'_>) -> Option<()> {
        if read.takes(b'}') {
            return self.close();
        }
        if read.takes(b'(') {
            return self.metadata(read);
        }
        if matches!(read.peek(), Some(Piece::Text(_))) {
            let name = read.text()?;
            return self.open_variant(&name, read);
        }
        for (word, specifier) in [("def", 0), ("over", 1), ("class", 2)] {
            if read.takes_word(word) {
                return self.open_prim(specifier, read);
            }
        }
        if read.takes_word("variantSet") {
            let set = read.text()?;
            let holder = self.open.last_mut()?;
            holder.sets.push(self.build.values.token(&set));
            let path = self.build.child(holder.path, &format!("{{{set}=}}"));
            self.open.push(Open { set, ..Open::of(path, SpecKind::VariantSet) });
            return (read.takes(b'=') && read.takes(b'{')).then_some(());
        }
        self.property(read)
    }

    fn open_prim(&mut self, specifier: u32, read: &mut Statements<'_>) -> Option<()> {
        let type_name = match read.peek()? {
            Piece::Word(_) => read.word(),
            _ => None,
        };
        let name = read.text()?;
        let holder = self.open.last_mut()?;
        holder.prims.push(self.build.values.token(&name));
        let mut prim = Open::of(self.build.child(holder.path, &name), SpecKind::Prim);
        prim.fields.push(("specifier", Values::inlined(number::SPECIFIER, specifier)));
        if let Some(name) = type_name {
            prim.fields.push(("typeName", self.build.values.token_value(name)));
        }
        self.open_braces(prim, read)
    }

    fn open_variant(&mut self, name: &str, read: &mut Statements<'_>) -> Option<()> {
        let [.., holder, set] = self.open.as_mut_slice() else { return None };
        if set.kind != SpecKind::VariantSet {
            return None;
        }
        set.variants.push(self.build.values.token(name));
        let path = self.build.child(holder.path, &format!("{{{}={name}}}", set.set));
        let mut variant = Open::of(path, SpecKind::Variant);
        variant.fields.push(("specifier", Values::inlined(number::SPECIFIER, 1)));
        self.open_braces(variant, read)
    }

    fn open_braces(&mut self, spec: Open, read: &mut Statements<'_>) -> Option<()> {
        self.open.push(spec);
        if read.takes(b'(') {
            self.metadata(read)?;
        }
        read.takes(b'{').then_some(())
    }

    /// Up to the parenthesis that closes it, of what is open.
    fn metadata(&mut self, read: &mut Statements<'_>) -> Option<()> {
        while !read.takes(b')') {
            let field = self.field(read)?;
            self.open.last_mut()?.fields.push(field);
        }
        Some(())
    }

    fn field(&mut self, read: &mut Statements<'_>) -> Option<(&'static str, Rep)> {
        let is_prepended = read.takes_word("prepend");
        let key = read.word()?;
        if !read.takes(b'=') {
            return None;
        }
        let build = &mut self.build;
        if is_prepended {
            return Some(match (key, read.value()?) {
                ("apiSchemas", Literal::List(names)) => {
                    let names: Option<Vec<u32>> =
                        names.iter().map(|name| build.values.token_of(name)).collect();
                    ("apiSchemas", build.values.list(number::TOKEN_LIST, Listed::Prepended, &names?))
                }
                ("variantSets", Literal::Text(set)) => {
                    let set = build.values.string(&set);
                    ("variantSetNames", build.values.list(number::STRING_LIST, Listed::Prepended, &[set]))
                }
                ("references", Literal::Path(path)) => {
                    let path = build.path_of(path)?;
                    ("references", build.values.references(&[path]))
                }
                ("payload", Literal::Asset(layer)) => {
                    let Literal::Path(prim) = read.value()? else { return None };
                    let prim = build.path_of(prim)?;
                    ("payload", build.values.payload(layer, prim))
                }
                _ => return None,
            });
        }
        let named = |key| move |value| Some((key, value));
        let values = &mut build.values;
        match key {
            "assetInfo" => self.dictionary(read).and_then(named("assetInfo")),
            "customData" => self.dictionary(read).and_then(named("customData")),
            "variants" => self.selection(read).and_then(named("variantSelection")),
            "doc" => named("documentation")(values.string_value(&read.text()?)),
            "displayName" => named("displayName")(values.string_value(&read.text()?)),
            "defaultPrim" => named("defaultPrim")(values.token_value(&read.text()?)),
            "upAxis" => named("upAxis")(values.token_value(&read.text()?)),
            "kind" => named("kind")(values.token_value(&read.text()?)),
            "interpolation" => named("interpolation")(values.token_value(&read.text()?)),
            "colorSpace" => named("colorSpace")(values.token_value(&read.text()?)),
            "elementSize" => named("elementSize")(Values::inlined(number::INT, read.word()?.parse().ok()?)),
            "instanceable" => named("instanceable")(Values::inlined(1, u32::from(read.word()? == "true"))),
            "metersPerUnit" => self.double(read).and_then(named("metersPerUnit")),
            "startTimeCode" => self.double(read).and_then(named("startTimeCode")),
            "endTimeCode" => self.double(read).and_then(named("endTimeCode")),
            "framesPerSecond" => self.double(read).and_then(named("framesPerSecond")),
            "timeCodesPerSecond" => self.double(read).and_then(named("timeCodesPerSecond")),
            _ => None,
        }
    }

    fn double(&mut self, read: &mut Statements<'_>) -> Option<Rep> {
        self.build.values.attribute(Kind::of("double")?, false, &read.value()?)
    }

    /// `{ string key = "value" … }`
    fn dictionary(&mut self, read: &mut Statements<'_>) -> Option<Rep> {
        if !read.takes(b'{') {
            return None;
        }
        let mut entries = Vec::new();
        while !read.takes(b'}') {
            let (kind, key) = (read.word()?, read.word()?);
            // The key first: the recipe is the string behind its own.
            let key = self.build.values.string(key);
            if !read.takes(b'=') {
                return None;
            }
            let value = match kind {
                "dictionary" => self.dictionary(read)?,
                kind => self.build.values.attribute(Kind::of(kind)?, false, &read.value()?)?,
            };
            entries.push((key, value));
        }
        Some(self.build.values.dictionary(&entries))
    }

    fn selection(&mut self, read: &mut Statements<'_>) -> Option<Rep> {
        if !read.takes(b'{') {
            return None;
        }
        let mut chosen = Vec::new();
        while read.takes_word("string") {
            let set = self.build.values.string(read.word()?);
            if !read.takes(b'=') {
                return None;
            }
            chosen.push((set, self.build.values.string(&read.text()?)));
        }
        read.takes(b'}').then(|| self.build.values.selection(&chosen))
    }

    fn property(&mut self, read: &mut Statements<'_>) -> Option<()> {
        let mut declared = Declaration::read(read)?;
        let mut fields = Vec::new();
        if let Some(name) = declared.name.strip_suffix(".timeSamples") {
            declared.name = name.to_owned();
            fields.push(("timeSamples", self.samples(&declared, read)?));
        } else if let Some(name) = declared.name.strip_suffix(".connect") {
            declared.name = name.to_owned();
            fields.push(("connectionPaths", self.targets(read)?));
        } else if declared.kind.is_none() {
            fields.push(("targetPaths", self.targets(read)?));
        } else if let Some(kind) = declared.kind.filter(|_| read.takes(b'=')) {
            let value = self.build.values.attribute(kind, declared.is_array, &read.value()?)?;
            fields.push(("default", value));
        }
        if read.takes(b'(') {
            while !read.takes(b')') {
                fields.push(self.field(read)?);
            }
        }
        self.add(&declared, fields)
    }

    fn targets(&mut self, read: &mut Statements<'_>) -> Option<Rep> {
        if !read.takes(b'=') {
            return None;
        }
        let targets = match read.value()? {
            Literal::List(targets) => targets,
            one => vec![one],
        };
        let mut paths = Vec::with_capacity(targets.len());
        for target in targets {
            let Literal::Path(path) = target else { return None };
            paths.push(self.build.path_of(path)?);
        }
        Some(self.build.values.list(number::PATH_LIST, Listed::Explicit, &paths))
    }

    fn samples(&mut self, declared: &Declaration, read: &mut Statements<'_>) -> Option<Rep> {
        if !(read.takes(b'=') && read.takes(b'{')) {
            return None;
        }
        let (mut times, mut values) = (Vec::new(), Vec::new());
        while !read.takes(b'}') {
            times.push(read.word()?.parse().ok()?);
            if !read.takes(b':') {
                return None;
            }
            values.push(self.build.values.attribute(declared.kind?, declared.is_array, &read.value()?)?);
            read.takes(b',');
        }
        Some(self.build.values.samples(&times, &values))
    }

    /// A property of what is open, or more of one that it has.
    fn add(&mut self, declared: &Declaration, fields: Fields) -> Option<()> {
        let properties = &mut self.open.last_mut()?.properties;
        if let Some(known) = properties.iter_mut().find(|known| known.name == declared.name) {
            known.fields.extend(fields);
            return Some(());
        }
        let values = &mut self.build.values;
        let is_attribute = declared.kind.is_some();
        let mut all = Vec::with_capacity(fields.len() + 3);
        if is_attribute {
            all.push(("typeName", values.token_value(&declared.type_name)));
        }
        all.push(("custom", Values::inlined(1, u32::from(declared.is_custom))));
        let is_uniform = declared.is_uniform || !is_attribute;
        all.push(("variability", Values::inlined(number::VARIABILITY, u32::from(is_uniform))));
        all.extend(fields);
        let kind = if is_attribute { SpecKind::Attribute } else { SpecKind::Relationship };
        properties.push(Property { name: declared.name.clone(), kind, fields: all });
        Some(())
    }

    /// What was opened last is whole.
    fn close(&mut self) -> Option<()> {
        let spec = self.open.pop()?;
        let Open { path, kind, mut fields, properties, .. } = spec;
        let mut names = Vec::with_capacity(properties.len());
        for property in properties {
            names.push(self.build.values.token(&property.name));
            let at = self.build.property(path, &property.name);
            self.build.spec(at, property.kind, &property.fields);
        }
        for (field, tokens) in [
            ("properties", names),
            ("primChildren", spec.prims),
            ("variantSetChildren", spec.sets),
            ("variantChildren", spec.variants),
        ] {
            if !tokens.is_empty() {
                fields.push((field, self.build.values.token_vector(&tokens)));
            }
        }
        self.build.spec(path, kind, &fields);
        Some(())
    }
}

impl Open {
    fn of(path: u32, kind: SpecKind) -> Self {
        let (set, fields, properties) = (String::new(), Vec::new(), Vec::new());
        let (prims, sets, variants) = (Vec::new(), Vec::new(), Vec::new());
        Self { path, kind, set, fields, properties, prims, sets, variants }
    }
}

impl Declaration {
    fn read(read: &mut Statements<'_>) -> Option<Self> {
        let is_custom = read.takes_word("custom");
        let is_uniform = read.takes_word("uniform");
        let word = read.word()?;
        let kind = if word == "rel" { None } else { Some(Kind::of(word)?) };
        let is_array = read.takes(b'[');
        if is_array && !read.takes(b']') {
            return None;
        }
        let type_name = if is_array { format!("{word}[]") } else { word.to_owned() };
        let name = read.word()?.to_owned();
        Some(Self { is_custom, is_uniform, kind, type_name, is_array, name })
    }
}

/// Floats as halfs, in the order that files have them.
fn halves(kind: Kind, floats: &[u8]) -> Vec<u8> {
    let (floats, _) = floats.as_chunks::<4>();
    let mut numbers: Vec<u16> = floats.iter().map(|bytes| half(f32::from_le_bytes(*bytes))).collect();
    if kind.is_turn {
        numbers.chunks_mut(kind.numbers).for_each(|turn| turn.rotate_left(1));
    }
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn unknown(text: &str) -> ExportError {
    let statement: String = text.chars().take(200).collect();
    ExportError::Statement { statement }
}
