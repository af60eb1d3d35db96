//! What a scene is in one view: its volumes, solids, operations, contents and deformations, worked out once and in this order, from the
//! scene, the city, the eye and what stayed from the scenes before.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use crate::{
    city::{CityModel, lifetime::Lifetimes, load::LoadOptions, spatial::SpatialIndex},
    geom::Aabb,
    lens::{
        chosen::{Choice, members},
        ray::{Bend, RayLens},
        ray_path::{Chosen, MOST_CHOOSING, PictureFrame, RayPaths, Scenery},
        solids::{ShownCity, Solids},
    },
    render::{
        city_facts::CityFacts,
        content_cities::{self, ContentCities, SceneContents},
        deformations::{self, KnownDeformations, SceneDeformations},
        displayed::{LastDisplayed, Stands},
        epochs::{Epochs, KnownLifetimes, LensPlaces, MetLenses},
        fields::{KnownFields, PlacedFields},
        footprints::{self, OwnFootprints},
        hiding::{convex, rounded},
        lens_volumes::{LensVolumes, Tools, volumes_of},
        light::{LEAST_SHADOW_SIZE, casts_shadows, occludes_sky, to_sun},
        moved::Moved,
        moving::{Moving, MovingObjects},
        occlusion::Occlusion,
        operations::{Beside, LensTables, MOST_FILTERS, Operations, SceneTime},
        parts::whole,
        placed_region::{Leaf, Members},
        placement::Eye,
        ray_fields::RayMasks,
        regions,
        sights::sights,
        solids::SolidTable,
        sun_eye::MapSize,
        volume::LensVolume,
    },
    scene::{Drawn, Scene, Sun, SunTime, Technique, Transparency},
    shader::{Bends, MOST_RAY_LENSES, MOST_SLOTS, MOST_VOLUMES, effect::AskedBy},
    time::Moment,
    view::{Camera, CameraError, View},
};

/// Why a scene cannot be resolved.
#[derive(Debug)]
pub(super) enum ResolveError {
    /// The camera.
    Camera(CameraError),
    /// Something a scene says that the city cannot answer.
    Scene(String),
}

impl From<CameraError> for ResolveError {
    fn from(error: CameraError) -> Self {
        Self::Camera(error)
    }
}

/// What stays from scene to scene.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// Solids of lenses made so far, and as the GPU reads them.
    pub solids: Solids,
    pub solid_table: Arc<SolidTable>,
    /// What occlusion lenses found last.
    pub occlusion: Occlusion,
    /// Contents of lenses loaded so far.
    pub contents: ContentCities,
    pub deformations: KnownDeformations,
    /// Outlines of lenses that bend rays, by their images.
    pub ray_masks: RayMasks,
    /// Fields loaded so far.
    pub fields: KnownFields,
    /// The city where they last showed it.
    pub displayed: LastDisplayed,
}

/// What scenes are resolved in.
pub(super) struct Surroundings<'a> {
    /// The city where it stands, and what is shown of it.
    pub city: ShownCity<'a>,
    /// The same as its file has it.
    pub model: &'a Arc<CityModel>,
    /// What is drawn of it; `None`: nothing yet.
    pub facts: Option<CityFacts<'a>>,
    /// What its objects cover of the ground, once an effect asks for it.
    pub footprints: &'a OwnFootprints,
    /// How contents of lenses are loaded.
    pub reading: &'a LoadOptions,
    /// When objects of cities are there.
    pub lifetimes: &'a KnownLifetimes,
    /// What moves of the city.
    pub moving: &'a MovingObjects,
    /// Whether that is drawn beside the rest of the city whatever shows.
    pub is_still: bool,
}

/// What a scene is in one view.
pub(super) struct Resolved {
    pub view: View,
    pub volumes: Vec<LensVolume>,
    pub solids: Arc<SolidTable>,
    pub operations: Operations,
    pub contents: SceneContents,
    pub deformations: SceneDeformations,
    /// How lenses bend rays.
    pub rays: RayPaths,
    /// Fields that stand in the city.
    pub fields: PlacedFields,
    /// Suns of several moments, the scene's own first, each with what the operations are in its frame; empty: there is one.
    pub suns: Vec<(Sun, Operations)>,
}

/// Who sees a scene, and through what.
struct SeenBy<'a> {
    eye: &'a Eye,
    /// Its picture.
    frame: &'a PictureFrame,
    /// The lenses that bend its rays.
    rays: &'a RayPaths,
    /// The fields that stand in the city.
    fields: &'a PlacedFields,
}

impl Surroundings<'_> {
    /// Box around what is drawn of the city, metres.
    fn bounds(&self) -> Aabb {
        self.facts.as_ref().map_or(Aabb::EMPTY, |facts| facts.bounds)
    }

    /// The same with the plain ground around it, metres.
    fn reach(&self) -> Aabb {
        self.facts.as_ref().map_or(Aabb::EMPTY, |facts| facts.reach)
    }

    /// What a scene is in a picture of this size and so many samples, seen by `camera`.
    pub fn resolve(
        &self,
        drawn: &Drawn,
        camera: &Camera,
        size: [u32; 2],
        samples: u32,
        known: &mut Known,
    ) -> Result<Resolved, ResolveError> {
        let scene = &*drawn.scene;
        let deformations = self.deformations(scene, camera, known)?;
        let eye = Eye::new(camera)?;
        let frame = PictureFrame::new(camera, size);
        let rays = self.rays(scene, &View::new(*camera, size, &self.reach())?, &mut known.ray_masks)?;
        let epochs = Epochs::new(scene).map_err(ResolveError::Scene)?;
        let mut fields = known.fields.of_scene(&scene.volumes, &epochs).map_err(ResolveError::Scene)?;
        let seen_by = SeenBy { eye: &eye, frame: &frame, rays: &rays, fields: &fields };
        let mut found = self.placed(drawn, &seen_by, &deformations.moved, known)?;
        let technique = scene.style.technique;
        if let Some(problem) = technique.refuses(scene).or_else(|| regions::refused(scene, &found.volumes)) {
            return Err(ResolveError::Scene(problem.to_string()));
        }
        regions::set_tests(technique, &mut found.volumes);
        known.solid_table = found.place_solids(&known.solid_table).map_err(ResolveError::Scene)?;
        let LensVolumes { mut volumes, tests } = found;
        let view = View::new(*camera, size, &self.reach())?;
        let contents = self.contents(drawn, &eye, &view, samples, &volumes, known)?;
        contents.add_to_members(&mut volumes, self.city, &deformations.moved);
        let sights = self.sights(scene, &eye, &deformations.moved, known);
        // What is moved may be anywhere.
        let seen = deformations.moved.is_nothing().then_some(&view);
        let placed = LensVolumes { volumes, tests };
        let (mut operations, mut moving) = self.operations(scene, &placed, &contents, sights, seen, fields.vary())?;
        let mut volumes = placed.volumes;
        let mut contents = contents;
        let shown = known.contents.moving(&contents, &moving.wanted);
        moving.bounds = shown.iter().fold(moving.bounds, |all, one| all.union(one.bounds(&Aabb::EMPTY)));
        contents.wanted.extend(moving.wanted);
        contents.wanted.extend(shown);
        add_members(&mut operations, &mut volumes, &self.models(&contents));
        fields.first_object = self.models(&contents).iter().map(|model| model.objects.len() as u32).sum();
        check_counts(&operations, &volumes)?;
        let (own, moved) = (self.reach(), &deformations.moved);
        let all = moved.bounds(&own).union(contents.bounds(&own, &volumes, moved)).union(moving.bounds);
        let all = all.union(fields.bounds());
        let mut view = View::new(*camera, size, &all)?;
        let solids = known.solid_table.clone();
        let mut rays = rays;
        let choosing = self.choose(scene, &mut rays, &mut operations, &self.models(&contents))?;
        refuse_with(scene, !rays.is_empty(), "lenses that bend rays")?;
        refuse_with(scene, !fields.is_empty(), "volumes")?;
        view.looks_around = rays.looks_around();
        if view.looks_around && view.is_orthographic() {
            // Its depths are distances from the eye.
            let farthest = all.corners().map(|corner| corner.distance(camera.eye)).into_iter().fold(0.0, f64::max);
            view.far_m = view.far_m.max(1.001 * farthest + 1.0);
        }
        operations.bend_rays(Bends {
            images: rays.images.len() as u32,
            planes: rays.planes.len() as u32,
            grids: rays.rims().any(|rim| rim.grid.is_some()),
            fields: rays.rims().any(|rim| rim.field.is_some()),
            choosing,
            own: rays.own_handlers(),
        });
        if !fields.is_empty() {
            operations.add_fields();
        }
        Ok(Resolved { view, volumes, solids, operations, contents, deformations, rays, fields, suns: Vec::new() })
    }

    /// Marks the objects that lenses which bend rays act on, where they do not act on all; how many such lenses there are.
    fn choose(
        &self,
        scene: &Scene,
        rays: &mut RayPaths,
        operations: &mut Operations,
        models: &[&CityModel],
    ) -> Result<u32, ResolveError> {
        let count = models.iter().map(|model| model.objects.len()).sum();
        let mut choosing = 0;
        for (number, rim) in rays.rims_mut() {
            let only = scene.lenses.get(number as usize).and_then(|lens| lens.ray()?.only.as_ref());
            if let Some(only) = only {
                let objects: Arc<[bool]> = members(self.city.model, only).into();
                let fields = [false; crate::scene::volume::MOST_VOLUMES];
                let members = Members { objects: Arc::clone(&objects), thresholds: None, fields, bounds: Aabb::EMPTY };
                rim.only = Some(Chosen { first: operations.add_members(&members, count), objects });
                choosing += 1;
            }
        }
        match choosing as usize > MOST_CHOOSING {
            true => Err(ResolveError::Scene(format!(
                "{choosing} lenses that bend rays act on some objects alone (ray.only); one picture takes {MOST_CHOOSING}"
            ))),
            false => Ok(choosing),
        }
    }

    /// The lenses that bend rays.
    fn rays(&self, scene: &Scene, view: &View, masks: &mut RayMasks) -> Result<RayPaths, ResolveError> {
        let enabled = (0..).zip(&scene.lenses).filter(|(_, lens)| lens.enabled);
        let lenses: Vec<(u32, &RayLens, [f32; 3])> =
            enabled.filter_map(|(i, lens)| Some((i, lens.ray()?, lens.color))).collect();
        if lenses.len() > MOST_RAY_LENSES {
            return Err(ResolveError::Scene(format!(
                "{} lenses bend rays; one picture takes {MOST_RAY_LENSES}",
                lenses.len()
            )));
        }
        for file in lenses.iter().filter_map(|(_, ray, _)| ray.mask.as_deref()) {
            masks.load(file).map_err(|error| ResolveError::Scene(format!("ray: mask: {error}")))?;
        }
        for (number, ray, _) in &lenses {
            if let Bend::Own(used) = &ray.bend {
                let wrong = |message| ResolveError::Scene(format!("lens {number}: ray.bend: {message}"));
                used.definition(AskedBy::Rays).map_err(wrong)?;
            }
        }
        let frame = PictureFrame::new(&view.camera, view.size);
        let half = frame.half;
        let shown = |across: DVec2| {
            let size = DVec2::new(view.size[0].into(), view.size[1].into());
            let pixel = DVec2::new(0.5 + 0.5 * across.x / half.x, 0.5 - 0.5 * across.y / half.y) * size;
            let index = self.city.index.get_or_init(|| SpatialIndex::build(self.city.model, self.city.geometries));
            Some(index.hit(self.city.model, &view.ray(pixel))?.t)
        };
        let feature = |choice: &Choice| self.triangles_of(choice, view);
        Ok(RayPaths::new(&lenses, &frame, &Scenery { shown: &shown, mask: &|file| masks.get(file), feature: &feature }))
    }

    /// The triangles of the objects that are shown and that a choice means, view space.
    fn triangles_of(&self, choice: &Choice, view: &View) -> Vec<[DVec3; 3]> {
        let model = self.city.model;
        let members = members(model, choice);
        let to_view = view.basis.view_from_world();
        let geometries = self.city.geometries.iter().map(|&g| &model.geometries[g as usize]);
        let tiles = geometries.filter(|g| members.get(g.object as usize) == Some(&true)).flat_map(|g| g.tiles.clone());
        let of_tile = |t: u32| {
            let tile = &model.tiles[t as usize];
            let indices = &model.indices[tile.indices.start as usize..tile.indices.end as usize];
            let corner = move |i: u32| to_view * (model.position(tile, tile.vertices.start + i) - view.camera.eye);
            indices.chunks_exact(3).map(move |corners| [corner(corners[0]), corner(corners[1]), corner(corners[2])])
        };
        tiles.flat_map(of_tile).collect()
    }

    /// The volumes of a scene's enabled lenses.
    pub fn volumes(
        &self,
        drawn: &Drawn,
        camera: &Camera,
        size: [u32; 2],
        known: &mut Known,
    ) -> Result<Vec<LensVolume>, ResolveError> {
        let moved = self.deformations(&drawn.scene, camera, known)?.moved;
        let view = View::new(*camera, size, &self.reach())?;
        let rays = self.rays(&drawn.scene, &view, &mut known.ray_masks)?;
        let (eye, frame) = (Eye::new(camera)?, PictureFrame::new(camera, size));
        let epochs = Epochs::new(&drawn.scene).map_err(ResolveError::Scene)?;
        let fields = known.fields.of_scene(&drawn.scene.volumes, &epochs).map_err(ResolveError::Scene)?;
        let seen_by = SeenBy { eye: &eye, frame: &frame, rays: &rays, fields: &fields };
        Ok(self.placed(drawn, &seen_by, &moved, known)?.volumes)
    }

    fn placed(
        &self,
        drawn: &Drawn,
        seen_by: &SeenBy,
        moved: &Moved,
        known: &mut Known,
    ) -> Result<LensVolumes, ResolveError> {
        let SeenBy { eye, frame, rays, fields } = *seen_by;
        let pois = &drawn.scene.pois;
        let stands = Stands::of_scene(&drawn.scene, self.city, pois, moved, &mut known.displayed);
        let mut tools = Tools {
            city: self.city,
            stands: &stands,
            stand: stands.shown(),
            at_rest: false,
            solids: &mut known.solids,
            occlusion: &mut known.occlusion,
            viewer: eye.viewer(),
            frame: *frame,
            camera: eye.own_motion(),
            rays,
            fields,
            names: drawn.scene.lenses.iter().map(|lens| lens.name.as_str()).collect(),
            moved,
            lens: "",
            is_enabled: true,
        };
        volumes_of(drawn, eye, &mut tools).map_err(ResolveError::Scene)
    }

    /// What the scene's lenses move.
    pub fn deformations(
        &self,
        scene: &Scene,
        camera: &Camera,
        known: &mut Known,
    ) -> Result<SceneDeformations, ResolveError> {
        known.occlusion.set_gone(self.gone(scene)?);
        if scene.lenses.iter().all(|lens| lens.deform().is_none()) {
            return Ok(SceneDeformations::default());
        }
        let mut stage = deformations::Stage {
            scene,
            model: self.city.model,
            file: self.model,
            bounds: self.bounds(),
            camera: *camera,
            eye: &Eye::new(camera)?,
            city: self.city,
            occlusion: &mut known.occlusion,
        };
        let found = known.deformations.of_scene(&mut stage).map_err(ResolveError::Scene)?;
        let count = found.moved.deformers.0.len();
        match count <= MOST_DEFORMERS {
            true => Ok(found),
            false => Err(ResolveError::Scene(format!(
                "{count} deformation lenses move the city; one picture takes {MOST_DEFORMERS}, as each is a part of its program"
            ))),
        }
    }

    /// What lenses show in themselves, in a picture of so many samples.
    fn contents(
        &self,
        drawn: &Drawn,
        eye: &Eye,
        view: &View,
        samples: u32,
        volumes: &[LensVolume],
        known: &mut Known,
    ) -> Result<SceneContents, ResolveError> {
        let scene = &*drawn.scene;
        if scene.lenses.iter().all(|lens| lens.shown().is_none()) {
            known.contents.clear();
            return Ok(SceneContents::default());
        }
        // What is out of the picture may hide the sky from what is in it.
        let sees_sky = occludes_sky(&scene.sun, samples);
        // The coarsest map looks farthest beyond its edge.
        let map = |facts: &CityFacts| {
            let direction = to_sun(&scene.sun);
            let size = MapSize { most: LEAST_SHADOW_SIZE, texel_px: 0.0, towards: direction };
            facts.light_eye(view, direction, &size, |_| (Vec::new(), Aabb::EMPTY))
        };
        let sun = self.facts.as_ref().filter(|_| casts_shadows(&scene.sun)).and_then(map);
        let sun = sun.map(|sun| sun.widest().frustum(1.0));
        let bends = scene.lenses.iter().any(|lens| lens.enabled && lens.ray().is_some());
        let stage = content_cities::Stage {
            drawn,
            model: self.model,
            geometries: self.city.geometries,
            still: self.shows_moving(scene)?.then(|| self.moving.still()),
            volumes,
            motion: &|lens| eye.motion(lens, scene, self.city.model),
            is_seen: &|volume| {
                if bends {
                    return true;
                }
                let is_in_sun = sees_sky || sun.as_ref().is_some_and(|frustum| frustum.meets(&volume.bounds));
                is_in_sun || volume.seen_part(view, whole(view.size)).is_some()
            },
            reading: self.reading,
        };
        known.contents.of_scene(&stage).map_err(ResolveError::Scene)
    }

    /// The models of the city and of contents.
    fn models<'m>(&'m self, contents: &'m SceneContents) -> Vec<&'m CityModel> {
        std::iter::once(self.model).chain(&contents.models).map(|m| &**m).collect()
    }

    /// What effects know of where points of interest are in the picture.
    fn sights(&self, scene: &Scene, eye: &Eye, moved: &Moved, known: &mut Known) -> Vec<Vec<u32>> {
        let stands = Stands::of_scene(scene, self.city, &scene.pois, moved, &mut known.displayed);
        sights(scene, &stands, eye, &mut known.occlusion)
    }

    fn operations(
        &self,
        scene: &Scene,
        placed: &LensVolumes,
        contents: &SceneContents,
        sights: Vec<Vec<u32>>,
        seen: Option<&View>,
        fields_vary: bool,
    ) -> Result<(Operations, Moving), ResolveError> {
        let volumes = &placed.volumes;
        let mut present = vec![false; scene.lenses.len()];
        for volume in volumes {
            present[volume.lens as usize] = true;
        }
        let footprints = footprints::tables(scene, self.city, self.footprints, contents, volumes);
        let (style, tables) = (&scene.style, LensTables { sights, footprints });
        let models = self.models(contents);
        let mut time = self.time(scene, contents)?;
        let places = places_of(&time.epochs, volumes, seen);
        time.met = self.met(&places, seen);
        let own = time.lifetimes.first().map(|own| &**own);
        let moving = match time.moves {
            true => self
                .moving
                .at(self.model, &time.epochs, &places, own, contents.has_copies())
                .map_err(ResolveError::Scene)?,
            false => Moving { bounds: Aabb::EMPTY, ..Moving::default() },
        };
        time.moving.clone_from(&moving.moments);
        time.fields_vary = fields_vary;
        time.suns = suns(scene, &time.epochs, &places).map_err(ResolveError::Scene)?;
        let beside = Beside { tables: &tables, time: &time, point_px: scene.figure.point_px() };
        let made = Operations::new(&style.effects, &scene.lenses, &present, placed.tests.clone(), &models, &beside);
        let mut operations = made.map_err(|error| ResolveError::Scene(error.to_string()))?;
        operations.contents.clone_from(&contents.uses);
        Ok((operations, moving))
    }
}

impl Surroundings<'_> {
    /// The objects that are not there at any moment of the scene; `None`: all are.
    fn gone(&self, scene: &Scene) -> Result<Option<Arc<[bool]>>, ResolveError> {
        let moments = Epochs::new(scene).map_err(ResolveError::Scene)?.own;
        if moments.iter().all(|(moment, _)| moment.is_none()) {
            return Ok(None);
        }
        let lifetimes = self.lifetimes.of(self.model, &scene.city.dating).map_err(ResolveError::Scene)?;
        Ok(Some(
            lifetimes.of.iter().map(|lifetime| !moments.iter().any(|(moment, _)| lifetime.holds(*moment))).collect(),
        ))
    }

    /// Which lenses, by their places, may hold some of which objects, or hold all of them, as they stand in a view; without one any may hold any.
    fn met(&self, places: &[LensPlaces], view: Option<&View>) -> MetLenses {
        let objects = view.filter(|_| !places.is_empty()).map(|_| self.object_boxes());
        MetLenses::new(objects.as_deref(), places)
    }

    /// The box around what is shown of each object, metres; empty without any.
    fn object_boxes(&self) -> Vec<Aabb> {
        let mut boxes = vec![Aabb::EMPTY; self.model.objects.len()];
        for geometry in self.city.geometries.iter().map(|&g| &self.model.geometries[g as usize]) {
            let own = &mut boxes[geometry.object as usize];
            *own = own.union(geometry.bounds);
        }
        // What moves may be anywhere.
        for object in self.moving.objects() {
            boxes[object as usize] = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        }
        boxes
    }

    /// Whether what moves is drawn beside the rest of the city.
    fn moves(&self, epochs: &Epochs) -> bool {
        !self.moving.is_empty() && (epochs.is_any() || self.is_still)
    }

    /// The same of a scene.
    fn shows_moving(&self, scene: &Scene) -> Result<bool, ResolveError> {
        Ok(!self.moving.is_empty() && self.moves(&Epochs::new(scene).map_err(ResolveError::Scene)?))
    }

    /// Which moments show, and when objects are there.
    fn time(&self, scene: &Scene, contents: &SceneContents) -> Result<SceneTime, ResolveError> {
        let epochs = Epochs::new(scene).map_err(ResolveError::Scene)?;
        let moves = self.moves(&epochs);
        if !epochs.is_any() && !moves {
            return Ok(SceneTime::default());
        }
        let dating = &scene.city.dating;
        let own = self.lifetimes.of(self.model, dating).map_err(ResolveError::Scene)?;
        // Data sets that lenses show may have other attributes, or none.
        let of_content = |model: &Arc<CityModel>| {
            self.lifetimes.of(model, dating).unwrap_or_else(|_| Arc::new(Lifetimes::undated(model)))
        };
        let lifetimes = std::iter::once(own).chain(contents.models.iter().map(of_content)).collect();
        Ok(SceneTime { epochs, lifetimes, moves, ..SceneTime::default() })
    }
}

/// Suns of different moments in one picture, at most: each takes a frame.
const MOST_SUNS: usize = 8;

/// The moments whose suns shine somewhere, the scene's own first; none where one sun is everywhere.
fn suns(scene: &Scene, epochs: &Epochs, places: &[LensPlaces]) -> Result<Vec<Option<Moment>>, String> {
    let own = epochs.own.first().and_then(|(moment, _)| *moment);
    if !scene.sun.in_lenses || scene.sun.when != SunTime::Scene || places.is_empty() {
        return Ok(Vec::new());
    }
    let too_many = || {
        format!("[sun] in_lenses: lenses show more than {MOST_SUNS} moments; fewer would be right, or one sun for all")
    };
    let anywhere = MetLenses::new(None, places);
    let all = epochs.moments_of(anywhere.of(0)).filter(|all| all.len() <= MOST_SUNS).ok_or_else(too_many)?;
    let others = all.into_iter().filter(|moment| *moment != own);
    let suns: Vec<Option<Moment>> = std::iter::once(own).chain(others).collect();
    Ok(if suns.len() > 1 { suns } else { Vec::new() })
}

/// Where the lenses with time operators are in a view, ascending; without one they may be anywhere.
fn places_of(epochs: &Epochs, volumes: &[LensVolume], view: Option<&View>) -> Vec<LensPlaces> {
    let own = |lens: u32| volumes.iter().filter(move |volume| volume.lens == lens);
    let boxes_of = |lens: u32| -> Option<Vec<Aabb>> {
        let bounds = |volume: &LensVolume| {
            let is_bounded = volume.region.is_bounded() && !volume.everywhere;
            let view = view.filter(|_| is_bounded)?;
            let bounds = volume.bounds_of_border(view);
            let farthest = bounds.center().distance(view.camera.eye) + 0.5 * bounds.size().length();
            // As far as places of fragments are rounded.
            let off = rounded(farthest);
            Some(Aabb { min: bounds.min - off, max: bounds.max + off })
        };
        own(lens).map(bounds).collect()
    };
    let places_of = |lens: u32| {
        let is_plain = |volume: &&LensVolume| volume.border.is_none() && !volume.everywhere;
        let convex = own(lens).filter(is_plain).filter_map(convex).cloned().collect();
        LensPlaces { around: boxes_of(lens), convex, eye: view.map_or(DVec3::ZERO, |view| view.camera.eye) }
    };
    epochs.lenses().into_iter().map(places_of).collect()
}

/// Puts the objects that lenses mean among the object values.
fn add_members(operations: &mut Operations, volumes: &mut [LensVolume], models: &[&CityModel]) {
    let objects = models.iter().map(|model| model.objects.len()).sum();
    for volume in volumes {
        for leaf in volume.region.leaves_mut() {
            if let Leaf::Members(members) = &leaf.leaf {
                leaf.place.first = operations.add_members(members, objects);
            }
        }
    }
}

/// Refuses ways of drawing that do not know what a scene has.
fn refuse_with(scene: &Scene, has_them: bool, what: &str) -> Result<(), ResolveError> {
    let refused = |key: &str, right: &str| {
        let message = format!("[style] {key}: does not go with {what}; \"{right}\" would be right");
        Err(ResolveError::Scene(message))
    };
    match has_them {
        false => Ok(()),
        true if scene.style.technique != Technique::Accumulate => refused("technique", "accumulate"),
        true if scene.style.transparency != Transparency::Exact => refused("transparency", "exact"),
        true => Ok(()),
    }
}

/// Refuses what is too much for one picture.
/// Deformation lenses of a picture: what they do is written into its program, one after the other, and made by the driver. With so many the
/// software adapter of two cores makes it in some 20 s.
const MOST_DEFORMERS: usize = 64;

fn check_counts(operations: &Operations, volumes: &[LensVolume]) -> Result<(), ResolveError> {
    let all: Vec<u32> = volumes.iter().map(|v| v.lens).collect();
    let counts = [
        ("volumes", volumes.len(), MOST_VOLUMES as usize),
        ("parameters of effects and outlines, in fours,", operations.parameters.len(), MOST_SLOTS as usize),
        ("different neighbourhood filters", operations.filters(&all, &[], false).len(), MOST_FILTERS),
    ];
    match counts.into_iter().find(|(_, count, most)| count > most) {
        Some((what, count, most)) => {
            let message = format!("the lenses have {count} {what} together; one picture takes {most}");
            Err(ResolveError::Scene(message))
        }
        None => Ok(()),
    }
}
