//! Which files of the library make which module.

use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    library::{
        BLEND, BORDER, BORDER_WIDTH, CITIES, CLASS, CLEAR, COLOR, COMBINED, COMBINED_DISTANCE, COMBINED_SECTION,
        COMBINED_SPRITE, DEPTH_CODE, DITHER, EDGE, FADING_MEMBERS, FADING_OUTLINE, FIELDS, FILTERED, FIXED, FORM,
        FRAGMENT, FRAGMENT_AT, File, GLASS, INSTANTS, LENS, LENS_SPRITE, LIFETIME, LIGHT, LINE, LINES, MATERIAL,
        MEMBER_OUTLINE, MEMBERS, MOMENT, MOVING, NO_FIELDS, OBJECTS, ONE_CITY, OUTLINE, OWN_SPRITE, PACKED, POINT,
        REGION, SECTIONS, SHELL_SIDES, SHELL_SPRITE, SIGHT, SOLID_DISTANCE, SOLID_SPRITE, STORED_SPRITE, SURFACE,
        TEXEL, TRANSPARENCY, VARYING, VIEW, VIEW_UNIFORM,
    },
    plan::program::Program,
};

/// A pass that draws the city and asks of each fragment what is there.
pub(super) fn of_city(program: &Program, behind: &[File]) -> Vec<File> {
    let lenses = of_lenses(program);
    let objects = of_objects(program);
    [&[VIEW, VIEW_UNIFORM, SURFACE, SIGHT], &lenses[..], &objects, &[FRAGMENT, FRAGMENT_AT, vertices(program)], behind]
        .concat()
}

/// The same of translucent fragments, which keep colours.
pub(super) fn of_translucent_city(program: &Program, behind: &[File]) -> Vec<File> {
    let lenses = of_lenses(program);
    let first = [VIEW, VIEW_UNIFORM, SURFACE, PACKED, TEXEL, SIGHT];
    [&first, &lenses[..], &of_objects(program), &[FRAGMENT, FRAGMENT_AT, vertices(program)], behind].concat()
}

/// The pass that draws lines, and what it calls.
pub(super) fn of_lines(program: &Program) -> Vec<File> {
    let cities = vertices(program);
    let mut files = vec![VIEW, VIEW_UNIFORM, SURFACE, COLOR, LIGHT];
    files.extend(of_objects(program));
    files.extend([POINT, SIGHT, FRAGMENT, cities, EDGE]);
    if program.has().blends {
        files.push(BLEND);
    }
    files.extend(of_lenses(program));
    files.push(LINES);
    files
}

/// What compositing calls of fields.
pub(super) fn of_fields(program: &Program) -> Vec<File> {
    if !program.has().fields {
        return vec![NO_FIELDS];
    }
    vec![FRAGMENT, FIELDS]
}

/// The libraries that shading calls.
pub(super) fn of_shading(program: &Program, handlers: &[EffectDefinition]) -> Vec<File> {
    let parts = program.has();
    let has = |kind| program.effects().iter().any(|&e| handlers[e as usize].kind == kind);
    let (materials, filters) = (has(EffectKind::Material), has(EffectKind::Filter));
    let mut files = vec![VIEW, SURFACE, COLOR, PACKED, LIGHT, OBJECTS, POINT, SIGHT];
    files.extend(of_time(program));
    files.push(values(program));
    files.extend(of_lenses(program));
    files.extend(if parts.shells { of_spans(program) } else { Vec::new() });
    files.extend(used(&[
        (parts.blends || materials, BLEND),
        (materials, MATERIAL),
        (parts.bodies, OUTLINE),
        (parts.bodies && parts.members, MEMBER_OUTLINE),
        (parts.bodies && parts.fading_members, FADING_OUTLINE),
        (parts.shells, GLASS),
        (filters, FILTERED),
        (parts.lines, LINE),
        (parts.transparency, TRANSPARENCY),
    ]));
    files
}

/// The pass that finds where volumes end, and what it calls.
pub(super) fn of_sections(program: &Program) -> Vec<File> {
    [
        &[VIEW, VIEW_UNIFORM, SURFACE, SIGHT],
        &of_lenses(program)[..],
        &of_spans(program)[..],
        program.has().combinations.then_some(COMBINED_SECTION).as_slice(),
        &of_objects(program)[..],
        &[FRAGMENT, vertices(program), SECTIONS],
    ]
    .concat()
}

/// What is known of objects.
pub(super) fn of_objects(program: &Program) -> Vec<File> {
    [&[OBJECTS], &of_time(program)[..], &[values(program)]].concat()
}

/// How values of objects are read.
fn values(program: &Program) -> File {
    if program.has().varies { VARYING } else { FIXED }
}

/// What is known of when they are there.
fn of_time(program: &Program) -> Vec<File> {
    let parts = program.has();
    used(&[(parts.timed, MOMENT), (parts.timed, LIFETIME), (parts.partly, INSTANTS), (parts.moves, MOVING)])
}

/// Where vertices stand: of the scene's own city, or also of contents.
pub(super) fn vertices(program: &Program) -> File {
    if program.has().has_cities() { CITIES } else { ONE_CITY }
}

/// The lens tests that a program makes.
pub(super) fn of_lenses(program: &Program) -> Vec<File> {
    let parts = program.has();
    let mut files = used(&[(parts.lenses, CLASS), (parts.lenses, REGION), (parts.lenses, FORM)]);
    files.extend(program.forms().files());
    files.extend(used(&[
        (parts.closed, LENS),
        (parts.closed && parts.outlines, CLEAR),
        (parts.sprites || parts.own_sprites || parts.side_sprites, LENS_SPRITE),
        (parts.sprites || parts.own_sprites, DEPTH_CODE),
        (parts.sprites || parts.own_sprites, STORED_SPRITE),
        (parts.own_sprites, OWN_SPRITE),
        (parts.members, MEMBERS),
        (parts.borders || parts.fading, DITHER),
        (parts.fading, FADING_MEMBERS),
        (parts.side_sprites, SOLID_SPRITE),
        (parts.combinations, COMBINED),
        (parts.combined_sprites, COMBINED_SPRITE),
        (parts.borders || parts.distances, BORDER_WIDTH),
        (parts.borders, BORDER),
        (parts.by_ray && parts.side_sprites, SHELL_SIDES),
        (parts.by_ray && parts.sprites, SHELL_SPRITE),
        (parts.distances && parts.solids, SOLID_DISTANCE),
        (parts.distances && parts.combinations, COMBINED_DISTANCE),
    ]));
    files
}

/// The libraries that tell from sprites where a ray is inside.
pub(super) fn of_spans(program: &Program) -> Vec<File> {
    let parts = program.has();
    // With borders along rays they are there already.
    let is_new = !parts.by_ray;
    used(&[(parts.side_sprites && is_new, SHELL_SIDES), (parts.sprites && is_new, SHELL_SPRITE)])
}

/// With the threshold of a pixel, which fragments know.
pub(super) fn with_threshold(mut files: Vec<File>) -> Vec<File> {
    if files.contains(&FRAGMENT) && !files.contains(&DITHER) {
        files.push(DITHER);
    }
    files
}

fn used(files: &[(bool, File)]) -> Vec<File> {
    files.iter().filter(|(is_used, _)| *is_used).map(|(_, file)| *file).collect()
}
