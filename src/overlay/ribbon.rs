//! The skin of a context line: trapezoids with projective texture coordinates, and how it fades (Trapp §3.4.3).

use glam::DVec2;

/// The least width of a line's end, pixels: at 0 the texture coordinate w would be 0, and u·w / w nothing.
pub const LEAST_WIDTH: f64 = 1.0 / 256.0;

/// A corner of a trapezoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where it is, pixels.
    pub at: DVec2,
    /// Texture coordinates (u·w, v·w, w), interpolated linearly over the trapezoid and divided by the last one per fragment, so that the skin does
    /// not shear along the diagonal. u runs from 0 at the overlay to 1 at the focus, v from 0 to 1 across. w is the width here over the largest width of
    /// the line, above 0 and at most 1.
    pub uvw: [f64; 3],
}

/// The trapezoids of a line along `points` (pixels, from the overlay to the focus) that is `width_overlay` wide where it begins and `width_focus`
/// where it ends, pixels; linear in the way along it. For each segment its corners in turn: overlay end v = 0, v = 1, focus end v = 1, v = 0.
///
/// A straight line has one. At the joints of others neighbours share the corners of the mitre, at most twice as far out as the width.
/// Segments without length, points that are not finite: left out. Widths below [`LEAST_WIDTH`] or not finite count as it.
pub fn ribbon(points: &[DVec2], width_overlay: f64, width_focus: f64) -> Vec<[Corner; 4]> {
    let mut way: Vec<DVec2> = points.iter().copied().filter(|p| p.is_finite()).collect();
    way.dedup();
    let segments: Vec<(DVec2, f64)> = way
        .windows(2)
        .filter_map(|pair| {
            let along = pair[1] - pair[0];
            Some((along.try_normalize()?, along.length()))
        })
        .collect();
    let length: f64 = segments.iter().map(|s| s.1).sum();
    // Segments so short that they have no direction leave no trapezoid, and then the points and the segments do not match.
    if segments.len() + 1 != way.len() || segments.is_empty() || !length.is_finite() {
        return Vec::new();
    }
    let sane = |width: f64| if width.is_finite() { width.max(LEAST_WIDTH) } else { LEAST_WIDTH };
    let (first, last) = (sane(width_overlay), sane(width_focus));
    let largest = first.max(last);
    let mut travelled = 0.0;
    let mut crosscuts = Vec::with_capacity(way.len());
    for (i, &at) in way.iter().enumerate() {
        let share = (travelled / length).clamp(0.0, 1.0);
        let width = first + (last - first) * share;
        let before = segments[i.saturating_sub(1)].0.perp();
        let after = segments[i.min(segments.len() - 1)].0.perp();
        // The mitre of two unit normals: their sum over (1 + their cosine); held where the line nearly turns back.
        let mitre = (before + after) / (1.0 + before.dot(after)).max(0.5);
        let aside = if mitre.length_squared() > 0.0 { mitre } else { after } * (0.5 * width);
        // u·w is linear in the way, as w is: u = share · last / width is what projects a square onto the whole trapezoid.
        let (uw, w) = (share * last / largest, width / largest);
        crosscuts.push([Corner { at: at - aside, uvw: [uw, 0.0, w] }, Corner { at: at + aside, uvw: [uw, w, w] }]);
        travelled += segments.get(i).map_or(0.0, |s| s.1);
    }
    crosscuts.windows(2).map(|c| [c[0][0], c[0][1], c[1][1], c[1][0]]).collect()
}

/// The visibility of a fragment of a line at `fragment` near the centre of interest `centre` (both pixels): 0 up to the distance `inner`, 1 from
/// `outer` on, t²(3 − 2t) between; where the two are equal, a step. 0 ≤ inner ≤ outer, pixels; an inner radius above the outer counts as equal to it.
pub fn fade(centre: DVec2, fragment: DVec2, inner: f64, outer: f64) -> f64 {
    let distance = centre.distance(fragment);
    let t = if outer > inner {
        ((distance - inner) / (outer - inner)).clamp(0.0, 1.0)
    } else if distance > outer {
        1.0
    } else {
        0.0
    };
    if t.is_nan() { 1.0 } else { t * t * (3.0 - 2.0 * t) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uv(corner: [f64; 3]) -> [f64; 2] {
        [corner[0] / corner[2], corner[1] / corner[2]]
    }

    #[test]
    fn a_straight_line_is_one_trapezoid() {
        let quads = ribbon(&[DVec2::new(10.0, 10.0), DVec2::new(40.0, 10.0)], 8.0, 2.0);
        assert_eq!(quads.len(), 1);
        let at = quads[0].map(|c| c.at.to_array());
        assert_eq!(at, [[10.0, 6.0], [10.0, 14.0], [40.0, 11.0], [40.0, 9.0]]);
        assert_eq!(quads[0].map(|c| uv(c.uvw)), [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        assert_eq!(quads[0].map(|c| c.uvw[2]), [1.0, 1.0, 0.25, 0.25]);
    }

    /// The projective image of a square's middle is where the diagonals of the trapezoid meet.
    #[test]
    fn the_middle_of_the_skin_is_where_the_diagonals_meet() {
        for (a, b) in [(8.0, 2.0), (1.0, 9.0), (3.0, 3.0)] {
            let quad = ribbon(&[DVec2::ZERO, DVec2::new(100.0, 0.0)], a, b)[0];
            let share = a / (a + b);
            // Along the axis v = 1/2; both triangles of the quad interpolate linearly, and agree, as the coordinates are affine in the plane.
            let mix = |i: usize| {
                let across = |p: Corner, q: Corner| 0.5 * (p.uvw[i] + q.uvw[i]);
                across(quad[0], quad[1]) * (1.0 - share) + across(quad[3], quad[2]) * share
            };
            let [u, v] = uv([mix(0), mix(1), mix(2)]);
            assert!((u - 0.5).abs() < 1e-15 && (v - 0.5).abs() < 1e-15, "{a} {b}: {u} {v}");
        }
    }

    #[test]
    fn a_bend_does_not_change_the_skin_of_a_straight_line() {
        let whole = ribbon(&[DVec2::ZERO, DVec2::new(100.0, 0.0)], 6.0, 2.0)[0];
        let parts = ribbon(&[DVec2::ZERO, DVec2::new(25.0, 0.0), DVec2::new(100.0, 0.0)], 6.0, 2.0);
        assert_eq!((parts[0][0], parts[1][2]), (whole[0], whole[2]));
        let cut = parts[0][3].uvw;
        assert_eq!(cut, parts[1][0].uvw);
        // A quarter along: linear between the ends' (u·w, w).
        assert!((cut[0] - 0.25 * whole[3].uvw[0]).abs() < 1e-15 && (cut[2] - (0.75 + 0.25 / 3.0)).abs() < 1e-15);
    }

    #[test]
    fn neighbours_share_the_mitre() {
        let quads = ribbon(&[DVec2::ZERO, DVec2::new(10.0, 0.0), DVec2::new(10.0, 10.0)], 2.0, 2.0);
        assert_eq!(quads.len(), 2);
        assert!((quads[0][3].at - DVec2::new(11.0, -1.0)).length() < 1e-12, "{:?}", quads[0][3]);
        assert!((quads[0][2].at - DVec2::new(9.0, 1.0)).length() < 1e-12);
        assert_eq!((quads[0][3], quads[0][2]), (quads[1][0], quads[1][1]));
    }

    #[test]
    fn degenerate_lines_have_no_skin_and_no_nan() {
        assert!(ribbon(&[], 1.0, 1.0).is_empty());
        assert!(ribbon(&[DVec2::ONE; 3], 1.0, 1.0).is_empty());
        assert!(ribbon(&[DVec2::NAN, DVec2::ONE], 1.0, 1.0).is_empty());
        for back in [DVec2::ZERO, DVec2::new(5.0, 0.0), DVec2::new(5.0, 1e-9)] {
            let quads = ribbon(&[DVec2::ZERO, DVec2::new(10.0, 0.0), back], 0.0, f64::NAN);
            assert_eq!(quads.len(), 2);
            assert!(
                quads
                    .iter()
                    .flatten()
                    .all(|c| c.at.is_finite() && c.uvw.iter().all(|x| x.is_finite()) && c.uvw[2] > 0.0)
            );
            assert!(quads.iter().flatten().all(|c| c.at.length() < 10.1), "a mitre does not run away");
        }
    }

    #[test]
    fn lines_fade_towards_the_centre_of_interest() {
        let at = |distance: f64, e: f64, r: f64| fade(DVec2::new(3.0, 4.0), DVec2::new(3.0 + distance, 4.0), e, r);
        assert_eq!([0.0, 10.0, 15.0, 20.0, 99.0].map(|d| at(d, 10.0, 20.0)), [0.0, 0.0, 0.5, 1.0, 1.0]);
        assert_eq!(at(12.5, 10.0, 20.0), 0.25 * 0.25 * 2.5);
        assert_eq!([at(20.0, 20.0, 20.0), at(20.5, 20.0, 20.0), at(0.0, 0.0, 0.0)], [0.0, 1.0, 0.0]);
        assert_eq!(at(f64::NAN, 1.0, 2.0), 1.0, "what has no place does not fade");
    }
}
