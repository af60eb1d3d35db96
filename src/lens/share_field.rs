//! Shares of a band around a figure in the picture, as a field of texels: for lenses whose outline is no formula (Wang et al. §3.2).

use glam::{DVec2, DVec3};

/// Texels along a side.
pub const SIDE: usize = 512;

/// How far places of a square are from a core, in widths of the band around it: 0 in the core, 1 and more where the band has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct ShareField {
    /// Rows from low to high y.
    pub texels: Vec<f32>,
}

impl ShareField {
    /// That of a core. `band`: how wide the band is, in halves of a side.
    pub fn of_core(core: &[bool], band: f64) -> Self {
        let texel = 2.0 / SIDE as f64;
        let share = |squared: f64| (squared.sqrt() * texel / band) as f32;
        Self { texels: squared_distances(core).into_iter().map(share).collect() }
    }

    /// That of a lens whose outline a mask is: 1 outside, and less inside by how far that is, in halves of a side.
    pub fn of_mask(mask: &[bool]) -> Self {
        let outside: Vec<bool> = mask.iter().map(|is_in| !is_in).collect();
        let texel = 2.0 / SIDE as f64;
        let texels = squared_distances(&outside).into_iter().enumerate().map(|(i, squared)| {
            // Beyond the square is outside, too; the outline goes between texels.
            let to_side = [i % SIDE, i / SIDE].into_iter().map(|k| k.min(SIDE - 1 - k) + 1).min().unwrap_or(0) as f64;
            (1.0 - (squared.sqrt().min(to_side) - 0.5).max(0.0) * texel) as f32
        });
        Self { texels: texels.collect() }
    }

    /// The share at a place, in halves of a side from the middle: between texels linearly; outside of the square that at its border.
    pub fn at(&self, place: DVec2) -> f64 {
        let at = ((0.5 * place + 0.5) * SIDE as f64 - 0.5).clamp(DVec2::ZERO, DVec2::splat(SIDE as f64 - 1.0));
        let low = at.floor().min(DVec2::splat(SIDE as f64 - 2.0));
        let share = at - low;
        let texel = |x: usize, y: usize| f64::from(self.texels[(low.y as usize + y) * SIDE + low.x as usize + x]);
        let row = |y| texel(0, y) + (texel(1, y) - texel(0, y)) * share.x;
        row(0) + (row(1) - row(0)) * share.y
    }
}

/// Of each texel the squared distance to the nearest of the core, texels: exact (Felzenszwalb & Huttenlocher 2012).
fn squared_distances(core: &[bool]) -> Vec<f64> {
    // Beyond all that a square has, and a number.
    const FAR: f64 = 1e12;
    let mut field: Vec<f64> = core.iter().map(|is_in| if *is_in { 0.0 } else { FAR }).collect();
    let mut line = vec![0.0; SIDE];
    for x in 0..SIDE {
        (0..SIDE).for_each(|y| line[y] = field[y * SIDE + x]);
        for (y, value) in along_line(&line).into_iter().enumerate() {
            field[y * SIDE + x] = value;
        }
    }
    for row in field.chunks_exact_mut(SIDE) {
        let found = along_line(row);
        row.copy_from_slice(&found);
    }
    field
}

/// The lower envelope of the parabolas over a line.
fn along_line(values: &[f64]) -> Vec<f64> {
    let mut roots: Vec<usize> = vec![0];
    let mut ends: Vec<f64> = vec![f64::NEG_INFINITY];
    let height = |q: usize| values[q] + (q * q) as f64;
    for q in 1..values.len() {
        let meets = |root: usize| (height(q) - height(root)) / (2.0 * (q - root) as f64);
        let mut at = meets(roots[roots.len() - 1]);
        while at <= ends[ends.len() - 1] {
            roots.pop();
            ends.pop();
            at = meets(roots[roots.len() - 1]);
        }
        roots.push(q);
        ends.push(at);
    }
    let mut k = 0;
    let value = |q: usize| {
        while k + 1 < roots.len() && ends[k + 1] < q as f64 {
            k += 1;
        }
        let away = q as f64 - roots[k] as f64;
        values[roots[k]] + away * away
    };
    (0..values.len()).map(value).collect()
}

/// The parts of a triangle of view space between two distances along the view axis, as corners in order.
pub fn between(corners: [DVec3; 3], [near, far]: [f64; 2]) -> Vec<DVec3> {
    let cut = |polygon: Vec<DVec3>, inside: &dyn Fn(DVec3) -> f64| {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            let (da, db) = (inside(*a), inside(b));
            if da >= 0.0 {
                kept.push(*a);
            }
            if (da < 0.0) != (db < 0.0) {
                kept.push(a.lerp(b, da / (da - db)));
            }
        }
        kept
    };
    let kept = cut(corners.to_vec(), &|p| -p.z - near);
    if far.is_finite() { cut(kept, &|p| far + p.z) } else { kept }
}

/// Marks the texels of a convex polygon, in halves of a side from the middle: those whose middles it holds, and those along its edges.
pub fn mark(core: &mut [bool], polygon: &[DVec2]) {
    if polygon.len() < 2 || !polygon.iter().all(|p| p.is_finite()) {
        return;
    }
    let texels: Vec<DVec2> = polygon.iter().map(|p| (0.5 * *p + 0.5) * SIDE as f64).collect();
    let end = SIDE as f64 - 1.0;
    for (i, a) in texels.iter().enumerate() {
        let b = texels[(i + 1) % texels.len()];
        let steps = (2.0 * a.distance(b)).ceil().clamp(1.0, 8.0 * SIDE as f64);
        for step in 0..=steps as usize {
            let at = a.lerp(b, step as f64 / steps);
            if at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::splat(SIDE as f64)).all() {
                core[at.y as usize * SIDE + at.x as usize] = true;
            }
        }
    }
    let low = texels.iter().fold(DVec2::INFINITY, |low, p| low.min(*p)).clamp(DVec2::ZERO, DVec2::splat(end));
    let high = texels.iter().fold(DVec2::NEG_INFINITY, |high, p| high.max(*p)).clamp(DVec2::ZERO, DVec2::splat(end));
    for y in low.y as usize..=high.y as usize {
        for x in low.x as usize..=high.x as usize {
            let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let side = |i: usize| (texels[(i + 1) % texels.len()] - texels[i]).perp_dot(at - texels[i]);
            let sides: Vec<f64> = (0..texels.len()).map(side).collect();
            if sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0) {
                core[y * SIDE + x] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_brute_force() {
        let mut core = vec![false; SIDE * SIDE];
        let marked = [(3, 7), (200, 40), (201, 40), (511, 500), (90, 333)];
        marked.iter().for_each(|(x, y)| core[y * SIDE + x] = true);
        let found = squared_distances(&core);
        for (x, y) in (0..SIDE).step_by(29).flat_map(|x| (0..SIDE).step_by(31).map(move |y| (x, y))) {
            let away = |(a, b): &(usize, usize)| (x as f64 - *a as f64).powi(2) + (y as f64 - *b as f64).powi(2);
            let expected = marked.iter().map(away).fold(f64::INFINITY, f64::min);
            assert_eq!(found[y * SIDE + x], expected, "{x}, {y}");
        }
    }

    #[test]
    fn shares_rise_from_the_core_to_the_end_of_the_band() {
        let mut core = vec![false; SIDE * SIDE];
        let square = [[-0.25, -0.25], [0.25, -0.25], [0.25, 0.25], [-0.25, 0.25]].map(DVec2::from);
        mark(&mut core, &square);
        let field = ShareField::of_core(&core, 0.5);
        assert_eq!(field.at(DVec2::ZERO), 0.0);
        for away in [0.05, 0.2, 0.45, 0.7] {
            let share = field.at(DVec2::new(0.25 + away, 0.1));
            // To a texel.
            assert!((share - away / 0.5).abs() < 2.0 * 2.0 / SIDE as f64 / 0.5, "{share} at {away}");
        }
        let corner = field.at(DVec2::splat(0.25 + 0.3));
        assert!((corner - 0.3 * 2.0_f64.sqrt() / 0.5).abs() < 0.02, "{corner}");
    }

    #[test]
    fn a_round_mask_is_a_round_lens() {
        let middle = |k: usize| (k as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0;
        let mask: Vec<bool> = (0..SIDE * SIDE).map(|i| middle(i % SIDE).hypot(middle(i / SIDE)) < 0.8).collect();
        let field = ShareField::of_mask(&mask);
        for place in [[0.0, 0.0], [0.3, 0.1], [-0.5, 0.5], [0.1, -0.75]].map(DVec2::from) {
            let expected = 1.0 - (0.8 - place.length());
            assert!((field.at(place) - expected).abs() < 1.5 * 2.0 / SIDE as f64, "{place}: {}", field.at(place));
        }
        assert_eq!(field.at(DVec2::new(0.9, 0.2)), 1.0);
        let all = ShareField::of_mask(&vec![true; SIDE * SIDE]);
        assert!((all.at(DVec2::new(0.7, -0.2)) - 0.7).abs() < 2.0 / SIDE as f64, "the square ends it");
    }

    #[test]
    fn triangles_are_cut_at_distances() {
        let corners = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(2.0, 0.0, -3.0), DVec3::new(0.0, 2.0, -3.0)];
        let part = between(corners, [2.0, 2.5]);
        assert!(part.len() >= 4 && part.iter().all(|p| (-2.5 - 1e-12..=-2.0 + 1e-12).contains(&p.z)), "{part:?}");
        assert!(between(corners, [4.0, 9.0]).is_empty());
        assert_eq!(between(corners, [0.0, f64::INFINITY]).len(), 3);
    }
}
