//! What a picture warns of: codes that come from the scene and not from a file (docs/warnings.md).

use std::collections::{BTreeMap, BTreeSet};

use crate::{
    render::{
        content_cities::SceneContents,
        deformed::DeformedFigures,
        displayed::Showing,
        enclosed::{areas, objects_meeting, with_corners_outside},
        furniture::{Furniture, Piece},
        picture::{Picture, Studio},
        resolve::Resolved,
        section_rounds::ends_of,
        text::{cleaned, has_glyph},
    },
    scene::Scene,
};

/// The codes.
pub const CODES: [&str; 11] = [
    SPRITE_LAYERS,
    OPEN_SHELLS,
    NOT_DERIVED,
    NOTHING_DERIVED,
    DERIVED_INSTEAD,
    WEAKENED,
    LAYER_ROOM,
    COARSE,
    NO_GLYPH,
    SEEN_TWICE,
    VOLUME_UNSEEN,
];

/// Rays have more intervals than a sprite has layers.
const SPRITE_LAYERS: &str = "sprite-layers";
/// What sections were asked for encloses nothing.
const OPEN_SHELLS: &str = "open-shells";
/// What a content was to derive has no such form.
const NOT_DERIVED: &str = "not-derived";
/// Of what a content derives nothing is left.
const NOTHING_DERIVED: &str = "nothing-derived";
/// What a content was to show has no such geometry, and something else stands for it.
const DERIVED_INSTEAD: &str = "derived-instead";

/// A deformation would fold space as it was asked for.
const WEAKENED: &str = "deformation-weakened";
/// What is deformed has more triangles than there is room for.
const COARSE: &str = "deformation-coarse";

/// City objects by lens that its content shows as they are, such that it leaves out, and such that it shows as something else, since
/// they have no form that it derives.
pub(super) fn not_derived(contents: &SceneContents) -> [BTreeMap<u32, u32>; 3] {
    [0, 1, 2].map(|which| {
        let of = |lens: u32| Some(contents.of_lens(lens)?.city.as_ref()?.not_derived[which]);
        let counts = contents.uses.iter().filter_map(|used| Some((used.lens, of(used.lens)?)));
        counts.filter(|(_, count)| *count > 0).collect()
    })
}

/// A lens that bends rays shows things more than once.
const SEEN_TWICE: &str = "rays-fold";

/// Nothing is seen of a volume, whatever the eye.
const VOLUME_UNSEEN: &str = "volume-unseen";

/// Translucent fragments found no room.
const LAYER_ROOM: &str = "layer-room";

/// Text has characters that no font has.
const NO_GLYPH: &str = "no-glyph";
/// Characters that a message names; the others are counted.
const MOST_NAMED: usize = 5;

/// The characters of `furniture` that no font has, each once.
pub fn without_glyph(furniture: &Furniture) -> BTreeSet<char> {
    let texts = furniture.pieces.iter().filter_map(|piece| match piece {
        Piece::Text(line) => Some(&line.text),
        Piece::Panel(_) | Piece::Image(_) | Piece::Board(_) | Piece::Strip(_) | Piece::Polygon(_) => None,
    });
    texts.flat_map(|text| cleaned(text).chars().collect::<Vec<_>>()).filter(|c| !has_glyph(*c)).collect()
}

/// How many they are, and which.
pub fn boxes(missing: &BTreeSet<char>) -> Option<(u64, String)> {
    let named: Vec<String> =
        missing.iter().take(MOST_NAMED).map(|c| format!("{c} (U+{:04X})", u32::from(*c))).collect();
    let more =
        if missing.len() > MOST_NAMED { format!(" and {} more", missing.len() - MOST_NAMED) } else { String::new() };
    let message = format!("no font has {}{more}: drawn as boxes", named.join(", "));
    (!missing.is_empty()).then_some((missing.len() as u64, message))
}

/// What is missing of translucent layers, of all samples and parts of a picture.
fn missing_layers(picture: &Picture) -> Option<(u64, String)> {
    let count = picture.layers.excess;
    let all = picture.layers.nodes;
    (count > 0).then(|| (count, format!("{count} of {all} translucent fragments found no room and are missing")))
}

/// What a deformation bends more than triangles follow.
fn coarse(picture: &Picture) -> Option<(u64, String)> {
    let DeformedFigures { report, asked_px, .. } = picture.deformed?;
    let count = report.too_coarse as u64;
    let message = if report.tolerance_px > asked_px {
        format!(
            "what is deformed is {} pixels from where it should be at most, not {asked_px}: else it had too many triangles",
            report.tolerance_px
        )
    } else {
        let places = if count == 1 { "place" } else { "places" };
        format!(
            "{count} {places} of what is deformed stay more than {asked_px} pixels off: edges there are too short to split"
        )
    };
    (count > 0 || report.tolerance_px > asked_px).then(|| (count.max(1), message))
}

/// City objects by lens that are cut by it and would have a section, were they closed shells: some of their triangles meet it,
/// and some of their corners lie outside.
pub(super) fn open_shells(studio: &Studio, resolved: &Resolved) -> BTreeMap<u32, u32> {
    let Resolved { volumes, operations, deformations, .. } = resolved;
    let mut open = BTreeMap::new();
    let Some(city) = studio.renderer.city() else { return open };
    let is_closed =
        |object: &u32| city.shells.contains_key(object) || studio.model.objects[*object as usize].class.is_ground();
    for of_lens in volumes.chunk_by(|a, b| a.lens == b.lens).filter(|v| v[0].section.is_some()) {
        if ends_of(operations, of_lens[0].lens).is_empty() {
            continue;
        }
        let areas = areas(of_lens);
        let (city, showing) = (studio.shown(), Showing::of_city(&deformations.moved));
        let mut met = objects_meeting(city, &areas, &showing);
        met.retain(|object| !is_closed(object));
        let count = with_corners_outside(city, &met, &areas, &showing).len() as u32;
        if count > 0 {
            open.insert(of_lens[0].lens, count);
        }
    }
    open
}

/// A diagnostic of lenses.
struct Diagnostic {
    code: &'static str,
    /// What is counted, by lens.
    counts: fn(&Picture) -> &BTreeMap<u32, u32>,
    /// The message, from a lens' name and its count.
    message: fn(&str, u32) -> String,
}

const DIAGNOSTICS: &[Diagnostic] = &[
    Diagnostic {
        code: SPRITE_LAYERS,
        counts: |picture| &picture.excess,
        message: |lens, rays| {
            format!(
                "{rays} rays enter lens \"{lens}\" more often than its sprite has layers; more (sprite.layers) would be right"
            )
        },
    },
    Diagnostic {
        code: OPEN_SHELLS,
        counts: |picture| &picture.open,
        message: |lens, objects| {
            let are = if objects == 1 { "object that lens" } else { "objects that lens" };
            let what =
                if objects == 1 { "is no closed shell: it shows its" } else { "are no closed shells: they show their" };
            format!("{objects} {are} \"{lens}\" meets {what} inside where it is cut, and no section")
        },
    },
    Diagnostic {
        code: NOT_DERIVED,
        counts: |picture| &picture.not_derived[0],
        message: |lens, objects| {
            let are = if objects == 1 { "object has" } else { "objects have" };
            format!("{objects} {are} no such form as lens \"{lens}\" asks for (flat, without area); shown unchanged")
        },
    },
    Diagnostic {
        code: NOTHING_DERIVED,
        counts: |picture| &picture.not_derived[1],
        message: |lens, objects| {
            let are = if objects == 1 { "object" } else { "objects" };
            format!("{objects} {are} of which lens \"{lens}\" leaves nothing (upright faces only)")
        },
    },
    Diagnostic {
        code: DERIVED_INSTEAD,
        counts: |picture| &picture.not_derived[2],
        message: |lens, objects| {
            let (have, prisms) = if objects == 1 { ("object has", "a prism") } else { ("objects have", "prisms") };
            format!(
                "{objects} {have} no level of detail 1, as lens \"{lens}\" asks for; shown as {prisms} over the footprint"
            )
        },
    },
    Diagnostic {
        code: WEAKENED,
        counts: |picture| &picture.weakened,
        message: |lens, permille| {
            let percent = f64::from(permille) / 10.0;
            format!("lens \"{lens}\" would fold space: used at {percent} % of its strength")
        },
    },
    Diagnostic {
        code: SEEN_TWICE,
        counts: |picture| &picture.folded,
        message: |lens, permille| {
            let percent = f64::from(permille) / 10.0;
            format!(
                "lens \"{lens}\" shows things more than once, turned round in {percent} % of what it changes; a wider band (border, of a feature lens radius) or a magnification nearer to 1 would not"
            )
        },
    },
];

fn each<'a>(scene: &'a Scene, picture: &'a Picture, of: &Diagnostic) -> Vec<(&'a str, u32, String)> {
    let of_lens = |(lens, count): (&u32, &u32)| {
        let name = scene.lenses[*lens as usize].name.as_str();
        (name, *count, (of.message)(name, *count))
    };
    (of.counts)(picture).iter().map(of_lens).collect()
}

/// Diagnostics of no lens: code, count, message.
fn of_pictures(picture: &Picture) -> impl Iterator<Item = (&'static str, u64, String)> {
    let unseen = &picture.unseen_volumes;
    let found = [
        (LAYER_ROOM, missing_layers(picture)),
        (COARSE, coarse(picture)),
        (NO_GLYPH, boxes(&picture.without_glyph)),
        (VOLUME_UNSEEN, (!unseen.is_empty()).then(|| (unseen.len() as u64, unseen.join("; ")))),
    ];
    found.into_iter().filter_map(|(code, found)| found.map(|(count, message)| (code, count, message)))
}

/// One line for each diagnostic, and each lens that has it.
pub(super) fn messages(scene: &Scene, picture: &Picture) -> Vec<String> {
    let of_lenses = DIAGNOSTICS.iter().flat_map(|of| each(scene, picture, of)).map(|(_, _, message)| message);
    of_lenses.chain(of_pictures(picture).map(|(_, _, message)| message)).collect()
}

/// The same in the form of warnings of files.
pub(super) fn warnings(scene: &Scene, picture: &Picture) -> Vec<serde_json::Value> {
    let warning = |of: &Diagnostic| {
        let all = each(scene, picture, of);
        let lenses: Vec<&str> = all.iter().map(|(lens, ..)| *lens).collect();
        let messages: Vec<&str> = all.iter().map(|(.., message)| message.as_str()).collect();
        let count: u32 = all.iter().map(|(_, count, _)| count).sum();
        let code = of.code;
        (count > 0).then(
            || serde_json::json!({ "code": code, "count": count, "objects": lenses, "message": messages.join("; ") }),
        )
    };
    let of_pictures = of_pictures(picture).map(
        |(code, count, message)| serde_json::json!({ "code": code, "count": count, "objects": [], "message": message }),
    );
    DIAGNOSTICS.iter().filter_map(warning).chain(of_pictures).collect()
}
