//! The scene that an overlay shows: the main one from an eye of its own, with its own lenses and look.

use glam::{DVec2, DVec3};

use crate::{
    city::{CityModel, ObjectClass},
    geom::{Aabb, Shape, Sphere},
    lens::{
        BestView, Class, EffectUse, Lens, LensBody, LensKind, Parameter, Region,
        best_view::{LocalView, MapMode},
        chosen::Choice,
        epoch::linked,
    },
    render::picture::{RenderError, Studio},
    scene::{Figure, PiecePlace, Poi, PoiPlace, Scene, Style, StyleLook},
    view::{Camera, Field, Framing, default_near_m, local},
};

/// Radius of the ball around a point of interest that is a point and no object, metres.
pub const POINT_RADIUS_M: f64 = 25.0;
/// From this share on that is seen of an object, of what would be were it alone, what stands before it stays: to cut it away, and the ground with it, would
/// take more than it gives.
const CLEAR: f64 = 0.9;
/// The chroma that is left beside an object that stands out, and how far to white or to black what is there goes.
const PALE: f64 = 0.25;
const VEIL: f64 = 0.45;
/// What buildings are filled with on a map, and how much of it.
const BUILT: &str = "#b98d6b";
const FILLED: f64 = 0.7;
/// How far above all else the eye of a map stands, metres.
const ABOVE_M: f64 = 100.0;

/// What an overlay shows.
#[derive(Clone, Debug)]
pub struct Local {
    /// The scene, with its camera.
    pub scene: Scene,
    /// Whether nothing is behind it.
    pub transparent: bool,
    /// Whether left and right are exchanged.
    pub mirror: bool,
    /// Of a map: what is in its middle.
    pub middle: Option<DVec2>,
    /// How much larger it is drawn than it is shown, for a fisheye.
    pub magnification: f64,
}

/// The ball around a point of interest.
fn ball(studio: &Studio, poi: &Poi) -> Result<Sphere, RenderError> {
    match &poi.place {
        PoiPlace::At(at) | PoiPlace::AboveGround(at) => Ok(Sphere { center: *at, radius: POINT_RADIUS_M }),
        PoiPlace::Object(id) => studio.bulk(id).map(|bulk| bulk.ball),
        PoiPlace::On(name) => Err(RenderError::Scene(format!("there is no trajectory \"{name}\""))),
    }
}

/// What a view goes by, beside what it shows.
#[derive(Clone, Copy, Debug)]
pub struct From {
    /// The camera of the picture that it stands in.
    pub main: Camera,
    /// Width and height of what it shows, pixels.
    pub size: [u32; 2],
    /// Of a map: what was in its middle in the frame before.
    pub tracked: Option<DVec2>,
}

/// The scene that the view of a lens shows. The studio stands as it does at the moment of that, then.
///
/// # Errors
/// Where its point of interest has no place in the city.
pub fn local(
    studio: &mut Studio,
    scene: &Scene,
    lens: &str,
    shown: &BestView,
    view: &LocalView,
    &From { main, size, tracked }: &From,
) -> Result<Local, RenderError> {
    let main = &main;
    let mut seen = seen_through(scene, shown);
    show_moment(studio, scene, lens, &mut seen)?;
    studio.stand_at(&seen);
    let studio = &*studio;
    let model = &*studio.model;
    let wrong = |message: String| RenderError::Scene(format!("lens \"{lens}\": {message}"));
    let of_lens = |error: RenderError| match error {
        RenderError::Scene(message) => wrong(message),
        other => other,
    };
    let first = || {
        let name = shown.pois.first().map_or("", String::as_str);
        let poi = scene.pois.iter().find(|poi| poi.name == name);
        let poi = poi.ok_or_else(|| wrong(format!("there is no point of interest \"{name}\"")))?;
        let ahead = scene.moving(poi).and_then(|moving| moving.direction).and_then(local::level_heading);
        let standing = Poi { name: poi.name.clone(), place: scene.place(poi) };
        let ball = ball(studio, &standing).map_err(of_lens)?;
        // Where it is shown: what moves it here moves it in its view, too, as far as that has the lens.
        let center = studio.deformers(&seen, size)?.value(ball.center);
        let ball = Sphere { center, ..ball };
        Ok::<_, RenderError>((standing, ball, ahead.unwrap_or_else(|| local::heading(main))))
    };
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let viewer = main.basis().ok().map(|basis| [basis.forward, basis.up]);
    let framed = |ball: &Sphere, normal: DVec3, fov_y: f64| {
        let framing = Framing::new(ball, normal, &Field { fov_y, aspect }, viewer);
        framing.map(|framing| framing.camera()).map_err(|error| wrong(error.to_string()))
    };
    let mut own = Local {
        scene: seen.clone(),
        transparent: false,
        mirror: false,
        middle: None,
        magnification: view.magnification(),
    };
    let camera = match view {
        LocalView::Best { normal, fov_y, highlight } => {
            let (poi, ball, _) = first()?;
            if let (PoiPlace::Object(id), true) = (&poi.place, highlight) {
                own.scene.lenses.push(highlighting(id, own.scene.style.look));
            }
            let given = *normal;
            match &poi.place {
                PoiPlace::Object(id) => {
                    let field = Field { fov_y: *fov_y, aspect };
                    best(studio, scene, id, &ball, given, &field, viewer).map_err(of_lens)?
                }
                // A place has no facades: from the south-west and from above.
                _ => framed(&ball, given.unwrap_or(DVec3::new(-1.0, -1.0, 0.8)), *fov_y)?,
            }
        }
        LocalView::Mcop { normal, distance_m, fov_y } => local::towards_viewer(main, *normal, *distance_m, *fov_y),
        LocalView::Scop { direction, of_camera, mirror, fov_y } => {
            own.mirror = *mirror;
            let direction = if *of_camera { local::of_viewer(main, *direction) } else { *direction };
            local::from_viewer(main, direction, *fov_y)
        }
        LocalView::Map { mode, height_m, lazy, .. } => {
            let heading = if *mode == MapMode::HeadUp { local::heading(main) } else { DVec2::Y };
            let eye = over_city(studio, main.eye.truncate());
            let middle =
                tracked.map_or(eye, |before| local::followed(before, eye, 0.5 * lazy * height_m * aspect.min(1.0)));
            own.middle = Some(middle);
            if shown.look.is_none() {
                draw_as_map(&mut own.scene, model);
            }
            // Of the city's height alone: an eye that rises sees the same map.
            let top = studio.extent().max.z;
            local::map(middle.extend(if top.is_finite() { top } else { 0.0 }), heading, *height_m, ABOVE_M)
        }
        LocalView::Worldlet { azimuth, elevation, margin_m, fov_y } => {
            let (poi, ball, _) = first()?;
            own.transparent = true;
            own.scene.lenses.push(alone(&poi, model, *margin_m));
            let (up, level) = (elevation.sin(), elevation.cos());
            let normal = DVec3::new(level * azimuth.sin(), level * azimuth.cos(), up);
            framed(&Sphere { radius: ball.radius + margin_m, ..ball }, normal, *fov_y)?
        }
        LocalView::Follow { distance_m, height_m, fov_y } => {
            let (_, ball, heading) = first()?;
            local::behind(ball.center, heading, *distance_m, *height_m, *fov_y)
        }
        LocalView::Onboard { azimuth, height_m, fov_y } => {
            let (_, ball, heading) = first()?;
            local::level(ball.center + *height_m * DVec3::Z, heading, *azimuth, *fov_y)
        }
        LocalView::Camera { camera, .. } => *camera,
    };
    own.scene.camera = Some(camera);
    Ok(own)
}

/// Has the view of a lens show the moment that the lens makes of the scene's, under the sun of then.
fn show_moment(studio: &Studio, scene: &Scene, lens: &str, own: &mut Scene) -> Result<(), RenderError> {
    let steps = scene.lenses.iter().find(|own| own.name == lens).map_or(&[][..], |own| &own.time);
    if steps.is_empty() {
        return Ok(());
    }
    // The view may have other lenses.
    let of_lens = |message: String| RenderError::Scene(format!("lens \"{lens}\": time, \"link\": {message}"));
    own.time_steps = linked(&own.time_steps, &scene.lenses).map_err(of_lens)?;
    own.time_steps.extend(linked(steps, &scene.lenses).map_err(of_lens)?);
    if let Some(sun) = studio.sun_by_date(own)? {
        own.sun = sun;
    }
    Ok(())
}

/// The camera from where an object is seen best, or from a direction that is `given`: all of it fills the picture, however long it is. `ball`:
/// that around it, where it is shown.
fn best(
    studio: &Studio,
    scene: &Scene,
    id: &str,
    ball: &Sphere,
    given: Option<DVec3>,
    field: &Field,
    viewer: Option<[DVec3; 2]>,
) -> Result<Camera, RenderError> {
    let best = given.is_none().then(|| studio.best_view(id, field.fov_y, &scene.sun)).transpose()?;
    let normal = best.as_ref().map(|best| best.framing.normal).or(given).unwrap_or(DVec3::Z);
    let bulk = studio.bulk(id)?;
    let by = ball.center - bulk.ball.center;
    let corners: Vec<DVec3> = bulk.corners.iter().map(|corner| *corner + by).collect();
    let framing = Framing::of_points(&corners, ball, normal, field, viewer);
    let camera = framing.map(|framing| framing.camera()).map_err(|error| RenderError::Scene(error.to_string()))?;
    let is_clear = best.is_some_and(|best| best.seen.unoccluded >= CLEAR);
    let near_m = default_near_m(camera.eye.distance(camera.target));
    Ok(if is_clear { Camera { near_m, ..camera } } else { camera })
}

/// The scene as the view of a lens has it, still without its camera.
fn seen_through(scene: &Scene, shown: &BestView) -> Scene {
    let mut own = scene.clone();
    own.animation = None;
    own.figure = Figure {
        legend: PiecePlace::None,
        scale_bar: PiecePlace::None,
        time_labels: false,
        north_arrow: PiecePlace::None,
        title: None,
        caption: None,
        ..own.figure
    };
    for lens in &mut own.lenses {
        let is_in = match &shown.lenses {
            Some(names) => names.contains(&lens.name),
            // What is fixed to a camera, and what is flat, acts in its own view alone.
            None => !lens.kind.has_overlay() && !lens.is_of_camera() && !is_flat(lens),
        };
        lens.enabled &= is_in;
    }
    if let Some(look) = &shown.look {
        let (base, effects, background) = (look.base, look.effects.clone(), look.background);
        own.style = Style { look: look.look, base, effects, background, ..own.style };
    }
    own
}

/// The place of a city that is nearest to one in plan, so that a map of what is around it shows some of the city.
fn over_city(studio: &Studio, at: DVec2) -> DVec2 {
    let extent = studio.extent();
    if extent.is_empty() { at } else { at.clamp(extent.min.truncate(), extent.max.truncate()) }
}

/// Has a scene look as a map does that says nothing of its look: flat colours, and buildings filled, unless the scene colours what it shows itself.
fn draw_as_map(scene: &mut Scene, model: &CityModel) {
    if scene.style.look == StyleLook::Natural {
        scene.style.look = StyleLook::Map;
    }
    if !scene.style.effects.is_empty() {
        return;
    }
    let built = model.objects.iter().filter(|object| object.class == ObjectClass::Building);
    let mut types: Vec<String> = built.map(|object| model.strings.get(object.kind).to_owned()).collect();
    types.retain(|kind| !kind.is_empty());
    types.sort_unstable();
    types.dedup();
    if types.is_empty() {
        return;
    }
    let filled = EffectUse {
        effect: "overlay".into(),
        class: Class::Inside,
        blend: None,
        weight: None,
        parameters: [
            ("color".to_owned(), Parameter::Text(BUILT.to_owned())),
            ("opacity".to_owned(), Parameter::Number(FILLED)),
        ]
        .into(),
    };
    let fill = Lens {
        shapes: vec![Region::Thematic(Choice { types, ..Choice::default() })],
        effects: vec![filled],
        body: LensBody::None,
        ..Lens::plain("", LensKind::default(), [0.0; 3])
    };
    // Below all others: what lenses of the scene show stays.
    scene.lenses.insert(0, fill);
}

/// A lens that lets an object stand out: what is beside it is pale, and dark in looks that are dark.
fn highlighting(id: &str, look: StyleLook) -> Lens {
    let used = |effect: &str, parameter: &str, value: f64| EffectUse {
        effect: effect.into(),
        class: Class::Rest,
        blend: None,
        weight: None,
        parameters: [(parameter.to_owned(), Parameter::Number(value))].into(),
    };
    let veil = match look {
        StyleLook::Night | StyleLook::Blueprint => used("darken", "amount", VEIL),
        StyleLook::Natural | StyleLook::Paper | StyleLook::Map => used("brighten", "amount", VEIL),
    };
    Lens {
        shapes: vec![Region::Thematic(Choice { ids: vec![id.to_owned()], ..Choice::default() })],
        effects: vec![used("saturate", "factor", PALE), veil],
        body: LensBody::None,
        ..Lens::plain("", LensKind::default(), [0.0; 3])
    }
}

fn is_flat(lens: &Lens) -> bool {
    lens.shapes.iter().any(|s| s.any(&|f| matches!(f, Region::Shape(Shape::Flat { .. }))))
}

/// A lens that leaves nothing but a point of interest and the objects that come within `margin_m` of its box in plan.
fn alone(poi: &Poi, model: &CityModel, margin_m: f64) -> Lens {
    let near = match &poi.place {
        PoiPlace::At(at) | PoiPlace::AboveGround(at) => Aabb { min: *at, max: *at },
        PoiPlace::On(_) => Aabb::EMPTY,
        PoiPlace::Object(id) => model.find_object(id).map_or(Aabb::EMPTY, |object| model.family_bounds(object)),
    };
    let meets = |bounds: Aabb| {
        let reach = DVec2::splat(margin_m);
        let (low, high) = (near.min.truncate() - reach, near.max.truncate() + reach);
        bounds.min.truncate().cmple(high).all() && bounds.max.truncate().cmpge(low).all()
    };
    let is_own = |id: &str| matches!(&poi.place, PoiPlace::Object(own) if own == id);
    let roots = model.roots();
    let taken = roots.iter().enumerate().filter(|&(object, &root)| root as usize == object).filter(|&(object, _)| {
        let is_near = || !model.objects[object].class.is_ground() && meets(model.family_bounds(object as u32));
        is_own(&model.objects[object].id) || (margin_m > 0.0 && is_near())
    });
    let mut ids: Vec<String> = taken.map(|(object, _)| model.objects[object].id.to_string()).collect();
    if let PoiPlace::Object(id) = &poi.place
        && !ids.contains(id)
    {
        ids.push(id.clone());
    }
    let erased = EffectUse {
        effect: "eraser".into(),
        class: Class::Rest,
        blend: None,
        weight: None,
        parameters: [("keep_terrain".to_owned(), Parameter::Boolean(false))].into(),
    };
    Lens {
        shapes: vec![Region::Thematic(Choice { ids, ..Choice::default() })],
        effects: vec![erased],
        body: LensBody::None,
        ..Lens::plain("", LensKind::default(), [0.0; 3])
    }
}
