//! The sun over twenty places against an almanac (`sun.txt`, made by `sun.py`).

use veduta::{city::sun::Site, time::Interval};

/// What the almanac and the program may differ by, degrees.
const OFF_DEG: f64 = 0.01;

#[test]
fn the_sun_stands_where_an_almanac_says() {
    let mut seen = 0;
    for line in include_str!("sun.txt").lines() {
        let parts: Vec<&str> = line.split(' ').collect();
        let number = |i: usize| parts[i].parse::<f64>().expect("a number");
        let (azimuth, elevation) = (number(3), number(4));
        let at = Interval::parse(parts[2]).expect("a time").begin.expect("a moment");
        let sun = Site::given(number(0), number(1)).sun_without_air(at, 0.0).expect("the sun");
        let aside = (sun.azimuth.to_degrees() - azimuth + 540.0).rem_euclid(360.0) - 180.0;
        let above = sun.elevation.to_degrees() - elevation;
        // Near the zenith a small way is a large angle.
        let aside = aside * elevation.to_radians().cos();
        assert!(aside.abs() < OFF_DEG && above.abs() < OFF_DEG, "{line}: {aside} aside, {above} above");
        seen += 1;
    }
    assert_eq!(seen, 40, "two dates at each of twenty places");
}
