//! What tests that draw share: a studio over files or over the synthetic city, and lenses by one line.
#![allow(dead_code, reason = "every test binary uses its own part")]

pub mod bent;
pub mod by_rays;
pub mod random_scene;
pub mod volumes;

use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::{
        Arc, OnceLock,
        atomic::{AtomicU32, Ordering::Relaxed},
    },
};

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    city::{
        CityModel,
        load::{LoadOptions, Quiet, load},
        synth,
    },
    geom::{Ray, Shape, Volume, combination::Operation},
    gpu::Gpu,
    lens::{Class, EffectUse, Lens, LensBody, LensKind, Parameter, Region, classify::intervals},
    render::{
        light::SHADOW_SIZE,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{CitySpec, Scene, Sun},
    view::{Camera, Projection},
};

/// All AOVs.
pub const ALL: Aovs = Aovs { depth: true, object_id: true, normal: true, lens_mask: true };

/// Whether a property is to be tried with all that there is (`./dev hard`), not with the sample that every run takes.
pub fn is_thorough() -> bool {
    std::env::var_os("VEDUTA_HARD").is_some()
}

/// Whether the `i`-th of what a property is tried with is tried in this run: each one in a thorough run, else one in `every`.
pub fn is_tried(i: usize, every: usize) -> bool {
    is_thorough() || i.is_multiple_of(every)
}

/// How far the adapter of the tests moves corners of triangles at most, pixels: what it shows may be so far beside its face.
pub fn snapping() -> f64 {
    static MEASURED: OnceLock<f64> = OnceLock::new();
    *MEASURED.get_or_init(|| Gpu::open().expect("an adapter, hardware or software").snapping)
}

/// How far a place that is shown at distance D may be beside its face for the adapter's grid, metres.
pub fn off_face(view: &veduta::view::View, d: f64) -> f64 {
    snapping() * view.pixel_m(d)
}

/// A file of `citydata/`.
pub fn citydata(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("citydata").join(name)
}

/// A studio over files, without the plain ground.
pub fn studio(files: &[PathBuf]) -> Studio {
    let model = load(files, &LoadOptions::default(), &Quiet).expect("the files load");
    let spec = CitySpec { ground: false, ..CitySpec::default() };
    over(model, &spec)
}

/// A studio over a city, with shadow maps of a sixteenth of the texels: on the software adapter these are more than a small picture has, and
/// what is asked of shadows here does not depend on them.
fn over(model: CityModel, spec: &CitySpec) -> Studio {
    let gpu = Gpu::open().expect("an adapter, hardware or software");
    let mut studio = Studio::new(gpu, Arc::new(model), spec).expect("a studio");
    studio.renderer.settings.shadow_size = SHADOW_SIZE / 4;
    studio
}

/// A studio over a scene's city.
pub fn of_scene(scene: &Scene) -> Studio {
    let changes = (scene.city.changes.clone(), scene.city.dating.clone());
    let (joins, timetables) = (scene.city.joins.clone(), scene.city.timetables.clone());
    let options = LoadOptions {
        up: scene.city.up,
        materials: scene.city.materials,
        joins,
        timetables,
        changes,
        ..LoadOptions::default()
    };
    let model = load(&scene.city.files, &options, &Quiet).expect("the files load");
    over(model, &scene.city)
}

/// The studio with the shadow maps that people have.
pub fn with_full_shadows(mut studio: Studio) -> Studio {
    studio.renderer.settings.shadow_size = SHADOW_SIZE;
    studio
}

/// A studio over the synthetic city.
pub fn synthetic(buildings: u64) -> Studio {
    static MADE: AtomicU32 = AtomicU32::new(0);
    let number = MADE.fetch_add(1, Relaxed);
    let path = std::env::temp_dir().join(format!("veduta-synth-{}-{number}.city.json", std::process::id()));
    let mut file = std::fs::File::create(&path).expect("a temporary file");
    let options = synth::SynthOptions { buildings, seed: 7 };
    synth::write_cityjson(&options, &mut file, &mut |_| ()).expect("a synthetic city");
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// A city of boxes (south-west corner, size) and of a slope of terrain that climbs to the north by half, if it has one; with the plain ground
/// where it has none, if that is wanted.
pub fn boxes(name: &str, boxes: &[([i64; 3], [i64; 3])], has_slope: bool, ground: bool) -> Studio {
    let mut vertices: Vec<[i64; 3]> = vec![[-100, 0, 0], [100, 0, 0], [100, 200, 100], [-100, 200, 100]];
    let slope = r#""slope": {"type": "TINRelief", "geometry": [{"type": "CompositeSurface", "lod": "1", "boundaries": [[[0,1,2]],[[0,2,3]]]}]}"#;
    let mut objects: Vec<String> = has_slope.then(|| slope.to_owned()).into_iter().collect();
    for (i, (at, size)) in boxes.iter().enumerate() {
        let first = vertices.len();
        for z in [0, size[2]] {
            let corners = [[0, 0], [size[0], 0], [size[0], size[1]], [0, size[1]]];
            vertices.extend(corners.map(|[x, y]| [at[0] + x, at[1] + y, at[2] + z]));
        }
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let faces = faces.map(|face| vec![face.map(|k: usize| first + k)]);
        objects.push(format!(
            r#""box {i}": {{"type": "Building", "geometry": [{{"type": "Solid", "lod": "2", "boundaries": [{faces:?}]}}]}}"#
        ));
    }
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [1, 1, 1], "translate": [0, 0, 0]}}, "CityObjects": {{{}}}, "vertices": {vertices:?}}}"#,
        objects.join(", ")
    );
    static MADE: AtomicU32 = AtomicU32::new(0);
    let number = MADE.fetch_add(1, Relaxed);
    let path = std::env::temp_dir().join(format!("veduta-{name}-{}-{number}.city.json", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    let scene =
        Scene { city: CitySpec { files: vec![path.clone()], ground, ..Default::default() }, ..Scene::default() };
    let studio = of_scene(&scene);
    std::fs::remove_file(path).expect("the temporary file");
    studio
}

/// A folder of one test, removed at its end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A triangle of what a studio shows.
pub struct Triangle {
    /// Metres.
    pub corners: [DVec3; 3],
    /// Index of its object.
    pub object: u32,
    /// Index of its surface.
    pub surface: u32,
}

/// The triangles of some geometries of a model, with their objects.
pub fn faces(model: &CityModel, geometries: &[u32]) -> Vec<([DVec3; 3], u32)> {
    let mut all = Vec::new();
    for geometry in geometries.iter().map(|&g| &model.geometries[g as usize]) {
        for tile in &model.tiles[geometry.tiles.start as usize..geometry.tiles.end as usize] {
            for corners in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
                let corners = [0, 1, 2].map(|k| model.position(tile, tile.vertices.start + corners[k]));
                all.push((corners, geometry.object));
            }
        }
    }
    all
}

/// All of them.
pub fn triangles(studio: &Studio) -> Vec<Triangle> {
    let model = &studio.model;
    let mut all = Vec::new();
    for &g in &studio.geometries {
        for t in model.geometries[g as usize].tiles.clone() {
            let tile = &model.tiles[t as usize];
            for corners in model.indices[tile.indices.start as usize..tile.indices.end as usize].chunks_exact(3) {
                let surface = model.vertices[(tile.vertices.start + corners[0]) as usize].surface;
                let corners = [0, 1, 2].map(|k| model.position(tile, tile.vertices.start + corners[k]));
                all.push(Triangle { corners, object: model.surfaces[surface as usize].object, surface });
            }
        }
    }
    all
}

/// A scene without shadows, seen by `camera`.
pub fn scene(camera: Camera, lenses: Vec<Lens>) -> Scene {
    Scene { camera: Some(camera), lenses, sun: Sun { shadows: false, ..Sun::default() }, ..Scene::default() }
}

/// A colour lens with one effect, without outline.
pub fn lens(name: &str, shapes: impl IntoIterator<Item = impl Into<Region>>, effect: &str) -> Lens {
    Lens {
        name: name.into(),
        kind: LensKind::default(),
        enabled: true,
        color: [0.8, 0.1, 0.1],
        placement: Default::default(),
        shapes: shapes.into_iter().map(Into::into).collect(),
        effects: vec![used(effect)],
        time: vec![],
        body: LensBody::None,
        sprite: None,
        border: None,
        keeps_shadows: false,
        at_rest: false,
        section: None,
    }
}

/// An effect with its defaults.
pub fn used(effect: &str) -> EffectUse {
    EffectUse { effect: effect.into(), class: Class::Inside, blend: None, weight: None, parameters: BTreeMap::new() }
}

/// An effect with these numbers.
pub fn with_numbers(effect: &str, numbers: &[(&str, f64)]) -> EffectUse {
    let parameters = numbers.iter().map(|(name, n)| ((*name).to_owned(), Parameter::Number(*n))).collect();
    EffectUse { parameters, ..used(effect) }
}

/// What a focus area holds, in f64, from its parts.
pub enum Reference {
    /// The union of volumes.
    Volumes(Vec<Volume>),
    /// A combination.
    Combined(Operation, Vec<Reference>),
}

impl Reference {
    /// Of a focus area that needs no city.
    pub fn of(focus: &Region) -> Self {
        match focus {
            Region::Combined { how, parts } => Self::Combined(*how, parts.iter().map(Self::of).collect()),
            other => Self::Volumes(other.volumes().expect("volumes")),
        }
    }

    /// No further from the border than this, negative inside.
    pub fn distance(&self, p: DVec3) -> f64 {
        match self {
            Self::Volumes(all) => all.iter().map(|v| v.signed_distance(p)).fold(f64::INFINITY, f64::min),
            Self::Combined(how, parts) => {
                let join = |a: f64, b: f64| match how {
                    Operation::Union => a.min(b),
                    Operation::Intersection => a.max(b),
                    Operation::Difference => a.max(-b),
                };
                parts.iter().map(|part| part.distance(p)).reduce(join).expect("parts")
            }
        }
    }

    /// Where a ray is inside, ascending and apart.
    pub fn intervals(&self, ray: &Ray) -> Vec<(f64, f64)> {
        let mut ends: Vec<f64> = Vec::new();
        self.ends(ray, &mut ends);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let mut found: Vec<(f64, f64)> = Vec::new();
        for pair in ends.windows(2).filter(|pair| self.holds(ray, pair[0].midpoint(pair[1]))) {
            match found.last_mut() {
                Some(last) if last.1 == pair[0] => last.1 = pair[1],
                _ => found.push((pair[0], pair[1])),
            }
        }
        found
    }

    fn ends(&self, ray: &Ray, ends: &mut Vec<f64>) {
        match self {
            Self::Volumes(all) => ends.extend(all.iter().flat_map(|v| intervals(v, ray)).flat_map(|(a, b)| [a, b])),
            Self::Combined(_, parts) => parts.iter().for_each(|part| part.ends(ray, ends)),
        }
    }

    fn holds(&self, ray: &Ray, t: f64) -> bool {
        match self {
            Self::Volumes(all) => all.iter().flat_map(|v| intervals(v, ray)).any(|(a, b)| a <= t && t < b),
            Self::Combined(how, parts) => {
                parts.iter().map(|part| part.holds(ray, t)).reduce(|a, b| how.joins(a, b)).expect("parts")
            }
        }
    }

    /// The middle of the box around it.
    pub fn center(&self) -> DVec3 {
        match self {
            Self::Volumes(all) => all[0].bounds().center(),
            Self::Combined(_, parts) => parts[0].center(),
        }
    }
}

/// One of each shape around a point, about `r` metres in size.
pub fn shapes(at: DVec3, r: f64) -> Vec<Region> {
    let turn = DQuat::from_rotation_z(0.6) * DQuat::from_rotation_x(0.35);
    let points = (0..24)
        .map(|i| {
            let t = f64::from(i);
            at + r * DVec3::new((t * 1.7).sin(), (t * 2.9).cos(), (t * 0.8).sin())
        })
        .collect();
    let plan = |corners: &[[f64; 2]]| corners.iter().map(|c| at.truncate() + r * DVec2::from(*c)).collect::<Vec<_>>();
    let outline = [[-1.0, -0.8], [0.9, -0.9], [1.0, 0.7], [0.2, 0.6], [0.1, -0.2], [-0.3, 0.9], [-0.9, 0.5]];
    let closed = [
        Shape::Sphere { center: at, radius: r },
        Shape::Box { center: at, size: DVec3::new(1.6, 1.1, 0.9) * r, rotation: turn },
        Shape::Cylinder { center: at, radius: 0.7 * r, height: 1.3 * r, axis: turn * DVec3::Z },
        Shape::Convex { points },
        Shape::Ellipsoid { center: at, radii: DVec3::new(1.1, 0.5, 0.8) * r, rotation: turn },
        Shape::Frustum { center: at, radius: 0.8 * r, top_radius: 0.5 * r, height: 1.3 * r, axis: turn * DVec3::Z },
        Shape::Frustum { center: at, radius: 0.9 * r, top_radius: 0.0, height: 1.4 * r, axis: DVec3::Z },
    ];
    let concave = [
        Region::Prism {
            points: plan(&outline),
            holes: vec![plan(&[[0.3, -0.6], [0.6, -0.6], [0.5, -0.3]])],
            base: at.z - 0.5 * r,
            height: 0.9 * r,
        },
        Region::Mesh { file: "citydata/ring.obj".into(), at, rotation: turn, scale: 0.8 * r },
    ];
    let ball = |by: DVec3, radius: f64| Region::from(Shape::Sphere { center: at + r * by, radius: radius * r });
    let slab = Shape::Box { center: at, size: DVec3::new(3.0, 0.7, 3.0) * r, rotation: turn };
    let bitten = [ball(DVec3::ZERO, 1.0), slab.clone().into(), ball(DVec3::new(0.7, 0.3, 0.4), 0.6)];
    let ring = Region::Mesh { file: "citydata/ring.obj".into(), at, rotation: DQuat::IDENTITY, scale: 0.8 * r };
    let combined = [
        Region::Combined { how: Operation::Difference, parts: bitten.to_vec() },
        Region::Combined {
            how: Operation::Union,
            parts: vec![
                Region::Combined { how: Operation::Intersection, parts: vec![ring, slab.into()] },
                ball(DVec3::new(0.0, -0.9, 0.0), 0.4),
            ],
        },
    ];
    closed.into_iter().map(Region::from).chain(concave).chain(combined).collect()
}

/// An orthographic camera.
pub fn orthographic(eye: DVec3, target: DVec3, height_m: f64) -> Camera {
    Camera { projection: Projection::Orthographic { height_m }, ..Camera::looking(eye, target, 1.0) }
}

/// One unjittered sample with all AOVs and statistics.
pub fn picture(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Picture {
    let request = Request { aovs: ALL, statistics: true, ..Request::plain(size) };
    studio.render(scene, &request).expect("a picture")
}

/// Whether the lens' bit is set, per pixel.
pub fn bits(picture: &Picture, lens: usize) -> Vec<bool> {
    let planes = picture.lens_mask.as_ref().expect("masks were asked for");
    planes[lens / 32].iter().map(|word| word >> (lens % 32) & 1 == 1).collect()
}

/// Pixels of the lens' mask that are wrong against f64, by how far the shown point is from the border. A test from shapes
/// may err within 8 · 2⁻²³ · max(D, |centre − eye|) of it and the adapter's grid, a sprite within a pixel besides.
pub fn wrong_pixels(picture: &Picture, view: &veduta::view::View, lens: &Lens, bit: usize) -> usize {
    let parts: Vec<Reference> = lens.shapes.iter().map(Reference::of).collect();
    let depth = picture.depth.as_ref().expect("depth was asked for");
    let inside = bits(picture, bit);
    let [w, h] = picture.size;
    let farthest = parts.iter().map(|p| p.center().distance(view.camera.eye)).fold(0.0, f64::max);
    let mut wrong = 0;
    for (i, (x, y)) in (0..h).flat_map(|y| (0..w).map(move |x| (x, y))).enumerate() {
        let d = f64::from(depth[i]);
        if !d.is_finite() {
            wrong += usize::from(inside[i]);
            continue;
        }
        let p = view.pixel_ray(x, y).at(d);
        let distance = parts.iter().map(|part| part.distance(p)).fold(f64::INFINITY, f64::min);
        // Solids ask beside a place, and of each place as far along the normal.
        let texel = if lens.sprite.is_some() { view.pixel_m(d) } else { 2.0 * off_face(view, d) };
        if distance.abs() > texel + 8.0 * f64::from(f32::EPSILON) * d.max(farthest) {
            wrong += usize::from(inside[i] != (distance < 0.0));
        }
    }
    wrong
}

/// Draws street views through the city with and without what near buildings hide, and compares every byte; returns how many
/// views left something out, and the triangles drawn with and without.
pub fn hiding_changes_nothing(studio: &mut Studio, views: u32, size: [u32; 2]) -> (u32, u64, u64) {
    let extent = studio.extent();
    let (mut used, mut drawn_hiding, mut drawn_all) = (0, 0, 0);
    for i in 0..views {
        // Additive recurrences: spread evenly, the same in every run.
        let at = |step: f64| (f64::from(i) * step + 0.5).fract();
        let share = DVec3::new(at(0.754_877_666_2), at(0.569_840_290_9), 0.0);
        let foot = (extent.min + extent.size() * (0.1 + 0.8 * share)).with_z(extent.min.z);
        let eye = foot + DVec3::Z * (1.7 + 12.0 * at(0.618_033_988_7));
        let turn = std::f64::consts::TAU * at(0.324_717_957_2);
        let target = eye + DVec3::new(turn.cos(), turn.sin(), -0.1 * at(0.41)) * 50.0;
        let scene = scene(Camera::looking(eye, target, 0.9), vec![]);
        let samples = if i % 4 == 3 { 3 } else { 1 };
        let request = Request { samples, aovs: ALL, statistics: true, ..Request::plain(size) };
        let mut draw = |hides: bool| {
            studio.renderer.settings.culls_hidden = hides;
            let picture = studio.render(&scene, &request).expect("a picture");
            let named = |p: &str| picture.statistics.passes.iter().any(|pass| pass.name == p);
            let triangles = picture.statistics.passes.iter().map(|pass| pass.triangles).sum::<u64>();
            (named("geometry beyond"), triangles, picture)
        };
        let (hid, fewer, with) = draw(true);
        let (_, all, without) = draw(false);
        assert!(with.rgba == without.rgba, "view {i}: another picture");
        assert!(with.object_id == without.object_id, "view {i}: other objects");
        assert!(with.normal == without.normal, "view {i}: other normals");
        let bits = |p: &Picture| p.depth.as_ref().expect("depth").iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        assert!(bits(&with) == bits(&without), "view {i}: other depths");
        assert!(fewer <= all, "view {i}: {fewer} triangles instead of {all}");
        if hid {
            (used, drawn_hiding, drawn_all) = (used + 1, drawn_hiding + fewer, drawn_all + all);
        }
    }
    (used, drawn_hiding, drawn_all)
}
