//! Exact predicates on integer points: differences below 2⁵¹ give products that fit `i128` with room to sum.

/// Twice the signed area of the triangle `a b c`; positive when it turns left.
#[inline]
pub fn orient(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i128 {
    cross([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]])
}

/// The z component of `u × v`.
#[inline]
pub fn cross(u: [i64; 2], v: [i64; 2]) -> i128 {
    i128::from(u[0]) * i128::from(v[1]) - i128::from(u[1]) * i128::from(v[0])
}

/// The scalar product of two plane vectors.
#[inline]
pub fn dot(u: [i64; 2], v: [i64; 2]) -> i128 {
    i128::from(u[0]) * i128::from(v[0]) + i128::from(u[1]) * i128::from(v[1])
}

/// Twice the signed area inside a ring; positive when it runs counter-clockwise.
pub fn twice_area(ring: impl ExactSizeIterator<Item = [i64; 2]> + Clone) -> i128 {
    let mut points = ring.clone();
    let Some(first) = points.next() else { return 0 };
    let mut previous = first;
    let mut sum = 0;
    for point in points {
        sum += orient(first, previous, point);
        previous = point;
    }
    sum
}

/// Whether the closed segments `a b` and `c d` share any point.
pub fn segments_meet(a: [i64; 2], b: [i64; 2], c: [i64; 2], d: [i64; 2]) -> bool {
    let apart = |i: usize| a[i].max(b[i]) < c[i].min(d[i]) || c[i].max(d[i]) < a[i].min(b[i]);
    if apart(0) || apart(1) {
        return false;
    }
    let sides = |p, q, r, s| orient(p, q, r).signum() * orient(p, q, s).signum();
    // Collinear segments whose boxes meet do meet; for all others both tests must straddle or touch.
    sides(a, b, c, d) <= 0 && sides(c, d, a, b) <= 0
}

/// The exact Newell normal of a closed ring: the sum of the cross products of its edges, twice the ring's vector area.
///
/// Independent of where the ring starts and of where it lies; a reversed ring gives the opposite vector.
pub fn newell(ring: &[[i64; 3]]) -> [i128; 3] {
    let Some((&base, rest)) = ring.split_first() else { return [0; 3] };
    let from_base = |p: [i64; 3]| [p[0] - base[0], p[1] - base[1], p[2] - base[2]];
    let mut normal = [0_i128; 3];
    let mut previous = [0_i64; 3];
    for &point in rest {
        let current = from_base(point);
        normal[0] += cross([previous[1], previous[2]], [current[1], current[2]]);
        normal[1] += cross([previous[2], previous[0]], [current[2], current[0]]);
        normal[2] += cross([previous[0], previous[1]], [current[0], current[1]]);
        previous = current;
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_square_has_area_two_halves() {
        let square = [[0, 0], [1, 0], [1, 1], [0, 1]];
        assert_eq!(twice_area(square.into_iter()), 2);
        assert_eq!(twice_area(square.into_iter().rev()), -2);
    }

    #[test]
    fn segments_meet_at_ends_and_along_lines() {
        assert!(segments_meet([0, 0], [2, 2], [0, 2], [2, 0]), "crossing");
        assert!(segments_meet([0, 0], [2, 0], [1, 0], [1, 5]), "T");
        assert!(segments_meet([0, 0], [2, 0], [2, 0], [3, 5]), "end to end");
        assert!(segments_meet([0, 0], [2, 0], [1, 0], [3, 0]), "overlap");
        assert!(!segments_meet([0, 0], [2, 0], [3, 0], [4, 0]), "collinear, apart");
        assert!(!segments_meet([0, 0], [4, 4], [3, 2], [5, 2]), "boxes meet, segments do not");
    }

    #[test]
    fn the_newell_normal_is_twice_the_vector_area() {
        let square = [[5, 0, 0], [5, 3, 0], [5, 3, 3], [5, 0, 3]];
        assert_eq!(newell(&square), [18, 0, 0]);
        let mut turned = square;
        turned.rotate_left(3);
        assert_eq!(newell(&turned), [18, 0, 0]);
        turned.reverse();
        assert_eq!(newell(&turned), [-18, 0, 0]);
    }
}
