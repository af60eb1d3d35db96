//! The lens volumes of a scene: its focus areas, resolved.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    city::{CityModel, derived::Derive},
    geom::{
        Aabb, Solid, Volume,
        combination::{Operation, Tree},
        shape::{Motion, Sphere},
    },
    lens::{
        BorderUnit, Class, Lens, LensBody, LensSprite, OwnRegion, Region,
        chosen::members,
        ray_path::{PictureFrame, RayPaths},
        rendering::When,
        solids::{Place, RegionError, ShownCity, Solids},
    },
    render::{
        displayed::{Showing, Stand, Stands, looks_at_rest},
        enclosed::{Held, enclosed},
        fields::PlacedFields,
        moved::Moved,
        occlusion::{Occlusion, Search},
        operations::AllTests,
        own_sprites,
        placed_region::{Leaf, Members, PlacedLeaf, PlacedRegion, too_large},
        placement::Eye,
        solids::{MOST_ENTRIES, SolidTable},
        volume::LensVolume,
    },
    scene::{Drawn, volume::MOST_VOLUMES},
    view::CameraError,
    visibility::Viewer,
};

/// The volumes of a scene's enabled lenses, and how the volumes of all its lenses may be tested.
#[derive(Debug, Default)]
pub struct LensVolumes {
    /// Bottom lens first.
    pub volumes: Vec<LensVolume>,
    /// How they may be tested.
    pub tests: AllTests,
}

/// What focus areas are made with.
pub(super) struct Tools<'a> {
    /// The city at rest.
    pub city: ShownCity<'a>,
    /// It at rest and where it is shown.
    pub stands: &'a Stands<'a>,
    /// Where the lens looks for occluders.
    pub stand: Stand<'a>,
    /// Whether it holds objects by where they are at rest.
    pub at_rest: bool,
    /// Solids made so far.
    pub solids: &'a mut Solids,
    /// Occluders that lenses found.
    pub occlusion: &'a mut Occlusion,
    /// From where.
    pub viewer: Viewer,
    /// Its picture.
    pub frame: PictureFrame,
    /// From its coordinates to the model's.
    pub camera: Motion,
    /// The lenses that bend its rays, and the names of the scene's lenses.
    pub rays: &'a RayPaths,
    /// See `rays`.
    pub names: Vec<&'a str>,
    /// The fields that stand in the city.
    pub fields: &'a PlacedFields,
    /// How the city is shown.
    pub moved: &'a Moved,
    /// The name of the lens.
    pub lens: &'a str,
    /// Whether it acts: of one that does not nobody is looked for.
    pub is_enabled: bool,
}

/// Resolves the focus areas of a scene. An error names the key of the scene file.
pub(super) fn volumes_of<'a>(drawn: &'a Drawn, eye: &Eye, tools: &mut Tools<'a>) -> Result<LensVolumes, String> {
    let (mut all, scene, city) = (LensVolumes::default(), &*drawn.scene, tools.city);
    for (i, lens) in scene.lenses.iter().enumerate() {
        (tools.lens, tools.is_enabled) = (&lens.name, lens.enabled);
        (tools.stand, tools.at_rest) = (tools.stands.of_lens(lens), looks_at_rest(lens));
        // Attached to what is not there, it acts nowhere.
        let motion = eye.motion(lens, scene, city.model);
        let place = Place { motion: motion.unwrap_or(Motion::NONE), sight: eye.sight() };
        let mut of_lens: Vec<PlacedRegion> = Vec::new();
        let of_rays = lens.ray().and_then(|ray| tools.frame.figure(ray)).map(Region::Shape);
        for (j, region) in of_rays.iter().chain(&lens.shapes).enumerate() {
            match regions_of(region, &place, tools) {
                Ok(mut placed) => {
                    let fades = lens.soft_border().is_some() && !ends_along_rays(lens);
                    if fades || has_surface(lens.drawn_body()) {
                        let leaves = placed.iter_mut().flat_map(PlacedRegion::leaves_mut);
                        leaves.for_each(|leaf| tell_distance(&mut leaf.leaf, tools.solids));
                    }
                    of_lens.extend(placed);
                }
                Err(_) if !lens.enabled => {}
                Err((key, message)) => {
                    // The shape of an occlusion lens is intersected with its occluders, which have no key.
                    let key = if region.occluders().is_some() { key.trim_start_matches("shapes.1.") } else { &key };
                    let place = if lens.shapes.len() == 1 { "shape".to_owned() } else { format!("shapes.{j}") };
                    let dot = if key.is_empty() { "" } else { "." };
                    return Err(format!("[lens.{}] {place}{dot}{key}: {message}", drawn.owner(i as u32)));
                }
            }
        }
        for leaf in of_lens.iter_mut().flat_map(PlacedRegion::leaves_mut) {
            move_leaf(&mut leaf.leaf, lens, tools)
                .map_err(|message| format!("[lens.{}] space: {message}", drawn.owner(i as u32)))?;
        }
        of_lens.retain(|region| !region.is_empty());
        // One sprite for all of a lens.
        let has_own = of_lens.iter().flat_map(PlacedRegion::leaves).any(|leaf| matches!(leaf.leaf, Leaf::Own(_)));
        if lens.sprite.is_some() && has_own {
            let message = "a region of your own is tested by its function, not by a depth sprite";
            return Err(format!("[lens.{}] sprite: {message}", drawn.owner(i as u32)));
        }
        if lens.sprite.is_some() {
            // Those of files stay as they are.
            let (mut saved, others): (Vec<PlacedRegion>, _) =
                of_lens.into_iter().partition(|region| region.saved().is_some());
            saved.extend(PlacedRegion::union(&others).map_or(others, |union| vec![union]));
            of_lens = saved;
        }
        for mut region in of_lens {
            if let Some(content) = lens.shown() {
                region.leaves_mut().for_each(|leaf| in_all_levels(&mut leaf.leaf, city, content.derive.as_ref()));
            }
            let volume = volume_of(i as u32, lens, region, &place.motion, scene.figure.point_px())
                .map_err(|message| format!("[lens.{}] sprite.camera: {message}", drawn.owner(i as u32)))?;
            let [picture, sun] = volume.tests();
            all.tests.picture.extend(picture);
            all.tests.sun.extend(sun);
            all.tests.leaves.extend(volume.region.forms_in_combination());
            // A lens without volume shows nothing and costs nothing.
            if lens.enabled && motion.is_some() && !volume.region.is_empty() {
                all.volumes.push(volume);
            }
        }
    }
    tools.solids.forget_others();
    tools.occlusion.forget_others();
    Ok(all)
}

/// Puts what a lens acts on where deformations take it: the box around objects, and, of a lens of the city at rest, its volumes.
fn move_leaf(leaf: &mut Leaf, lens: &Lens, tools: &mut Tools) -> Result<(), String> {
    if tools.moved.is_nothing() {
        return Ok(());
    }
    match leaf {
        Leaf::Members(members) => members.bounds = tools.moved.bounds(&members.bounds),
        Leaf::Volume(volume) if lens.at_rest && lens.deform().is_none() => {
            match tools.solids.moved(volume, &tools.moved.deformers)? {
                Some(placed) => *volume = Volume::Solid(placed),
                None => *volume = Volume::Sphere(Sphere { center: volume.bounds().center(), radius: 0.0 }),
            }
        }
        Leaf::Sprite(_) if lens.at_rest => {
            return Err("a saved sprite stands where it is; \"displayed\" would be right".into());
        }
        Leaf::Own(_) if lens.at_rest => {
            return Err("a region of your own stands where it is; \"displayed\" would be right".into());
        }
        Leaf::Volume(_) | Leaf::Sprite(_) | Leaf::Own(_) => {}
    }
    Ok(())
}

/// Makes a polytope a solid, which knows how far away it is.
fn tell_distance(leaf: &mut Leaf, solids: &mut Solids) {
    let Leaf::Volume(volume) = leaf else { return };
    if let Volume::Convex(hull) = volume
        && let Some(placed) = solids.of_hull(hull)
    {
        *volume = Volume::Solid(placed);
    }
}

fn volume_of(
    number: u32,
    lens: &Lens,
    region: PlacedRegion,
    motion: &Motion,
    point_px: f64,
) -> Result<LensVolume, CameraError> {
    let sprite = lens.sprite.map(|sprite| LensSprite { own: sprite.own.map(|own| own.moved(motion)), ..sprite });
    let mut volume = LensVolume {
        lens: number,
        bounds: region.bounds(),
        region,
        everywhere: lens.classes().any(|class| class == Class::Rest),
        drawn: lens.drawn_body(),
        point_px,
        sprite,
        asks_sides: lens.classes().any(|class| class != Class::Inside) || ends_along_rays(lens),
        border: lens.soft_border(),
        keeps_shadows: lens.keeps_shadows,
        section: lens.section,
    };
    volume.bounds = own_sprites::bounds(&volume)?;
    Ok(volume)
}

/// Whether it asks where rays enter and leave it.
fn ends_along_rays(lens: &Lens) -> bool {
    lens.soft_border().is_some_and(|border| border.unit == BorderUnit::Ray)
}

/// Makes the box around chosen objects hold all that a content may show of them: other levels of detail, and what is derived.
fn in_all_levels(leaf: &mut Leaf, city: ShownCity, derive: Option<&Derive>) {
    if let Leaf::Members(members) = leaf {
        let all = city.model.geometries.iter().filter(|g| members.objects[g.object as usize]);
        members.bounds = all.fold(members.bounds, |bounds, g| bounds.union(g.bounds));
        if let Some(how) = derive {
            let chosen = (0..members.objects.len() as u32).filter(|&object| members.objects[object as usize]);
            let reach = |object| how.form.reach(&family_bounds(city.model, object));
            members.bounds = chosen.fold(members.bounds, |bounds, object| bounds.union(reach(object)));
        }
    }
}

/// As [`CityModel::family_bounds`], and quick where families are small: it is asked in every frame.
fn family_bounds(model: &CityModel, object: u32) -> Aabb {
    let children = &model.objects[object as usize].children;
    if children.iter().any(|&child| !model.objects[child as usize].children.is_empty()) {
        return model.family_bounds(object);
    }
    let own = std::iter::once(object).chain(children.iter().copied());
    let geometries = own.flat_map(|member| model.objects[member as usize].geometries.clone());
    geometries.fold(Aabb::EMPTY, |all, geometry| all.union(model.geometries[geometry as usize].bounds))
}

/// The placed regions whose union a focus area is.
fn regions_of(region: &Region, place: &Place, tools: &mut Tools) -> Result<Vec<PlacedRegion>, RegionError> {
    if !matches!(region, Region::Combined { .. }) {
        return Ok(leaves_of(region, place, tools)?.into_iter().map(|leaf| PlacedRegion::One(leaf.into())).collect());
    }
    let program = tree_of(region, place, tools)?.program();
    if let Some((what, count, most)) = too_large(&program) {
        return Err(("shapes".into(), format!("a combination may have at most {most} {what}, has {count}")));
    }
    Ok(match program.len() {
        0 => Vec::new(),
        1 => program.into_iter().map(|(leaf, _)| PlacedRegion::One(leaf)).collect(),
        _ => vec![PlacedRegion::Combined(program)],
    })
}

fn tree_of(region: &Region, place: &Place, tools: &mut Tools) -> Result<Tree<PlacedLeaf>, RegionError> {
    match region {
        Region::Combined { how, parts } => {
            let tree = |(i, part): (usize, &Region)| {
                let tree = match part {
                    Region::Sprite { .. } => Err((
                        "kind".into(),
                        "a depth sprite is no part of a combination; a shape of its own would be right".into(),
                    )),
                    _ => tree_of(part, place, tools),
                };
                tree.map_err(|(key, message)| within(i, &key, message))
            };
            let trees: Result<Vec<_>, _> = parts.iter().enumerate().map(tree).collect();
            Ok(Tree::joined(*how, trees?))
        }
        _ => {
            let leaves = leaves_of(region, place, tools)?;
            let trees = leaves.into_iter().map(|leaf| match leaf.is_empty() {
                true => Tree::Nothing,
                false => Tree::Leaf(leaf.into()),
            });
            Ok(Tree::joined(Operation::Union, trees))
        }
    }
}

/// The leaves whose union a focus area is that is no combination.
fn leaves_of(region: &Region, place: &Place, tools: &mut Tools) -> Result<Vec<Leaf>, RegionError> {
    let city = tools.city;
    let mut thresholds = None;
    let fields = fields_that_hide(region, tools);
    let objects: Arc<[bool]> = match region {
        Region::Thematic(choice) => members(city.model, choice).into(),
        Region::Occluders(_) | Region::Case { .. } if !tools.is_enabled => vec![false; city.model.objects.len()].into(),
        Region::Occluders(of) => {
            let shown = tools.occlusion.objects(tools.lens, Search { of, when: &[] }, tools.stand, tools.viewer);
            thresholds = shown.thresholds;
            shown.objects
        }
        Region::Case { of, when } => {
            let shown = tools.occlusion.objects(tools.lens, Search { of, when }, tools.stand, tools.viewer);
            thresholds = shown.thresholds;
            shown.objects
        }
        Region::Enclosed { parts, whole, types } => {
            objects_in(parts, Held { whole: *whole, types }, place, tools)?.into()
        }
        Region::Own { used, center, size, rotation } => {
            let own = OwnRegion::new(used, *center, *size, *rotation, &place.motion);
            return own.map(|own| vec![Leaf::Own(own)]).map_err(|message| ("kind".to_owned(), message));
        }
        Region::Magnified { lens, by } => {
            let number = tools.names.iter().position(|name| name == lens);
            let shapes =
                number.map(|number| tools.rays.magnified(number as u32, *by, &tools.frame)).unwrap_or_default();
            let placed = shapes.iter().map(|shape| shape.placed(&tools.camera, &place.sight));
            let placed: Result<Vec<Vec<Volume>>, _> = placed.collect();
            let placed = placed.map_err(|error| (String::new(), error.to_string()))?;
            return Ok(placed.into_iter().flatten().map(Leaf::Volume).collect());
        }
        Region::Sprite { file } => return Ok(vec![Leaf::Sprite(tools.solids.sprite(file, city, &place.motion)?)]),
        _ => return Ok(tools.solids.volumes(region, city, place)?.into_iter().map(Leaf::Volume).collect()),
    };
    let shown = city.geometries.iter().map(|&g| &city.model.geometries[g as usize]);
    let bounds = shown.filter(|g| objects[g.object as usize]).fold(Aabb::EMPTY, |all, g| all.union(g.bounds));
    let bounds = bounds.union(tools.fields.bounds_of(&fields));
    Ok(vec![Leaf::Members(Members { objects, thresholds, fields, bounds })])
}

/// Which fields are occluders: of a lens whose test asks for points of interest those that hide the middle of one, in all its cases that hold of
/// whatever it is.
fn fields_that_hide(region: &Region, tools: &mut Tools) -> [bool; MOST_VOLUMES] {
    let of = match region {
        Region::Occluders(of) => of,
        Region::Case { of, when } if when.last().is_some_and(When::is_always) => of,
        _ => return [false; MOST_VOLUMES],
    };
    if !tools.is_enabled || tools.fields.is_empty() || !of.test.needs_poi() {
        return [false; MOST_VOLUMES];
    }
    let pois = of.pois.iter().filter_map(|name| tools.stand.pois.iter().find(|poi| poi.name == *name));
    let boxes: Vec<Aabb> = pois.map(|poi| tools.occlusion.box_of(&poi.place, tools.stand.city)).collect();
    let places: Vec<DVec3> = boxes.iter().filter(|own| !own.is_empty()).map(Aabb::center).collect();
    tools.fields.that_hide(&places, tools.viewer)
}

/// The objects that some shapes hold, one per object of the city.
fn objects_in(parts: &[Region], held: Held, place: &Place, tools: &mut Tools) -> Result<Vec<bool>, RegionError> {
    let mut placed = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        placed.extend(regions_of(part, place, tools).map_err(|(key, message)| within(i, &key, message))?);
    }
    let areas: Vec<_> =
        placed.iter().filter(|region| !region.is_empty()).map(|region| (region, region.bounds())).collect();
    let nothing = Moved::default();
    let showing = Showing::of_city(if tools.at_rest { &nothing } else { tools.moved });
    Ok(enclosed(tools.city, &areas, held, &showing))
}

/// What is wrong with part i of a focus area: a key of the part, and words.
fn within(i: usize, key: &str, message: String) -> RegionError {
    let dot = if key.is_empty() { "" } else { "." };
    (format!("shapes.{i}{dot}{key}"), message)
}

impl LensVolumes {
    /// Gives every solid its place in the table of all of them, which is made anew where `before` does not hold just these.
    pub fn place_solids(&mut self, before: &Arc<SolidTable>) -> Result<Arc<SolidTable>, String> {
        let solids = || {
            let leaves = self.volumes.iter().flat_map(|v| v.region.leaves());
            leaves.filter_map(|leaf| solid_of(&leaf.leaf))
        };
        let table = match before.holds(solids()) {
            true => before.clone(),
            false => Arc::new(SolidTable::new(solids()).map_err(|entries| {
                format!("the solids of the lenses take {entries} entries together; one picture takes {MOST_ENTRIES}")
            })?),
        };
        for leaf in self.volumes.iter_mut().flat_map(|v| v.region.leaves_mut()) {
            if let Some(place) = solid_of(&leaf.leaf).and_then(|solid| table.place(solid)) {
                leaf.place = place.clone();
            }
        }
        Ok(table)
    }
}

/// Whether a body asks how far away it is.
fn has_surface(body: LensBody) -> bool {
    matches!(body, LensBody::Shell | LensBody::Halo)
}

fn solid_of(leaf: &Leaf) -> Option<&Arc<Solid>> {
    match leaf {
        Leaf::Volume(Volume::Solid(placed)) => Some(&placed.solid),
        _ => None,
    }
}
