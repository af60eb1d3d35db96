//! Regions of lenses where they stand in a frame: volumes, membership by object, saved sprites, users' tests, and CSG trees of them.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use crate::{
    geom::{
        Aabb, Volume,
        combination::{self, Operation},
        common_part::TOUCH_M,
        shape::{OrientedBox, Rows, RowsEye, flat::ENDLESS_M},
    },
    lens::{OwnRegion, PlacedSprite},
    render::{layout, solids::SolidPlace},
    scene::volume::MOST_VOLUMES,
    shader::{Form, LensTest},
    view::View,
};

/// A region of a lens, placed: in the world, with where the GPU has what belongs to it.
#[derive(Clone, Debug)]
pub enum PlacedRegion {
    /// A leaf of a CSG tree alone.
    One(PlacedLeaf),
    /// A CSG tree in postfix order: its leaves, each with the operations after it.
    Combined(Vec<(PlacedLeaf, Vec<Operation>)>),
}

/// What decides by itself what is inside.
#[derive(Clone, Debug)]
pub enum Leaf {
    /// A volume, model coordinates.
    Volume(Volume),
    /// Membership by object.
    Members(Members),
    /// A saved depth sprite.
    Sprite(PlacedSprite),
    /// A user's region test.
    Own(OwnRegion),
}

/// City objects, with all that belongs to them wherever it is.
#[derive(Clone, Debug)]
pub struct Members {
    /// One per object of the city: whether it is one, be it in part.
    pub objects: Arc<[bool]>,
    /// Where some come or go, from which threshold of a pixel on and below which each object is in, 0 to 1; `None`: members are
    /// wholly in.
    pub thresholds: Option<Arc<[[f32; 2]]>>,
    /// Of each field that stands in the city, whether it is one.
    pub fields: [bool; MOST_VOLUMES],
    /// Box around what is shown of them, metres.
    pub bounds: Aabb,
}

/// A leaf, and where the GPU has what belongs to it.
#[derive(Clone, Debug)]
pub struct PlacedLeaf {
    /// The leaf.
    pub leaf: Leaf,
    /// Of a solid, where its faces stand; of members, `first` is where their marks begin among the objects' values.
    pub place: SolidPlace,
}

impl Members {
    /// Whether an object is one of them; those of other data sets are not.
    pub fn has(&self, object: u32) -> bool {
        self.objects.get(object as usize).is_some_and(|is_member| *is_member)
    }
}

impl From<Leaf> for PlacedLeaf {
    fn from(leaf: Leaf) -> Self {
        Self { leaf, place: SolidPlace::default() }
    }
}

/// Leaves of a combination, at most.
pub const MOST_LEAVES: usize = 64;
/// What a combination keeps in mind at once, at most: bits of a word.
const MOST_DEPTH: usize = 32;
/// Operations after one leaf, at most: two bits each of what an f32 holds exactly.
const MOST_OPERATIONS: usize = 12;
/// What counts as deep.
const NESTED: &str = "combinations within combinations of which none is the first in its list";

/// Of what a combination has too much, how much, and how much it may have.
pub fn too_large(program: &[(PlacedLeaf, Vec<Operation>)]) -> Option<(&'static str, usize, usize)> {
    let operations = program.iter().map(|(_, then)| then.len()).max().unwrap_or(0);
    let limits = [
        ("shapes (a corridor counts as one for each of its points and ways between them)", program.len(), MOST_LEAVES),
        (NESTED, combination::depth(program), MOST_DEPTH),
        (NESTED, operations, MOST_OPERATIONS),
    ];
    limits.into_iter().find(|(_, count, most)| count > most)
}

/// Triangles are told from combinations down to parts of this size, metres.
const FINEST_M: f64 = 1e-3;

/// Parts that a triangle is cut into at most. Those of which it is open then are nearer to the border than they are wide.
const MOST_PARTS: usize = 1 << 16;

/// The distance, or the side, of a combination of two.
fn join(operation: Operation, a: f64, b: f64) -> f64 {
    match operation {
        Operation::Union => a.min(b),
        Operation::Intersection => a.max(b),
        Operation::Difference => a.max(-b),
    }
}

impl PlacedLeaf {
    /// How far a place of an object is from it, metres, never overrated; below 0 inside.
    fn distance(&self, place: DVec3, object: u32) -> f64 {
        match &self.leaf {
            Leaf::Volume(volume) => volume.signed_distance(place),
            Leaf::Own(own) => own.distance(place),
            Leaf::Members(members) if members.has(object) => f64::NEG_INFINITY,
            // Saved depth sprites are no parts of combinations.
            Leaf::Members(_) | Leaf::Sprite(_) => f64::INFINITY,
        }
    }

    /// 1: a triangle with its corners within `radius` of its middle, which is `distance` away, is out of it; -1: it is in it; 0: neither is
    /// known.
    fn side_of(&self, corners: &[DVec3; 3], distance: f64, radius: f64) -> f64 {
        match &self.leaf {
            _ if distance > radius => 1.0,
            _ if distance < -radius => -1.0,
            Leaf::Volume(volume) if !volume.meets_triangle(corners) => 1.0,
            Leaf::Volume(volume) if volume.is_convex() && corners.iter().all(|p| volume.contains(*p)) => -1.0,
            _ => 0.0,
        }
    }
}

impl PlacedRegion {
    /// Its leaves.
    pub fn leaves(&self) -> impl Iterator<Item = &PlacedLeaf> {
        let (one, many) = match self {
            Self::One(leaf) => (Some(leaf), &[][..]),
            Self::Combined(program) => (None, &program[..]),
        };
        one.into_iter().chain(many.iter().map(|(leaf, _)| leaf))
    }

    /// Its leaves.
    pub fn leaves_mut(&mut self) -> impl Iterator<Item = &mut PlacedLeaf> {
        let (one, many) = match self {
            Self::One(leaf) => (Some(leaf), &mut [][..]),
            Self::Combined(program) => (None, &mut program[..]),
        };
        one.into_iter().chain(many.iter_mut().map(|(leaf, _)| leaf))
    }

    /// The volume that it is, if it is one.
    pub fn volume(&self) -> Option<&Volume> {
        match self {
            Self::One(PlacedLeaf { leaf: Leaf::Volume(volume), .. }) => Some(volume),
            _ => None,
        }
    }

    /// The saved depth sprite that it is, if it is one.
    pub fn saved(&self) -> Option<&PlacedSprite> {
        match self {
            Self::One(PlacedLeaf { leaf: Leaf::Sprite(sprite), .. }) => Some(sprite),
            _ => None,
        }
    }

    /// Its form; `None` of a saved depth sprite.
    pub fn form(&self) -> Option<Form> {
        match self {
            Self::One(leaf) => leaf.leaf.form(),
            Self::Combined(_) => Some(Form::Combined),
        }
    }

    /// How it is tested from its own numbers.
    pub fn test(&self) -> LensTest {
        self.form().map_or(LensTest::OwnSprite, LensTest::Numbers)
    }

    /// Forms of its leaves, if it is a combination; ascending, each once.
    pub fn forms_in_combination(&self) -> Vec<Form> {
        if matches!(self, Self::One(_)) { Vec::new() } else { self.leaf_forms() }
    }

    /// Forms of its leaves, ascending, each once.
    pub fn leaf_forms(&self) -> Vec<Form> {
        let mut forms: Vec<Form> = self.leaves().filter_map(|leaf| leaf.leaf.form()).collect();
        forms.sort_unstable();
        forms.dedup();
        forms
    }

    /// Whether some leaf is a solid.
    pub fn has_solids(&self) -> bool {
        self.leaves().any(PlacedLeaf::is_solid)
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::One(leaf) => leaf.leaf.is_empty(),
            Self::Combined(_) => self.bounds().is_empty(),
        }
    }

    /// Box around it, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::One(leaf) => leaf.leaf.bounds(),
            Self::Combined(program) => {
                let join = |operation, a: Aabb, b: Aabb| match operation {
                    Operation::Union => a.union(b),
                    Operation::Intersection => Aabb { min: a.min.max(b.min), max: a.max.min(b.max) },
                    Operation::Difference => a,
                };
                combination::fold(program, |leaf| leaf.leaf.bounds(), join).unwrap_or(Aabb::EMPTY)
            }
        }
    }

    /// Whether it has an end on all sides.
    pub fn is_bounded(&self) -> bool {
        self.bounds().size().max_element() < ENDLESS_M
    }

    /// Whether what is in it is asked of objects, be it in part: of places alone it cannot be told.
    pub fn has_members(&self) -> bool {
        self.leaves().any(|leaf| matches!(leaf.leaf, Leaf::Members(_)))
    }

    /// Whether its ends along a ray have a closed form.
    pub fn is_form(&self) -> bool {
        matches!(self, Self::One(leaf) if leaf.leaf.form().is_some_and(|form| form.closed().is_some()))
    }

    /// Intervals that a ray may be in it, at most, if its leaves say so: solids may be gone through any number of times.
    pub fn most_intervals(&self) -> Option<usize> {
        (!self.has_solids()).then(|| self.leaves().count())
    }

    /// The union of bodies as one combination; `None` where that is none or too large for one.
    pub fn union(bodies: &[Self]) -> Option<Self> {
        let mut all: Vec<(PlacedLeaf, Vec<Operation>)> = Vec::new();
        if bodies.iter().any(|region| region.saved().is_some()) {
            return None;
        }
        for (i, region) in bodies.iter().filter(|region| !region.is_empty()).enumerate() {
            match region {
                Self::One(leaf) => all.push((leaf.clone(), Vec::new())),
                Self::Combined(program) => all.extend(program.iter().cloned()),
            }
            if let (1.., Some((_, then))) = (i, all.last_mut()) {
                then.push(Operation::Union);
            }
        }
        let is_one = all.len() > 1 && !bodies.iter().any(Self::has_members) && too_large(&all).is_none();
        is_one.then_some(Self::Combined(all))
    }

    /// Whether it is a convex volume.
    pub fn is_convex(&self) -> bool {
        self.volume().is_some_and(Volume::is_convex)
    }

    /// Whether anything is in front of it or behind it: not of choices of objects alone.
    pub fn has_sides(&self) -> bool {
        self.leaves().any(|leaf| !matches!(leaf.leaf, Leaf::Members(_)))
    }

    /// Whether a perspective view's rays start inside of it; a choice of objects counts as the box around them.
    pub fn holds_eye(&self, view: &View) -> bool {
        let holds = |leaf: &PlacedLeaf| match &leaf.leaf {
            Leaf::Volume(volume) => volume.contains(view.camera.eye),
            Leaf::Own(own) => own.distance(view.camera.eye) <= 0.0,
            Leaf::Members(members) => {
                let eye = view.camera.eye;
                eye.cmpge(members.bounds.min).all() && eye.cmple(members.bounds.max).all()
            }
            // What it is tested by knows nothing of the picture's eye.
            Leaf::Sprite(_) => false,
        };
        !view.is_orthographic()
            && match self {
                Self::One(leaf) => matches!(leaf.leaf, Leaf::Volume(_) | Leaf::Own(_)) && holds(leaf),
                Self::Combined(program) => combination::holds(program, holds),
            }
    }

    /// Whether a closed triangle of an object and the region share a point; of combinations to [`FINEST_M`].
    pub fn meets(&self, corners: &[DVec3; 3], object: u32) -> bool {
        match self {
            Self::One(PlacedLeaf { leaf: Leaf::Volume(volume), .. }) => volume.meets_triangle(corners),
            Self::One(PlacedLeaf { leaf: Leaf::Members(members), .. }) => members.has(object),
            Self::One(PlacedLeaf { leaf: Leaf::Sprite(sprite), .. }) => sprite.meets_triangle(corners),
            Self::One(leaf) => self.meets_part(&[(leaf.clone(), Vec::new())], corners, object),
            Self::Combined(program) => self.meets_part(program, corners, object),
        }
    }

    /// By the distance of a triangle's middle from the border, which a combination of distances never overrates: what is further
    /// away than the corners is decided. So is what lies wholly in or out of each body that it depends on; a face along a border, be it a
    /// millimetre beside it, would be cut up without end otherwise. The rest is cut in two.
    fn meets_part(&self, program: &[(PlacedLeaf, Vec<Operation>)], corners: &[DVec3; 3], object: u32) -> bool {
        let mut parts = vec![*corners];
        let mut count = 0;
        while let Some(part @ [a, b, c]) = parts.pop() {
            let middle = (a + b + c) / 3.0;
            let radius = part.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
            let distance = |leaf: &PlacedLeaf| leaf.distance(middle, object);
            let distance = combination::fold(program, distance, join).unwrap_or(f64::INFINITY);
            if distance <= TOUCH_M {
                return true;
            }
            count += 1;
            if distance > radius || radius < FINEST_M || count > MOST_PARTS {
                continue;
            }
            let side = |leaf: &PlacedLeaf| leaf.side_of(&part, leaf.distance(middle, object), radius);
            match combination::fold(program, side, join) {
                Some(side) if side < 0.0 => return true,
                Some(side) if side > 0.0 => continue,
                _ => {}
            }
            // Across the longest edge.
            let edges = [(a, b, c), (b, c, a), (c, a, b)];
            let longest = edges.into_iter().max_by(|x, y| x.0.distance(x.1).total_cmp(&y.0.distance(y.1)));
            let (p, q, r) = longest.unwrap_or((a, b, c));
            let half = p.midpoint(q);
            parts.extend([[p, half, r], [half, q, r]]);
        }
        false
    }

    /// The region that it is for an eye; planes and leaves are appended to `planes`.
    pub fn rows(&self, view: &View, planes: &mut Vec<[f32; 4]>) -> layout::Region {
        match self {
            Self::One(leaf) => leaf.rows(view, planes),
            Self::Combined(_) => self.combined_rows(view, planes),
        }
    }

    /// The same as a combination, if only of one leaf; leaves are appended to `planes`.
    pub fn combined_rows(&self, view: &View, planes: &mut Vec<[f32; 4]>) -> layout::Region {
        let alone;
        let program = match self {
            Self::One(leaf) => {
                alone = [(leaf.clone(), Vec::new())];
                &alone[..]
            }
            Self::Combined(program) => program,
        };
        let leaf = |(leaf, then): &(PlacedLeaf, Vec<Operation>)| match &leaf.leaf {
            // The box around them stands for them where it matters what a ray goes through.
            Leaf::Members(members) => {
                let size = members.bounds.size();
                let around =
                    Volume::Box(OrientedBox { center: members.bounds.center(), size, rotation: glam::DQuat::IDENTITY });
                let region = PlacedLeaf::from(Leaf::Volume(around)).rows(view, &mut Vec::new());
                let test = leaf.test_number();
                (layout::Region { test, ..region }, leaf.place.first as f32, then.clone())
            }
            Leaf::Volume(_) | Leaf::Sprite(_) | Leaf::Own(_) => (leaf.rows(view, planes), 0.0, then.clone()),
        };
        let leaves: Vec<_> = program.iter().map(leaf).collect();
        let out = layout::Region {
            test: LensTest::Numbers(Form::Combined).number(),
            b: [planes.len() as f32, leaves.len() as f32, f32::from(u8::from(self.holds_eye(view))), 0.0],
            ..Default::default()
        };
        for (s, first, then) in leaves {
            // Two bits for each, the first in the lowest.
            let operations = then.iter().rev().fold(0, |all, operation| all << 2 | *operation as u32);
            planes.extend([
                [s.a[0], s.a[1], s.a[2], 0.0],
                s.b,
                s.c,
                s.d,
                [s.test as f32, operations as f32, first, 0.0],
            ]);
        }
        out
    }
}

impl Leaf {
    /// Its form; `None` of a saved depth sprite.
    pub fn form(&self) -> Option<Form> {
        match self {
            Self::Members(Members { thresholds: None, .. }) => Some(Form::Members),
            Self::Members(_) => Some(Form::FadingMembers),
            Self::Sprite(_) => None,
            Self::Volume(volume) => Some(Form::Volume(volume.form())),
            Self::Own(own) => Some(Form::Own(own.handler)),
        }
    }

    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Volume(volume) => volume.is_empty(),
            Self::Members(members) => members.bounds.is_empty(),
            Self::Sprite(sprite) => sprite.bounds.is_empty(),
            Self::Own(own) => own.is_empty(),
        }
    }

    /// Box around it, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Volume(volume) => volume.bounds(),
            Self::Members(members) => members.bounds,
            Self::Sprite(sprite) => sprite.bounds,
            Self::Own(own) => own.bounds(),
        }
    }
}

impl PlacedLeaf {
    /// Whether it is a solid.
    pub fn is_solid(&self) -> bool {
        self.leaf.form().is_some_and(Form::is_solid)
    }

    /// The number of its test in WGSL.
    fn test_number(&self) -> u32 {
        self.leaf.form().map_or(LensTest::OwnSprite, LensTest::Numbers).number()
    }

    /// The region that it is for an eye; its planes are appended to `planes`.
    pub fn rows(&self, view: &View, planes: &mut Vec<[f32; 4]>) -> layout::Region {
        let test = self.test_number();
        let rows = match &self.leaf {
            Leaf::Members(_) => Rows { b: [self.place.first as f32, 0.0, 0.0, 0.0], ..Rows::default() },
            // Its rows stand elsewhere (`render::own_sprites`).
            Leaf::Sprite(_) => Rows::default(),
            Leaf::Own(own) => return own_rows(own, view, planes, self.test_number()),
            Leaf::Volume(volume) => {
                let eye = RowsEye {
                    eye: view.camera.eye,
                    view_from_world: view.basis.view_from_world(),
                    is_orthographic: view.is_orthographic(),
                    near_m: view.camera.near_m,
                    stored: self.place.first,
                };
                volume.rows(&eye, planes)
            }
        };
        layout::Region { a: rows.a, test, b: rows.b, c: rows.c, d: rows.d }
    }
}

/// The numbers of a user's region for an eye; its half edges and its parameters are appended to `planes`.
fn own_rows(own: &OwnRegion, view: &View, planes: &mut Vec<[f32; 4]>, test: u32) -> layout::Region {
    let view_from_world = view.basis.view_from_world();
    let axes = view_from_world * DMat3::from_quat(own.rotation);
    let row = |axis: DVec3, w: f64| axis.as_vec3().extend(w as f32).to_array();
    let first = planes.len() as f64;
    planes.push(own.half.as_vec3().extend(0.0).to_array());
    let four = |four: &[f32]| std::array::from_fn(|i| four.get(i).copied().unwrap_or(0.0));
    planes.extend(own.parameters.chunks(4).map(four));
    layout::Region {
        a: (view_from_world * (own.center - view.camera.eye)).as_vec3().to_array(),
        test,
        b: row(axes.x_axis, first),
        c: row(axes.y_axis, 0.0),
        d: row(axes.z_axis, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Shape;

    fn leaf(shape: &Shape) -> PlacedLeaf {
        let volume = shape.volumes().expect("a shape").remove(0);
        PlacedLeaf { leaf: Leaf::Volume(volume), place: SolidPlace::default() }
    }

    /// A cylinder of 15 m around (0, 0), from 0 to 10 m, but for a box of 10 m from (0, -5, 2) to (10, 5, 12).
    fn cut_cylinder() -> PlacedRegion {
        let cylinder =
            Shape::Cylinder { center: DVec3::new(0.0, 0.0, 5.0), radius: 15.0, height: 10.0, axis: DVec3::Z };
        let cuboid =
            Shape::Box { center: DVec3::new(5.0, 0.0, 7.0), size: DVec3::splat(10.0), rotation: glam::DQuat::IDENTITY };
        PlacedRegion::Combined(vec![(leaf(&cylinder), vec![]), (leaf(&cuboid), vec![Operation::Difference])])
    }

    /// A face along a border would be ten thousand million parts of a millimetre.
    #[test]
    fn faces_along_a_border_are_decided_at_once() {
        let region = cut_cylinder();
        let level = |z: f64, half: f64| {
            [[-half, -half], [3.0 * half, -half], [-half, 3.0 * half]].map(|[x, y]| DVec3::new(x, y, z))
        };
        let upright = |x: f64| [[-4.0, 3.0], [4.0, 3.0], [0.0, 9.0]].map(|[y, z]| DVec3::new(x, y, z));
        for (what, triangle, meets) in [
            ("ground at the foot", level(0.0, 200.0), true),
            ("ground a tenth of a millimetre below it", level(-1e-4, 200.0), false),
            ("ground two millimetres below it", level(-2e-3, 200.0), false),
            ("a roof a tenth of a millimetre above it", level(10.0001, 200.0), false),
            ("a wall on the face of the box", upright(0.0), true),
            ("a wall a tenth of a millimetre inside the box", upright(1e-4), false),
            ("a wall a tenth of a millimetre outside the box", upright(-1e-4), true),
        ] {
            assert_eq!(region.meets(&triangle, 0), meets, "{what}");
        }
    }

    /// Against places of triangles, many of each.
    #[test]
    fn triangles_meet_what_one_of_their_places_is_in() {
        let region = cut_cylinder();
        let PlacedRegion::Combined(program) = &region else { unreachable!("a combination") };
        let distance = |p: DVec3| combination::fold(program, |leaf| leaf.distance(p, 0), join).expect("leaves");
        let mut state = 9_u64;
        let mut number = |low: f64, high: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut met, steps) = (0, 60);
        for _ in 0..400 {
            let middle = DVec3::new(number(-18.0, 18.0), number(-18.0, 18.0), number(-3.0, 13.0));
            let size = number(0.5, 12.0);
            let corners =
                [0; 3].map(|_| middle + size * DVec3::new(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0)));
            let [a, b, c] = corners;
            let places =
                (0..=steps).flat_map(|i| (0..=steps - i).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(steps))));
            let nearest = places.map(|[u, v]| distance(a + u * (b - a) + v * (c - a))).fold(f64::INFINITY, f64::min);
            let meets = region.meets(&corners, 0);
            met += usize::from(meets);
            // No place of it is further from one of these than a step.
            let step = size * 4.0 / f64::from(steps);
            assert!(if meets { nearest <= step } else { nearest > 0.0 }, "{corners:?}: {nearest}");
        }
        assert!((100..300).contains(&met), "{met} of 400");
    }
}
