//! Prims and their values, as a layer has them.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::{Affine3A, Mat4, Quat, Vec3};
use openusd::sdf::{AbstractData, Data, Path, Value};
use openusd::usda;

use super::mesh::vectors;
use super::{ReadError, beyond, broken};
use crate::asset::{Aspect, Asset};
use crate::read::MOST_PLACES;
use crate::read::arrange::level_of;

/// A layer.
pub(super) struct Layer {
    data: Data,
    paths: Vec<Path>,
    /// What a layer chooses that has this one as its payload, by the names of the sets.
    pub chosen: BTreeMap<String, String>,
}

/// At which levels of detail a prim is.
pub(super) enum Levels {
    All,
    One(u32),
    /// In a variant that is not chosen.
    Hidden,
}

/// Prims within prims, and lists within lists: the parser calls itself for each.
pub(super) const DEEPEST: usize = 200;

impl Layer {
    pub fn parse(text: &str) -> Result<Self, ReadError> {
        let (mut depth, mut deepest) = (0_usize, 0);
        for byte in text.bytes() {
            match byte {
                b'{' | b'[' | b'(' => depth += 1,
                b'}' | b']' | b')' => depth = depth.saturating_sub(1),
                _ => {}
            }
            deepest = deepest.max(depth);
        }
        if deepest > DEEPEST {
            return Err(beyond(format!("it is nested deeper than {DEEPEST}")));
        }
        let data = usda::parse(text).map_err(|error| broken(format!("{error:#}")))?;
        Ok(Self::of(data))
    }

    /// Text or binary, they are the same.
    pub fn of(data: Data) -> Self {
        let paths = data.spec_paths();
        Self { data, paths, chosen: BTreeMap::new() }
    }

    /// Prims of a type, in the order of their paths.
    pub fn prims_of(&self, kind: &str) -> impl Iterator<Item = Path> {
        self.paths.iter().filter(move |path| self.kind(path).as_deref() == Some(kind)).cloned()
    }

    pub fn kind(&self, prim: &Path) -> Option<String> {
        word(&*self.field(prim, "typeName")?)
    }

    pub fn has_any(&self, field: &str) -> bool {
        self.paths.iter().any(|path| self.data.has_field(path, field))
    }

    /// The files that the prims shown have as payloads, each once.
    pub fn payloads(&self) -> BTreeSet<String> {
        let is_shown = |path: &&Path| !matches!(self.level(path), Levels::Hidden);
        let of = |path: &Path| match self.field(path, "payload").as_deref() {
            Some(Value::Payload(payload)) => vec![payload.asset_path.clone()],
            Some(Value::PayloadListOp(list)) => {
                let lists =
                    [&list.explicit_items, &list.prepended_items, &list.added_items, &list.appended_items];
                lists.into_iter().flatten().map(|payload| payload.asset_path.clone()).collect()
            }
            _ => Vec::new(),
        };
        let files = self.paths.iter().filter(is_shown).flat_map(of);
        files.filter(|file| !file.is_empty()).collect()
    }

    /// Whether something in it is moved, turned or scaled.
    pub fn has_places(&self) -> bool {
        self.paths.iter().any(|path| path.as_str().ends_with(".xformOpOrder"))
    }

    /// What it chooses of all sets of variants, and what was chosen for it.
    pub fn selections(&self) -> BTreeMap<String, String> {
        let mut chosen = BTreeMap::new();
        for path in &self.paths {
            if let Some(Value::VariantSelectionMap(map)) = self.field(path, "variantSelection").as_deref() {
                chosen.extend(map.iter().map(|(set, variant)| (set.clone(), variant.clone())));
            }
        }
        chosen.extend(self.chosen.clone());
        chosen
    }

    fn field(&self, path: &Path, name: &str) -> Option<Cow<'_, Value>> {
        self.data.try_field(path, name).ok().flatten()
    }

    /// The value of an attribute.
    pub fn value(&self, prim: &Path, name: &str) -> Option<Cow<'_, Value>> {
        self.field(&prim.append_property(name).ok()?, "default")
    }

    /// How the values of an attribute belong to vertices.
    pub fn interpolation(&self, prim: &Path, name: &str) -> Option<String> {
        word(&*self.field(&prim.append_property(name).ok()?, "interpolation")?)
    }

    /// The names of a prim's attributes.
    pub fn attributes(&self, prim: &Path) -> impl Iterator<Item = &str> {
        let prefix = format!("{prim}.");
        let first = self.paths.partition_point(|path| path.as_str() < prefix.as_str());
        self.paths[first..].iter().map_while(move |path| path.as_str().strip_prefix(&prefix))
    }

    /// What a relationship or a connection leads to, without variants.
    pub fn target(&self, prim: &Path, name: &str, field: &str) -> Option<String> {
        self.targets(prim, name, field).into_iter().next()
    }

    fn targets(&self, prim: &Path, name: &str, field: &str) -> Vec<String> {
        let value = prim.append_property(name).ok().and_then(|path| self.field(&path, field));
        let paths = match value.as_deref() {
            Some(Value::PathListOp(list)) => {
                [&list.explicit_items, &list.prepended_items, &list.added_items, &list.appended_items]
                    .into_iter()
                    .flatten()
                    .cloned()
                    .collect()
            }
            Some(Value::PathVec(paths)) => paths.clone(),
            _ => Vec::new(),
        };
        paths.iter().map(plain).collect()
    }

    /// The material that is bound to a prim or to what it stands in.
    pub fn binding(&self, prim: &Path) -> Option<String> {
        let above = above(prim);
        std::iter::once(prim.clone())
            .chain(above)
            .find_map(|prim| self.target(&prim, "material:binding", "targetPaths"))
    }

    pub fn root_number(&self, name: &str) -> Option<f64> {
        number(&*self.field(&Path::abs_root(), name)?)
    }

    pub fn root_word(&self, name: &str) -> Option<String> {
        word(&*self.field(&Path::abs_root(), name)?)
    }

    /// Sets of variants that are called by levels of detail are levels, of all others the chosen one is looked at.
    pub fn level(&self, prim: &Path) -> Levels {
        let mut level = None;
        let mut rest = prim.as_str();
        while let Some((before, after)) = rest.split_once('{') {
            let Some((selection, behind)) = after.split_once('}') else { break };
            let Some((set, chosen)) = selection.split_once('=') else { break };
            let at = &prim.as_str()[..prim.as_str().len() - rest.len() + before.len()];
            rest = behind;
            let digits = chosen.trim_start_matches(|c: char| !c.is_ascii_digit()).parse().ok();
            match level_of(chosen).or_else(|| digits.filter(|_| set.to_lowercase().contains("lod"))) {
                Some(number) => level = Some(number),
                None if self.selection(at, set).as_deref() == Some(chosen) => {}
                None => return Levels::Hidden,
            }
        }
        level.map_or(Levels::All, Levels::One)
    }

    fn selection(&self, prim: &str, set: &str) -> Option<String> {
        if let Some(chosen) = self.chosen.get(set) {
            return Some(chosen.clone());
        }
        // A set within a variant of another one is chosen there, or on the prim itself.
        let here = Path::new(prim).ok();
        let plain = here.as_ref().map(Path::strip_all_variant_selections);
        let chosen = |path: Path| match self.field(&path, "variantSelection").as_deref() {
            Some(Value::VariantSelectionMap(map)) => map.get(set).cloned(),
            _ => None,
        };
        here.into_iter().chain(plain).find_map(chosen)
    }

    /// Where a prim stands: in one place, or where an instancer above it puts it.
    pub fn places(&self, prim: &Path, asset: &mut Asset) -> Result<Vec<Affine3A>, ReadError> {
        let mut places = vec![self.transform(prim, asset)];
        // A prim and its variants are one.
        let mut done = BTreeSet::new();
        for above in above(prim) {
            let says_nothing =
                above.is_prim_variant_selection_path() && self.value(&above, "xformOpOrder").is_none();
            if says_nothing || !done.insert(plain(&above)) {
                continue;
            }
            let transform = self.transform(&above, asset);
            if self.kind(&above).as_deref() == Some("PointInstancer") {
                let instances = self.instances(&above, prim);
                if instances.len().saturating_mul(places.len()) > MOST_PLACES {
                    return Err(too_many());
                }
                places =
                    instances.iter().flat_map(|at| places.iter().map(move |place| *at * *place)).collect();
            }
            for place in &mut places {
                *place = transform * *place;
            }
        }
        Ok(places)
    }

    fn instances(&self, instancer: &Path, prim: &Path) -> Vec<Affine3A> {
        let path = plain(prim);
        let prototypes = self.targets(instancer, "prototypes", "targetPaths");
        let is_above = |prototype: &String| path == *prototype || path.starts_with(&format!("{prototype}/"));
        let Some(index) = prototypes.iter().position(is_above) else { return Vec::new() };
        let indices = match self.value(instancer, "protoIndices").as_deref() {
            Some(Value::IntVec(indices)) => indices.clone(),
            _ => return Vec::new(),
        };
        let list = |name: &str| self.value(instancer, name).and_then(|value| vectors(&value));
        let (positions, scales) = (list("positions").unwrap_or_default(), list("scales"));
        let turns: Option<Vec<Quat>> =
            self.value(instancer, "orientations").and_then(|value| match &*value {
                Value::QuathVec(list) => {
                    let quat = |q: &openusd::gf::Quath| {
                        Quat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into())
                    };
                    Some(list.iter().map(quat).collect())
                }
                Value::QuatfVec(list) => {
                    Some(list.iter().map(|q| Quat::from_xyzw(q.x, q.y, q.z, q.w)).collect())
                }
                _ => None,
            });
        let of = |i: usize| {
            let scale = scales.as_ref().and_then(|list| list.get(i)).copied().unwrap_or(Vec3::ONE);
            let turn = turns.as_ref().and_then(|list| list.get(i)).copied().unwrap_or(Quat::IDENTITY);
            Affine3A::from_scale_rotation_translation(scale, turn, positions[i])
        };
        let count = indices.len().min(positions.len());
        (0..count).filter(|&i| usize::try_from(indices[i]) == Ok(index)).map(of).collect()
    }

    /// A prim's own transform.
    fn transform(&self, prim: &Path, asset: &mut Asset) -> Affine3A {
        let order = self.value(prim, "xformOpOrder");
        let (prim, order) = match order {
            Some(order) => (prim.clone(), order),
            // Its definition may stand outside of the variant.
            None => {
                let plain = prim.strip_all_variant_selections();
                match self.value(&plain, "xformOpOrder") {
                    Some(order) => (plain, order),
                    None => return Affine3A::IDENTITY,
                }
            }
        };
        let Value::TokenVec(order) = &*order else { return Affine3A::IDENTITY };
        let mut transform = Affine3A::IDENTITY;
        for op in order {
            let name = op.as_str();
            match self.value(&prim, name).and_then(|value| operation(name, &value)) {
                Some(step) => transform *= step,
                None => asset
                    .note(Aspect::Places, format!("the transform {} is not read", super::super::shown(name))),
            }
        }
        transform
    }
}

pub(super) fn too_many() -> ReadError {
    beyond(format!("its meshes have more than {MOST_PLACES} places"))
}

/// A path without variants.
fn plain(path: &Path) -> String {
    path.strip_all_variant_selections().as_str().to_owned()
}

fn operation(name: &str, value: &Value) -> Option<Affine3A> {
    let kind = name.strip_prefix("xformOp:")?.split(':').next()?;
    let one = || vectors(value)?.first().copied();
    let angle = || Some((number(value)? as f32).to_radians());
    Some(match kind {
        "translate" => Affine3A::from_translation(one()?),
        "scale" => Affine3A::from_scale(one()?),
        "rotateX" => Affine3A::from_rotation_x(angle()?),
        "rotateY" => Affine3A::from_rotation_y(angle()?),
        "rotateZ" => Affine3A::from_rotation_z(angle()?),
        "rotateXYZ" => {
            let angles = one()?.map(f32::to_radians);
            Affine3A::from_rotation_z(angles.z)
                * Affine3A::from_rotation_y(angles.y)
                * Affine3A::from_rotation_x(angles.x)
        }
        "orient" => match value {
            Value::Quatf(q) => Affine3A::from_quat(Quat::from_xyzw(q.x, q.y, q.z, q.w)),
            Value::Quath(q) => {
                Affine3A::from_quat(Quat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()))
            }
            Value::Quatd(q) => {
                Affine3A::from_quat(Quat::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32))
            }
            _ => return None,
        },
        // Rows there are columns here.
        "transform" => match value {
            Value::Matrix4d(matrix) => {
                Affine3A::from_mat4(Mat4::from_cols_array(&matrix.0.map(|x| x as f32)))
            }
            _ => return None,
        },
        _ => return None,
    })
}

pub(super) fn word(value: &Value) -> Option<String> {
    match value {
        Value::Token(token) => Some(token.as_str().to_owned()),
        Value::String(text) => Some(text.clone()),
        _ => None,
    }
}

pub(super) fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(f64::from(*number)),
        Value::Double(number) => Some(*number),
        Value::Half(number) => Some(number.to_f64()),
        Value::Int(number) => Some(f64::from(*number)),
        _ => None,
    }
}

/// The prims and variants that a prim is within, from the nearest on. Of a broken name (`{=}`) the crate gives the same path
/// as what is above it, for ever.
pub(super) fn above(prim: &Path) -> impl Iterator<Item = Path> {
    let mut length = prim.as_str().len();
    prim.strict_ancestors().take_while(move |above| {
        let is_shorter = above.as_str().len() < length;
        length = above.as_str().len();
        is_shorter
    })
}
