//! What is written is read back, for scenes of all kinds.

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::{keys::RAMPS, tests::read_text, *};
use crate::{
    city::{
        change::{Became, Between, CityChange},
        derived::{Derive, Form, Height},
        lifetime::{Dating, Undated},
        side_table::Join,
    },
    field::Component,
    geom::{Shape, combination::Operation, shape::FlatFigure},
    lens::{
        BestView, Border, BorderUnit, Class, Content, Copied, Deform, Discrete, EffectUse, Handled, Lens, LensBody,
        LensKind, LensSprite, Occluders, Only, OwnEye, Parameter, Placement, Region, Rendering,
        best_view::{Depiction, LocalView, Look, MapMode},
        chosen::Choice,
        color::parse_hex,
        deform::{BORDER, ControlProfile, Step},
        kind::{Deformation, FeatureLens, FisheyeLens, Magnifier, Occlusion, OwnRayLens, SamplingLens, TimeLens},
        ray::{
            Bend, Feature, Fisheye, FisheyeProjection, Magnify, RayLens, RayMethod, RayOutline, Sampling, SamplingRate,
        },
        rendering::{Case, ROWS, When},
        sprite::{Format, Mapping},
    },
    scene::{
        Anchor, Animation, Background, BaseStyle, Column, Figure, Layout, Overlay, Paper, PiecePlace, Poi, PoiPlace,
        Style, StyleLook, Sun, SunTime, Technique, TextSize, Transparency,
        above_ground::heights_of_lens,
        animation::{Change, ChangeKey, Numbers},
        overlay::{Along, BuiltInFrame, CallOut, ContextLine, Frame, LineEnd, LineKind, Outside, Sizes, Stand},
        trajectory::{Pace as WayPace, Trajectory},
        transparency::{MOST_PEELED, SLOTS},
        volume::{Slice, Transfer, Volume, VolumeLight, VolumeMode},
    },
    shader::{
        Blend, Clip, EffectKind,
        effect::{ParameterDefinition, ParameterKind, find},
    },
    time::{self, Moment, Span},
    view::{
        Camera, Projection,
        path::{self, CameraKey, Speed},
    },
    visibility::{Margin, Pace, Reference, Test},
};

fn point() -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-1e6..1e6f64).prop_map(DVec3::from)
}

fn shapes() -> impl Strategy<Value = Shape> {
    let angles = || prop::array::uniform3(-1800..1800i32).prop_map(|a| a.map(|a| f64::from(a) / 10.0));
    prop_oneof![
        (point(), 0.0..1e4f64).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
        (point(), prop::array::uniform3(0.0..1e3f64), angles()).prop_map(|(center, s, a)| Shape::Box {
            center,
            size: s.into(),
            rotation: rotation(a)
        }),
        (point(), 0.0..1e3f64, 0.0..1e3f64, point()).prop_filter_map("an axis", |(center, radius, height, a)| {
            Some(Shape::Cylinder { center, radius, height, axis: a.try_normalize()? })
        }),
        (point(), prop::array::uniform3(0.0..1e3f64), angles()).prop_map(|(center, r, a)| Shape::Ellipsoid {
            center,
            radii: r.into(),
            rotation: rotation(a)
        }),
        (point(), 0.0..1e3f64, prop_oneof![Just(0.0), 0.0..1e3f64], 0.0..1e3f64, point()).prop_filter_map(
            "an axis",
            |(center, radius, top_radius, height, a)| {
                Some(Shape::Frustum { center, radius, top_radius, height, axis: a.try_normalize()? })
            }
        ),
        prop::collection::vec(point(), 5..9).prop_map(|points| Shape::Convex { points }),
        (point(), prop::array::uniform6(0.1..1e3f64)).prop_map(|(at, ends)| {
            let sides = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z].into_iter().zip(ends);
            Shape::Polytope { planes: sides.map(|(n, d)| [n.x, n.y, n.z, d + n.dot(at)]).collect() }
        }),
        (prop::collection::vec(point(), 2..9), 0.0..1e3f64, 0.0..1e3f64)
            .prop_map(|(points, width, height)| Shape::Corridor { points, width, height }),
        (point(), angles(), figures_of_flats()).prop_map(|(center, a, figure)| Shape::Flat {
            center,
            rotation: rotation(a),
            figure
        }),
    ]
}

fn figures_of_flats() -> impl Strategy<Value = FlatFigure> {
    let pair = || prop::array::uniform2(-1e3..1e3f64).prop_map(DVec2::from);
    prop_oneof![
        (0.0..1e3f64).prop_map(|radius| FlatFigure::Disc { radius }),
        pair().prop_map(|size| FlatFigure::Rectangle { size: size.abs() }),
        prop::collection::vec(pair(), 3..9).prop_map(|points| FlatFigure::Polygon { points }),
    ]
}

fn placements() -> impl Strategy<Value = Placement> {
    prop_oneof![
        Just(Placement::World),
        Just(Placement::AboveGround),
        Just(Placement::Camera),
        ".{1,6}".prop_map(Placement::Object),
        ".{1,6}".prop_map(Placement::Poi),
    ]
}

fn plan() -> impl Strategy<Value = DVec2> {
    prop::array::uniform2(-1e6..1e6f64).prop_map(DVec2::from)
}

fn choices() -> impl Strategy<Value = Choice> {
    let ids = prop::collection::vec("[a-z\"]{1,5}", 1..3).prop_map(|ids| (ids, Vec::new(), None));
    let types = prop::collection::vec("[A-Z\"]{1,5}", 1..3).prop_map(|types| (Vec::new(), types, None));
    let attribute = (".{1,5}", prop::option::of(prop::collection::vec(".{1,4}", 1..3)))
        .prop_map(|(name, values)| (Vec::new(), Vec::new(), Some((name, values))));
    let all = (prop_oneof![ids, types, attribute], prop::option::of(-1e3..1e3f64), any::<bool>());
    let named = all.prop_map(|((ids, types, of), min, except)| {
        let (attribute, values) = of.map_or((None, None), |(name, values)| (Some(name), values));
        let min = min.filter(|_| attribute.is_some());
        Choice { ids, types, expression: None, attribute, values, min, max: min.map(|m| m + 1.0), except }
    });
    let meant = ("`[a-z \"]{1,5}` (>|contains|in 1 [.][.]) [0-9]{1,3}( and not `a`)?", any::<bool>());
    let meant = meant.prop_map(|(text, except)| Choice { expression: Some(text), except, ..Choice::default() });
    prop_oneof![named, meant]
}

fn regions() -> impl Strategy<Value = Region> {
    plain_regions().prop_recursive(2, 6, 3, |inner| {
        let how = prop::option::of(prop::sample::select(Operation::ALL.to_vec()));
        let types = prop::collection::vec("[A-Z\"]{1,5}", 0..3);
        (how, any::<bool>(), types, prop::collection::vec(inner, 1..3)).prop_map(|(how, whole, types, parts)| match how
        {
            Some(how) => Region::Combined { how, parts },
            None => Region::Enclosed { parts, whole, types },
        })
    })
}

fn plain_regions() -> impl Strategy<Value = Region> {
    let angles = prop::array::uniform3(-1800..1800i32).prop_map(|a| a.map(|a| f64::from(a) / 10.0));
    // With area, and a smaller one in it.
    let ring = (plan(), 1.0..1e3f64).prop_map(|(at, size)| {
        let corners =
            move |size: f64| [[0.0, 0.0], [3.0, 0.4], [1.0, 2.0]].map(|c| at + size * (DVec2::from(c) - 1.0)).to_vec();
        (corners(size), corners(0.3 * size))
    });
    let size = || prop::array::uniform2(0.0..1e3f64).prop_map(DVec2::from);
    prop_oneof![
        4 => shapes().prop_map(Region::from),
        1 => (point(), angles, 0.1..1e3f64).prop_map(|(at, a, scale)| Region::Mesh {
            file: "b.obj".into(),
            at,
            rotation: rotation(a),
            scale
        }),
        1 => (ring, any::<bool>(), -1e3..1e3f64, 0.0..1e3f64).prop_map(|((points, hole), holed, base, height)| {
            Region::Prism { points, holes: if holed { vec![hole] } else { vec![] }, base, height }
        }),
        1 => (plan(), size(), -1e3..1e3f64, 0.0..1e3f64).prop_map(|(corner, size, base, height)| Region::Mask {
            image: "m.png".into(),
            corner,
            size,
            base,
            height
        }),
        1 => (point(), prop::array::uniform3(0.0..1e3f64)).prop_map(|(corner, size)| Region::Mask3d {
            images: vec!["0.png".into(), "1.png".into()],
            corner,
            size: size.into()
        }),
        1 => Just(Region::Sprite { file: "s.exr".into() }),
        1 => ("[a-z]{1,5}", 0.1..9.0f64).prop_map(|(lens, by)| Region::Magnified { lens, by }),
        1 => choices().prop_map(Region::Objects),
        1 => choices().prop_map(Region::Thematic),
    ]
}

fn effects() -> impl Strategy<Value = EffectUse> {
    let class = prop_oneof![Just(Class::Inside), Just(Class::Front), Just(Class::Behind), Just(Class::Rest)];
    let used = |effect: &str, class, parameters: Vec<(&str, Parameter)>| EffectUse {
        effect: effect.into(),
        class,
        blend: None,
        weight: None,
        parameters: parameters.into_iter().map(|(k, v)| (k.to_owned(), v)).collect(),
    };
    let laid = (prop::option::of(prop::sample::select(Blend::ALL.to_vec())), prop::option::of(0.0..=1.0f64));
    let lay = |(used, (blend, weight))| EffectUse { blend, weight, ..used };
    let used = (class, 0.0..=1.0f64, ".{1,8}", any::<bool>(), any::<bool>()).prop_map(
        move |(class, amount, text, plain, flag)| {
            if plain {
                let parameters = if flag { vec![("amount", Parameter::Number(amount))] } else { vec![] };
                used("sepia", class, parameters)
            } else {
                let list = vec![
                    ("attribute", Parameter::Text(text.clone())),
                    ("reverse", Parameter::Boolean(flag)),
                    ("breaks", Parameter::Numbers(vec![amount, amount + 1.0])),
                    ("categories", Parameter::Texts(vec![text])),
                    ("no_data", Parameter::Text("#123456".into())),
                ];
                used("thematic", class, list)
            }
        },
    );
    (used, laid).prop_map(lay)
}

/// A sprite or a border, or neither.
fn ends() -> impl Strategy<Value = (Option<LensSprite>, Option<Border>)> {
    let sprite = sprites().prop_map(|sprite| (Some(sprite), None));
    let units = prop::sample::select(vec![BorderUnit::Metres, BorderUnit::Pixels, BorderUnit::Ray]);
    let border = (0.0..1e5, units, any::<bool>()).prop_map(|(width, unit, dithers)| {
        let discrete = if dithers { Discrete::Dither } else { Discrete::Threshold };
        (None, Some(Border { width, unit, discrete }))
    });
    prop_oneof![Just((None, None)), sprite, border]
}

fn derives() -> impl Strategy<Value = Derive> {
    let form = prop_oneof![
        any::<bool>().prop_map(|oriented| Form::Box { oriented }),
        Just(Form::Prism),
        Just(Form::Hull),
        prop_oneof![Just(0.05), 0.0..1000.0f64].prop_map(|lift_m| Form::Flat { lift_m }),
        (0.0..1000.0f64).prop_map(|lift_m| Form::Top { lift_m }),
        Just(Form::Lod1),
        (1e-3..1e5f64).prop_map(|metres| Form::Height(Height::Metres(metres))),
        (1e-3..1e3f64).prop_map(|factor| Form::Height(Height::Factor(factor))),
    ];
    (form, any::<bool>()).prop_map(|(form, parts)| Derive { form, parts })
}

prop_compose! {
    fn contents()(files in prop::collection::vec("[ -~äß]{1,9}", 0..3), tenths in prop::option::of(0..99u8),
        derive in prop::option::of(derives()),
        class in prop::sample::select(vec![Class::Inside, Class::Front, Class::Behind, Class::Rest]),
        clip in prop::sample::select(Clip::ALL.to_vec()), keep_terrain in any::<bool>(),
        only in prop::option::of((prop::sample::subsequence(Became::OF_EARLIER.to_vec(), 1..5), prop::option::of("[ -~äß]{1,9}"))),
        copied in prop::option::of((prop::option::of(point()), prop::option::of(point()), 1e-3..1e3f64, any::<bool>(), prop::array::uniform3(-1800..1800i32)))) -> Content {
        let copied = copied.map(|(from, to, scale, plain, angles)| match plain {
            true => Copied { from, to, ..Copied::default() },
            false => Copied { from, to, rotation: rotation(angles.map(|a| f64::from(a) / 10.0)), scale },
        });
        let files: Vec<std::path::PathBuf> = files.into_iter().filter(|f| !f.contains("${") && !f.starts_with("builtin:")).map(Into::into).collect();
        let only = only.filter(|_| !files.is_empty()).map(|(became, key)| Only { became, key });
        Content { files, only, lod: tenths.map(|tenths| crate::city::Lod { tenths }), derive, class, clip, keep_terrain, copied, transform: None }
    }
}

prop_compose! {
    fn sprites()(resolution in prop::option::of(16..16_384u32), format in 0..5usize, mapping in 0..4usize,
        near_m in prop::option::of(1e-3..10.0f64), far_m in prop::option::of(11.0..1e4f64), layers in 1..17u32,
        aggregate in any::<bool>(), own in prop::option::of((point(), point(), 1..1790u32, any::<bool>(), 0.01..100.0f64))) -> LensSprite {
        let (format, mapping) = (Format::WORDS[format].1, Mapping::WORDS[mapping].1);
        let own = own.map(|(eye, target, tenths, is_flat, aspect)| {
            let fov_y = (f64::from(tenths) / 10.0).to_radians();
            let projection = if is_flat { Projection::Orthographic { height_m: f64::from(tenths) } } else { Projection::Perspective { fov_y } };
            OwnEye { camera: Camera { projection, ..Camera::looking(eye, target, fov_y) }, aspect }
        });
        LensSprite { own, resolution, format, mapping, near_m, far_m, layers, aggregate }
    }
}

fn detections() -> impl Strategy<Value = Test> {
    let reference = prop::sample::select(Reference::WORDS.map(|(_, reference)| reference).to_vec());
    let up = || prop_oneof![Just(DVec3::Z), point().prop_filter_map("a direction", |v| v.try_normalize())];
    let radius = || 0.0..1e3f64;
    let one = prop_oneof![
        (radius(), reference.clone()).prop_map(|(radius, reference)| Test::Spherical { radius, reference }),
        (radius(), up()).prop_map(|(radius, up)| Test::Cylindrical { radius, up }),
        (radius(), reference, up()).prop_map(|(radius, reference, up)| Test::ViewerHeight { radius, reference, up }),
        Just(Test::ViewAxis),
        radius().prop_map(|radius| Test::Ground { radius }),
        (0.0..=1.0f64, 1..=65_536u32).prop_map(|(coverage, rays)| Test::Exact { coverage, rays }),
        prop::collection::vec(point(), 2..4).prop_map(|points| Test::Route { points }),
    ];
    one.prop_recursive(2, 6, 3, |inner| {
        (0..3, prop::collection::vec(inner, 1..3)).prop_map(|(how, mut parts)| match how {
            0 => Test::Any(parts),
            1 => Test::All(parts),
            _ => Test::Not(Box::new(parts.remove(0))),
        })
    })
}

/// An occlusion lens's part of a lens: whom it looks for, and how it draws them.
fn occluded() -> impl Strategy<Value = (Occluders, Rendering, bool)> {
    let choice = |id: String| Choice { ids: vec![id], ..Choice::default() };
    let choice = prop::option::of("[a-z\"]{1,5}".prop_map(choice));
    let render = prop_oneof![
        Just(Rendering::default()),
        // A second scene style beside those of `effects` is refused.
        effects().prop_filter_map("no scene style", |used| {
            (used.effect == "sepia").then(|| Rendering::of_effects(vec![used]))
        }),
    ];
    let row = prop::sample::select(ROWS.iter().collect::<Vec<_>>());
    let types = prop::collection::vec("[a-z\"]{1,5}", 0..3);
    let case = (row, 0.0..1e6f64, types, prop::option::of("[a-z\"]{1,5}")).prop_map(move |(row, nearer, types, id)| {
        let of = id.map(|id| Choice { ids: vec![id], ..Choice::default() });
        // Each number that the word takes, somewhere in its range.
        let number = |p: ParameterDefinition| match p.kind {
            ParameterKind::Number { min, max } => Some((p.name, Parameter::Number(min + (max - min) * (nearer / 1e6)))),
            _ => None,
        };
        let given = row.parameters().into_iter().filter_map(number).collect();
        Case { when: When { nearer_m: Some(nearer), types, of }, ..Case::of_row(row, given) }
    });
    let cases = prop::collection::vec(case, 1..4).prop_map(|mut cases| {
        // Scene styles of cases would meet those of `effects`.
        cases.retain(|case| {
            case.effects.iter().all(|used| find(&used.effect).is_some_and(|e| e.kind != EffectKind::Scene))
        });
        if cases.is_empty() { Rendering::default() } else { Rendering::of_cases(cases) }
    });
    let render = prop_oneof![2 => render, 1 => cases];
    let names = prop::collection::btree_set("[a-z\"]{1,5}", 1..3).prop_map(|names| names.into_iter().collect());
    let over_time = (0.0..=1000.0f64, 0.0..=60.0f64).prop_map(|(metres, fade_s)| (Margin { metres }, Pace { fade_s }));
    let over_time = prop_oneof![Just(Default::default()), over_time];
    (names, detections(), choice.clone(), choice, over_time, render, any::<bool>()).prop_map(
        |(pois, test, force, forbid, (margin, pace), render, has_shape)| {
            (Occluders { pois, test, force, forbid, margin, pace }, render, has_shape)
        },
    )
}

fn deforms() -> impl Strategy<Value = Deform> {
    let angle = || (-9000..9000i32).prop_map(|tenths| (f64::from(tenths) / 10.0).to_radians());
    let factor = || 0.01..=100.0f64;
    let step = prop_oneof![
        point().prop_map(|by| Step::Translate { by }),
        prop::array::uniform3(factor()).prop_map(|f| Step::Scale { factors: f.into() }),
        (-9.0..9.0f64, -9.0..9.0f64).prop_map(|(x, y)| Step::Shear { slope: DVec2::new(x, y) }),
        factor().prop_map(|factor| Step::Taper { factor }),
        angle().prop_map(|angle| Step::Twist { angle }),
        angle().prop_map(|angle| Step::Bend { angle }),
        (0.1..1e4f64, 0.0..1e4f64, factor()).prop_map(|(width, aside, height)| Step::OpenStreet {
            width,
            aside,
            height
        }),
        (0.0..100.0f64, 101.0..1e6f64, -1800..1800i32).prop_map(|(near, far, tenths)| Step::Panorama {
            near,
            far,
            angle: (f64::from(tenths) / 10.0).to_radians()
        }),
    ];
    let heights = ("[a-z]{1,5}", -9.0..9.0f64, 0.1..9.0f64, factor(), factor())
        .prop_map(|(attribute, low, more, a, b)| Step::Heights { attribute, from: [low, low + more], to: [a, b] });
    let lower = (occluded(), factor()).prop_map(|((of, ..), factor)| Step::Lower { of: of.into(), factor });
    let control = prop_oneof![
        (0.01..=0.5f64).prop_map(|border| ControlProfile::Linear { border }),
        Just(ControlProfile::Smooth { border: BORDER }),
        (0.01..=0.5f64).prop_map(|border| ControlProfile::Smooth { border }),
        Just(ControlProfile::Bump),
        Just(ControlProfile::Everywhere),
        (0.0..0.5f64, 0.51..=1.0f64).prop_map(|(inner, outer)| ControlProfile::Ring { inner, outer }),
        "[a-zß]{1,6}[.]png".prop_map(|file| ControlProfile::Image(file.into())),
    ];
    let steps = prop_oneof![
        4 => prop::collection::vec(step, 1..4),
        1 => prop::collection::vec(prop_oneof![heights, lower], 1..3),
    ];
    (steps, prop::option::of(control), prop_oneof![Just(1.0), 0.0..=1.0f64])
        .prop_map(|(steps, control, strength)| Deform { steps, control, strength })
}

/// Lenses that bend rays.
fn ray_lenses() -> impl Strategy<Value = LensKind> {
    let angle = |tenths: u32| (f64::from(tenths) / 10.0).to_radians();
    let magnify = || {
        let far = || prop::option::of(1e-3..1e4f64);
        (0.1..1e3f64, far(), far(), 0.0..=1.0f64).prop_map(|(magnification, at, distance, border)| Magnify {
            magnification,
            at,
            distance,
            border,
        })
    };
    let feature = (magnify(), choices())
        .prop_map(|(magnify, of)| Bend::Feature(Feature { magnify: Magnify { border: 1.0, ..magnify }, of }));
    let magnify = magnify().prop_map(Bend::Magnify);
    let points = prop::collection::vec((0.01..0.3f64, 0.01..1e3f64), 0..3).prop_map(|steps| {
        let mut x = 0.0;
        let mut inner: Vec<DVec2> = steps
            .into_iter()
            .map(|(step, rate)| {
                x += step;
                DVec2::new(x, rate)
            })
            .collect();
        inner.insert(0, DVec2::new(0.0, 2.0));
        inner.push(DVec2::new(1.0, 1.5));
        SamplingRate::Points(inner)
    });
    let rate = prop_oneof![(0.1..1e3f64).prop_map(SamplingRate::Cubic), points];
    let sample = rate.prop_map(|rate| Bend::Sample(Sampling { rate }));
    let fisheye = (10..1800u32, any::<bool>()).prop_map(move |(tenths, is_angular)| {
        let (angle, projection) = match is_angular {
            true => (angle(2 * tenths), FisheyeProjection::Angular),
            false => (angle(tenths), FisheyeProjection::Hemispherical),
        };
        Bend::Fisheye(Fisheye { angle, projection })
    });
    let bend = prop_oneof![magnify, feature, sample, fisheye];
    let mask = prop::option::of("[a-zß]{1,6}[.]png");
    let place = (prop::array::uniform2(0.0..=1.0f64), 0.001..4.0f64, any::<bool>(), any::<bool>(), mask);
    let method = prop_oneof![Just(RayMethod::Rays), Just(RayMethod::Image), Just(RayMethod::Vertices)];
    let only = prop::option::of(choices());
    (bend, place, method, 0.1..=8.0f64, only).prop_map(
        |(bend, (center, radius, is_square, grid, mask), method, fineness, only)| {
            let outline = if is_square { RayOutline::Square } else { RayOutline::Circle };
            let mut ray = RayLens { radius, grid, method, fineness, ..RayLens::new(bend) };
            if !matches!(ray.bend, Bend::Feature(_)) {
                (ray.center, ray.outline) = (center.into(), outline);
            }
            if matches!(ray.bend, Bend::Magnify(_)) && !is_square {
                ray.mask = mask.map(Into::into);
            }
            if !matches!(ray.bend, Bend::Feature(_)) && method == RayMethod::Rays {
                ray.only = only;
            }
            match &ray.bend {
                Bend::Feature(_) => FeatureLens { ray }.into(),
                Bend::Magnify(_) => Magnifier { ray }.into(),
                Bend::Sample(_) => SamplingLens { ray }.into(),
                Bend::Fisheye(_) => FisheyeLens { ray }.into(),
                // Handlers of users are there where one was added.
                Bend::Own(_) => OwnRayLens { ray }.into(),
            }
        },
    )
}

/// An aggregate of years, and of so many days later, with weights.
fn several(all: Vec<(bool, i64, u8)>) -> Handled {
    let at = |(is_later, count, _): &(bool, i64, u8)| match is_later {
        true => Span::of_micros(count * time::DAY).to_string(),
        false => Moment::of_year(*count).unwrap().written(),
    };
    let texts = Parameter::Texts(all.iter().map(at).collect());
    let weights = Parameter::Numbers(all.iter().map(|(.., weight)| f64::from(*weight)).collect());
    let parameters = [("at".to_owned(), texts), ("weights".to_owned(), weights)];
    Handled { handler: "aggregate".into(), parameters: parameters.into() }
}

/// Time operators of a lens, in few of them.
fn operators() -> impl Strategy<Value = Vec<Handled>> {
    let of = |op: &str, parameters: Vec<(&str, String)>| Handled {
        handler: op.to_owned(),
        parameters: parameters.into_iter().map(|(key, text)| (key.to_owned(), Parameter::Text(text))).collect(),
    };
    let moment =
        || (Moment::FIRST.micros()..=Moment::LAST.micros()).prop_map(|micros| Moment::from_micros(micros).unwrap());
    let one = prop_oneof![
        moment().prop_map(move |at| of("set", vec![("at", at.written())])),
        (-99..99i32).prop_map(move |months| of("shift", vec![("by", Span::of_months(months).to_string())])),
        (1..99i64).prop_map(move |days| of("ceil", vec![("unit", Span::of_micros(days * time::DAY).to_string())])),
        (1..99i32).prop_map(move |months| of(
            "floor",
            vec![("unit", Span::of_months(months).to_string()), ("by", "1 day".into())]
        )),
        (0..1440u32).prop_map(move |minute| of(
            "time-of-day",
            vec![("time", format!("{:02}:{:02}", minute / 60, minute % 60))]
        )),
        (1..999i64).prop_map(move |year| of(
            "loop",
            vec![("begin", Moment::of_year(year).unwrap().written()), ("end", "1000".into())]
        )),
        (1..99i32).prop_map(move |months| of("ghost", vec![("past", Span::of_months(months).to_string())])),
        prop::collection::vec((any::<bool>(), 1..999i64, 1..9u8), 1..4).prop_map(several),
    ];
    prop_oneof![4 => Just(vec![]), 1 => prop::collection::vec(one, 1..4)]
}

prop_compose! {
    fn lenses()(occluded in prop::option::weighted(0.3, occluded()),
        shapes in prop::collection::vec(regions(), 1..3), mut used in prop::collection::vec(effects(), 0..2),
        enabled in any::<bool>(), color in prop::array::uniform3(0.0..=1.0f32), body in 0..LensBody::WORDS.len(),
        ends in ends(), placement in placements(), content in prop::option::of(contents()), is_content in any::<bool>(),
        section in prop::option::of(prop::array::uniform3(0.0..=1.0f32)), keeps_shadows in any::<bool>(), at_rest in any::<bool>(),
        deform in prop::option::weighted(0.3, deforms()), time in operators(), bends in prop::option::weighted(0.3, ray_lenses())) -> Lens {
        let (mut placement, mut at_rest) = (placement, at_rest);
        // A soft border needs shapes that have a distance; what shapes of files have, `sprite` does not give.
        let is_saved = |s: &Region| matches!(s, Region::Sprite { .. });
        let (sprite, border) = if shapes.iter().any(|s| s.any(&is_saved)) { (None, None) } else { ends };
        let body = LensBody::WORDS[body].1;
        let mut kind = LensKind::of_word(if content.is_some() && is_content { "content" } else { "color" }).unwrap();
        let mut shapes = shapes;
        // Depth sprites are not combined.
        if let Some((of, drawn, has_shape)) = occluded && !shapes.iter().any(|s| s.any(&is_saved)) {
            kind = Occlusion { rendering: drawn, content: None }.into();
            shapes = occlusion::areas(of, if has_shape { shapes } else { vec![] });
        }
        if let Some(deform) = deform.filter(|_| matches!(kind, LensKind::Color(_))) {
            shapes = if deform.is_of_objects() { vec![] } else { shapes };
            kind = Deformation::from(deform).into();
        }
        if let Some(bends) = bends.filter(|_| matches!(kind, LensKind::Color(_)) && sprite.is_none() && content.is_none()) {
            (kind, shapes, placement, at_rest) = (bends, vec![], Placement::World, false);
            // In an outline of its own it has no effects.
            if kind.ray().is_some_and(|ray| ray.mask.is_some() || matches!(ray.bend, Bend::Feature(_))) {
                used.clear();
            }
        }
        if !time.is_empty() && matches!(kind, LensKind::Color(_)) {
            kind = TimeLens::default().into();
        }
        kind.set_content(content);
        Lens { name: String::new(), kind, enabled, color, placement, shapes, effects: used, time, body, sprite, border, keeps_shadows, at_rest, section }
    }
}

fn names(prefix: &'static str) -> impl Strategy<Value = Vec<String>> {
    prop::collection::vec(0..2usize, 0..2).prop_map(move |all| all.iter().map(|i| format!("{prefix}{i}")).collect())
}

fn local_views() -> impl Strategy<Value = (&'static str, Depiction)> {
    let unit = || point().prop_filter("a direction", |v| v.try_normalize().is_some());
    let fov = || (1..1790u32).prop_map(|tenths| (f64::from(tenths) / 10.0).to_radians());
    let angle = |tenths: i32| (f64::from(tenths) / 10.0).to_radians();
    let mode = prop::sample::select(MapMode::WORDS.map(|(_, mode)| mode).to_vec());
    let camera = (unit(), fov()).prop_map(|(eye, fov_y)| Camera::looking(eye, DVec3::ZERO, fov_y)).boxed();
    let view =
        (camera, any::<bool>()).prop_map(|(camera, above_ground)| LocalView::Camera { camera, above_ground }).boxed();
    let of = |kind: &'static str| move |view: LocalView| (kind, Depiction::View(view));
    prop_oneof![
        ".{1,6}".prop_map(|text| ("annotation", Depiction::Text(text))),
        "[a-zß]{1,6}[.]png".prop_map(|file| ("annotation", Depiction::Image(file.into()))),
        (prop::option::of(unit()), fov(), any::<bool>())
            .prop_map(|(normal, fov_y, highlight)| LocalView::Best { normal, fov_y, highlight })
            .prop_map(of("best-view")),
        (unit(), 1e-3..1e6f64, fov())
            .prop_map(|(normal, distance_m, fov_y)| LocalView::Mcop { normal, distance_m, fov_y })
            .prop_map(of("best-view")),
        (unit(), any::<bool>(), any::<bool>(), fov())
            .prop_map(|(direction, of_camera, mirror, fov_y)| LocalView::Scop { direction, of_camera, mirror, fov_y })
            .prop_map(of("best-view")),
        view.clone().prop_map(of("best-view")),
        view.clone().prop_map(of("see-through")),
        view.prop_map(of("portal")),
        (1e-3..1e3f64, 1e-3..1e3f64, fov())
            .prop_map(|(distance_m, height_m, fov_y)| LocalView::Follow { distance_m, height_m, fov_y })
            .prop_map(of("best-view")),
        (-9000..9000i32, 1e-3..1e3f64, fov())
            .prop_map(move |(a, height_m, fov_y)| LocalView::Onboard { azimuth: angle(a), height_m, fov_y })
            .prop_map(of("best-view")),
        (mode, 1e-3..1e7f64, 1.0..4.0f64, 0.0..1.0f64)
            .prop_map(|(mode, height_m, magnification, lazy)| LocalView::Map { mode, height_m, magnification, lazy })
            .prop_map(of("map-view")),
        (-9000..9000i32, -900..900i32, 0.0..1e3f64, fov())
            .prop_map(move |(a, e, margin_m, fov_y)| LocalView::Worldlet {
                azimuth: angle(a),
                elevation: angle(e),
                margin_m,
                fov_y
            })
            .prop_map(of("worldlet")),
    ]
}

prop_compose! {
    /// Lenses with overlays: named n2 and n3, tied to points of interest p0 and p1, with lenses n0 and n1 in their views.
    fn shown()((kind, depiction) in local_views(), mut pois in names("p"), lenses in prop::option::of(names("n\"")), used in effects(), base in any::<bool>(),
        background in prop::option::of(prop::array::uniform3(0.0..=1.0f32)), has_look in any::<bool>()) -> LensKind {
        let background = background.map_or(Background::Sky, Background::Color);
        let effects = if used.effect == "sepia" { vec![EffectUse { class: Class::Inside, ..used }] } else { vec![] };
        let base = if base { BaseStyle::Clay } else { BaseStyle::Natural };
        let (mut look, mut lenses) = (has_look.then_some(Look { look: StyleLook::WORDS[effects.len() % 5].1, base, effects, background }), lenses.map(|all| all.iter().map(|n| format!("{n}\\ü")).collect()));
        if kind == "annotation" {
            (look, lenses) = (None, None);
        }
        if matches!(depiction, Depiction::View(LocalView::Best { .. } | LocalView::Worldlet { .. } | LocalView::Follow { .. } | LocalView::Onboard { .. })) && pois.is_empty() {
            pois.push("p0".into());
        }
        let mut kind = LensKind::of_word(kind).unwrap();
        *kind.best_view_mut().unwrap() = BestView { pois, depiction, lenses, look };
        kind
    }
}

prop_compose! {
    fn lines()(kind in prop::sample::select(LineKind::WORDS.map(|(_, k)| k).to_vec()), color in prop::option::of(prop::array::uniform3(0.0..=1.0f32)),
        widths in prop::array::uniform2(prop::option::of(0.0..200.0f64)), skin in prop::option::of("[a-z]{1,4}"), area in any::<bool>(), hidden in any::<bool>(),
        arrow_distance_m in prop::option::of(0.0..1e6f64), fade in prop::option::of((0.0..100.0f64, 0.0..300.0f64))) -> ContextLine {
        ContextLine {
            kind, color, widths, arrow_distance_m,
            skin: skin.map(Into::into),
            to: if area { LineEnd::Area } else { LineEnd::Point },
            outside: if hidden { Outside::Hidden } else { Outside::Arrow },
            fade: fade.map(|(inner, more)| [inner, inner + more]),
        }
    }
}

fn stands() -> impl Strategy<Value = Stand> {
    let call_out = (prop::option::of(0.0..1e5f64), prop::option::of(1e-3..1e5f64), -900..=900i32);
    prop_oneof![
        Just(Stand::Laid),
        prop::array::uniform2(0.0..=1.0f64).prop_map(Stand::At),
        call_out.prop_map(|(height_m, width_m, tenths)| {
            Stand::Scene(CallOut { height_m, width_m, tilt: (f64::from(tenths) / 10.0).to_radians() })
        }),
    ]
}

prop_compose! {
    fn overlays()(priority in -1e3..1e3f64, interest in 0.0..=1.0f64, size in prop::array::uniform2(2..2000u32), has_sizes in any::<[bool; 3]>(), share in 0.01..=1.0f64,
        opacity in 0.0..=1.0f64, frame in prop::option::of(prop::sample::select(BuiltInFrame::WORDS.map(|(_, f)| f).to_vec())), masks in prop::array::uniform2(prop::option::of("[a-z]{1,4}")),
        caption in prop::option::of(".{1,6}"), line in prop::option::of(lines()), stand in stands()) -> Overlay {
        let masks = masks.map(|file| file.map(Into::into));
        let [alpha, images] = masks;
        Overlay {
            lens: String::new(), priority, interest, stand, size: has_sizes[2].then_some(size), share: if has_sizes[2] { Overlay::SHARE } else { share }, opacity, caption, line,
            min: has_sizes[0].then(|| size.map(|side| side / 2)),
            max: has_sizes[1].then(|| size.map(|side| side + 7)),
            frame: frame.map_or(Frame::Images { alpha, frame: images }, Frame::BuiltIn),
        }
    }
}

prop_compose! {
    fn layouts()(along in prop::sample::select(Along::WORDS.map(|(_, a)| a).to_vec()), sizes in prop::sample::select(Sizes::WORDS.map(|(_, s)| s).to_vec()),
        exploration_focus in any::<bool>(), margin_px in prop::option::of(0.0..100.0f64), gap_px in prop::option::of(0.0..100.0f64)) -> Layout {
        Layout { along, sizes, exploration_focus, margin_px, gap_px }
    }
}

/// Places of a piece; `least` 1: of one that is somewhere.
fn piece_places(least: usize) -> impl Strategy<Value = PiecePlace> {
    (least..11usize, prop::array::uniform2(0.0..=1.0f64)).prop_map(|(which, at)| match which {
        0 => PiecePlace::None,
        1 => PiecePlace::Auto,
        10 => PiecePlace::At(at),
        which => PiecePlace::Anchor(Anchor::WORDS[which - 2].1),
    })
}

prop_compose! {
    fn figures()(wanted in prop::array::uniform2(piece_places(1)), places in prop::array::uniform3(piece_places(0)), title in prop::option::of(".{1,8}"), caption in prop::option::of("[a-z\n\"]{1,8}"),
        text in prop::option::of((6.0..=180.0f64, any::<bool>())), dpi in prop::option::of(72.0..=150.0f64),
        paper in prop::option::of(prop_oneof![
            prop::array::uniform2(5.0..500.0f64).prop_map(Paper::Millimetres), prop::sample::select(Column::WORDS.map(|(_, c)| Paper::Column(c)).to_vec())]),
        pixels in prop::array::uniform2(100..2000u32).prop_map(|[width, height]| [width, height.min(7 * width)])) -> Figure {
        let [title_at, caption_at] = wanted;
        let [legend, scale_bar, north_arrow] = places;
        // Points of a paper without dots of its own are those of 300.
        let text = text.map(|(size, is_in_points): (f64, bool)| if is_in_points { (size.min(90.0), true) } else { (size, false) });
        let size = |(size, is_in_points): (f64, bool)| if is_in_points { TextSize::Points(size) } else { TextSize::Pixels(size) };
        let is_in_mm = matches!(paper, Some(Paper::Millimetres(_)));
        let pixels = if is_in_mm { Figure::default().size } else { pixels };
        Figure { size: pixels, paper, legend, title, title_at, caption, caption_at, scale_bar, north_arrow, text: text.map(size), dpi, ..Figure::default() }
    }
}

prop_compose! {
    fn changes()(path in "[a-z.\"]{1,9}", is_place in any::<bool>(), constant in any::<bool>(), steps in prop::collection::vec((0.01..9.0f64, point()), 1..4)) -> Change {
        let mut at = 0.0;
        let key = |(step, p): (f64, DVec3)| {
            at += step;
            let place = Numbers::List(p.to_array().map(Numbers::One).to_vec());
            ChangeKey { at, value: if is_place { place } else { Numbers::List(vec![place, Numbers::One(p.x)]) } }
        };
        let keys = steps.into_iter().map(key).collect();
        let speed = if constant && is_place { Speed::Constant } else { Speed::Keys };
        Change { path: format!("lens.{path}.{}", if is_place { "center" } else { "points" }), speed, is_place, keys }
    }
}

prop_compose! {
    /// Its camera's keys are of the projection of `camera`.
    fn animations()(frames in 1..1_000_000u32, fps in 0.01..1000.0f64, constant in any::<bool>(),
        changes in prop::collection::vec(changes(), 0..3), keys in prop::collection::vec((0.01..9.0f64, point(), point(), 1..1790u32), 0..4)) -> (Animation, Vec<u32>) {
        let (mut at, mut tenths) = (0.0, Vec::new());
        let mut camera: Vec<CameraKey> = Vec::new();
        for (step, eye, target, tenth) in keys {
            at += step;
            camera.push(CameraKey { at, eye, target, up: DVec3::new(0.0, 0.5, 2.0), projection: Projection::Orthographic { height_m: 1.0 } });
            tenths.push(tenth);
        }
        let speed = if constant { Speed::Constant } else { Speed::Keys };
        let moments = Moment::of_year(i64::from(frames % 3000)).zip(Moment::of_year(3000)).filter(|_| frames % 2 == 0);
        (Animation { frames, fps, speed, camera, changes, moments: moments.map(|(a, b)| [a, b]) }, tenths)
    }
}

fn transparencies() -> impl Strategy<Value = Transparency> {
    prop_oneof![
        prop::sample::select(&Transparency::WORDS[..]).prop_map(|word| Transparency::of(word, None).unwrap().unwrap()),
        (0..=MOST_PEELED).prop_map(|layers| Transparency::Peel { layers }),
        prop::sample::select(&SLOTS[..]).prop_map(|layers| Transparency::KBuffer { layers }),
    ]
}

prop_compose! {
    /// Ways, without their names; those by times have one for each point, and one more where they are closed.
    fn ways()(points in prop::collection::vec(point(), 2..5), by_speed in any::<bool>(), speed in 1e-6..1e3f64,
        steps in prop::collection::vec(1e-3..1e3f64, 5), flags in prop::array::uniform4(any::<bool>()), start_s in -1e6..1e6f64, above_ground in any::<bool>(),
        color in prop::array::uniform3(0.0..=1.0f32)) -> Trajectory {
        let [is_closed, is_smooth, marker, trace] = flags;
        let count = points.len() + usize::from(is_closed);
        let times = steps[..count].iter().scan(0.0, |sum, step| { *sum += step; Some(*sum) }).collect();
        let pace = if by_speed { WayPace::Speed(speed) } else { WayPace::Times(times) };
        Trajectory { name: String::new(), points, above_ground, pace, form: path::Form { is_closed, is_smooth }, start_s, color, marker, trace }
    }
}

prop_compose! {
    fn volumes()(file in "[a-zäß]{1,9}[.]nrrd", is_plume in any::<bool>(), words in prop::array::uniform3(0..8usize), flags in prop::array::uniform4(any::<bool>()),
        values in prop::collection::vec(-1e6..1e6f64, 0..5), numbers in prop::array::uniform4(0.02..15.0f64), origin in prop::option::of(point()), text in prop::option::of("[a-z\"ü]{1,6}"),
        colors in prop::collection::vec("#[0-9a-f]{6}", 2..6), opacity in prop::collection::vec(0.0..=1.0f32, 2..6), time_step in 0..9u32) -> Volume {
        let [is_visible, y_up, labels, is_ranged] = flags;
        let mut values = values;
        values.sort_by(f64::total_cmp);
        values.dedup();
        if labels {
            values = vec![3.0, 7.0, 12.0];
        }
        let count = values.len();
        let mut colors: Vec<[f32; 3]> = colors.iter().filter_map(|hex| parse_hex(hex)).collect();
        let mut opacity = opacity;
        if count > 0 {
            colors.resize(count, [0.0; 3]);
            opacity.resize(count, 0.5);
        }
        let mode = VolumeMode::WORDS[words[0]].1;
        let mixes = matches!(mode, VolumeMode::Maximum | VolumeMode::Minimum | VolumeMode::Average | VolumeMode::Gradient);
        let mode = if labels && mixes { VolumeMode::XRay } else { mode };
        let has_light = matches!(mode, VolumeMode::Direct | VolumeMode::Gradient | VolumeMode::Isosurface);
        Volume {
            name: String::new(),
            visible: is_visible,
            file: if is_plume { crate::field::PLUME.into() } else { file.into() },
            field: text.clone(),
            label: text.clone(),
            unit: text,
            component: [Component::Magnitude, Component::Index(0), Component::Index(1), Component::Index(2)][words[1] % 4],
            time_step: if is_ranged { 0 } else { time_step },
            begins: is_ranged.then(|| Moment::FIRST.max(Moment::from_micros(numbers[0] as i64 * 3_600_000_000).unwrap_or(Moment::FIRST))),
            ends: is_ranged.then_some(Moment::LAST),
            labels,
            origin,
            spacing: is_ranged.then(|| DVec3::from_slice(&numbers)),
            rotation: rotation([f64::from(time_step) * 20.0, if y_up { 15.0 } else { 0.0 }, 0.0]),
            y_up,
            transfer: Transfer {
                ramp: RAMPS[words[2]].to_owned(),
                names: if labels { ["a", "b", "c"].map(str::to_owned).to_vec() } else { Vec::new() },
                range: is_ranged.then_some([-1.5, numbers[0]]),
                colors: if y_up { colors } else { Vec::new() },
                opacity,
                values,
            },
            mode,
            level: (mode == VolumeMode::Isosurface).then_some(numbers[1]),
            slice: if mode == VolumeMode::Slice { Slice { axis: words[1] as u32 % 3, at: numbers[2] / 16.0 } } else { Slice::default() },
            light: if has_light { VolumeLight::WORDS[words[2] % 3].1 } else { VolumeLight::None },
            keeps: labels,
            thickness: is_visible.then_some(numbers[3]),
            step: numbers[2],
        }
    }
}

prop_compose! {
    fn scenes()(eye in point(), target in point(), ortho in any::<bool>(), tenths in 1..1790u32, with_camera in any::<bool>(),
        near_m in 1e-3..10.0f64, sun in (-3600..3600i32, -900..900i32, any::<bool>()), clay in any::<bool>(),
        background in prop::option::of(prop::array::uniform3(0.0..=1.0f32)), poi in prop::collection::vec((".{1,6}", point(), any::<bool>()), 0..3),
        mut lenses in prop::collection::vec(lenses(), 0..4), size in prop::array::uniform2(1..=16_384u32), samples in 1..=1024u32,
        shown in prop::collection::vec((shown(), prop::option::of(overlays())), 0..3), layout in prop::option::of(layouts()), figure in figures(), lod in prop::option::of(0..99u8), technique in prop::sample::select(&Technique::ALL[..]), transparency in transparencies(), chord_px in prop_oneof![Just(0.25), 0.02..=100.0f64], ground in any::<bool>(), files in prop::collection::vec("[ -~äß]{1,9}", 0..3),
        (animation, ways, time_s, volumes) in (prop::option::of(animations()), prop::collection::vec(ways(), 0..3), -1e6..1e6f64, prop::collection::vec(volumes(), 0..3)),
        (moment, from, undated, steps) in (prop::option::of(Moment::FIRST.micros()..=Moment::LAST.micros()), prop::option::of("[a-z]{1,5}"), any::<bool>(), operators())) -> Scene {
        let projection_of = |tenths: u32, ortho: bool| match ortho {
            true => Projection::Orthographic { height_m: f64::from(tenths) },
            false => Projection::Perspective { fov_y: (f64::from(tenths) / 10.0).to_radians() },
        };
        let projection = projection_of(tenths, ortho);
        let animation = animation.map(|(mut animation, tenths)| {
            for (key, tenths) in animation.camera.iter_mut().zip(tenths) {
                key.projection = projection_of(tenths, ortho && with_camera);
            }
            animation
        });
        let up = if clay { DVec3::Z } else { target };
        for (i, lens) in lenses.iter_mut().enumerate() {
            lens.name = format!("n\"{i}\\ü");
            // What has no heights has none above the ground.
            if lens.placement == Placement::AboveGround && !heights_of_lens(lens, &mut |_, _| {}) {
                lens.placement = Placement::World;
            }
        }
        // What views name has to be there.
        let mut pois = poi;
        let mut overlays = Vec::new();
        if !shown.is_empty() {
            pois.resize(2, ("o".into(), DVec3::ONE, true));
            let plain = Lens { name: String::new(), kind: LensKind::default(), enabled: true, color: [0.5; 3], placement: Placement::World, shapes: vec![Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }.into()], effects: vec![], time: vec![], body: LensBody::Outline, sprite: None, border: None, keeps_shadows: false, at_rest: false, section: None };
            while lenses.len() < 2 {
                lenses.push(Lens { name: format!("n\"{}\\ü", lenses.len()), ..plain.clone() });
            }
            for (kind, overlay) in shown {
                let name = format!("n\"{}\\ü", lenses.len());
                // A call-out stands above a place.
                let has_ground = |stand: &Stand| !(kind.best_view().unwrap().pois.is_empty() && matches!(stand, Stand::Scene(_)));
                let stand = overlay.as_ref().map(|own| own.stand).filter(has_ground).unwrap_or_default();
                overlays.extend(overlay.map(|overlay| Overlay { lens: name.clone(), stand, ..overlay }));
                lenses.push(Lens { name, kind, shapes: vec![], ..plain.clone() });
            }
        }
        let moving = ways.first().map(|_| Poi { name: "m".into(), place: PoiPlace::On("w0".into()) });
        let poi = pois;
        let mut scene = Scene {
            trajectories: ways.into_iter().enumerate().map(|(i, way)| Trajectory { name: format!("w{i}"), ..way }).collect(),
            volumes: volumes.into_iter().enumerate().map(|(i, volume)| Volume { name: format!("v{i}"), ..volume }).collect(),
            time_s,
            moment: moment.and_then(Moment::from_micros),
            time_steps: steps,
            overlays,
            layout: layout.unwrap_or_default(),
            camera: with_camera.then_some(Camera { eye, target, up, projection, near_m }),
            camera_above_ground: with_camera && ground,
            sun: Sun { azimuth: (f64::from(sun.0) / 10.0).to_radians(), elevation: (f64::from(sun.1) / 10.0).to_radians(), shadows: sun.2, when: if sun.2 { moment.and_then(Moment::from_micros).map_or(SunTime::Never, SunTime::At) } else if clay { SunTime::Scene } else { SunTime::Never }, place: clay.then(|| DVec2::new(f64::from(sun.1) / 10.0, f64::from(sun.0) / 20.0)), utc_offset_h: sun.2.then(|| f64::from(sun.1) / 90.0), ..Sun::default() },
            style: Style { look: StyleLook::WORDS[sun.0.unsigned_abs() as usize % 5].1, base: if clay { BaseStyle::Clay } else { BaseStyle::Natural }, effects: vec![], background: background.map_or(Background::Sky, Background::Color), technique, transparency, chord_px, facades: !clay && ground },
            pois: poi.into_iter().enumerate().map(|(i, (text, at, o))| Poi { name: format!("p{i}"), place: if o { PoiPlace::Object(text) } else if i == 1 { PoiPlace::AboveGround(at) } else { PoiPlace::At(at) } }).chain(moving).collect(),
            lenses,
            figure: Figure { size: if figure.paper.is_some() { figure.size } else { size }, samples: Some(samples), ..figure },
            animation,
            ..Scene::default()
        };
        scene.city.files = files.into_iter().filter(|f| !f.contains("${")).map(Into::into).collect();
        scene.city.lod = lod.map(|tenths| crate::city::Lod { tenths }.to_string());
        scene.city.ground = ground;
        scene.city.joins = (0..scene.lenses.len() % 3).map(|i| Join { file: format!("t{i}.csv").into(), key: from.clone().unwrap_or_default(), attribute: undated.then(|| "id".into()), valid: [clay.then(|| "since".into()), undated.then(|| "until".into())] }).collect();
        scene.city.changes = moment.and_then(Moment::from_micros).into_iter().map(|at| CityChange {
            attribute: if undated { "change".into() } else { "since".into() },
            between: if clay { Between::Moments([at, at]) } else { Between::Files { files: vec!["old.city.json".into()], key: from.clone() } },
        }).collect();
        scene.city.timetables = (0..scene.lenses.len() % 2).map(|i| format!("day{i}.csv").into()).collect();
        scene.city.dating = Dating { until: from.clone().filter(|_| clay), from, undated: if undated { Undated::Hide } else if clay { Undated::Ghost } else { Undated::Show } };
        scene
    }
}

/// Rotations agree within a rounding, all else to the bit.
fn same(a: &Scene, b: &Scene) -> bool {
    let mut b = b.clone();
    for (la, lb) in a.lenses.iter().zip(&mut b.lenses) {
        la.shapes.iter().zip(&mut lb.shapes).for_each(|(sa, sb)| turn_alike(sa, sb));
        let copied = |lens: &Lens| lens.content().and_then(|c| c.copied);
        if let (Some(a), Some(b)) = (copied(la), lb.kind.content_mut().and_then(|c| c.copied.as_mut()))
            && a.rotation.dot(b.rotation).abs() > 1.0 - 1e-12
        {
            b.rotation = a.rotation;
        }
    }
    *a == b
}

/// Gives `b` the rotations of `a` where they agree within a rounding.
fn turn_alike(a: &Region, b: &mut Region) {
    let turns = match (a, b) {
        (Region::Combined { parts: a, .. }, Region::Combined { parts: b, .. })
        | (Region::Enclosed { parts: a, .. }, Region::Enclosed { parts: b, .. }) => {
            a.iter().zip(b).for_each(|(a, b)| turn_alike(a, b));
            None
        }
        (Region::Shape(Shape::Box { rotation: ra, .. }), Region::Shape(Shape::Box { rotation: rb, .. }))
        | (
            Region::Shape(Shape::Ellipsoid { rotation: ra, .. }),
            Region::Shape(Shape::Ellipsoid { rotation: rb, .. }),
        )
        | (Region::Shape(Shape::Flat { rotation: ra, .. }), Region::Shape(Shape::Flat { rotation: rb, .. }))
        | (Region::Mesh { rotation: ra, .. }, Region::Mesh { rotation: rb, .. }) => Some((ra, rb)),
        _ => None,
    };
    if let Some((ra, rb)) = turns.filter(|(ra, rb)| ra.dot(**rb).abs() > 1.0 - 1e-12) {
        *rb = *ra;
    }
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn what_is_written_is_read_back(scene in scenes()) {
        let text = to_toml(&scene);
        let back = read_text(&text).map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert!(same(&scene, &back), "{text}\n{scene:?}\n{back:?}");
        prop_assert_eq!(to_toml(&back), text, "writing again changes nothing");
    }

    #[test]
    fn no_text_makes_it_crash(text in "[a-z\\[\\]{}=\", .0-9\n]{0,200}") {
        let _ = read_text(&text);
        let _ = read_text(&format!("veduta = 1\n[[lens]]\n{text}"));
    }
}

#[test]
fn half_turns_are_written_alike_whichever_sign_their_rounding_has() {
    for (yaw, pitch) in (0..2).flat_map(|i| (-89..90).map(move |pitch| (360 * i - 180, pitch))) {
        for roll in (-180..=180).step_by(7) {
            let turn = rotation([f64::from(yaw), f64::from(pitch) + 0.1, f64::from(roll) - 0.1]);
            let once = forms::angles(turn);
            assert!(once[0] > 0.0, "{yaw} {pitch} {roll}: {once:?}");
            assert_eq!(forms::angles(rotation(once)), once, "{yaw} {pitch} {roll}: writing again changes nothing");
        }
    }
}
