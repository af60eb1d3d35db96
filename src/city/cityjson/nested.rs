//! Boundaries and what runs parallel to them, read flat: nested arrays of integers without recursion.
//!
//! Members of a geometry come in any order, so its type may be unknown while its boundaries are read: every depth
//! keeps the ends of its arrays, and what a depth means is decided afterwards.
//!
//! ```text
//! depth      0              1                2             3
//! Solid      all shells     shell            polygon       ring of indices
//! MultiSurf. all polygons   polygon          ring of indices
//! ```

use crate::city::json::{Json, Kind, Number, Step};

/// The deepest that indices may lie: MultiSolid, five arrays deep.
const MAX_DEPTH: usize = 4;

/// Nested arrays of vertex indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Boundaries {
    /// The indices, in order; what is no index of 32 bits is `u32::MAX`, which no pool has.
    pub indices: Vec<u32>,
    /// Depth of the arrays that hold the indices; `None` while there is none.
    pub leaf_depth: Option<usize>,
    /// Per depth, the exclusive end of each array: in `indices` at the leaf depth, else in the next depth's ends.
    pub ends: [Vec<u32>; MAX_DEPTH + 1],
    /// Whether the arrays were too deep, uneven, or held something else.
    pub is_malformed: bool,
}

impl Boundaries {
    /// Nothing, but the memory is kept.
    pub fn clear(&mut self) {
        self.indices.clear();
        self.leaf_depth = None;
        self.ends.iter_mut().for_each(Vec::clear);
        self.is_malformed = false;
    }

    /// Reads the value of `boundaries` in place of what was there.
    pub fn read_again(&mut self, json: &mut Json<'_>) -> Step<()> {
        self.clear();
        if json.peek()? != Kind::Array {
            self.is_malformed = true;
            return json.skip();
        }
        let this = self;
        json.take(b'[');
        let mut depth = 0;
        let mut needs_comma = false;
        loop {
            if json.take(b']') {
                this.close(depth);
                let Some(up) = depth.checked_sub(1) else { return Ok(()) };
                (depth, needs_comma) = (up, true);
                continue;
            }
            if needs_comma && !json.take(b',') {
                return json.error("expected ',' or ']'");
            }
            needs_comma = true;
            match json.peek()? {
                Kind::Array if depth < MAX_DEPTH => {
                    json.take(b'[');
                    this.is_malformed |= this.leaf_depth.is_some_and(|leaf| leaf <= depth);
                    (depth, needs_comma) = (depth + 1, false);
                }
                Kind::Number => {
                    this.is_malformed |= *this.leaf_depth.get_or_insert(depth) != depth;
                    this.indices.push(index(json.number()?));
                }
                _ => {
                    json.skip()?;
                    this.is_malformed = true;
                }
            }
        }
    }

    fn close(&mut self, depth: usize) {
        // Without any index so far both ends are 0, so the leaf depth need not be known.
        let inner = match self.leaf_depth {
            Some(leaf) if leaf == depth => self.indices.len(),
            _ => self.ends.get(depth + 1).map_or(0, Vec::len),
        };
        self.ends[depth].push(inner as u32);
    }

    /// Indices, ring ends and polygon ends of a geometry whose rings lie at `depth`; `None` if it is not of that depth.
    pub fn rings(&self, depth: usize) -> Option<(&[u32], &[u32], &[u32])> {
        let fits = !self.is_malformed && self.leaf_depth.is_none_or(|leaf| leaf == depth) && self.ends[0].len() == 1;
        fits.then(|| (&self.indices[..], &self.ends[depth][..], &self.ends[depth - 1][..]))
    }
}

fn index(number: Number) -> u32 {
    match number {
        Number::Integer(i) => u32::try_from(i).unwrap_or(u32::MAX),
        // Some writers print whole numbers as `12.0`.
        Number::Real(r) if r.fract() == 0.0 && (0.0..4e9).contains(&r) => r as u32,
        Number::Real(_) => u32::MAX,
    }
}

/// One step through nested arrays of integers and nulls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Token {
    /// An array begins.
    Open,
    /// The innermost open array ends.
    Close,
    /// `null`: nothing here, or for everything in this place.
    Null,
    /// A number; what is no whole number of 32 bits is `u32::MAX`.
    Index(u32),
}

/// Nested arrays parallel to boundaries: semantics values, material values, texture values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// The arrays, flat; balanced.
    pub tokens: Vec<Token>,
    /// Whether there was something else than arrays, integers and nulls.
    pub is_malformed: bool,
}

impl Values {
    /// Reads nested arrays, an integer, or null.
    pub fn read(json: &mut Json<'_>) -> Step<Self> {
        let mut this = Self::default();
        let mut depth = 0_usize;
        let mut needs_comma = false;
        loop {
            if depth > 0 && json.take(b']') {
                this.tokens.push(Token::Close);
                (depth, needs_comma) = (depth - 1, true);
            } else {
                if needs_comma && !json.take(b',') {
                    return json.error("expected ',' or ']'");
                }
                needs_comma = true;
                match json.peek()? {
                    Kind::Array => {
                        json.take(b'[');
                        this.tokens.push(Token::Open);
                        (depth, needs_comma) = (depth + 1, false);
                    }
                    Kind::Number => this.tokens.push(Token::Index(index(json.number()?))),
                    kind => {
                        this.is_malformed |= kind != Kind::Null;
                        json.skip()?;
                        this.tokens.push(Token::Null);
                    }
                }
            }
            if depth == 0 {
                return Ok(this);
            }
        }
    }

    /// Calls `each(item, tokens)` for the items `items_depth` below the arrays of `ends`, with the tokens that stand in
    /// the item's place: one index or null, or a whole array. A null in place of an outer array stands for all inside it, and so
    /// does an array of nulls alone, however many. Returns how many places do not match; there is nothing in them, and in no other.
    pub fn for_each(&self, ends: &[Vec<u32>], mut each: impl FnMut(usize, &[Token])) -> u64 {
        if ends.first().is_none_or(|all| all.len() != 1) {
            return 1;
        }
        let mut walk = Walk { tokens: &self.tokens, at: 0, ends, each: &mut each, wrong: self.is_malformed.into() };
        walk.item(0, 0);
        walk.wrong
    }
}

/// Walks tokens and array ends side by side; as deep as the ends are, five at most.
struct Walk<'a> {
    tokens: &'a [Token],
    at: usize,
    ends: &'a [Vec<u32>],
    each: &'a mut dyn FnMut(usize, &[Token]),
    /// Places that do not match.
    wrong: u64,
}

impl Walk<'_> {
    /// The array `index` of `depth`, or an item when `depth` is below the last ends.
    fn item(&mut self, depth: usize, index: usize) {
        let start = self.at;
        if depth == self.ends.len() {
            self.skip();
            return (self.each)(index, &self.tokens[start..self.at]);
        }
        let ends = &self.ends[depth];
        let first = if index == 0 { 0 } else { ends[index - 1] as usize };
        let inner = first..ends[index] as usize;
        if self.tokens.get(start) != Some(&Token::Open) {
            self.wrong += u64::from(self.tokens.get(start) != Some(&Token::Null));
            self.skip();
            return self.nothing(depth + 1, inner);
        }
        self.at += 1;
        let (mut left, mut are_more) = (inner, false);
        while self.tokens.get(self.at).is_some_and(|token| *token != Token::Close) {
            match left.next() {
                Some(i) => self.item(depth + 1, i),
                None => {
                    self.skip();
                    are_more = true;
                }
            }
        }
        self.at += 1;
        let is_matched = left.is_empty() && !are_more;
        self.wrong +=
            u64::from(!is_matched && self.tokens[start..self.at].iter().any(|t| matches!(t, Token::Index(_))));
        self.nothing(depth + 1, left);
    }

    /// Every item inside the arrays `range` of `depth` gets null.
    fn nothing(&mut self, depth: usize, range: std::ops::Range<usize>) {
        let mut range = range;
        for ends in self.ends.iter().skip(depth) {
            let at = |i: usize| if i == 0 { 0 } else { ends[i - 1] as usize };
            range = at(range.start)..at(range.end);
        }
        for i in range {
            (self.each)(i, &[Token::Null]);
        }
    }

    /// Passes one index, null, or array of any depth.
    fn skip(&mut self) {
        let mut depth = 0_usize;
        while let Some(token) = self.tokens.get(self.at) {
            self.at += 1;
            match token {
                Token::Open => depth += 1,
                Token::Close => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boundaries(text: &str) -> Boundaries {
        let mut boundaries = Boundaries::default();
        boundaries.read_again(&mut Json::new(text.as_bytes())).unwrap();
        boundaries
    }

    fn values(text: &str) -> Values {
        Values::read(&mut Json::new(text.as_bytes())).unwrap()
    }

    #[test]
    fn rings_and_polygons_come_out_flat() {
        let solid = "[ [ [[0,1,2],[3,4,5]], [[6,7,8]] ], [ [[9,10,11]] ] ]";
        let (indices, rings, polygons) =
            (boundaries(solid).rings(3).map(|(i, r, p)| (i.to_vec(), r.to_vec(), p.to_vec()))).unwrap();
        assert_eq!(indices, (0..12).collect::<Vec<_>>());
        assert_eq!(rings, [3, 6, 9, 12]);
        assert_eq!(polygons, [2, 3, 4]);
        assert_eq!(boundaries(solid).rings(2), None, "a Solid is no MultiSurface");
    }

    #[test]
    fn empty_arrays_keep_their_place() {
        let b = boundaries("[[], [[]], [[0,1,2], []], [[3]]]");
        let (_, rings, polygons) = b.rings(2).unwrap();
        assert_eq!(rings, [0, 3, 3, 4]);
        assert_eq!(polygons, [0, 1, 3, 4]);
        assert!(boundaries("[]").rings(2).unwrap().2.is_empty());
    }

    #[test]
    fn what_is_no_index_points_past_every_pool() {
        assert_eq!(
            boundaries("[[[0,-1,4294967296,2.0,1.5,99999999999999999999]]]").indices,
            [0, u32::MAX, u32::MAX, 2, u32::MAX, u32::MAX]
        );
        for wrong in ["7", "null", "[[[0,[1],2]]]", "[[0],[[1]]]", "[[[\"a\"]]]", "[[[[[[1]]]]]]", "[null]"] {
            assert!(boundaries(wrong).is_malformed, "{wrong}");
        }
        let deep = "[".repeat(1_000_000) + &"]".repeat(1_000_000);
        assert!(boundaries(&deep).is_malformed);
        assert!(Boundaries::default().read_again(&mut Json::new(b"[[[1,2")).is_err());
    }

    fn per_polygon(boundary: &str, depth: usize, text: &str) -> (u64, Vec<Token>) {
        let b = boundaries(boundary);
        let mut out = vec![Token::Close; b.ends[depth - 1].len()];
        let wrong = values(text).for_each(&b.ends[..depth - 1], |i, tokens| out[i] = tokens[0]);
        (wrong, out)
    }

    #[test]
    fn values_run_parallel_to_polygons() {
        use Token::{Index, Null};
        let surfaces = "[[[0,1,2]],[[0,1,3]],[[1,2,3]]]";
        assert_eq!(per_polygon(surfaces, 2, "[0,null,1]"), (0, vec![Index(0), Null, Index(1)]));
        for nothing in ["null", "[null]", "[]", "[null,null,null,null]"] {
            assert_eq!(per_polygon(surfaces, 2, nothing), (0, vec![Null; 3]), "{nothing}");
        }
        let solid = "[[[[0,1,2]],[[0,1,3]]],[[[1,2,3]]]]";
        assert_eq!(per_polygon(solid, 3, "[[0,1],[2]]"), (0, vec![Index(0), Index(1), Index(2)]));
        assert_eq!(per_polygon(solid, 3, "[null,[2]]"), (0, vec![Null, Null, Index(2)]));
        assert_eq!(per_polygon(solid, 3, "[[null],[2]]"), (0, vec![Null, Null, Index(2)]));
        let multi = "[[[[[0,1,2]],[[0,1,3]]]],[[[[1,2,3]]]]]";
        assert_eq!(per_polygon(multi, 4, "[[[4,5]],null]"), (0, vec![Index(4), Index(5), Null]));
    }

    #[test]
    fn what_does_not_match_costs_its_own_place() {
        use Token::{Index, Null};
        let surfaces = "[[[0,1,2]],[[0,1,3]],[[1,2,3]]]";
        assert_eq!(per_polygon(surfaces, 2, "[0,1]"), (1, vec![Index(0), Index(1), Null]));
        assert_eq!(per_polygon(surfaces, 2, "[0,1,2,3]"), (1, vec![Index(0), Index(1), Index(2)]));
        assert_eq!(per_polygon(surfaces, 2, "5"), (1, vec![Null; 3]));
        assert_eq!(per_polygon(surfaces, 2, "[0,\"a\",2]"), (1, vec![Index(0), Null, Index(2)]));
        let solid = "[[[[0,1,2]],[[0,1,3]]],[[[1,2,3]]]]";
        // Of a Solid they are one array deeper.
        assert_eq!(per_polygon(solid, 3, "[0,1]"), (2, vec![Null; 3]));
        assert_eq!(per_polygon(solid, 3, "[[0],[2]]"), (1, vec![Index(0), Null, Index(2)]));
    }

    #[test]
    fn texture_values_come_ring_by_ring() {
        let b = boundaries("[[[0,1,2],[3,4,5]],[[0,1,3]]]");
        let mut rings = Vec::new();
        let wrong = values("[[[0,10,11,12],[null]],null]").for_each(&b.ends[..2], |i, t| rings.push((i, t.len())));
        assert_eq!((wrong, &rings[..]), (0, &[(0, 6), (1, 3), (2, 1)][..]));
        // A face of two rings without a texture may say so once.
        rings.clear();
        let wrong = values("[[[null]],[[0,1,2,3]]]").for_each(&b.ends[..2], |i, t| rings.push((i, t.len())));
        assert_eq!((wrong, &rings[..]), (0, &[(0, 3), (1, 1), (2, 6)][..]));
    }
}
