//! The faces of a solid by where they are: what asks for the nearest of a place, or for those that a line meets, looks at few of them.

use glam::DVec3;

use crate::geom::{aabb::Aabb, shape::solid::Solid};

/// Faces of a leaf, at most: their number takes three bits.
const MOST_OF_LEAF: usize = 2;

/// A box that holds faces.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    bounds: Aabb,
    /// The node that follows when all in this one is done with.
    next: u32,
    /// The first of its faces in their order, and how many there are: of an inner one, whose first child follows it, none.
    faces: [u32; 2],
}

/// Boxes around boxes around faces. Halved again and again where most of the middles lie apart: no branch is much longer than another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// The numbers of the faces, those of each leaf one after the other.
    order: Vec<u32>,
}

impl Tree {
    pub fn new(faces: &[[DVec3; 3]]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..faces.len() as u32).collect() };
        tree.add(faces, [0, faces.len()]);
        tree
    }

    /// Adds the node of the faces from..to of the order, and those under it.
    fn add(&mut self, faces: &[[DVec3; 3]], [from, to]: [usize; 2]) {
        let corners = |i: &u32| faces[*i as usize];
        let own = &mut self.order[from..to];
        let bounds = Aabb::from_points(own.iter().flat_map(corners));
        let at = self.nodes.len();
        let is_leaf = own.len() <= MOST_OF_LEAF;
        let listed = if is_leaf { [from as u32, own.len() as u32] } else { [0; 2] };
        self.nodes.push(Node { bounds, next: 0, faces: listed });
        if !is_leaf {
            let sum = |i: &u32| corners(i).iter().sum::<DVec3>();
            let size = Aabb::from_points(own.iter().map(sum)).size();
            let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(2);
            let half = own.len() / 2;
            own.select_nth_unstable_by(half, |a, b| sum(a)[axis].total_cmp(&sum(b)[axis]).then(a.cmp(b)));
            self.add(faces, [from, from + half]);
            self.add(faces, [from + half, to]);
        }
        self.nodes[at].next = self.nodes.len() as u32;
    }

    /// Where each face stands in the order.
    pub fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.order.len()];
        for (place, face) in (0..).zip(&self.order) {
            places[*face as usize] = place;
        }
        places
    }

    /// The nodes as `shape/solid.wgsl` reads them, two entries each.
    pub fn node_words(&self) -> Vec<[u32; 4]> {
        let bits = |p: DVec3, w: u32| [(p.x as f32).to_bits(), (p.y as f32).to_bits(), (p.z as f32).to_bits(), w];
        let words = |node: &Node| {
            let [first, count] = node.faces;
            [bits(node.bounds.min, node.next), bits(node.bounds.max, first << 3 | count)]
        };
        self.nodes.iter().flat_map(words).collect()
    }

    /// The faces in their order as `shape/solid.wgsl` reads them, four entries each.
    pub fn face_words(&self, solid: &Solid) -> Vec<[u32; 4]> {
        let bits = |v: f64| (v as f32).to_bits();
        let mut words = Vec::with_capacity(4 * self.order.len());
        for &face in &self.order {
            let corners = &solid.faces()[face as usize];
            // By x, so that every edge runs to the right; `turn` says whether that is their order.
            let mut order = [0, 1, 2];
            order.sort_by(|a, b| corners[*a].x.total_cmp(&corners[*b].x));
            let is_even = matches!(order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
            let [a, b, c] = order.map(|i| corners[i]);
            let (normal, rise) = upward(&[a, b, c]);
            let turn: i32 = if is_even { 1 } else { -1 };
            words.push([bits(a.x), bits(a.y), bits(a.z), turn.cast_unsigned()]);
            words.push([bits(b.x), bits(b.y), bits(b.z), u32::from(is_border(solid, corners))]);
            words.push([bits(c.x), bits(c.y), bits(c.z), 0]);
            words.push([bits(normal.x), bits(normal.y), bits(normal.z), bits(rise)]);
        }
        words
    }
}

/// The normal of a face that looks up, its length 1; for an upright one straight up, and how much higher than its first corner
/// the level is at which it counts as above.
pub(super) fn upward(corners: &[DVec3; 3]) -> (DVec3, f64) {
    let [a, b, c] = *corners;
    match (b - a).cross(c - a).try_normalize() {
        Some(n) if n.z.abs() > 1e-12 => (if n.z < 0.0 { -n } else { n }, 0.0),
        _ => (DVec3::Z, (a.z + b.z + c.z) / 3.0 - a.z),
    }
}

/// Whether one side of a face is outside: not where bodies touch or overlap. Asked beside its middle alone.
fn is_border(solid: &Solid, face: &[DVec3; 3]) -> bool {
    let [a, b, c] = *face;
    let beside = 1e-3_f64.max(1e-6 * solid.bounds().size().max_element());
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return true };
    let middle = (a + b + c) / 3.0;
    [beside, -beside].iter().any(|d| solid.winding(middle + d * normal) == 0)
}
