//! Reference systems: their canonical names, and metres out of degrees and out of earth-centred coordinates.
//!
//! Degrees become UTM (transverse Mercator, Krüger's series as in Karney, "Transverse Mercator with an
//! accuracy of a few nanometers", 2011, equations 6 to 12 and 35, order n⁶), in the zone of the first vertex
//! read, for the whole city. Error of the series: below 10 nm within 3,000 km of the central meridian; GRS 80
//! stands for WGS 84 too (below 0.1 mm). Heights are kept. UTM draws 0.04 % short at its central meridian.

use glam::{DAffine3, DMat3, DVec3};

/// A reference system as far as Veduta understands it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Crs {
    /// `EPSG:7415`, compound `EPSG:25832+5783`, `OGC:CRS84`.
    pub name: String,
    /// The meaning of the coordinates.
    pub axes: Axes,
}

/// The meaning of the first two coordinates; the third is always metres up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// East, north in metres.
    Metric,
    /// As [`Axes::Metric`], but in feet: used as they are, with a warning.
    Feet,
    /// Latitude, longitude in degrees.
    LatLon,
    /// Longitude, latitude in degrees.
    LonLat,
    /// Earth-centred metres: x to the equator at Greenwich, z to the north pole.
    Geocentric,
}

/// Geographic systems with latitude first (EPSG register): WGS 84, ETRS89, JGD2000/2011, NAD83, GDA94/2020, RGF93, NZGD2000,
/// with and without height, and the compounds 6697 (JGD2011 + height) and 9518 (WGS 84 + EGM2008).
const LAT_LON: &[u32] = &[
    4167, 4171, 4258, 4269, 4283, 4326, 4612, 4937, 4939, 4947, 4957, 4959, 4965, 4979, 6667, 6668, 6697, 7843, 7844,
    9518,
];
/// Geocentric systems (EPSG register): WGS 84, ETRS89, JGD2011.
const GEOCENTRIC: &[u32] = &[4936, 4978, 6666];
/// State-plane systems in US survey feet (EPSG register) of cities with open models: New York, San Francisco, Boston, ...
const FEET: &[u32] = &[2225, 2226, 2227, 2229, 2230, 2236, 2240, 2249, 2263, 2272, 2277, 2278, 2283, 2285, 2926, 6539];

/// Names that German surveys write, and the EPSG codes of the same systems.
const ADV: &[(&str, &str)] = &[
    ("ETRS89_UTM31", "25831"),
    ("ETRS89_UTM32", "25832"),
    ("ETRS89_UTM33", "25833"),
    ("DHHN92_NH", "5783"),
    ("DHHN2016_NH", "7837"),
];

impl Crs {
    /// Reads a reference system as files spell it: URN, URL (compound too), `EPSG:7415`; `None` where it is not understood.
    pub fn parse(raw: &str) -> Option<Self> {
        let upper = raw.trim().to_ascii_uppercase();
        if upper.contains("CRS84") {
            return Some(Self { name: "OGC:CRS84".into(), axes: Axes::LonLat });
        }
        let codes = if upper.starts_with("URN:ADV:") { adv_codes(&upper) } else { epsg_codes(&upper) };
        let first = *codes.first()?;
        let name = codes.iter().map(u32::to_string).collect::<Vec<_>>().join("+");
        let axes = match first {
            code if LAT_LON.contains(&code) => Axes::LatLon,
            code if GEOCENTRIC.contains(&code) => Axes::Geocentric,
            code if FEET.contains(&code) => Axes::Feet,
            _ => Axes::Metric,
        };
        Some(Self { name: format!("EPSG:{name}"), axes })
    }
}

/// The codes in `URN:OGC:DEF:CRS:EPSG::7415`, `.../CRS/EPSG/0/7415`, `EPSG:25832+5783`, and compounds of the first two.
fn epsg_codes(upper: &str) -> Vec<u32> {
    let mut codes = Vec::new();
    for part in upper.split("EPSG").skip(1) {
        // A compound URN goes on after a comma, a compound URL after an ampersand.
        let part = part.split([',', '&']).next().unwrap_or_default();
        // Between the authority and the code stands a version (`0`, `9.8.6`) or nothing; the code comes last.
        let fields: Vec<&str> = part.split([':', '/', '#']).filter(|f| !f.is_empty()).collect();
        let last =
            fields.iter().rev().find(|f| f.trim_end_matches('+').bytes().all(|b| b.is_ascii_digit() || b == b'+'));
        codes.extend(
            last.into_iter().flat_map(|f| f.split('+')).filter_map(|c| c.parse::<u32>().ok()).filter(|c| *c > 0),
        );
    }
    codes
}

fn adv_codes(upper: &str) -> Vec<u32> {
    ADV.iter().filter(|(name, _)| upper.contains(name)).filter_map(|(_, code)| code.parse().ok()).collect()
}

/// The metric frame that a city in degrees is put in: a UTM zone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UtmZone {
    /// 1..=60; zone 31 has its central meridian at 3° east.
    pub number: u8,
    /// Whether northings start at 10,000,000 m at the equator.
    pub is_south: bool,
}

/// The metric frames that the coordinates of a city were put in, where its files are in degrees or earth-centred. Two cities are in the same
/// places if these are equal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frames {
    /// The zone that degrees were projected to.
    pub zone: Option<UtmZone>,
    /// The frame that earth-centred coordinates were turned to.
    pub local: Option<LocalFrame>,
}

/// Semi-major axis of GRS 80 and WGS 84, metres.
const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// Flattening of GRS 80.
const FLATTENING: f64 = 1.0 / 298.257_222_101;
/// Scale at the central meridian.
const SCALE: f64 = 0.9996;

impl UtmZone {
    /// The zone of a place, degrees. The exceptions around Norway are not made: they are for map sheets.
    pub fn at(lat_deg: f64, lon_deg: f64) -> Self {
        let number = ((lon_deg + 180.0) / 6.0).floor().rem_euclid(60.0) as u8 + 1;
        Self { number, is_south: lat_deg < 0.0 }
    }

    /// Easting, northing, height in metres; NaN beyond the poles or 90° from the central meridian.
    pub fn project(self, lat_deg: f64, lon_deg: f64, height_m: f64) -> DVec3 {
        let central_deg = f64::from(self.number) * 6.0 - 183.0;
        let mut lambda_deg = lon_deg - central_deg;
        lambda_deg -= 360.0 * (lambda_deg / 360.0).round();
        if lat_deg.abs() > 90.0 || lambda_deg.abs() >= 90.0 {
            return DVec3::NAN;
        }
        let (xi, eta) = transverse_mercator(lat_deg.to_radians(), lambda_deg.to_radians());
        let false_northing = if self.is_south { 1.0e7 } else { 0.0 };
        DVec3::new(500_000.0 + SCALE * eta, false_northing + SCALE * xi, height_m)
    }
}

/// Where an earth-centred city is put: east, north and up of a place, which has its height above the ellipsoid and is (0, 0) across.
///
/// The ground falls away from the plane through the place by d² / 12,756 km: 8 cm in 1 km, 8 m in 10 km.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalFrame {
    /// From earth-centred coordinates.
    local_from_earth: DAffine3,
}

/// Heights beyond this are none of a city, metres: what has them may be earth-centred.
const HIGHEST_CITY_M: f64 = 20_000.0;
/// How far above and below the ellipsoid there are cities, metres: from mines to what is taken for a planet's picture from orbit.
const NEAR_GROUND_M: f64 = 100_000.0;

impl LocalFrame {
    /// That of a place in earth-centred coordinates; `None` where it is not near the ground.
    pub fn at(place: DVec3) -> Option<Self> {
        let (latitude, height) = geodetic(place).filter(|(_, height)| height.abs() < NEAR_GROUND_M)?;
        let longitude = place.y.atan2(place.x);
        let ((sin_lat, cos_lat), (sin_lon, cos_lon)) = (latitude.sin_cos(), longitude.sin_cos());
        let east = DVec3::new(-sin_lon, cos_lon, 0.0);
        let up = DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat);
        let turned = DMat3::from_cols(east, up.cross(east), up).transpose();
        let to = DVec3::new(0.0, 0.0, height) - turned * place;
        Some(Self { local_from_earth: DAffine3::from_mat3_translation(turned, to) })
    }

    /// That of a place in a file that does not say where it is, z up: of one that can only be earth-centred.
    pub fn of_unnamed(place: DVec3) -> Option<Self> {
        (place.z.abs() > HIGHEST_CITY_M).then(|| Self::at(place)).flatten()
    }

    /// From earth-centred coordinates.
    pub fn local_from_earth(&self) -> DAffine3 {
        self.local_from_earth
    }
}

/// Latitude in radians and height above the ellipsoid in metres of a place in earth-centred coordinates (Bowring 1985, repeated until it
/// stands: below a micrometre and 1e-12); `None` at the earth's middle, where neither is known.
fn geodetic(place: DVec3) -> Option<(f64, f64)> {
    let e2 = FLATTENING * (2.0 - FLATTENING);
    let across = place.x.hypot(place.y);
    if !place.is_finite() || across.hypot(place.z) < 1000.0 * 1000.0 {
        return None;
    }
    let mut latitude = place.z.atan2(across * (1.0 - e2));
    for _ in 0..6 {
        let (sin, cos) = ((1.0 - FLATTENING) * latitude.tan()).atan().sin_cos();
        let minor = SEMI_MAJOR_M * (1.0 - FLATTENING);
        latitude = (place.z + e2 / (1.0 - e2) * minor * sin.powi(3)).atan2(across - e2 * SEMI_MAJOR_M * cos.powi(3));
    }
    let (sin, cos) = latitude.sin_cos();
    let height = across * cos + place.z * sin - SEMI_MAJOR_M * (1.0 - e2 * sin * sin).sqrt();
    Some((latitude, height))
}

/// Northing and easting in metres on the unscaled transverse Mercator.
fn transverse_mercator(phi: f64, lambda: f64) -> (f64, f64) {
    let n = FLATTENING / (2.0 - FLATTENING);
    let e = (FLATTENING * (2.0 - FLATTENING)).sqrt();
    let n2 = n * n;
    let radius = SEMI_MAJOR_M / (1.0 + n) * (1.0 + n2 / 4.0 + n2 * n2 / 64.0 + n2 * n2 * n2 / 256.0);
    // Conformal latitude (equations 7 to 9), by its tangent; finite at the poles because tan(90°) is in f64.
    let tau = phi.tan();
    let sigma = (e * (e * phi.sin()).atanh()).sinh();
    let tau_conformal = tau * (1.0 + sigma * sigma).sqrt() - sigma * (1.0 + tau * tau).sqrt();
    let xi_sphere = tau_conformal.atan2(lambda.cos());
    let eta_sphere = (lambda.sin() / tau_conformal.hypot(lambda.cos())).asinh();
    let (mut xi, mut eta) = (xi_sphere, eta_sphere);
    for (j, alpha) in krueger_alpha(n).into_iter().enumerate() {
        let m = 2.0 * (j + 1) as f64;
        xi += alpha * (m * xi_sphere).sin() * (m * eta_sphere).cosh();
        eta += alpha * (m * xi_sphere).cos() * (m * eta_sphere).sinh();
    }
    (radius * xi, radius * eta)
}

/// Karney 2011, equation 35.
fn krueger_alpha(n: f64) -> [f64; 6] {
    // Horner's scheme over the powers of n, lowest first.
    let series = |power: i32, terms: &[f64]| n.powi(power) * terms.iter().rev().fold(0.0, |sum, t| sum * n + t);
    [
        series(1, &[1.0 / 2.0, -2.0 / 3.0, 5.0 / 16.0, 41.0 / 180.0, -127.0 / 288.0, 7891.0 / 37800.0]),
        series(2, &[13.0 / 48.0, -3.0 / 5.0, 557.0 / 1440.0, 281.0 / 630.0, -1_983_433.0 / 1_935_360.0]),
        series(3, &[61.0 / 240.0, -103.0 / 140.0, 15061.0 / 26880.0, 167_603.0 / 181_440.0]),
        series(4, &[49561.0 / 161_280.0, -179.0 / 168.0, 6_601_661.0 / 7_257_600.0]),
        series(5, &[34729.0 / 80640.0, -3_418_889.0 / 1_995_840.0]),
        series(6, &[212_378_941.0 / 319_334_400.0]),
    ]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn names_are_canonical() {
        for (raw, name) in [
            ("urn:ogc:def:crs:EPSG::7415", "EPSG:7415"),
            ("urn:ogc:def:crs:EPSG:9.8.6:7415", "EPSG:7415"),
            ("https://www.opengis.net/def/crs/EPSG/0/28992", "EPSG:28992"),
            ("http://www.opengis.net/def/crs/EPSG/0/6697", "EPSG:6697"),
            ("urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783", "EPSG:25832+5783"),
            (
                "http://www.opengis.net/def/crs-compound?1=http://www.opengis.net/def/crs/EPSG/0/25832&2=http://www.opengis.net/def/crs/EPSG/0/5783",
                "EPSG:25832+5783",
            ),
            ("EPSG:7415", "EPSG:7415"),
            ("epsg:25832+5783", "EPSG:25832+5783"),
            ("EPSG:25832+EPSG:5783", "EPSG:25832+5783"),
            ("urn:adv:crs:ETRS89_UTM32*DE_DHHN92_NH", "EPSG:25832+5783"),
            ("urn:ogc:def:crs:OGC:1.3:CRS84", "OGC:CRS84"),
        ] {
            assert_eq!(Crs::parse(raw).map(|c| c.name).as_deref(), Some(name), "{raw}");
        }
        for raw in ["", "local", "urn:ogc:def:crs:EPSG::", "https://www.opengis.net/def/crs/EPSG/0/", "EPSG:x"] {
            assert_eq!(Crs::parse(raw), None, "{raw}");
        }
        assert_eq!(Crs::parse("EPSG:6697").unwrap().axes, Axes::LatLon);
        assert_eq!(Crs::parse("EPSG:7415").unwrap().axes, Axes::Metric);
    }

    /// Radii of curvature in the meridian and across it, metres.
    fn radii(phi: f64) -> (f64, f64) {
        let e2 = FLATTENING * (2.0 - FLATTENING);
        let w = 1.0 - e2 * phi.sin().powi(2);
        (SEMI_MAJOR_M * (1.0 - e2) / w.powf(1.5), SEMI_MAJOR_M / w.sqrt())
    }

    /// Transverse Mercator is the one conformal map that is true along its central meridian: check both, by
    /// integrating the meridian numerically and by finite differences.
    #[test]
    fn is_true_on_the_meridian_and_conformal_beside_it() {
        let steps = 20_000;
        let mut arc = 0.0;
        for i in 0..steps {
            let width = 0.9_f64 / f64::from(steps);
            let at = |t: f64| radii((f64::from(i) + t) * width).0;
            arc += width / 6.0 * (at(0.0) + 4.0 * at(0.5) + at(1.0));
        }
        assert!((transverse_mercator(0.9, 0.0).0 - arc).abs() < 1e-6);
        for (phi, lambda) in [(0.9, 0.05), (0.2, -0.03), (-0.6, 0.2), (1.2, 0.1)] {
            let h = 1e-5;
            let (meridian, across) = radii(phi);
            let difference = |dp: f64, dl: f64, length: f64| {
                let (a, b) = (transverse_mercator(phi + dp, lambda + dl), transverse_mercator(phi - dp, lambda - dl));
                ((a.0 - b.0) / (2.0 * h * length), (a.1 - b.1) / (2.0 * h * length))
            };
            let north = difference(h, 0.0, meridian);
            let east = difference(0.0, h, across * phi.cos());
            assert!((north.0 - east.1).abs() < 1e-8 && (north.1 + east.0).abs() < 1e-8, "{phi} {lambda}");
        }
    }

    /// Earth-centred coordinates of a geodetic place.
    fn earth_centred(lat: f64, lon: f64, height: f64) -> DVec3 {
        let e2 = FLATTENING * (2.0 - FLATTENING);
        let across = radii(lat).1;
        let equator = (across + height) * lat.cos();
        DVec3::new(equator * lon.cos(), equator * lon.sin(), (across * (1.0 - e2) + height) * lat.sin())
    }

    #[test]
    fn an_earth_centred_place_has_its_height_and_stands_upright() {
        for (lat, lon) in [(0.0, 0.0), (0.9, 0.07), (-0.6, 2.6), (1.57, -3.0), (0.02, 1.8), (-FRAC_PI_2, 0.3)] {
            for height in [-400.0, 0.0, 35.0, 8848.0] {
                let place = earth_centred(lat, lon, height);
                let frame = LocalFrame::at(place).expect("near the ground").local_from_earth();
                let at = frame.transform_point3(place);
                assert!((at - DVec3::new(0.0, 0.0, height)).length() < 1e-6, "{lat} {lon}: {at}");
                let over = frame.transform_point3(earth_centred(lat, lon, height + 100.0));
                assert!((over - DVec3::new(0.0, 0.0, height + 100.0)).length() < 1e-6, "{lat} {lon}: {over}");
                if lat.abs() < 1.5 {
                    let (meridian, across) = radii(lat);
                    let north = frame.transform_point3(earth_centred(lat + 1e-5, lon, height)) - at;
                    let east = frame.transform_point3(earth_centred(lat, lon + 1e-5, height)) - at;
                    assert!(
                        (north.truncate() - glam::DVec2::new(0.0, 1e-5 * (meridian + height))).length() < 1e-3,
                        "{north}"
                    );
                    let parallel = 1e-5 * (across + height) * lat.cos();
                    assert!((east.truncate() - glam::DVec2::new(parallel, 0.0)).length() < 1e-3, "{east}");
                }
            }
        }
        for nowhere in [DVec3::ZERO, DVec3::NAN, DVec3::new(85_000.0, 447_000.0, 5.0), DVec3::splat(9e6)] {
            assert_eq!(LocalFrame::at(nowhere), None, "{nowhere}");
        }
    }

    /// The Eiffel Tower, as maps print it: 31U 448252 5411933.
    #[test]
    fn a_landmark_is_where_maps_have_it() {
        let zone = UtmZone::at(48.8582, 2.2945);
        assert_eq!(zone, UtmZone { number: 31, is_south: false });
        let at = zone.project(48.8582, 2.2945, 35.0);
        assert!((at - DVec3::new(448_252.0, 5_411_933.0, 35.0)).abs().max_element() < 1.0, "{at}");
        assert_eq!(UtmZone::at(-33.9, 151.2), UtmZone { number: 56, is_south: true });
        assert!(UtmZone::at(0.0, 179.999).number == 60 && UtmZone::at(0.0, 180.0).number == 1);
        assert!(zone.project(91.0, 2.0, 0.0).is_nan());
    }
}
