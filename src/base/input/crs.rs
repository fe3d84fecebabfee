//! The units of length that a map's coordinates are in, by what a file says of its coordinate system: well-known text (ISO
//! 19162, and OGC 01-009 before it) or the keys of `GeoTIFF` (OGC 19-008r4).
//!
//! Only units that the file itself names count: a number of EPSG alone says nothing here.

/// Metres in an international foot, and in one of the surveys of the United States.
const FOOT_M: f64 = 0.3048;
const SURVEY_FOOT_M: f64 = 1200.0 / 3937.0;

/// How much of a unit's length texts round away.
const ROUNDING: f64 = 1e-7;

/// The units of a map that is not in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapUnits {
    /// Metres in a unit of places.
    pub places_m: f64,
    /// Metres in a unit of heights.
    pub heights_m: f64,
}

impl MapUnits {
    /// Metres in a unit of coordinates, if places and heights are in the same.
    pub fn scale(&self) -> Option<f64> {
        ((self.places_m - self.heights_m).abs() <= ROUNDING).then_some(self.places_m)
    }

    /// What a unit of so many metres is called.
    pub fn name(metres: f64) -> String {
        // The two feet differ by two millionths.
        let is = |unit: f64| (metres - unit).abs() <= ROUNDING;
        match () {
            () if is(1.0) => "metres".to_owned(),
            () if is(SURVEY_FOOT_M) => "US survey feet".to_owned(),
            () if is(FOOT_M) => "feet".to_owned(),
            () => format!("units of {metres} m"),
        }
    }

    /// Those of places and of heights, which are the same where the file names one; `None`: metres, or nothing is said.
    fn of(places_m: Option<f64>, heights_m: Option<f64>) -> Option<Self> {
        let places_m = places_m?;
        let units = Self { places_m, heights_m: heights_m.unwrap_or(places_m) };
        let is_metre = |unit: f64| (unit - 1.0).abs() <= ROUNDING;
        let are_usable = [places_m, units.heights_m].iter().all(|unit| unit.is_finite() && *unit > 0.0);
        (are_usable && !(is_metre(places_m) && is_metre(units.heights_m))).then_some(units)
    }

    /// By well-known text.
    pub(super) fn of_text(text: &str) -> Option<Self> {
        let (mut places, mut heights) = (None, None);
        let mut open: Vec<&str> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find(['[', '(', ']', ')', '"']) {
            let (before, after) = rest.split_at(at);
            rest = &after[1..];
            match after.as_bytes()[0] {
                b'"' => rest = rest.split_once('"').map_or("", |(_, rest)| rest),
                b']' | b')' => {
                    open.pop();
                }
                _ => {
                    let word = before
                        .rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_')
                        .next()
                        .unwrap_or_default();
                    if matches!(word, "UNIT" | "LENGTHUNIT") {
                        let metres = || rest.split([']', ')']).next()?.split(',').nth(1)?.trim().parse().ok();
                        // Units of axes stand for those of their system.
                        let of = open.iter().rev().find(|word| **word != "AXIS");
                        match of {
                            Some(&("PROJCS" | "PROJCRS" | "PROJECTEDCRS")) => places = places.or_else(metres),
                            Some(&("VERT_CS" | "VERTCS" | "VERTCRS" | "VERTICALCRS")) => {
                                heights = heights.or_else(metres);
                            }
                            _ => {}
                        }
                    }
                    open.push(word);
                }
            }
        }
        Self::of(places, heights)
    }

    /// By the keys of a directory.
    pub(super) fn of_keys(directory: &[u16]) -> Option<Self> {
        const PLACES: u16 = 3076;
        const HEIGHTS: u16 = 4099;
        let unit = |id: u16| {
            let mut entries = directory.chunks_exact(4).skip(1);
            let entry = entries.find(|entry| entry[0] == id && entry[1] == 0)?;
            match entry[3] {
                9001 => Some(1.0),
                9002 => Some(FOOT_M),
                9003 => Some(SURVEY_FOOT_M),
                _ => None,
            }
        };
        Self::of(unit(PLACES), unit(HEIGHTS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As GDAL writes them, shortened.
    const OLD: &str = r#"COMPD_CS["NAD83 / Maryland (ftUS) + NAVD88",PROJCS["NAD83 / Maryland (ftUS)",GEOGCS["NAD83",DATUM["North_American_Datum_1983",SPHEROID["GRS 1980",6378137,298.257]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Lambert"],PARAMETER["false_easting",1312333.333],UNIT["US survey foot",0.304800609601219],AXIS["X",EAST]],VERT_CS["NAVD88 height",VERT_DATUM["North American [1988]",2005],UNIT["metre",1.0],AXIS["Up",UP]]]"#;
    const NEW: &str = r#"PROJCRS["x",BASEGEOGCRS["y",DATUM["z",ELLIPSOID["e",6378137,298.257,LENGTHUNIT["metre",1]]]],CONVERSION["c",PARAMETER["False easting",1,LENGTHUNIT["metre",1]]],CS[Cartesian,2],AXIS["(E)",east,ORDER[1],LENGTHUNIT["foot",0.3048]],AXIS["(N)",north,LENGTHUNIT["foot",0.3048]]]"#;

    #[test]
    fn texts_name_their_units() {
        let old = MapUnits::of_text(OLD).unwrap();
        assert_eq!(
            (MapUnits::name(old.places_m), old.heights_m, old.scale()),
            ("US survey feet".to_owned(), 1.0, None)
        );
        let new = MapUnits::of_text(NEW).unwrap();
        assert_eq!((MapUnits::name(new.places_m), new.scale()), ("feet".to_owned(), Some(0.3048)));
        for text in [
            "",
            "PROJCS[\"m\",UNIT[\"metre\",1]]",
            "PROJCS[\"\",UNIT[\"a\"]",
            "GEOGCS[UNIT[\"degree\",0.017]]",
            "]][\"",
            "UNIT[\"é",
        ] {
            assert_eq!(MapUnits::of_text(text), None, "{text}");
        }
    }

    #[test]
    fn keys_name_their_units() {
        let of = |keys: &[[u16; 2]]| {
            let rows = keys.iter().flat_map(|[id, value]| [*id, 0, 1, *value]);
            MapUnits::of_keys(&[1, 1, 0, keys.len() as u16].into_iter().chain(rows).collect::<Vec<_>>())
        };
        assert_eq!(of(&[[1024, 1], [3076, 9003]]).unwrap().scale(), Some(1200.0 / 3937.0));
        assert_eq!(of(&[[3076, 9002], [4099, 9001]]), Some(MapUnits { places_m: 0.3048, heights_m: 1.0 }));
        assert_eq!(
            [of(&[]), of(&[[3076, 9001]]), of(&[[3076, 9001], [4099, 9001]]), of(&[[3076, 7]])],
            [None; 4]
        );
        assert_eq!(MapUnits::of_keys(&[1]), None);
    }
}
