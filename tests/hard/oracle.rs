//! Answers in exact integers that share no code with the program.

/// A point of the plane.
pub type P2 = [i64; 2];
/// A point in space.
pub type P3 = [i64; 3];

/// Twice the signed area of `a b c`.
pub fn turn(a: P2, b: P2, c: P2) -> i128 {
    let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(i128::from);
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Twice the signed area of a ring, by the shoelace formula.
pub fn shoelace(ring: &[P2]) -> i128 {
    (0..ring.len())
        .map(|i| {
            let (p, q) = (ring[i], ring[(i + 1) % ring.len()]);
            i128::from(p[0]) * i128::from(q[1]) - i128::from(q[0]) * i128::from(p[1])
        })
        .sum()
}

/// How often a ring winds around a point that is on none of its edges (crossings of a ray to the right).
pub fn winding(ring: &[P2], p: P2) -> i32 {
    let mut count = 0;
    for i in 0..ring.len() {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        if a[1] <= p[1] && b[1] > p[1] && turn(a, b, p) > 0 {
            count += 1;
        } else if a[1] > p[1] && b[1] <= p[1] && turn(a, b, p) < 0 {
            count -= 1;
        }
    }
    count
}

/// Whether a point lies on the closed segment.
pub fn on_segment(p: P2, a: P2, b: P2) -> bool {
    turn(a, b, p) == 0 && (0..2).all(|i| a[i].min(b[i]) <= p[i] && p[i] <= a[i].max(b[i]))
}

/// Whether the interiors of two triangles meet: no edge of either separates them (separating axes, exact).
pub fn interiors_meet(s: [P2; 3], t: [P2; 3]) -> bool {
    let separated_by_edges_of = |s: [P2; 3], t: [P2; 3]| {
        let sign = turn(s[0], s[1], s[2]).signum();
        (0..3).any(|i| t.iter().all(|&p| turn(s[i], s[(i + 1) % 3], p) * sign <= 0))
    };
    !separated_by_edges_of(s, t) && !separated_by_edges_of(t, s)
}

/// The exact vector area (twice) of a triangle in space.
pub fn normal(t: [P3; 3]) -> [i128; 3] {
    let d = |p: P3, q: P3| [0, 1, 2].map(|i| i128::from(q[i]) - i128::from(p[i]));
    let (u, v) = (d(t[0], t[1]), d(t[0], t[2]));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// A stream of numbers that is the same on every machine (splitmix64).
pub struct Numbers(pub u64);

impl Numbers {
    /// A number from `0..below`.
    pub fn below(&mut self, below: u64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below) as i64
    }
}
