//! Hard case 24: lenses of every two and three kinds in one place. Depths, ids and masks are held to a slow renderer without a GPU: per
//! pixel, rays in f64 through the triangles where they are shown, nearest first, and for each the rule of every lens in order.
//!
//! What it shares with the program is the reader of scenes, the made city, derived contents and the operators of deformations (the f64
//! reference of the GPU's, which has tests of its own).

use std::fmt::Write as _;

use glam::{DMat3, DQuat, DVec2, DVec3};
use rayon::prelude::*;
use veduta::{
    city::derived::derive,
    figure::scene_file::{Options, parse},
    geom::{Aabb, deform::Deformers},
    lens::{Class, Lens},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    shader::Clip,
    view::View,
};

use crate::case_27_bent_rays::{Bent, Piece, path};
use crate::studio::{self, ALL, bits, faces, is_thorough, of_scene, random_scene::Random};

/// Of pictures in an ordinary run; a thorough one asks each program for more.
const SIZE: [u32; 2] = [80, 50];
const THOROUGH_SIZE: [u32; 2] = [240, 150];
/// Of the pixels of lens masks that a thorough run asks for (`VEDUTA_HARD_PIXELS`), a tenth are held to the reference, over all scenes.
const SHARE: u64 = 10;
/// Scenes of an ordinary run beside all pairs of kinds: triples.
const TRIPLES: u64 = 3;
/// How far the sight lines beside that of a pixel are, pixels: what rounding may move; where the city is deformed, how far that may be off
/// and twice as far between its edges.
const BESIDE_PX: f64 = 0.02;
const BESIDE_DEFORMED_PX: f64 = 0.8;
/// Sight lines beside each other that meet what is deformed farther apart than so many times what that may be off.
const CLIFF: f64 = 8.0;
/// What lies nearer than this to where a class changes is not decided by the picture, of the distance.
const BAND: f64 = 4e-6;

/// A ball or a box, with tests of its own.
#[derive(Clone, Copy, Debug)]
enum Body {
    Ball { center: DVec3, radius: f64 },
    Block { center: DVec3, half: DVec3, axes: DMat3 },
}

impl Body {
    /// Where a ray is inside, of its parameter.
    fn interval(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        match self {
            Self::Ball { center, radius } => {
                let to = origin - *center;
                let (a, b, c) = (direction.length_squared(), to.dot(direction), to.length_squared() - radius * radius);
                let discriminant = b * b - a * c;
                (discriminant > 0.0).then(|| {
                    let root = discriminant.sqrt();
                    ((-b - root) / a, (-b + root) / a)
                })
            }
            Self::Block { center, half, axes } => {
                let (from, way) = (axes.transpose() * (origin - *center), axes.transpose() * direction);
                let mut interval = (f64::NEG_INFINITY, f64::INFINITY);
                for k in 0..3 {
                    let ends = [(-half[k] - from[k]) / way[k], (half[k] - from[k]) / way[k]];
                    interval = (interval.0.max(ends[0].min(ends[1])), interval.1.min(ends[0].max(ends[1])));
                }
                (interval.0 < interval.1).then_some(interval)
            }
        }
        .filter(|(_, exit)| *exit > 0.0)
    }

    /// How far a place is outside, at least; negative inside.
    fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Ball { center, radius } => p.distance(*center) - radius,
            Self::Block { center, half, axes } => ((axes.transpose() * (p - *center)).abs() - *half).max_element(),
        }
    }

    fn size(&self) -> f64 {
        match self {
            Self::Ball { radius, .. } => 2.0 * radius,
            Self::Block { half, .. } => 2.0 * half.max_element(),
        }
    }
}

/// What a lens does, as the reference knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    /// Nothing about what is there.
    Looks,
    /// Hides what is of this class of it; terrain stays.
    Hides(Class),
    /// Shows the n-th content in this class of it.
    Shows { class: Class, clip: Clip, world: usize, keeps_terrain: bool },
    /// Moves the city.
    Moves,
}

/// A lens of the reference; without a body, of the objects of a type.
struct Slow {
    act: Act,
    body: Option<Body>,
    at_rest: bool,
    members: Vec<bool>,
}

/// A triangle that is shown.
struct Face {
    shown: [DVec3; 3],
    /// Where it is before deformations.
    rest: [DVec3; 3],
    object: u32,
    world: usize,
    is_terrain: bool,
}

/// Where a sight line meets it.
#[derive(Clone, Copy)]
struct Hit {
    t: f64,
    rest: DVec3,
    face: usize,
    /// The line of sight that it lies on.
    ray: (DVec3, DVec3),
}

/// A lens of a scene, as text and as the reference has it.
struct Made {
    text: String,
    slow: Slow,
    content: Option<String>,
}

/// The kinds of lenses that are combined.
const KINDS: usize = 9;

fn size() -> [u32; 2] {
    if is_thorough() { THOROUGH_SIZE } else { SIZE }
}

fn class_word(class: Class) -> &'static str {
    match class {
        Class::Inside => "inside",
        Class::Front => "front",
        Class::Behind => "behind",
        Class::Rest => "rest",
    }
}

/// A lens of a kind, somewhere near the middle of the town.
fn lens(kind: usize, number: usize, view: &View, dice: &mut Random, has_moves: bool) -> Made {
    let center = DVec3::new(dice.number(-25.0, 25.0), dice.number(-25.0, 25.0), dice.number(0.0, 10.0));
    let is_ball = dice.once_in(2);
    let (radius, half) =
        (dice.number(14.0, 40.0), DVec3::new(dice.number(6.0, 25.0), dice.number(6.0, 25.0), dice.number(6.0, 25.0)));
    let yaw = f64::from(dice.below(90) as u32);
    let class = *dice.pick(&[Class::Inside, Class::Inside, Class::Front, Class::Behind, Class::Rest]);
    let shape_at = |center: DVec3, yaw: f64| match is_ball {
        true => {
            format!("{{ kind = \"sphere\", center = [{}, {}, {}], radius = {radius} }}", center.x, center.y, center.z)
        }
        false => format!(
            "{{ kind = \"box\", center = [{}, {}, {}], size = [{}, {}, {}], rotation_deg = [{yaw}, 0, 0] }}",
            center.x,
            center.y,
            center.z,
            2.0 * half.x,
            2.0 * half.y,
            2.0 * half.z
        ),
    };
    let body_at = |center: DVec3, axes: DMat3| match is_ball {
        true => Body::Ball { center, radius },
        false => Body::Block { center, half, axes },
    };
    let turned = DMat3::from_rotation_z(yaw.to_radians());
    let mut text = format!("[[lens]]\nname = \"l{number}\"\nbody = \"none\"\n");
    let mut slow = Slow { act: Act::Looks, body: Some(body_at(center, turned)), at_rest: false, members: Vec::new() };
    let mut content = None;
    let word = class_word(class);
    // Fixed to the camera: its axes are right, up and back.
    let is_of_camera = kind < 4 && dice.once_in(4);
    let mut shape = shape_at(center, yaw);
    if is_of_camera {
        let basis = view.basis;
        let axes = DMat3::from_cols(basis.right, basis.up, -basis.forward);
        let own = axes.transpose() * (center - view.camera.eye);
        let own = DVec3::new((own.x * 100.0).round(), (own.y * 100.0).round(), (own.z * 100.0).round()) / 100.0;
        shape = shape_at(own, yaw);
        slow.body = Some(body_at(view.camera.eye + axes * own, axes * turned));
        text += "placement = \"camera\"\n";
    }
    match kind {
        0 => {
            let _ = writeln!(text, "shape = {shape}\neffects = [{{ effect = \"sepia\", class = \"{word}\" }}]");
        }
        1..=3 => {
            slow.act = Act::Hides(if kind == 1 { Class::Inside } else { class });
            let word = if kind == 1 { "inside" } else { word };
            let _ = writeln!(text, "shape = {shape}\neffects = [{{ effect = \"eraser\", class = \"{word}\" }}]");
        }
        4 | 5 => {
            let (own, keeps_terrain) = match kind {
                4 => ("derive = \"box\"".to_owned(), true),
                _ => {
                    let [x, y, z] = [0; 3].map(|_| dice.number(-10.0, 10.0));
                    let scale = dice.number(0.5, 1.4);
                    (
                        format!(
                            "from = [0, 0, 0], to = [{x}, {y}, {z}], rotation_deg = [{yaw}, 0, 0], scale = {scale}"
                        ),
                        false,
                    )
                }
            };
            let clip = *dice.pick(&[Clip::Order, Clip::Order, Clip::Merge, Clip::Discard]);
            let clip_word = match clip {
                Clip::Order => "order",
                Clip::Merge => "merge",
                Clip::Discard => "discard",
            };
            slow.act = Act::Shows { class, clip, world: 0, keeps_terrain };
            let _ = writeln!(
                text,
                "kind = \"content\"\nshape = {shape}\nclip = \"{clip_word}\"\ncontent = {{ {own}, class = \"{word}\" }}"
            );
            content = Some(own);
        }
        6 => {
            slow.body = None;
            slow.act = Act::Hides(Class::Inside);
            text += "shape = { kind = \"thematic\", types = [\"Building\"] }\neffects = [\"eraser\"]\n";
        }
        _ => {
            slow.act = Act::Moves;
            let middle = DVec3::new(center.x, center.y, 20.0);
            slow.body = Some(Body::Block { center: middle, half: DVec3::new(45.0, 40.0, 30.0), axes: DMat3::IDENTITY });
            let steps = [
                "{ kind = \"translate\", by = [6, 0, 9] }",
                "{ kind = \"twist\", angle_deg = 40 }",
                "{ kind = \"taper\", factor = 0.6 }",
            ];
            let _ = writeln!(
                text,
                "kind = \"deformation\"\nshape = {{ kind = \"box\", center = [{}, {}, 20], size = [90, 80, 60] }}\ndeform = [{}]",
                center.x,
                center.y,
                dice.pick(&steps)
            );
        }
    }
    if has_moves && kind < 4 && !is_of_camera && dice.once_in(3) {
        // In front of and behind what is moved along are left to other tests.
        if matches!(slow.act, Act::Looks | Act::Hides(Class::Inside)) {
            slow.at_rest = true;
            text += "space = \"rest\"\n";
        }
    }
    Made { text, slow, content }
}

/// Adds a triangle where it is shown: in parts of a metre and a half where something moves it.
fn add(faces: &mut Vec<Face>, corners: [DVec3; 3], of: (u32, usize, bool), deformers: &Deformers) {
    let mut left = vec![corners];
    while let Some(rest) = left.pop() {
        let moves = deformers.supports().any(|support| support.meets_triangle(&rest));
        let edges = [0, 1, 2].map(|k| rest[k].distance(rest[(k + 1) % 3]));
        let longest = (0..3).max_by(|&a, &b| edges[a].total_cmp(&edges[b])).unwrap_or(0);
        if moves && edges[longest] > 1.5 {
            let [a, b, c] = [0, 1, 2].map(|k| rest[(longest + k) % 3]);
            let middle = a.midpoint(b);
            left.extend([[a, middle, c], [middle, b, c]]);
            continue;
        }
        let shown = rest.map(|p| deformers.value(p));
        let (object, world, is_terrain) = of;
        faces.push(Face { shown, rest, object, world, is_terrain });
    }
}

/// Where a ray meets a triangle (Möller and Trumbore).
fn hit(origin: DVec3, direction: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<(f64, f64, f64)> {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = (origin - *a) / determinant;
    let u = s.dot(p);
    let q = s.cross(ab);
    let v = direction.dot(q);
    let t = ac.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, u, v))
}

/// What a sight line shows.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    /// As in pictures: 0 is nothing.
    id: u32,
    /// Others whose faces lie in the same place.
    others: Vec<u32>,
    t: f64,
    masks: Vec<bool>,
    /// Whether something about it is nearer to a border than a picture can tell.
    is_near_border: bool,
}

struct Reference {
    faces: Vec<Face>,
    lenses: Vec<Slow>,
    /// What bends rays, on top of all others.
    bent: Option<Bent>,
    /// How far shown places may be from where they should be, metres by metre of distance.
    slack: f64,
}

impl Reference {
    /// The class of a place with regard to a lens, and how far that is from another.
    fn class(&self, lens: &Slow, object: u32, hit: &Hit, ray: (DVec3, DVec3)) -> (Class, f64) {
        let Some(body) = &lens.body else {
            let is_member = lens.members.get(object as usize) == Some(&true);
            return (if is_member { Class::Inside } else { Class::Rest }, f64::INFINITY);
        };
        if lens.at_rest {
            let distance = body.distance(hit.rest);
            // Its body is moved to a thousandth of its size.
            let room = distance.abs() - 2e-3 * body.size() - 0.02;
            return (if distance < 0.0 { Class::Inside } else { Class::Rest }, room.max(0.0));
        }
        let (origin, direction) = ray;
        match body.interval(origin, direction) {
            None => (Class::Rest, f64::INFINITY),
            Some((entry, exit)) => {
                let entry = entry.max(0.0);
                let class = if hit.t < entry {
                    Class::Front
                } else if hit.t < exit {
                    Class::Inside
                } else {
                    Class::Behind
                };
                (class, (hit.t - entry).abs().min((hit.t - exit).abs()))
            }
        }
    }

    /// The lines that the ray through a place of the picture lies on, and from where to where.
    fn lines(&self, view: &View, pixel: DVec2) -> Vec<Piece> {
        let Some(bent) = &self.bent else {
            let ray = view.ray(pixel);
            return vec![([0.0, f64::INFINITY], ray.origin, ray.direction)];
        };
        let of_picture = pixel / DVec2::from(view.size.map(f64::from));
        let place = DVec2::new(2.0 * of_picture.x - 1.0, 1.0 - 2.0 * of_picture.y) * view.half_extent();
        let to_world = view.basis.view_from_world().transpose();
        let placed =
            |(range, origin, direction): Piece| (range, view.camera.eye + to_world * origin, to_world * direction);
        path(bent, place, view.is_orthographic()).into_iter().map(placed).collect()
    }

    fn seen(&self, hits: &mut [Hit]) -> Seen {
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        let mut is_near_border = false;
        let mut first: Option<Seen> = None;
        for hit in hits.iter() {
            let face = &self.faces[hit.face];
            let band = BAND * hit.t + 1e-4 + self.slack * hit.t;
            if first.as_ref().is_some_and(|first| hit.t > first.t + band) {
                break;
            }
            let (mut shown, mut below, mut is_hidden) = (1_u32, 0_u32, false);
            let mut classes = Vec::new();
            for lens in &self.lenses {
                let (class, room) = self.class(lens, face.object, hit, hit.ray);
                is_near_border |= room < band;
                classes.push(class);
                match lens.act {
                    Act::Hides(of) => is_hidden |= class == of && !face.is_terrain,
                    Act::Shows { class: of, clip, world, keeps_terrain } => {
                        if class != of || (keeps_terrain && face.is_terrain) {
                            continue;
                        }
                        let own = 1 << world;
                        shown = match clip {
                            Clip::Order => own,
                            Clip::Merge => shown | own,
                            Clip::Discard if below & !own != 0 => 0,
                            Clip::Discard => own,
                        };
                        below |= own;
                    }
                    Act::Looks | Act::Moves => {}
                }
            }
            if is_hidden || shown >> face.world & 1 == 0 {
                continue;
            }
            let masks = classes.iter().map(|class| *class == Class::Inside).collect();
            match &mut first {
                Some(first) => first.others.push(face.object + 1),
                None => first = Some(Seen { id: face.object + 1, t: hit.t, masks, ..Seen::default() }),
            }
        }
        let nothing = || Seen { masks: vec![false; self.lenses.len()], ..Seen::default() };
        Seen { is_near_border, ..first.unwrap_or_else(nothing) }
    }

    /// What every pixel shows, and what is seen beside its middle.
    fn picture(&self, view: &View, beside: f64) -> Vec<[Seen; 5]> {
        let [w, h] = size();
        let offsets = [[0.0, 0.0], [-beside, -beside], [beside, -beside], [-beside, beside], [beside, beside]];
        let lines_of = |x: u32, y: u32, [i, j]: [f64; 2]| {
            self.lines(view, DVec2::new(f64::from(x) + 0.5 + i, f64::from(y) + 0.5 + j))
        };
        // The pixels that a face may be in, along x and y.
        let spans = |face: &Face| {
            // What crosses the eye's plane may be anywhere.
            let corners: Option<Vec<DVec3>> = face.shown.iter().map(|p| view.pixel(*p)).collect();
            // And so may be what bent rays come to.
            let corners = corners.filter(|_| self.bent.is_none());
            [(0, w), (1, h)].map(|(axis, side)| match &corners {
                None => 0..side,
                Some(corners) => {
                    let all = corners.iter().map(|p| p[axis]);
                    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
                    let end = f64::from(side);
                    (low - 2.0).clamp(0.0, end) as u32..(high + 2.0).clamp(0.0, end) as u32
                }
            })
        };
        let spans: Vec<_> = self.faces.iter().map(spans).collect();
        let row = |y: u32| {
            let rays: Vec<_> = (0..w).map(|x| offsets.map(|offset| lines_of(x, y, offset))).collect();
            let mut hits: Vec<[Vec<Hit>; 5]> = (0..w).map(|_| Default::default()).collect();
            for (number, [across, _]) in spans.iter().enumerate().filter(|(_, [_, down])| down.contains(&y)) {
                let face = &self.faces[number];
                for x in across.clone() {
                    let lines = rays[x as usize].iter().enumerate();
                    for (k, ([begin, end], origin, direction)) in
                        lines.flat_map(|(k, all)| all.iter().map(move |l| (k, l)))
                    {
                        let Some((t, u, v)) = hit(*origin, *direction, &face.shown) else { continue };
                        if t < *begin || t > *end {
                            continue;
                        }
                        let [a, b, c] = face.rest;
                        let rest = a + (b - a) * u + (c - a) * v;
                        hits[x as usize][k].push(Hit { t, rest, face: number, ray: (*origin, *direction) });
                    }
                }
            }
            let one = |mut of: [Vec<Hit>; 5]| std::array::from_fn(|k| self.seen(&mut of[k]));
            hits.into_iter().map(one).collect::<Vec<_>>()
        };
        (0..h).into_par_iter().flat_map_iter(row).collect()
    }
}

/// A scene of the lenses of some kinds, in this order.
fn scene_of(kinds: &[usize], seed: u64) -> (String, Vec<Made>) {
    let mut dice = Random::new(seed, 0);
    let (angle, height) = (dice.number(0.0, 6.25), dice.number(8.0, 70.0));
    let eye = [70.0 * angle.cos(), 70.0 * angle.sin(), height].map(|v| (v * 100.0_f64).round() / 100.0);
    let head = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[camera]\neye = {eye:?}\ntarget = [0, 0, 6]\nfov_deg = 50\n[sun]\nshadows = false\n"
    );
    let plain = parsed(&head);
    let view = view_of(&plain);
    let has_moves = kinds.iter().any(|kind| *kind >= 7);
    let made: Vec<Made> =
        kinds.iter().enumerate().map(|(i, kind)| lens(*kind, i, &view, &mut dice, has_moves)).collect();
    (made.iter().fold(head, |text, made| text + &made.text), made)
}

fn parsed(text: &str) -> Scene {
    parse(text, "combined.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn view_of(scene: &Scene) -> View {
    let around = Aabb { min: DVec3::splat(-1e3), max: DVec3::splat(1e3) };
    View::new(scene.camera.expect("a camera"), size(), &around).expect("a view")
}

/// Draws a scene and holds it to the reference. How many pixels were compared, and how many of them show what a lens does.
fn compare(studio: &mut Studio, kinds: &[usize], seed: u64, bends: &str) -> Result<[u64; 2], String> {
    let (mut text, made) = scene_of(kinds, seed);
    text += bends;
    let scene = parsed(&text);
    let view = view_of(&scene);
    let backend = if seed.is_multiple_of(2) { Backend::Specialised } else { Backend::Uber };
    let request = Request { aovs: ALL, backend, ..Request::plain(size()) };
    let drawn = studio.render(&scene, &request).map_err(|error| format!("{error}\n{text}"))?;
    let deformers = studio.deformers(&scene, size()).map_err(|error| error.to_string())?;
    let moves = !deformers.0.is_empty();
    let reference = reference_of(studio, &scene, made, &deformers);
    let beside = if moves { BESIDE_DEFORMED_PX } else { BESIDE_PX };
    let wanted = reference.picture(&view, beside);
    // What bends rays has a mask of its own, which other tests look at.
    held(&drawn, &wanted, reference.lenses.len(), reference.slack)
        .map_err(|wrong| format!("kinds {kinds:?}, seed {seed}: {wrong}\n{text}"))
}

fn reference_of(studio: &Studio, scene: &Scene, made: Vec<Made>, deformers: &Deformers) -> Reference {
    let model = &studio.model;
    let is_ground = |object: u32| model.objects[object as usize].class.is_ground();
    let mut all = Vec::new();
    for (corners, object) in faces(model, &studio.geometries) {
        add(&mut all, corners, (object, 0, is_ground(object)), deformers);
    }
    let mut known: Vec<String> = Vec::new();
    let mut lenses = Vec::new();
    for (mut one, lens) in made.into_iter().zip(&scene.lenses) {
        if let (Act::Shows { world, .. }, Some(own)) = (&mut one.slow.act, &one.content) {
            *world = known.iter().position(|text| text == own).unwrap_or_else(|| {
                known.push(own.clone());
                for (corners, object) in content_of(studio, lens) {
                    add(&mut all, corners, (object, known.len(), is_ground(object)), deformers);
                }
                known.len() - 1
            }) + 1;
        }
        if one.slow.body.is_none() {
            let is_building = |object: u32| {
                let kind = |o: u32| model.strings.get(model.objects[o as usize].kind) == "Building";
                kind(object) || kind(model.root(object))
            };
            one.slow.members = (0..model.objects.len() as u32).map(is_building).collect();
        }
        lenses.push(one.slow);
    }
    // A quarter of a pixel, and twice that between edges.
    let pixel = view_of(scene).pixel_m(1.0);
    let bent = scene.lenses.iter().find_map(Lens::ray).map(|ray| Bent::new(ray, &view_of(scene)));
    Reference { faces: all, lenses, bent, slack: if deformers.0.is_empty() { 0.0 } else { 0.75 * pixel } }
}

/// The triangles of a content where it stands before deformations.
fn content_of(studio: &Studio, lens: &Lens) -> Vec<([DVec3; 3], u32)> {
    let content = lens.shown().expect("a content");
    match (&content.derive, &content.copied) {
        (Some(how), _) => {
            let made = derive(&studio.model, &studio.geometries, how);
            faces(&made.model, &made.geometries())
        }
        (None, copied) => {
            let copied = copied.expect("a copy");
            let (from, to) = (copied.from.unwrap_or_default(), copied.to.unwrap_or_default());
            let (rotation, scale): (DQuat, f64) = (copied.rotation, copied.scale);
            let place = |p: DVec3| rotation * ((p - from) * scale) + to;
            let all = faces(&studio.model, &studio.geometries).into_iter();
            all.map(|(corners, object)| (corners.map(place), object)).collect()
        }
    }
}

/// Compares what is sure. `slack`: as of the reference.
fn held(drawn: &Picture, wanted: &[[Seen; 5]], lenses: usize, slack: f64) -> Result<[u64; 2], String> {
    let (ids, depth) = (drawn.object_id.as_ref().expect("ids"), drawn.depth.as_ref().expect("depths"));
    let masks: Vec<Vec<bool>> = (0..lenses).map(|lens| bits(drawn, lens)).collect();
    let [mut compared, mut acted] = [0, 0];
    for (i, around) in wanted.iter().enumerate() {
        let [own, others @ ..] = around;
        let all = around.iter().map(|seen| seen.t);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
        // Beside an edge behind which the same object goes on, what is seen of it may lie anywhere between.
        let is_cliff = slack > 0.0 && high - low > CLIFF * slack * own.t;
        let is_sure = !is_cliff
            && !around.iter().any(|seen| seen.is_near_border)
            && others.iter().all(|other| other.id == own.id && other.masks == own.masks);
        if !is_sure {
            continue;
        }
        compared += 1;
        acted += u64::from(own.masks.iter().any(|is_in| *is_in));
        let at = || format!("pixel {}, {}", i as u32 % size()[0], i as u32 / size()[0]);
        // Where faces of two objects touch, either may be shown.
        if ids[i] != own.id && !around.iter().any(|seen| seen.others.contains(&ids[i])) {
            return Err(format!("{}: object {} at {}, wanted {} at {}", at(), ids[i], depth[i], own.id, own.t));
        }
        for (lens, mask) in masks.iter().enumerate() {
            if mask[i] != own.masks[lens] {
                return Err(format!("{}: lens {lens} holds it: {}, wanted {}", at(), mask[i], own.masks[lens]));
            }
        }
        if own.id != 0 {
            let d = f64::from(depth[i]);
            let room = 2.0 * (high - low) + 1e-5 * own.t;
            if d < low - room || d > high + room {
                return Err(format!("{}: {d} m away, wanted {}", at(), own.t));
            }
        }
    }
    Ok([compared, acted])
}

#[test]
fn lenses_of_every_two_and_three_kinds_show_what_a_slow_renderer_says() {
    let mut studio = of_scene(&parsed("veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n"));
    let pairs: Vec<Vec<usize>> = (0..KINDS).flat_map(|a| (0..KINDS).map(move |b| vec![a, b])).collect();
    let mut dice = Random::new(24, 0);
    let (mut total, mut acted, mut wrong) = (0, 0, Vec::new());
    let mut run = |kinds: &[usize], seed: u64| match compare(&mut studio, kinds, seed, "") {
        Ok([compared, own]) => {
            total += compared;
            acted += own;
            total
        }
        Err(message) => {
            wrong.push(message);
            total
        }
    };
    for (i, kinds) in pairs.iter().enumerate().filter(|(i, _)| studio::is_tried(*i, 11)) {
        run(kinds, i as u64);
    }
    let wanted = std::env::var("VEDUTA_HARD_PIXELS").ok().and_then(|text| text.parse().ok()).unwrap_or(0) / SHARE;
    let mut seed = 1000;
    loop {
        let kinds: Vec<usize> = (0..3).map(|_| dice.below(KINDS)).collect();
        seed += 1;
        let so_far = run(&kinds, seed);
        if seed >= 1000 + TRIPLES && (!is_thorough() || so_far >= wanted) {
            break;
        }
    }
    let scenes = wrong.len();
    wrong.truncate(4);
    assert!(scenes == 0, "{scenes} scenes differ:\n{}", wrong.join("\n"));
    println!("{total} pixels compared, {acted} of them in lenses");
    assert!(acted * 12 > total && total > 20_000, "{acted} of {total} pixels are in lenses");
}

/// Lenses that bend rays, over all of the picture's height.
const BENDING: [&str; 3] = [
    "kind = \"magnifier\"\nray = { radius = 0.5, magnification = 2.2, distance = 35, at = 30, border = 0.4 }",
    "kind = \"fisheye\"\nray = { angle_deg = 140 }",
    "kind = \"sampling\"\nray = { radius = 0.5, magnification = 2.5, outline = \"square\" }",
];

/// Of an ordinary run, every so-manieth of the pairs.
const PAIRS_TRIED: usize = 7;

#[test]
fn lenses_of_every_kind_seen_through_those_that_bend_rays_show_what_a_slow_renderer_says() {
    let mut studio = of_scene(&parsed("veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n"));
    let (mut total, mut acted, mut wrong, mut scenes) = (0, 0, Vec::new(), 0);
    let pairs = (0..KINDS).flat_map(|kind| BENDING.map(|bending| (kind, bending))).enumerate();
    for (i, (kind, bending)) in pairs.filter(|(i, _)| studio::is_tried(*i, PAIRS_TRIED)) {
        scenes += 1;
        let bends = format!("[[lens]]\nname = \"bends\"\nbody = \"none\"\n{bending}\n");
        match compare(&mut studio, &[kind], 500 + i as u64, &bends) {
            Ok([compared, own]) => (total, acted) = (total + compared, acted + own),
            Err(message) => wrong.push(message),
        }
    }
    println!("{scenes} scenes, {total} pixels compared, {acted} of them in lenses");
    let count = wrong.len();
    wrong.truncate(4);
    assert!(count == 0, "{count} of {scenes} scenes differ:\n{}", wrong.join("\n"));
    assert!(acted * 20 > total && total > 2_000 * scenes, "{acted} of {total} pixels are in lenses");
}
