//! Where the sun stands over a city, by place, date and hour: the solar position algorithm of Reda & Andreas (2004), within 0.0003° in the years
//! −2000 to 6000.

use glam::DVec2;
use proj_core::Transform;
use solar_positioning::{Location, RefractionCorrection, SolarPositions, delta_t, time::JulianDate};

use crate::time::{DAY, HOUR, Moment};

/// Where a city is on the earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// Degrees, north positive, −90..90.
    pub latitude: f64,
    /// Degrees, east positive, −180..180.
    pub longitude: f64,
    /// How far the model's north is clockwise from true north, radians (meridian convergence).
    pub north: f64,
}

/// Where the sun stands, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Clockwise from the model's north.
    pub azimuth: f64,
    /// Above the horizon, as it is seen: lifted by the air (1010 hPa, 10 °C).
    pub elevation: f64,
}

/// How far apart the places are that tell where north is, metres.
const NORTHWARD_M: f64 = 100.0;

impl Site {
    /// A place in the reference system of a model; its canonical name, and coordinates in metres.
    ///
    /// # Errors
    /// The system has no place on the earth that is known here: what would be right.
    pub fn of_model(crs: Option<&str>, at: DVec2) -> Result<Self, String> {
        let right = "[sun] place = [LATITUDE, LONGITUDE] would be right";
        let name = crs.ok_or_else(|| format!("the city has no reference system that says where it is; {right}"))?;
        let unknown = || format!("where \"{name}\" is on the earth is not known here; {right}");
        // Of a compound the first is in plan.
        let plan = name.split('+').next().unwrap_or(name);
        let transform = Transform::new_horizontal(plan, "EPSG:4326").map_err(|_| unknown())?;
        let degrees = |at: DVec2| transform.convert((at.x, at.y)).map_err(|_| unknown());
        let ((longitude, latitude), (east, north)) = (degrees(at)?, degrees(at + DVec2::Y * NORTHWARD_M)?);
        let is_there = latitude.abs() <= 90.0 && longitude.abs() <= 180.0 && north.abs() <= 90.0;
        if !is_there || at.abs().max_element() < 360.0 {
            return Err(unknown());
        }
        let (aside, ahead) = ((east - longitude) * latitude.to_radians().cos(), north - latitude);
        Ok(Self { latitude, longitude, north: aside.atan2(ahead) })
    }

    /// A place in degrees, of a model whose north is true.
    pub fn given(latitude: f64, longitude: f64) -> Self {
        Self { latitude, longitude, north: 0.0 }
    }

    /// How far clocks there are ahead of UTC, hours, if they go by the sun: whole hours.
    pub fn standard_offset_h(&self) -> f64 {
        (self.longitude / 15.0).round()
    }

    /// Where the sun stands there when a clock that is so many hours ahead of UTC shows a moment.
    ///
    /// # Errors
    /// The years in which it is known.
    pub fn sun(&self, at: Moment, offset_h: f64) -> Result<SunPosition, String> {
        self.position(at, offset_h, Some(RefractionCorrection::standard()))
    }

    fn position(&self, at: Moment, offset_h: f64, air: Option<RefractionCorrection>) -> Result<SunPosition, String> {
        /// The Julian date of the start of 1970.
        const START: f64 = 2_440_587.5;
        let unknown = |_| {
            format!("where the sun stood in {} is not known; a year from -500 to 3000 would be right", at.written())
        };
        let micros = at.micros() - (offset_h * HOUR as f64).round() as i64;
        let julian = START + micros as f64 / DAY as f64;
        let (year, month, _) = at.date();
        let delta_t = delta_t::estimate_from_date(year.into(), month.unsigned_abs().into()).map_err(unknown)?;
        let julian = JulianDate::new(julian, delta_t).map_err(unknown)?;
        let location = Location { latitude: self.latitude, longitude: self.longitude };
        let sun = SolarPositions::new().at_from_julian(julian, location, 0.0, air).map_err(unknown)?;
        let azimuth = (sun.azimuth().to_radians() - self.north).rem_euclid(std::f64::consts::TAU);
        Ok(SunPosition { azimuth, elevation: sun.elevation_angle().to_radians() })
    }

    /// The same without what the air does.
    ///
    /// # Errors
    /// See [`Self::sun`].
    pub fn sun_without_air(&self, at: Moment, offset_h: f64) -> Result<SunPosition, String> {
        self.position(at, offset_h, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::Interval;

    fn moment(text: &str) -> Moment {
        Interval::parse(text).expect("a time").begin.expect("a beginning")
    }

    #[test]
    fn cities_know_where_they_are() {
        for (crs, at, latitude, longitude, north) in [
            // As C PROJ 9 has them.
            ("EPSG:28992", DVec2::new(155_000.0, 463_000.0), 52.155_172, 5.387_204, -0.0003),
            ("EPSG:7415", DVec2::new(84_700.0, 447_300.0), 52.009_607, 4.363_253, -0.8081),
            ("EPSG:25832+5783", DVec2::new(500_000.0, 5_400_000.0), 48.753_013, 9.0, 0.0),
            ("EPSG:25832", DVec2::new(400_000.0, 5_400_000.0), 48.744_984, 7.639_721, -1.0227),
            ("EPSG:3946", DVec2::new(1_842_000.0, 5_176_000.0), 45.769_411, 4.825_859, 1.3135),
            ("EPSG:2193", DVec2::new(1_748_000.0, 5_428_000.0), -41.285_883, 174.767_400, -1.1664),
            ("EPSG:31256", DVec2::new(2900.0, 341_000.0), 48.207_397, 16.371_152, 0.0282),
        ] {
            let site = Site::of_model(Some(crs), at).unwrap_or_else(|wrong| panic!("{crs}: {wrong}"));
            let near = |a: f64, b: f64, off: f64| (a - b).abs() < off;
            assert!(near(site.latitude, latitude, 2e-5) && near(site.longitude, longitude, 2e-5), "{crs}: {site:?}");
            assert!(near(site.north.to_degrees(), north, 0.01), "{crs}: {}", site.north.to_degrees());
        }
        let unknown = Site::of_model(None, DVec2::ZERO).expect_err("nowhere");
        assert!(unknown.contains("place = [LATITUDE, LONGITUDE] would be right"));
        assert!(Site::of_model(Some("EPSG:1"), DVec2::splat(1e5)).is_err());
        assert!(Site::of_model(Some("EPSG:4979"), DVec2::new(48.0, 16.0)).is_err(), "degrees are made metres of");
    }

    #[test]
    fn the_sun_stands_where_its_algorithm_was_published_with() {
        // Reda & Andreas, table A5.1, but for the height and the air there: their zenith is 50.11162°.
        let golden = Site::given(39.742_476, -105.1786);
        let sun = golden.sun_without_air(moment("2003-10-17T12:30:30"), -7.0).expect("the sun");
        assert!((sun.azimuth.to_degrees() - 194.340_24).abs() < 0.001, "{}", sun.azimuth.to_degrees());
        assert!((90.0 - sun.elevation.to_degrees() - 50.1277).abs() < 0.001, "{}", sun.elevation.to_degrees());
        // North of the model is not always true north.
        let turned = Site { north: 0.1, ..golden };
        let aside = sun.azimuth - turned.sun_without_air(moment("2003-10-17T12:30:30"), -7.0).expect("the sun").azimuth;
        assert!((aside - 0.1).abs() < 1e-9, "{aside}");
        // The air lifts it, near the horizon by half a degree.
        let low = moment("2003-10-17T17:15:00");
        let lift = |site: &Site| {
            site.sun(low, -7.0).expect("the sun").elevation
                - site.sun_without_air(low, -7.0).expect("the sun").elevation
        };
        assert!((0.2..0.6).contains(&lift(&golden).to_degrees()), "{}", lift(&golden).to_degrees());
        assert!(golden.sun(Moment::FIRST, 0.0).expect_err("too long ago").contains("-500 to 3000"));
        assert_eq!((golden.standard_offset_h(), Site::given(52.0, 4.4).standard_offset_h()), (-7.0, 0.0));
    }
}
