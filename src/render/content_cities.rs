//! The contents of a scene's lenses: loaded when their lenses are first seen, kept as long as these are enabled.

use std::{
    path::PathBuf,
    sync::{Arc, OnceLock},
    time::Instant,
};

use rustc_hash::FxHashSet;

use crate::{
    city::{
        CityModel, Lod,
        change::{ATTRIBUTE, Became, Between},
        derived::{Derive, derive},
        ground::plain_ground,
        load::{self, LoadOptions},
        shown::shown_geometries,
    },
    geom::{Aabb, shape::Motion},
    lens::{Class, Content, ContentSource, Lens, solids::ShownCity},
    render::{
        city::CityBuffers,
        contents::{ContentCity, WantedContent},
        displayed::Showing,
        enclosed::{Area, areas, meeting},
        moved::Moved,
        operations::ContentUse,
        placed_region::Leaf,
        standing::Placement,
        stats,
        volume::LensVolume,
    },
    scene::Drawn,
    shader::MOST_CITIES,
};

/// Cities that contents show, as loaded so far.
#[derive(Debug, Default)]
pub struct ContentCities {
    models: Vec<Loaded>,
    cities: Vec<Made>,
    /// What moves of the scene's city as contents show it, and whose it is.
    of_movers: Vec<(ContentSource, u64, Option<Arc<ContentCity>>)>,
    /// Names given so far.
    given: u64,
}

/// The city of contents.
#[derive(Debug)]
struct Made {
    source: ContentSource,
    /// Whether what moves of the scene's own city is left out.
    is_still: bool,
    city: Arc<ContentCity>,
}

/// Another data set.
#[derive(Debug)]
struct Loaded {
    files: Vec<PathBuf>,
    /// Whether it is an earlier state of the scene's city, and by which attribute objects of both are the same.
    earlier: Option<Option<String>>,
    model: Arc<CityModel>,
    /// What became of its objects.
    became: Vec<Became>,
}

impl Loaded {
    fn is_of(&self, source: &ContentSource) -> bool {
        self.files == source.files && self.earlier == source.only.as_ref().map(|only| only.key.clone())
    }
}

/// The contents of a scene in a frame.
#[derive(Clone, Debug, Default)]
pub struct SceneContents {
    /// What the GPU is to hold.
    pub wanted: Vec<WantedContent>,
    /// What its lenses show, bottom lens first.
    pub uses: Vec<ContentUse>,
    /// The other data sets among them: their objects follow the city's, in this order.
    pub models: Vec<Arc<CityModel>>,
    /// Those among the contents that are of the scene's own city.
    own: Vec<(u32, ContentSource)>,
}

/// What contents are worked out from.
pub struct Stage<'a> {
    /// The scene.
    pub drawn: &'a Drawn<'a>,
    /// Its city, and what is shown of it.
    pub model: &'a Arc<CityModel>,
    /// Its geometries that are shown.
    pub geometries: &'a [u32],
    /// Those among them that never move, where what moves is drawn beside them.
    pub still: Option<&'a [u32]>,
    /// Volumes of enabled lenses.
    pub volumes: &'a [LensVolume],
    /// From the coordinates of a lens to the model's; `None`: it is attached to what is not there.
    pub motion: &'a dyn Fn(&Lens) -> Option<Motion>,
    /// Whether a volume may be seen, from the eye or from the sun.
    pub is_seen: &'a dyn Fn(&LensVolume) -> bool,
    /// What may be loaded.
    pub reading: &'a LoadOptions,
}

impl ContentCities {
    /// Drops all of them.
    pub fn clear(&mut self) {
        self.cities.clear();
        self.models.clear();
        self.of_movers.clear();
    }

    /// The contents that a frame may show. An error names the key of the scene file.
    pub fn of_scene(&mut self, stage: &Stage) -> Result<SceneContents, String> {
        let mut found = SceneContents::default();
        let lenses = stage.drawn.scene.lenses.iter().enumerate();
        let with_content = || lenses.clone().filter_map(|(i, lens)| Some((i, lens, lens.shown()?)));
        // Numbers are those of all lenses, so that one that comes and goes changes no other.
        let mut numbers: Vec<&Content> = Vec::new();
        let mut used: Vec<ContentSource> = Vec::new();
        for (i, lens, content) in with_content() {
            let source = content.source();
            let is_same = |c: &&Content| !c.is_moved() && !content.is_moved() && c.source() == source;
            let before = numbers.iter().position(is_same);
            let number = before.unwrap_or(numbers.len()) as u32 + 1;
            if before.is_none() {
                numbers.push(content);
            }
            if number >= MOST_CITIES {
                let most = MOST_CITIES - 1;
                let i = stage.drawn.owner(i as u32);
                return Err(format!("[lens.{i}] content: the scene has more contents than one picture takes: {most}"));
            }
            if lens.enabled {
                used.push(source.clone());
            }
            let volumes: Vec<&LensVolume> = stage.volumes.iter().filter(|v| v.lens as usize == i).collect();
            let is_loaded = source.is_shown_city() || self.cities.iter().any(|made| made.source == source);
            if volumes.is_empty() || !(is_loaded || volumes.iter().any(|v| (stage.is_seen)(v))) {
                continue;
            }
            let owner = stage.drawn.owner(i as u32);
            let wrong = |(key, message): (&str, String)| format!("[lens.{owner}] content.{key}: {message}");
            let city = self.city(content, stage).map_err(wrong)?;
            let placement = placement(content, lens, &volumes, stage).map_err(wrong)?;
            let class = content.class;
            let (clip, keeps_terrain) = (content.clip, content.keeps_terrain());
            found.uses.push(ContentUse { lens: i as u32, class, city: number, clip, keeps_terrain });
            if !found.wanted.iter().any(|w| w.number == number) {
                let first_object = found.first_object(stage.model, city.as_deref());
                found.wanted.push(WantedContent { number, turn: 0, city, first_object, placement });
                found.own.extend(source.files.is_empty().then_some((number, source)));
            }
        }
        let is_still = stage.still.is_some();
        self.cities.retain(|made| used.contains(&made.source) && made.is_still == is_still);
        self.models.retain(|model| self.cities.iter().any(|made| model.is_of(&made.source)));
        self.of_movers.retain(|(source, ..)| used.contains(source));
        Ok(found)
    }

    /// The city that a content shows; `None`: the scene's own, as it is shown.
    fn city(&mut self, content: &Content, stage: &Stage) -> Result<Option<Arc<ContentCity>>, (&'static str, String)> {
        let is_own = content.files.is_empty();
        let source = content.source();
        if source.is_shown_city() {
            return Ok(None);
        }
        let own = stage.still.unwrap_or(stage.geometries);
        let is_still = stage.still.is_some();
        let is_shown = |city: &ContentCity| city.is_own && !city.is_derived() && city.geometries == own;
        if let Some(Made { city, .. }) = self.cities.iter().find(|m| m.source == source && m.is_still == is_still) {
            return Ok((!is_shown(city)).then(|| city.clone()));
        }
        let loaded = if is_own { None } else { Some(self.model(&source, stage)?) };
        let loaded = loaded.map(|place| &self.models[place]);
        let model = loaded.map_or(stage.model, |loaded| &loaded.model).clone();
        let drawn = || model.geometries.iter().filter(|g| g.triangles > 0);
        if let Some(lod) = content.lod.filter(|lod| !drawn().any(|g| g.lod == *lod)) {
            let mut all: Vec<Lod> = drawn().map(|g| g.lod).collect();
            all.sort_unstable();
            all.dedup();
            let all: Vec<String> = all.iter().map(Lod::to_string).collect();
            return Err(("lod", format!("nothing has the level of detail {lod}; there are {}", all.join(", "))));
        }
        let mut geometries = match content.lod {
            None if is_own => own.to_vec(),
            lod => shown_geometries(&model, lod),
        };
        if is_own && is_still && content.lod.is_some() {
            geometries.retain(|g| model.mover(model.geometries[*g as usize].object).is_none());
        }
        if geometries.is_empty() {
            return Err(match is_own {
                true => ("lod", "the city holds nothing that can be shown".to_owned()),
                false => ("files", format!("{} hold nothing that can be shown", named(&content.files))),
            });
        }
        if let Some((only, became)) = content.only.as_ref().zip(loaded.map(|loaded| &loaded.became)) {
            let is_of = |g: &u32| only.became.contains(&became[model.geometries[*g as usize].object as usize]);
            let is_ground = |g: &u32| model.objects[model.geometries[*g as usize].object as usize].class.is_ground();
            geometries.retain(|g| is_of(g) && !is_ground(g));
        }
        self.given += 1;
        let city = match &content.derive {
            Some(how) => derived(self.given, model, &geometries, how, is_own),
            None => {
                let wants_ground = !is_own && content.only.is_none() && stage.drawn.scene.city.ground;
                let ground = wants_ground.then(|| plain_ground(&model, &geometries)).flatten();
                ContentCity { ground, ..ContentCity::plain(self.given, model, geometries, is_own) }
            }
        };
        let city = Arc::new(city);
        self.cities.push(Made { source, is_still, city: city.clone() });
        Ok((!is_shown(&city)).then_some(city))
    }

    /// What moves of the scene's own city, as contents of that city show it: each of `moving` once more for each of them.
    pub fn moving(&mut self, contents: &SceneContents, moving: &[WantedContent]) -> Vec<WantedContent> {
        let mut found = Vec::new();
        for (number, source) in &contents.own {
            let Some(content) = contents.wanted.iter().find(|w| w.number == *number) else { continue };
            for one in moving {
                let Some(base) = &one.city else { continue };
                let Some(city) = self.mover(source, base) else { continue };
                let placement = content.placement.after(&one.placement);
                found.push(WantedContent { number: *number, city: Some(city), placement, ..*one });
            }
        }
        found
    }

    /// Something that moves as contents show it; `None`: they show nothing of it.
    fn mover(&mut self, source: &ContentSource, base: &Arc<ContentCity>) -> Option<Arc<ContentCity>> {
        if source.is_shown_city() {
            return Some(base.clone());
        }
        if let Some((.., known)) = self.of_movers.iter().find(|(of, id, _)| of == source && *id == base.id) {
            return known.clone();
        }
        let model = &base.model;
        let mover = |g: u32| model.mover(model.geometries[g as usize].object);
        let own = base.geometries.first().and_then(|g| mover(*g));
        let geometries: Vec<u32> = match source.lod {
            None => base.geometries.clone(),
            lod => shown_geometries(model, lod).into_iter().filter(|g| mover(*g) == own).collect(),
        };
        self.given += 1;
        let city = match &source.derive {
            Some(how) => ContentCity { moves: true, ..derived(self.given, model.clone(), &geometries, how, true) },
            None => ContentCity { moves: true, ..ContentCity::plain(self.given, model.clone(), geometries, true) },
        };
        let city = Some(city).filter(|city| !city.geometries.is_empty()).map(Arc::new);
        self.of_movers.push((source.clone(), base.id, city.clone()));
        city
    }

    /// The place of a data set among those that are loaded.
    fn model(&mut self, source: &ContentSource, stage: &Stage) -> Result<usize, (&'static str, String)> {
        if let Some(known) = self.models.iter().position(|known| known.is_of(source)) {
            return Ok(known);
        }
        let reading = LoadOptions { frames: stage.model.frames, ..stage.reading.of_others() };
        let model = load::load(&source.files, &reading, &load::Quiet);
        let mut model = model.map_err(|error| ("files", error.to_string()))?;
        let (changes, dating) = &stage.reading.changes;
        for change in changes {
            if let Between::Moments(moments) = change.between
                && let Err(message) = model.add_change(&change.attribute, moments, dating)
            {
                log::info!("{}: {message}", named(&source.files));
            }
        }
        let earlier = source.only.as_ref().map(|only| only.key.clone());
        let became = match &earlier {
            Some(key) => model.add_change_until(ATTRIBUTE, stage.model, key.as_deref()),
            None => Ok(Vec::new()),
        };
        let became = became.map_err(|error| ("only", error.to_string()))?;
        self.models.push(Loaded { files: source.files.clone(), earlier, model: Arc::new(model), became });
        Ok(self.models.len() - 1)
    }
}

impl SceneContents {
    /// Whether contents show something of the scene's own city elsewhere than it is.
    pub fn has_copies(&self) -> bool {
        let is_moved = |number: u32| self.wanted.iter().any(|w| w.number == number && !w.placement.is_none());
        self.own.iter().any(|(number, _)| is_moved(*number))
    }

    /// What the objects of a content's city are counted from.
    fn first_object(&mut self, own: &CityModel, city: Option<&ContentCity>) -> u32 {
        let Some(city) = city.filter(|city| !city.is_own) else { return 0 };
        let before = self.models.iter().position(|model| Arc::ptr_eq(model, &city.source));
        let count = before.unwrap_or(self.models.len());
        let first = own.objects.len() + self.models[..count].iter().map(|model| model.objects.len()).sum::<usize>();
        if before.is_none() {
            self.models.push(city.source.clone());
        }
        first as u32
    }

    /// Makes the boxes of lenses around objects hold these wherever contents show them, those of other lenses too: what belongs to a
    /// chosen object is in the lens, wherever it is.
    pub fn add_to_members(&self, volumes: &mut [LensVolume], own: ShownCity, moved: &Moved) {
        for volume in volumes.iter_mut().filter(|volume| volume.region.has_members()) {
            for leaf in volume.region.leaves_mut() {
                let Leaf::Members(members) = &mut leaf.leaf else { continue };
                let shown = self.wanted.iter().map(|content| content.bounds_of(&members.objects, own));
                // What shows none of them is nowhere, whatever is moved.
                let shown = shown.filter(|bounds| !bounds.is_empty()).map(|bounds| moved.bounds(&bounds));
                members.bounds = shown.fold(members.bounds, |all, bounds| all.union(bounds));
            }
            volume.bounds = volume.region.bounds();
        }
    }

    /// Box around what the lenses may show of it, metres; `own`: around the scene's city at rest.
    pub fn bounds(&self, own: &Aabb, volumes: &[LensVolume], moved: &Moved) -> Aabb {
        let of = |shown: &ContentUse| {
            // A border may be as wide as it likes.
            let ends = |v: &&LensVolume| v.lens == shown.lens && v.region.is_bounded() && v.border.is_none();
            let reaches = volumes.iter().filter(ends);
            let room = reaches.fold(Aabb::EMPTY, |all, v| all.union(v.bounds));
            let is_inside = shown.class == Class::Inside && !room.is_empty();
            let all = self
                .wanted
                .iter()
                .find(|w| w.number == shown.city)
                .map_or(Aabb::EMPTY, |w| moved.bounds(&w.bounds(own)));
            let part = Aabb { min: all.min.max(room.min), max: all.max.min(room.max) };
            if is_inside { part } else { all }
        };
        self.uses.iter().fold(Aabb::EMPTY, |all, shown| all.union(of(shown)))
    }

    /// What statistics say of it; `on_gpu`: the buffers of a content's city, by its name.
    pub(super) fn figures<'a>(
        &self,
        drawn: &Drawn,
        own: ShownCity,
        on_gpu: impl Fn(u64) -> Option<&'a CityBuffers>,
    ) -> Vec<stats::Content> {
        let mut counted: Vec<u64> = Vec::new();
        let figure = |w: &WantedContent| {
            let (model, shown) = w.shown(own);
            let objects = shown.iter().map(|&g| model.geometries[g as usize].object);
            let city = w.city.as_ref();
            let on_gpu = on_gpu(city.map_or(0, |city| city.id));
            let is_new = city.is_some_and(|city| !counted.contains(&city.id));
            counted.extend(city.map(|city| city.id));
            let mut lenses: Vec<u32> =
                self.uses.iter().filter(|u| u.city == w.number).map(|u| drawn.owner(u.lens)).collect();
            lenses.dedup();
            stats::Content {
                lenses,
                objects: objects.collect::<FxHashSet<_>>().len() as u64,
                first_object: city.filter(|city| !city.is_own).map(|_| w.first_object),
                triangles: on_gpu.map_or(0, |city| city.triangles),
                gpu_bytes: on_gpu.filter(|_| is_new).map_or(0, |city| city.bytes),
            }
        };
        self.wanted.iter().filter(|w| w.turn == 0).map(figure).collect()
    }

    /// The content that a lens shows.
    pub fn of_lens(&self, lens: u32) -> Option<&WantedContent> {
        let shown = self.uses.iter().find(|u| u.lens == lens)?;
        self.wanted.iter().find(|w| w.number == shown.city)
    }
}

/// The city that is made of another one's objects.
fn derived(id: u64, source: Arc<CityModel>, geometries: &[u32], how: &Derive, is_own: bool) -> ContentCity {
    let started = Instant::now();
    let made = derive(&source, geometries, how);
    let (word, count) = (how.form.row().word, made.model.geometries.len());
    log::info!("{count} geometries derived as \"{word}\" in {:.0} ms", started.elapsed().as_secs_f64() * 1e3);
    ContentCity {
        id,
        geometries: made.geometries(),
        model: Arc::new(made.model),
        source,
        heights: made.heights,
        made_of: (geometries.to_vec(), how.parts),
        footprints: OnceLock::new(),
        ground: None,
        is_own,
        moves: false,
        has_shadow: !how.form.is_pressed(),
        is_lit_as_before: how.form.is_pressed(),
        not_derived: [made.unchanged, made.left_out, made.instead],
    }
}

fn named(files: &[PathBuf]) -> String {
    files.iter().map(|f| f.display().to_string()).collect::<Vec<_>>().join(", ")
}

/// Where a content of a lens stands.
fn placement(
    content: &Content,
    lens: &Lens,
    volumes: &[&LensVolume],
    stage: &Stage,
) -> Result<Placement, (&'static str, String)> {
    if !content.is_moved() {
        return Ok(Placement::NONE);
    }
    let copied = content.copied.unwrap_or_default();
    let around = || volumes.iter().fold(Aabb::EMPTY, |all, v| all.union(v.bounds));
    let to = match copied.to {
        Some(to) => (stage.motion)(lens).unwrap_or(Motion::NONE).point(to),
        None if volumes.iter().all(|v| v.region.is_bounded()) => around().center(),
        None => return Err(("to", "is missing: a lens without end has no middle to put it to".to_owned())),
    };
    let from = copied.from.unwrap_or(to);
    let Some(transform) = &content.transform else {
        return Ok(Placement { from, to, rotation: copied.rotation, scale: copied.scale });
    };
    let own = transform.similarity(around().size()).map_err(|message| ("transform", message))?;
    let (rotation, scale) = (own.rotation * copied.rotation, own.scale * copied.scale);
    Ok(Placement { from, to: to + own.offset, rotation, scale })
}

impl WantedContent {
    /// The model that it shows, and the geometries of it; `own`: the scene's city.
    fn shown<'a>(&'a self, own: ShownCity<'a>) -> (&'a CityModel, &'a [u32]) {
        self.city.as_ref().map_or((own.model, own.geometries), |city| (&*city.model, &city.geometries[..]))
    }

    /// Box around where these objects of the scene's city stand in it, metres.
    fn bounds_of(&self, objects: &[bool], own: ShownCity) -> Aabb {
        if self.city.as_ref().is_some_and(|city| !city.is_own) {
            return Aabb::EMPTY;
        }
        let (model, geometries) = self.shown(own);
        let all = geometries.iter().map(|&g| &model.geometries[g as usize]);
        let of_objects = all.filter(|g| objects.get(g.object as usize) == Some(&true));
        self.placement.boxed(&of_objects.fold(Aabb::EMPTY, |all, g| all.union(g.bounds)))
    }

    /// Box around where it stands, metres; `own`: around the scene's city.
    pub fn bounds(&self, own: &Aabb) -> Aabb {
        let of = |city: &Arc<ContentCity>| {
            let bounds = city.geometries.iter().map(|&g| city.model.geometries[g as usize].bounds);
            let ground = city.ground.as_ref().map_or(Aabb::EMPTY, |ground| ground.bounds);
            bounds.fold(ground, Aabb::union)
        };
        self.placement.boxed(&self.city.as_ref().map_or(*own, of))
    }

    /// City objects of which a triangle, where it stands, meets one of the volumes.
    pub fn objects_meeting(&self, own: ShownCity, volumes: &[&LensVolume], moved: &Moved) -> u64 {
        let (model, geometries) = self.shown(own);
        let is_own = self.city.as_ref().is_none_or(|city| city.is_own);
        let areas = areas(volumes);
        let areas: Vec<&Area> = areas.iter().collect();
        meeting(model, geometries, &areas, &Showing::of_content(moved, &self.placement, is_own)).len() as u64
    }
}
