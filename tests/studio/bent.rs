//! A slow ray caster for lenses that bend rays: per pixel the path of Wang et al.'s own equations in f64, and all triangles of the objects whose boxes it meets.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use veduta::{
    lens::{
        Lens, LensBody, LensKind,
        kind::{FisheyeLens, Magnifier, SamplingLens},
        ray::{Bend, Fisheye, FisheyeProjection, Magnify, RayLens, RayOutline, Sampling, SamplingRate},
    },
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, Projection, View},
};

use crate::studio;

/// How far from an edge's image an object may be another one, pixels.
pub const BESIDE_PX: f64 = 1e-3;
/// How far depths may be outside of those that the rays around have, of themselves: what f32 rounds of places and slopes.
pub const DEPTH_OFF: f64 = 2e-6;

/// A lens of the reference, as the equations have it.
#[derive(Clone, Debug)]
pub struct Bent {
    center: DVec2,
    radius: f64,
    is_square: bool,
    what: What,
}

/// Steps of an integral.
const STEPS: usize = 100_000;

#[derive(Clone, Debug)]
enum What {
    /// Equation 1: a plane at `z_l`, its focal point at `f` behind it, a border, and the depth from which on rays go as the eye sees.
    Magnifier {
        z_l: f64,
        f: f64,
        border: f64,
        z_m: f64,
    },
    /// Equation 3: the integral up to each of many equally wide places.
    Sampling(Vec<f64>),
    Fisheye(f64, FisheyeProjection),
}

impl Bent {
    /// That of a lens whose distances are given.
    pub fn new(lens: &RayLens, view: &View) -> Self {
        let half = view.half_extent();
        let center = DVec2::new((2.0 * lens.center.x - 1.0) * half.x, (1.0 - 2.0 * lens.center.y) * half.y);
        let what = match &lens.bend {
            Bend::Magnify(Magnify { magnification: m, at, distance, border }) => {
                let (z_l, z_m) = (distance.expect("a distance"), at.expect("a depth"));
                // For a wanted magnification at a depth.
                let plain = if view.is_orthographic() { 1.0 } else { 1.0 + z_m / z_l };
                What::Magnifier { z_l, f: z_m / (1.0 - plain / m), border: border * lens.radius * 2.0 * half.y, z_m }
            }
            Bend::Sample(Sampling { rate }) => {
                let step = 1.0 / STEPS as f64;
                let grown = (0..STEPS).scan(0.0, |sum, i| {
                    *sum += step / rate.at((i as f64 + 0.5) * step);
                    Some(*sum)
                });
                What::Sampling(std::iter::once(0.0).chain(grown).collect())
            }
            Bend::Fisheye(Fisheye { angle, projection }) => What::Fisheye(*angle, *projection),
            Bend::Feature(_) => panic!("it has no rim"),
            Bend::Own(used) => panic!("{used:?} is one's own"),
        };
        Self { center, radius: lens.radius * 2.0 * half.y, is_square: lens.outline == RayOutline::Square, what }
    }

    fn radius_at(&self, from: DVec2) -> f64 {
        if self.is_square { from.abs().max_element() } else { from.length() }
    }
}

/// A piece of a ray: from where to where in its parameter, where it begins and goes, view space.
pub type Piece = ([f64; 2], DVec3, DVec3);

/// Where the ray of a place of the picture begins, and where it goes.
pub fn plain_ray(place: DVec2, is_parallel: bool) -> (DVec3, DVec3) {
    match is_parallel {
        true => (place.extend(0.0), DVec3::NEG_Z),
        false => (DVec3::ZERO, place.extend(-1.0)),
    }
}

/// A plane that bends rays (equation 1).
pub struct Plane {
    pub center: DVec2,
    pub z_l: f64,
    pub f: f64,
    pub z_m: f64,
}

impl Plane {
    /// That of a magnifier in the middle of the picture.
    pub fn of(lens: &RayLens, is_parallel: bool) -> Self {
        let magnify = lens.bend.magnify().expect("a magnifier");
        let (z_l, z_m) = (magnify.distance.expect("a distance"), magnify.at.expect("a depth"));
        let plain = if is_parallel { 1.0 } else { 1.0 + z_m / z_l };
        Self { center: DVec2::ZERO, z_l, f: z_m / (1.0 - plain / magnify.magnification), z_m }
    }

    /// The path of a place's ray, where the border has come to `k`.
    pub fn path(&self, place: DVec2, k: f64, is_parallel: bool) -> Vec<Piece> {
        let Self { center, z_l, f, z_m } = *self;
        let (origin, direction) = plain_ray(place, is_parallel);
        let on_plane = origin + z_l * direction;
        // The focal point, on the line of sight through the lens' middle; and where the ray would meet its plane.
        let (middle_origin, middle_direction) = plain_ray(center, is_parallel);
        let focus = middle_origin + (z_l + f) * middle_direction;
        let undisturbed = origin + (z_l + f) * direction;
        let target = focus + k * (undisturbed - focus);
        let slope = (target - on_plane) / f;
        let reached = on_plane + z_m * slope;
        let end = z_l + z_m;
        let on = if is_parallel { DVec3::NEG_Z } else { reached / end };
        vec![
            ([0.0, z_l], origin, direction),
            ([z_l, end], on_plane - z_l * slope, slope),
            ([end, f64::INFINITY], reached - end * on, on),
        ]
    }
}

/// The path of the ray of a place of the picture through one lens.
pub fn path(lens: &Bent, place: DVec2, is_parallel: bool) -> Vec<Piece> {
    let own = |place| plain_ray(place, is_parallel);
    let (origin, direction) = own(place);
    let from = place - lens.center;
    let r = lens.radius_at(from);
    if r >= lens.radius {
        return vec![([0.0, f64::INFINITY], origin, direction)];
    }
    match &lens.what {
        What::Magnifier { z_l, f, border, z_m } => {
            let k = if *border > 0.0 { ((r - (lens.radius - border)) / border).clamp(0.0, 1.0) } else { 0.0 };
            Plane { center: lens.center, z_l: *z_l, f: *f, z_m: *z_m }.path(place, k, is_parallel)
        }
        What::Sampling(integrals) => {
            let integral = |to: f64| {
                let at = to * STEPS as f64;
                let low = (at as usize).min(STEPS - 1);
                integrals[low] + (at - low as f64) * (integrals[low + 1] - integrals[low])
            };
            let share = r / lens.radius;
            let shown = if share > 0.0 { integral(share) / integral(1.0) / share } else { 0.0 };
            let (origin, direction) = own(lens.center + shown * from);
            vec![([0.0, f64::INFINITY], origin, direction)]
        }
        What::Fisheye(angle, projection) => {
            let share = from.length() / lens.radius;
            let turn = match projection {
                FisheyeProjection::Angular => share * angle / 2.0,
                FisheyeProjection::Hemispherical => (share * (angle / 2.0).sin()).asin(),
            };
            let forward = own(if is_parallel { DVec2::ZERO } else { lens.center }).1.normalize_or_zero();
            let right = forward.cross(DVec3::Y).normalize_or_zero();
            let up = right.cross(forward);
            let aside = if share > 0.0 { (from.x * right + from.y * up).normalize_or_zero() } else { DVec3::ZERO };
            vec![([0.0, f64::INFINITY], DVec3::ZERO, turn.cos() * forward + turn.sin() * aside)]
        }
    }
}

/// A triangle of the city, view space.
pub struct Face {
    pub corners: [DVec3; 3],
    pub object: u32,
}

/// Where a line meets a triangle (Möller & Trumbore, 1997).
fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(ac);
    let det = ab.dot(p);
    if det.abs() < 1e-300 {
        return None;
    }
    let from = origin - a;
    let u = from.dot(p) / det;
    let q = from.cross(ab);
    let v = direction.dot(q) / det;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| ac.dot(q) / det)
}

/// How far a place is from a triangle.
fn away_from(place: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let foot = place - normal * (place - a).dot(normal);
    let is_over = [(a, b), (b, c), (c, a)].into_iter().all(|(a, b)| (b - a).cross(foot - a).dot(normal) >= 0.0);
    if is_over && normal != DVec3::ZERO {
        return (place - a).dot(normal).abs();
    }
    let from_side = |(a, b): (DVec3, DVec3)| {
        let along = b - a;
        let share = ((place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        place.distance(a + share * along)
    };
    [(a, b), (b, c), (c, a)].map(from_side).into_iter().fold(f64::INFINITY, f64::min)
}

/// Whether a line may meet a box within a range: what is lost to rounding counts as met.
fn may_meet([low, high]: &[DVec3; 2], origin: DVec3, direction: DVec3, [begin, end]: [f64; 2]) -> bool {
    let room = 1e-9 * (low.abs().max(high.abs()).max_element() + origin.abs().max_element());
    let (mut from, mut to) = (begin, end);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        let (a, b) = (low[axis] - room - o, high[axis] + room - o);
        if d == 0.0 {
            if a > 0.0 || b < 0.0 {
                return false;
            }
            continue;
        }
        let (near, far) = if d > 0.0 { (a / d, b / d) } else { (b / d, a / d) };
        (from, to) = (from.max(near), to.min(far));
    }
    from <= to + 1e-9 * to.abs()
}

/// What a path meets first: its object and the parameter.
pub fn first(faces: &[Face], pieces: &[Piece], near: f64) -> Option<(u32, f64)> {
    for ([begin, end], origin, direction) in pieces {
        let met = faces.iter().filter_map(|face| {
            let t = meets(*origin, *direction, face.corners)?;
            (t >= begin.max(near) && t <= *end).then_some((face.object, t))
        });
        if let Some(found) = met.min_by(|a, b| a.1.total_cmp(&b.1)) {
            return Some(found);
        }
    }
    None
}

/// All that a path meets, the parameters in no order.
pub fn met(faces: &[Face], pieces: &[Piece], near: f64) -> Vec<f64> {
    let of_piece = |([begin, end], origin, direction): &Piece| {
        let met = faces.iter().filter_map(|face| meets(*origin, *direction, face.corners));
        met.filter(|t| *t >= begin.max(near) && t <= end).collect::<Vec<f64>>()
    };
    pieces.iter().flat_map(of_piece).collect()
}

pub fn lens(kind: impl Into<LensKind>) -> Lens {
    Lens { body: LensBody::None, ..Lens::plain("bent", kind, [0.5; 3]) }
}

pub fn magnifier(ray: RayLens) -> Lens {
    lens(Magnifier { ray })
}

pub fn magnify(magnification: f64, distance: f64, at: f64, border: f64) -> RayLens {
    let bend = Magnify { magnification, at: Some(at), distance: Some(distance), border };
    RayLens { bend: Bend::Magnify(bend), radius: 0.42, ..RayLens::magnifier() }
}

fn sampling(rate: SamplingRate) -> Lens {
    lens(SamplingLens { ray: RayLens { bend: Bend::Sample(Sampling { rate }), radius: 0.45, ..RayLens::sampling() } })
}

fn fisheye(angle_deg: f64, projection: FisheyeProjection) -> Lens {
    let bend = Bend::Fisheye(Fisheye { angle: angle_deg.to_radians(), projection });
    lens(FisheyeLens { ray: RayLens { bend, ..RayLens::fisheye() } })
}

/// Lenses of every kind.
pub fn all() -> Vec<Lens> {
    let square = RayLens { outline: RayOutline::Square, ..magnify(3.0, 120.0, 90.0, 0.3) };
    let aside = RayLens { center: DVec2::new(0.35, 0.6), radius: 0.3, ..magnify(5.0, 60.0, 140.0, 0.5) };
    let drawn = [[0.0, 3.0], [0.3, 3.0], [0.6, 1.0], [1.0, 1.5]].map(DVec2::from).to_vec();
    vec![
        magnifier(magnify(2.5, 100.0, 100.0, 0.4)),
        magnifier(aside),
        magnifier(square),
        magnifier(magnify(0.7, 100.0, 100.0, 0.8)),
        magnifier(magnify(2.0, 80.0, 160.0, 0.0)),
        sampling(SamplingRate::Cubic(3.0)),
        sampling(SamplingRate::Points(drawn)),
        fisheye(180.0, FisheyeProjection::Angular),
        fisheye(320.0, FisheyeProjection::Angular),
        fisheye(150.0, FisheyeProjection::Hemispherical),
    ]
}

pub fn cameras(studio: &Studio) -> Vec<Camera> {
    let middle = studio.extent().center();
    let slanting = Camera::looking(middle + DVec3::new(70.0, -150.0, 120.0), middle, 0.8);
    let level = Camera { projection: Projection::Orthographic { height_m: 160.0 }, ..slanting };
    let street = Camera::looking(middle + DVec3::new(9.0, -60.0, 4.0), middle + DVec3::new(-6.0, 20.0, 8.0), 1.0);
    vec![slanting, level, street]
}

/// A node of a hierarchy of boxes around faces.
struct Node {
    around: [DVec3; 2],
    /// Where its second child is; the first follows it. 0: it has faces.
    second: usize,
    faces: std::ops::Range<usize>,
}

/// Faces of a leaf.
const LEAF: usize = 6;

/// A hierarchy over faces, whose order it changes: in the middle of the longest side of the box around their middles.
fn hierarchy(faces: &mut [Face], first: usize, nodes: &mut Vec<Node>) {
    let corners = || faces.iter().flat_map(|face| face.corners);
    let around = corners().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| [low.min(p), high.max(p)]);
    let own = nodes.len();
    nodes.push(Node { around, second: 0, faces: first..first + faces.len() });
    if faces.len() <= LEAF {
        return;
    }
    let middle = |face: &Face| face.corners.iter().sum::<DVec3>() / 3.0;
    let ends = faces.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], face| {
        [low.min(middle(face)), high.max(middle(face))]
    });
    let wide = ends[1] - ends[0];
    let axis = (0..3).max_by(|a, b| wide[*a].total_cmp(&wide[*b])).unwrap_or(0);
    let half = faces.len() / 2;
    faces.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let (left, right) = faces.split_at_mut(half);
    hierarchy(left, first, nodes);
    nodes[own].second = nodes.len();
    hierarchy(right, first + half, nodes);
}

/// A city as a camera sees it, without lenses.
pub struct Sight {
    pub faces: Vec<Face>,
    /// Over them.
    nodes: Vec<Node>,
    pub half: DVec2,
    pub is_parallel: bool,
    size: [u32; 2],
    near: f64,
}

impl Sight {
    pub fn new(studio: &Studio, camera: Camera, size: [u32; 2]) -> Self {
        let view = View::new(camera, size, &studio.extent()).expect("a view");
        let to_view = view.basis.view_from_world();
        let face =
            |t: studio::Triangle| Face { corners: t.corners.map(|c| to_view * (c - camera.eye)), object: t.object };
        let mut faces: Vec<Face> = studio::triangles(studio).into_iter().map(face).collect();
        let mut nodes = Vec::new();
        hierarchy(&mut faces, 0, &mut nodes);
        let (half, is_parallel) = (view.half_extent(), view.is_orthographic());
        Self { faces, nodes, half, is_parallel, size, near: camera.near_m }
    }

    /// The middle of a pixel.
    pub fn pixel(&self, i: usize) -> DVec2 {
        let w = self.size[0] as usize;
        DVec2::new((i % w) as f64 + 0.5, (i / w) as f64 + 0.5)
    }

    /// Where that is in the picture's plane.
    pub fn place(&self, pixel: DVec2) -> DVec2 {
        let [w, h] = self.size.map(f64::from);
        DVec2::new(2.0 * pixel.x / w - 1.0, 1.0 - 2.0 * pixel.y / h) * self.half
    }

    pub fn straight(&self, place: DVec2) -> Vec<Piece> {
        let (origin, direction) = plain_ray(place, self.is_parallel);
        vec![([0.0, f64::INFINITY], origin, direction)]
    }

    /// What a path meets first: its object and the parameter. Faces in boxes that a piece misses are left out.
    pub fn first(&self, pieces: &[Piece]) -> Option<(u32, f64)> {
        for (range, origin, direction) in pieces {
            let (begin, mut end) = (range[0].max(self.near), range[1]);
            let mut found = None;
            let mut todo = vec![0];
            while let Some(number) = todo.pop() {
                let node = &self.nodes[number];
                if !may_meet(&node.around, *origin, *direction, [begin, end]) {
                    continue;
                }
                if node.second > 0 {
                    todo.extend([node.second, number + 1]);
                    continue;
                }
                for face in &self.faces[node.faces.clone()] {
                    let t = meets(*origin, *direction, face.corners).filter(|t| *t >= begin && *t <= end);
                    if let Some(t) = t.filter(|t| found.is_none_or(|(_, nearest)| *t < nearest)) {
                        found = Some((face.object, t));
                        end = t;
                    }
                }
            }
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// Whether a face of an object comes as near to where the path of a pixel is at a depth as paths of places beside it.
    fn is_beside(&self, object: u32, lens: &Bent, pixel: DVec2, depth: f64) -> bool {
        let at = |pixel: DVec2| {
            let pieces = path(lens, self.place(pixel), self.is_parallel);
            let piece = pieces.iter().find(|(range, ..)| depth <= range[1]).expect("they go on for ever");
            piece.1 + depth * piece.2
        };
        let place = at(pixel);
        let reach =
            [DVec2::X, DVec2::Y].map(|by| at(pixel + BESIDE_PX * by).distance(place)).into_iter().fold(0.0, f64::max);
        let own = self.faces.iter().filter(|face| face.object == object);
        own.into_iter().any(|face| away_from(place, face.corners) <= reach)
    }

    /// What an AOV of objects says of a path.
    pub fn id(&self, path: &[Piece]) -> u32 {
        self.first(path).map_or(0, |(object, _)| object + 1)
    }
}

pub fn draw(studio: &mut Studio, scene: &Scene, size: [u32; 2], backend: Backend) -> Picture {
    let aovs = Aovs { depth: true, object_id: true, ..Aovs::default() };
    studio.render(scene, &Request { aovs, backend, ..Request::plain(size) }).expect("a picture")
}

/// The same where the processor follows rays, and where the GPU does.
pub fn draw_both(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> [Picture; 2] {
    let usual = studio.renderer.settings.traces_rays;
    let pictures = [true, false].map(|traces_rays| {
        studio.renderer.settings.traces_rays = traces_rays;
        draw(studio, scene, size, Backend::Specialised)
    });
    studio.renderer.settings.traces_rays = usual;
    pictures
}

/// Pixels of a lens that were compared, and those that are wrong where the processor follows rays or where the GPU does, with the farthest that a
/// depth is off.
pub fn compare(studio: &mut Studio, camera: Camera, lens: &Lens, size: [u32; 2]) -> (usize, usize, f64) {
    let scene = studio::scene(camera, vec![lens.clone()]);
    let pictures = draw_both(studio, &scene, size);
    let view = View::new(camera, size, &studio.extent()).expect("a view");
    let sight = Sight::new(studio, camera, size);
    let reference = Bent::new(lens.ray().expect("a lens that bends rays"), &view);
    let shown = pictures.map(|picture| (picture.object_id.expect("ids"), picture.depth.expect("depths")));
    let met = |pixel: DVec2| sight.first(&path(&reference, sight.place(pixel), sight.is_parallel));
    // Whether what a pixel shows is right, where its path meets this, and how far its depth is off.
    let judge = |pixel: DVec2, own: Option<(u32, f64)>, id: u32, depth: f64| {
        // Most are the same in the middle of the pixel already.
        match own {
            Some((object, t)) if object + 1 == id => {
                let off = (t / depth - 1.0).abs();
                if off <= DEPTH_OFF {
                    return (true, off);
                }
            }
            None if id == 0 => return (true, 0.0),
            _ => {}
        }
        let beyond = |[nearest, farthest]: [f64; 2]| (nearest / depth - 1.0).max(1.0 - farthest / depth).max(0.0);
        let ends = |all: &mut dyn Iterator<Item = f64>| {
            all.fold([f64::INFINITY, 0.0], |[low, high], t| [low.min(t), high.max(t)])
        };
        // Slivers of faces may pass between a few places around: then there are many.
        for rings in [2, 24] {
            let around = (0..8 * rings * rings).map(|k| {
                let (turn, ring) = (k % (8 * rings), 1 + k / (8 * rings));
                let turn = (f64::from(turn) + 0.5 * f64::from(ring % 2)) / (8.0 * f64::from(rings));
                f64::from(ring) / f64::from(rings) * BESIDE_PX * DVec2::from_angle(std::f64::consts::TAU * turn)
            });
            let met: Vec<Option<(u32, f64)>> =
                std::iter::once(own).chain(around.map(|aside| met(pixel + aside))).collect();
            let Some(shown) = id.checked_sub(1) else {
                // The plain ground, or nothing.
                if met.iter().any(Option::is_none) {
                    return (true, 0.0);
                }
                continue;
            };
            let off = beyond(ends(&mut met.iter().flatten().filter(|(object, _)| *object == shown).map(|(_, t)| *t)));
            if off <= DEPTH_OFF {
                return (true, off);
            }
            // An edge that it shares with another object is seen there, however narrow its faces are.
            let off = beyond(ends(&mut met.iter().flatten().map(|(_, t)| *t)));
            if off <= DEPTH_OFF && sight.is_beside(shown, &reference, pixel, depth) {
                return (true, off);
            }
        }
        (false, f64::INFINITY)
    };
    let of_pixel = |i: usize| {
        let pixel = sight.pixel(i);
        let from = sight.place(pixel) - reference.center;
        if reference.radius_at(from) >= reference.radius {
            return None;
        }
        let own = met(pixel);
        let judged = shown.each_ref().map(|(ids, depths)| judge(pixel, own, ids[i], f64::from(depths[i])));
        judged.into_iter().reduce(|(a, off_a), (b, off_b)| (a && b, off_a.max(off_b)))
    };
    let found: Vec<(bool, f64)> = (0..shown[0].0.len()).into_par_iter().filter_map(of_pixel).collect();
    let wrong = found.iter().filter(|(is_right, _)| !is_right).count();
    (found.len(), wrong, found.iter().map(|(_, off)| *off).fold(0.0, f64::max))
}
