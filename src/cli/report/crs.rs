//! Names of the reference systems city models come in.

/// EPSG code and name, by code.
const NAMES: &[(u32, &str)] = &[
    (2056, "CH1903+ / LV95 (Switzerland)"),
    (2154, "RGF93 / Lambert-93 (France)"),
    (2180, "ETRS89 / Poland CS92"),
    (2263, "NAD83 / New York Long Island, US feet"),
    (2326, "Hong Kong 1980 Grid"),
    (3006, "SWEREF99 TM (Sweden)"),
    (3067, "ETRS89 / TM35FIN (Finland)"),
    (3301, "Estonian Coordinate System of 1997"),
    (3414, "SVY21 / Singapore TM"),
    (3812, "ETRS89 / Belgian Lambert 2008"),
    (3855, "EGM2008 height"),
    (3857, "WGS 84 / Pseudo-Mercator (not true to scale)"),
    (3900, "N2000 height"),
    (3903, "ETRS89 / TM35FIN + N2000 height"),
    (3946, "RGF93 / CC46 (France, Lyon)"),
    (4258, "ETRS89, degrees"),
    (4326, "WGS 84, degrees"),
    (4979, "WGS 84, degrees and ellipsoidal height"),
    (5514, "S-JTSK / Krovak East North (Czechia)"),
    (5555, "ETRS89 / UTM 32N + DHHN92 height"),
    (5556, "ETRS89 / UTM 33N + DHHN92 height"),
    (5613, "RH2000 height"),
    (5701, "ODN height"),
    (5703, "NAVD88 height"),
    (5709, "NAP height"),
    (5710, "Ostend height"),
    (5720, "NGF-IGN69 height"),
    (5728, "LN02 height"),
    (5773, "EGM96 height"),
    (5778, "GHA height"),
    (5783, "DHHN92 height"),
    (6312, "CGRS93 / Cyprus Local TM"),
    (6668, "JGD2011, degrees"),
    (6695, "JGD2011 height"),
    (6697, "JGD2011, degrees + height"),
    (7405, "OSGB36 / British National Grid + ODN height"),
    (7415, "Amersfoort / RD New + NAP height (Netherlands)"),
    (7423, "ETRS89, degrees + EVRF2007 height"),
    (7789, "ITRF2014, geocentric"),
    (7837, "DHHN2016 height"),
    (9518, "WGS 84, degrees + EGM2008 height"),
    (25831, "ETRS89 / UTM 31N"),
    (25832, "ETRS89 / UTM 32N"),
    (25833, "ETRS89 / UTM 33N"),
    (27700, "OSGB36 / British National Grid"),
    (28991, "Amersfoort / RD Old (Netherlands)"),
    (28992, "Amersfoort / RD New (Netherlands)"),
    (31254, "MGI / Austria GK West"),
    (31255, "MGI / Austria GK Central"),
    (31256, "MGI / Austria GK East"),
    (31370, "BD72 / Belgian Lambert 72"),
];

/// The name of `EPSG:7415`, or of both parts of `EPSG:25832+5783`.
pub fn name(crs: &str) -> Option<String> {
    let codes = crs.strip_prefix("EPSG:")?;
    let names: Option<Vec<String>> = codes.split('+').map(|code| name_of(code.parse().ok()?)).collect();
    names.map(|names| names.join(" + "))
}

fn name_of(code: u32) -> Option<String> {
    match code {
        32601..=32660 => Some(format!("WGS 84 / UTM {}N", code - 32600)),
        32701..=32760 => Some(format!("WGS 84 / UTM {}S", code - 32700)),
        6669..=6687 => Some(format!("JGD2011 / Japan Plane Rectangular {}", code - 6668)),
        _ => NAMES.binary_search_by_key(&code, |(c, _)| *c).ok().map(|i| NAMES[i].1.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_sorted_by_code() {
        assert!(NAMES.is_sorted_by(|a, b| a.0 < b.0));
    }

    #[test]
    fn single_compound_and_unknown() {
        assert!(name("EPSG:7415").unwrap().contains("Amersfoort"));
        assert_eq!(name("EPSG:25832+5783").unwrap(), "ETRS89 / UTM 32N + DHHN92 height");
        assert_eq!(name("EPSG:32733").unwrap(), "WGS 84 / UTM 33S");
        assert_eq!(name("EPSG:25832+1"), None);
        assert_eq!(name("OGC:CRS84"), None);
    }
}
