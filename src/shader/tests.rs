use std::{
    collections::BTreeSet,
    hash::{DefaultHasher, Hash as _, Hasher as _},
    sync::{Mutex, PoisonError},
};

use wgpu::naga;

use super::*;
use crate::{geom::shape::VolumeForm, seeds::is_thorough};

fn step(effect: u32, scope: Scope, blend: Option<Blend>) -> Step {
    Step { effect, scope, parameters: 0, blend }
}

/// All that a combination may be made of.
const LEAVES: [Form; 9] = [
    Form::Volume(VolumeForm::Sphere),
    Form::Volume(VolumeForm::Box),
    Form::Volume(VolumeForm::Cylinder),
    Form::Volume(VolumeForm::Convex),
    Form::Volume(VolumeForm::Ellipsoid),
    Form::Volume(VolumeForm::Frustum),
    Form::Volume(VolumeForm::Solid),
    Form::Members,
    Form::FadingMembers,
];

/// All lens tests.
fn tests() -> Vec<LensTest> {
    LensTest::all().collect()
}

/// As the sun asks: no sprite tells it anything.
fn by_shapes(mut program: Program) -> Program {
    let by_shape = |test: &mut LensTest| match test {
        LensTest::Sprite | LensTest::LayeredSprite => *test = LensTest::volume(VolumeForm::Sphere),
        LensTest::Sides(form) => *test = LensTest::Numbers(*form),
        _ => {}
    };
    match &mut program {
        Program::Specialised(plan) => {
            plan.lenses.iter_mut().flat_map(|l| &mut l.volumes).for_each(by_shape);
            *plan = plan.clone().without_borders();
        }
        Program::Uber(uber) => {
            uber.borders = false;
            uber.by_ray = false;
            uber.tests.iter_mut().for_each(by_shape);
            uber.tests.sort_unstable();
            uber.tests.dedup();
        }
    }
    program
}

/// The numbers of all effects.
fn numbers() -> Vec<u32> {
    let is_effect = |(_, h): &(usize, &EffectDefinition)| effect::find(&h.name).is_some();
    handlers().iter().enumerate().filter(is_effect).map(|(i, _)| i as u32).collect()
}

/// What the two lenses show: nothing, or all ways to clip.
fn contents_of(seed: usize) -> Vec<PlanContent> {
    let content = |i: usize| PlanContent {
        lens: i as u32,
        class: ClassTest::ALL[(seed + i) % 4],
        city: (i + seed % 30) as u32 + 1,
        clip: Clip::ALL[(seed / 2 + i) % 3],
        keeps_terrain: (seed + i).is_multiple_of(4),
    };
    (0..if seed.is_multiple_of(2) { 0 } else { 2 }).map(content).collect()
}

/// What the two lenses do to the moment: nothing, or all that there is.
fn epochs_of(seed: usize) -> Vec<PlanEpoch> {
    let all = (0..).zip(handlers()).filter(|(_, handler)| handler.kind == EffectKind::Epoch).map(|(number, _)| number);
    let of_lens =
        |lens: u32| all.clone().map(move |handler| PlanEpoch { lens, handler, words: 8 + handler % 9, bit: 31 + lens });
    match seed % 3 {
        1 => of_lens(0).chain(of_lens(1)).collect(),
        _ => Vec::new(),
    }
}

/// A scene of the context and two lenses whose steps are these effects, in order; `seed` chooses classes, blends,
/// bodies and masks. The modules that both back ends need for it.
fn modules(effects: &[u32], seed: usize) -> Vec<Module> {
    let scopes: Vec<Scope> = std::iter::once(Scope::Everywhere)
        .chain(ClassTest::ALL.into_iter().flat_map(|c| [Scope::Lens(0, c), Scope::Lens(1, c)]))
        .collect();
    let mut steps = Vec::new();
    for (i, &effect) in effects.iter().enumerate() {
        let blend = (i + seed).is_multiple_of(3).then(|| Blend::ALL[(i + seed) % 6]);
        steps.push(step(effect, scopes[(seed + 4 * i) % scopes.len()], blend));
    }
    let lens = |number, volumes: &[usize], body| PlanLens {
        number,
        volumes: volumes.iter().map(|v| tests()[(seed + v) % tests().len()]).collect(),
        leaves: LEAVES[seed % 8..].to_vec(),
        body,
        border: seed.is_multiple_of(5).then_some(PlanBorder {
            parameters: 5,
            dithers: seed.is_multiple_of(2),
            by_ray: seed.is_multiple_of(3),
        }),
    };
    let kind = [BodyKind::Outline, BodyKind::Shell, BodyKind::Halo][seed / 2 % 3];
    let body = seed.is_multiple_of(2).then_some(PlanBody { kind, parameters: 3 });
    let plan = Plan {
        lenses: vec![lens(0, &[0], None), lens(40, &[1, 2], body)],
        lines: effects.iter().any(|&e| handlers()[e as usize].lines),
        steps,
        haze: seed.is_multiple_of(5),
        masks: seed.is_multiple_of(7),
        contents: contents_of(seed),
        clear_materials: seed.is_multiple_of(4),
        timed: seed % 3 < 2,
        partly: seed % 3 == 1,
        moves: seed % 3 < 2 && seed % 7 < 3,
        bends: Bends {
            images: u32::from(seed % 8 == 1),
            planes: (seed % 4) as u32 / 3 + u32::from(seed.is_multiple_of(5)),
            grids: seed % 3 == 2,
            choosing: if seed % 4 == 3 { 1 } else { 0 },
            ..Bends::default()
        },
        fields: seed % 5 > 2,
        varies: seed % 3 < 2 && seed % 5 < 2,
        lit: seed % 3 < 2 && seed % 5 < 1,
        epochs: epochs_of(seed),
        ..Plan::default()
    };
    let uber = Uber {
        effects: plan.effects(),
        tests: {
            let mut tests: Vec<LensTest> = plan.tests().collect();
            tests.sort_unstable();
            tests
        },
        leaves: LEAVES[seed % 8..].to_vec(),
        bodies: plan.bodies(),
        sides: !seed.is_multiple_of(3),
        borders: plan.has_borders(),
        by_ray: plan.has_borders() && seed.is_multiple_of(3),
        dithers: plan.has_borders(),
        blends: plan.has_blends(),
        haze: plan.haze,
        masks: plan.masks,
        lines: plan.lines,
        transparency: false,
        clear_materials: plan.clear_materials,
        fields: plan.fields,
        contents: !plan.contents.is_empty(),
        timed: plan.timed,
        partly: plan.partly,
        moves: plan.moves,
        bends: plan.bends,
        varies: plan.varies,
        lit: plan.lit,
        epochs: Program::Specialised(plan.clone()).epochs(),
    };
    let hiding = plan.hiding(handlers()).map(Program::Specialised).into_iter();
    let hiding = hiding.chain(uber.hiding(handlers()).map(Program::Uber));
    let has_lenses = |p: &Program| p.has().lenses;
    let lining = plan.lining(handlers()).map(Program::Specialised).into_iter();
    let lining = lining.chain(uber.lining(handlers()).map(Program::Uber));
    // Adapters and methods that differ in a line take turns.
    let turn = (seed / 2).is_multiple_of(2);
    let mut modules: Vec<Module> = hiding
        .clone()
        .flat_map(|p| {
            let layers = [Module::Layers(p.clone(), turn), Module::Slots(p.clone(), !turn)];
            [Module::Geometry(Some(p.clone())), Module::Shadow(Some(by_shapes(p)))].into_iter().chain(layers)
        })
        .collect();
    let layering = [
        plan.layering(handlers()).map(Program::Specialised).zip(plan.hiding(handlers()).map(Program::Specialised)),
        uber.layering(handlers()).map(Program::Uber).zip(uber.hiding(handlers()).map(Program::Uber)),
    ];
    for (shading, hidden) in layering.into_iter().flatten() {
        modules.push(Module::Composite(shading.clone()));
        modules.extend([ForwardKind::Tail, ForwardKind::Chance(turn)].map(|kind| {
            let (hidden, shading) = (hidden.clone(), shading.clone());
            Module::Forward(Forward { kind, hidden, shading })
        }));
    }
    modules.extend(hiding.filter(has_lenses).map(Module::Sections));
    modules.extend(lining.map(Module::Lines));
    modules.push(Module::Shade(Program::Specialised(plan.shading(handlers()))));
    modules.push(Module::Shade(Program::Uber(uber.shading(handlers()))));
    modules
}

/// All controls with all steps, with and without a band.
fn every_deformer() -> DeformPlan {
    let is_step = |number: &u32| handlers()[*number as usize].kind == EffectKind::Deform;
    let controls = [
        PlanControl::Everywhere,
        PlanControl::Linear,
        PlanControl::Smooth,
        PlanControl::Bump,
        PlanControl::Ring,
        PlanControl::Texels,
    ];
    let all = (0..handlers().len() as u32).filter(is_step);
    let steps: Vec<PlanStep> = all.map(|number| PlanStep::new(number, handlers())).collect();
    assert_eq!(steps.len(), 7, "translate, scale, shear, taper, twist, bend and open-street");
    let deformer = |control| [false, true].map(|has_band| PlanDeformer { control, has_band, steps: steps.clone() });
    DeformPlan(controls.into_iter().flat_map(deformer).collect())
}

fn all_modules() -> Vec<Module> {
    let plain = [Program::Specialised(Plan::default()), Program::Uber(Uber::default())];
    let mut modules = vec![
        Module::Geometry(None),
        Module::Shadow(None),
        Module::Sprite,
        Module::AmbientOcclusion,
        Module::Resolve,
        Module::Narrow,
        Module::Refine(DeformPlan::default()),
        Module::Refine(every_deformer()),
        Module::Bare,
    ];
    modules.extend(plain.map(Module::Shade));
    modules.push(Module::SpriteList);
    modules.extend(
        VolumeForm::ALL.iter().filter(|f| Form::Volume(**f).closed().is_some()).map(|f| Module::StoredForm(*f)),
    );
    modules.extend(LEAVES[..7].iter().map(|kind| Module::StoredLayers(vec![*kind])));
    modules.push(Module::StoredLayers(LEAVES[..7].to_vec()));
    modules.push(Module::CombinedSprite(LEAVES.to_vec()));
    modules.extend(LEAVES.map(|kind| Module::CombinedSprite(vec![kind])));
    let is_filter = |e: &u32| handlers()[*e as usize].kind == EffectKind::Filter;
    modules.extend(numbers().into_iter().filter(is_filter).map(Module::Filter));
    modules.extend([Module::Furniture, Module::FurnitureOver]);
    modules.extend([Module::CountLayers, Module::SortLayers, Module::ShownLayers, Module::LinkSlots]);
    modules
}

#[test]
fn contents_alone_make_modules_that_are_valid() {
    let lens = |number| PlanLens {
        number,
        volumes: vec![LensTest::volume(VolumeForm::Sphere)],
        leaves: vec![],
        body: None,
        border: None,
    };
    for contents in [contents_of(1), contents_of(3), contents_of(5)] {
        let plan = Plan { lenses: vec![lens(0), lens(1)], contents, ..Plan::default() };
        let uber = Uber { tests: vec![LensTest::volume(VolumeForm::Sphere)], contents: true, ..Uber::default() };
        let hiding = [
            Program::Specialised(plan.hiding(handlers()).expect("something is clipped")),
            Program::Uber(uber.hiding(handlers()).expect("something may be clipped")),
        ];
        for program in hiding {
            validate(&Module::Geometry(Some(program.clone())));
            validate(&Module::Shadow(Some(program)));
        }
        assert!(plan.shading(handlers()).contents.is_empty(), "shading asks what is there, not why");
    }
}

fn validate(module: &Module) {
    validate_text(&module.name(), &module.source());
}

/// Validates a text, once in the life of the process: most modules of most scenes are those of another.
fn validate_text(name: &str, source: &str) {
    static KNOWN: Mutex<BTreeSet<u64>> = Mutex::new(BTreeSet::new());
    let mut hasher = DefaultHasher::new();
    source.hash(&mut hasher);
    if !KNOWN.lock().unwrap_or_else(PoisonError::into_inner).insert(hasher.finish()) {
        return;
    }
    assert!(!source.contains("//@") && !source.contains("/*@"), "{name}: a hook is left");
    let parsed = match naga::front::wgsl::parse_str(source) {
        Ok(parsed) => parsed,
        Err(error) => panic!("{name}: {}", error.emit_to_string(source)),
    };
    let mut validator = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::default()
            | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32
            | naga::valid::Capabilities::EARLY_DEPTH_TEST,
    );
    if let Err(error) = validator.validate(&parsed) {
        panic!("{name}: {}", error.emit_to_string(source));
    }
    let functions = parsed.functions.iter().map(|(_, function)| function);
    for function in functions.chain(parsed.entry_points.iter().map(|entry| &entry.function)) {
        if let Some(span) = branch_on_uniforms(&parsed, function, &function.body) {
            let line = span.location(source).line_number as usize;
            let text = source.lines().nth(line - 1).unwrap_or_default().trim();
            panic!(
                "{name}, line {line} ({text}): a branch on nothing but uniforms, for which Mesa's software driver compiles anew in each frame; use select()"
            );
        }
    }
}

/// Where a block goes one way or another by uniforms and constants alone.
fn branch_on_uniforms(module: &naga::Module, function: &naga::Function, block: &naga::Block) -> Option<naga::Span> {
    use naga::Statement as S;
    let is_decided = |condition: naga::Handle<naga::Expression>| leaves(module, function, condition) == [false, true];
    block.span_iter().find_map(|(statement, span)| {
        let (conditions, blocks): (Vec<_>, Vec<&naga::Block>) = match statement {
            S::Block(inner) => (vec![], vec![inner]),
            S::If { condition, accept, reject } => (vec![*condition], vec![accept, reject]),
            S::Switch { selector, cases } => (vec![*selector], cases.iter().map(|case| &case.body).collect()),
            S::Loop { body, continuing, break_if } => (break_if.iter().copied().collect(), vec![body, continuing]),
            _ => return None,
        };
        if conditions.into_iter().any(is_decided) {
            return Some(*span);
        }
        blocks.into_iter().find_map(|inner| branch_on_uniforms(module, function, inner))
    })
}

/// Whether an expression depends on anything but uniforms and constants; whether on a uniform.
fn leaves(module: &naga::Module, function: &naga::Function, of: naga::Handle<naga::Expression>) -> [bool; 2] {
    use naga::Expression as E;
    let all = |parts: &[naga::Handle<naga::Expression>]| {
        let each = parts.iter().map(|part| leaves(module, function, *part));
        each.fold([false; 2], |[a, b], [c, d]| [a | c, b | d])
    };
    match &function.expressions[of] {
        E::Literal(_) | E::Constant(_) | E::Override(_) | E::ZeroValue(_) => [false; 2],
        E::GlobalVariable(global) => {
            let global = &module.global_variables[*global];
            let is_of_frame = matches!(global.name.as_deref(), Some("view" | "light" | "eye" | "refinement"));
            let is_of_frame = is_of_frame && global.space == naga::AddressSpace::Uniform;
            [!is_of_frame, is_of_frame]
        }
        E::Load { pointer: part }
        | E::AccessIndex { base: part, .. }
        | E::Splat { value: part, .. }
        | E::Swizzle { vector: part, .. }
        | E::Unary { expr: part, .. }
        | E::Relational { argument: part, .. }
        | E::As { expr: part, .. } => all(&[*part]),
        E::Access { base, index } => all(&[*base, *index]),
        E::Binary { left, right, .. } => all(&[*left, *right]),
        E::Select { condition, accept, reject } => all(&[*condition, *accept, *reject]),
        E::Compose { components, .. } => all(components),
        E::Math { arg, arg1, arg2, arg3, .. } => {
            let parts: Vec<_> = [Some(*arg), *arg1, *arg2, *arg3].into_iter().flatten().collect();
            all(&parts)
        }
        _ => [true, false],
    }
}

/// Effects, and what chooses all else of a scene.
type Seeded = (Vec<u32>, usize);

fn validate_all(lists: &[Seeded]) {
    use rayon::prelude::*;
    lists.par_iter().for_each(|(list, seed)| modules(list, *seed).iter().for_each(validate));
}

/// Each list with a seed of its own.
fn numbered(lists: impl Iterator<Item = Vec<u32>>) -> Vec<Seeded> {
    lists.enumerate().map(|(seed, list)| (list, seed)).collect()
}

/// Each effect so often.
fn singles(times: usize) -> impl Iterator<Item = Vec<u32>> {
    numbers().into_iter().flat_map(move |a| vec![vec![a]; times])
}

fn pairs() -> impl Iterator<Item = Vec<u32>> {
    let all = numbers();
    all.clone().into_iter().flat_map(move |a| all.clone().into_iter().map(move |b| vec![a, b]))
}

/// A hundred triples: three effects of every three prototypes, those of one prototype in turn, and in turn in all orders.
fn covering_triples() -> Vec<Vec<u32>> {
    let of = |kind| numbers().into_iter().filter(move |&e| handlers()[e as usize].kind == kind).collect::<Vec<_>>();
    let kinds: Vec<Vec<u32>> = EffectKind::ALL.map(of).into_iter().filter(|effects| !effects.is_empty()).collect();
    let mut taken = vec![0; kinds.len()];
    let mut next = |kind: usize| {
        taken[kind] += 1;
        kinds[kind][(taken[kind] - 1) % kinds[kind].len()]
    };
    let choices = (0..kinds.len()).flat_map(|a| (a..kinds.len()).map(move |b| [a, b]));
    let choices: Vec<[usize; 3]> =
        choices.flat_map(|[a, b]| (b..kinds.len()).map(move |c| [a, b, c]).collect::<Vec<_>>()).collect();
    let triple = |(i, kinds): (usize, &[usize; 3])| {
        let mut triple = kinds.map(&mut next).to_vec();
        triple.rotate_left(i % 3);
        if i % 2 == 1 {
            triple.swap(0, 1);
        }
        triple
    };
    choices.iter().cycle().take(100.max(choices.len())).enumerate().map(triple).collect()
}

#[test]
fn regions_of_all_kinds_are_told_apart_by_valid_wgsl() {
    let [sepia, gloss, cel] = ["sepia", "gloss", "cel"].map(|name| effect::number_of(name).expect("there is one"));
    for (seed, test) in LensTest::all().enumerate() {
        let lens = |number| PlanLens { number, volumes: vec![test], leaves: LEAVES.to_vec(), body: None, border: None };
        let steps = vec![
            step(sepia, Scope::Everywhere, None),
            step(cel, Scope::Lens(0, ClassTest::Inside), None),
            step(gloss, Scope::Lens(1, ClassTest::ALL[seed % 4]), None),
            step(sepia, Scope::Lens(1, ClassTest::ALL[(seed + 1) % 4]), Some(Blend::Multiply)),
        ];
        let plan = Plan { lenses: vec![lens(0), lens(1)], steps, haze: seed % 2 == 0, ..Plan::default() };
        for regions in [Regions::combinations(&plan), Regions::passes(&plan)] {
            let plan = Plan { regions: Some(regions.clone()), ..plan.clone() };
            validate(&Module::Geometry(Some(Program::Specialised(plan.clone()))));
            validate(&Module::Regions(plan.clone()));
            for region in 0..regions.count().expect("few") {
                validate(&Module::Shade(Program::Specialised(plan.of_region(region))));
            }
        }
        let regions = Some(Regions::combinations(&plan));
        validate(&Module::Shade(Program::Specialised(Plan { regions, masks: seed % 3 == 0, ..plan })));
    }
}

/// Adapters may have four bind groups and no more; those on which triangles hold their depth have another.
#[test]
fn a_fifth_bind_group_is_asked_of_adapters_that_need_it_alone() {
    let mut held = 0;
    let of_effects = numbered(singles(1)).into_iter().flat_map(|(list, seed)| modules(&list, seed));
    for module in all_modules().into_iter().chain(of_effects) {
        assert!(!module.source().contains("@group(4)"), "{}", module.name());
        let source = module.source_for_people(handlers(), &[], &Adapter { holds_depth: true, ..Adapter::LEAST });
        held += usize::from(source.contains("@group(4)"));
        validate_text(&module.name(), &source);
    }
    assert!(held > 10, "{held} modules");
}

#[test]
fn what_finds_no_room_is_read_where_it_stands() {
    let lens = |number| PlanLens { number, volumes: tests(), leaves: LEAVES.to_vec(), body: None, border: None };
    let plan = Plan { lenses: (0..9).map(lens).collect(), ..Plan::default() };
    let module = Module::Shade(Program::Specialised(plan));
    for room in [14, LEAST_CARRIED, 31, 1000] {
        let source = module.source_for_people(handlers(), &[], &Adapter { carried: room, ..Adapter::LEAST });
        validate_text(&module.name(), &source);
        let members = source.matches("@interpolate(flat, either)").count() as u32;
        let left = source.matches(" = lens_regions_uniform[").count();
        assert!(members <= room.max(14), "{members} vectors where {room} fit");
        assert_eq!(left > 0, room < 1000, "{left} are left with room for {room}");
    }
}

#[test]
fn lens_tests_have_numbers_of_their_own_in_wgsl() {
    let (mut numbers, mut constants) = (BTreeSet::new(), BTreeSet::new());
    for test in LensTest::all() {
        assert!(numbers.insert(test.number()) && constants.insert(test.constant()), "{test:?}");
        let uber = Uber { tests: vec![test], leaves: LEAVES.to_vec(), ..Uber::default() };
        let source = Module::Shade(Program::Uber(uber)).source();
        assert!(source.contains(&format!("const {}: u32 = {}u;\n", test.constant(), test.number())), "{test:?}");
    }
}

#[test]
fn every_file_of_the_library_is_in_the_table_and_has_sound_hooks() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut found = Vec::new();
    for part in ["lib", "pass", "shape"] {
        for entry in std::fs::read_dir(folder.join(part)).expect("a folder").flatten() {
            found.push(format!("{part}/{}", entry.file_name().to_string_lossy()));
        }
    }
    // What an adapter is measured with is drawn before there are modules.
    found.retain(|path| path != "pass/snapping.wgsl");
    let forms = VolumeForm::ALL.iter().map(|form| library::file_of(*form));
    let files: Vec<_> = library::ALL.iter().copied().chain(forms).collect();
    let mut listed: Vec<_> = files.iter().map(|file| file.path.to_owned()).collect();
    found.sort();
    listed.sort();
    assert_eq!(found, listed);
    for file in &files {
        let hooks = template::Template::of_files(&[*file]).hooks();
        let mut filled = template::Template::of_files(&[*file]);
        for hook in hooks {
            filled = filled.leave(&hook);
        }
        let text = filled.finished().unwrap_or_else(|error| panic!("{error}"));
        assert!(!text.contains("//@") && !text.contains("/*@"), "{}", file.path);
    }
}

#[test]
fn every_module_is_valid_wgsl() {
    all_modules().iter().for_each(validate);
}

#[test]
fn every_effect_of_the_context_is_valid_wgsl_without_a_lens() {
    for number in numbers() {
        let lines = handlers()[number as usize].lines;
        let plan = Plan { steps: vec![step(number, Scope::Everywhere, None)], lines, ..Plan::default() };
        let uber = Uber { effects: vec![number], lines, ..Uber::default() };
        let hiding = plan.hiding(handlers()).map(Program::Specialised).into_iter();
        for program in hiding.chain(uber.hiding(handlers()).map(Program::Uber)) {
            validate(&Module::Geometry(Some(program.clone())));
            validate(&Module::Shadow(Some(program)));
        }
        let lining = plan.lining(handlers()).map(Program::Specialised).into_iter();
        lining.chain(uber.lining(handlers()).map(Program::Uber)).for_each(|p| validate(&Module::Lines(p)));
        validate(&Module::Shade(Program::Specialised(plan.shading(handlers()))));
        validate(&Module::Shade(Program::Uber(uber.shading(handlers()))));
    }
}

#[test]
fn every_effect_and_every_ordered_pair_is_valid_wgsl() {
    // Scenes of pairs are few, and the same whichever comes first: what does not depend on the order is one text then.
    let scene = |pair: &[u32]| (pair.iter().sum::<u32>() / 6 % 6) as usize;
    let scene_of = |pair: Vec<u32>| (pair.clone(), scene(&pair));
    // Each two effects together in some text, in one of their orders; in a thorough run each two alone, in both.
    let all =
        (0..6).map(|seed| ((if seed % 2 == 0 { numbers() } else { numbers().into_iter().rev().collect() }), seed));
    let is_tried = |pair: &Vec<u32>| match pair[0] + pair[1] {
        _ if pair[0] == pair[1] => true,
        sum if sum.is_multiple_of(6) => pair[0] < pair[1],
        sum => sum % 6 == 1 && pair[0] > pair[1],
    };
    let of_pairs = pairs().filter(|pair| is_thorough() || is_tried(pair)).map(scene_of);
    validate_all(&all.chain(numbered(singles(2))).chain(of_pairs).collect::<Vec<_>>());
}

#[test]
fn triples_of_all_prototypes_are_valid_wgsl() {
    let triples = covering_triples();
    for number in numbers() {
        assert!(triples.iter().flatten().any(|e| *e == number), "{} is in none", handlers()[number as usize].name);
    }
    validate_all(&numbered(triples.into_iter()));
}

#[test]
#[ignore = "minutes; ./dev hard"]
fn all_triples_of_effects_are_valid_wgsl() {
    let triples = pairs().flat_map(|pair| numbers().into_iter().map(move |c| [&pair[..], &[c]].concat()));
    validate_all(&numbered(triples));
}

/// As `all_triples_of_effects_are_valid_wgsl`, where each pair is in a scene of its own.
#[test]
#[ignore = "minutes; ./dev hard"]
fn all_triples_have_pairs_that_are_valid_wgsl_in_other_scenes() {
    validate_all(&numbered(singles(9).chain(pairs())));
}

#[test]
fn a_pair_asks_for_the_modules_of_its_effects_and_no_others() {
    for pair in pairs() {
        let own = || pair.iter().map(|&e| &handlers()[e as usize]);
        let steps = pair.iter().map(|&e| step(e, Scope::Everywhere, None)).collect();
        let plan = Plan { steps, lines: own().any(|h| h.lines), ..Plan::default() };
        let uber = Uber { effects: plan.effects(), lines: plan.lines, ..Uber::default() };
        let has = |kind| own().any(|h| h.kind == kind);
        let hides = has(EffectKind::Hide) || has(EffectKind::Opacity);
        let names = || own().map(|h| h.name.as_str()).collect::<Vec<_>>();
        let of = |program: Program| program.effects();
        let all = handlers();
        for (found, wanted, what) in [
            (plan.hiding(all).map(Program::Specialised), hides, "hiding"),
            (uber.hiding(all).map(Program::Uber), hides, "hiding"),
            (plan.layering(all).map(Program::Specialised), has(EffectKind::Opacity), "layering"),
            (uber.layering(all).map(Program::Uber), has(EffectKind::Opacity), "layering"),
            (plan.lining(all).map(Program::Specialised), plan.lines, "lining"),
            (uber.lining(all).map(Program::Uber), plan.lines, "lining"),
        ] {
            assert_eq!(found.is_some(), wanted, "{what} of {:?}", names());
            let belongs = |e: &u32| match (what, all[*e as usize].kind) {
                ("hiding", kind) => matches!(kind, EffectKind::Hide | EffectKind::Opacity),
                ("layering", kind) => !matches!(kind, EffectKind::Hide | EffectKind::Filter),
                (_, kind) => matches!(kind, EffectKind::Hide | EffectKind::Scene | EffectKind::Post),
            };
            let expected: Vec<u32> = plan.effects().into_iter().filter(belongs).collect();
            assert_eq!(found.map_or(expected.clone(), of), expected, "{what} of {:?}", names());
        }
        let shown = |e: &u32| !matches!(all[*e as usize].kind, EffectKind::Hide | EffectKind::Opacity);
        let expected: Vec<u32> = plan.effects().into_iter().filter(shown).collect();
        assert_eq!(of(Program::Specialised(plan.clone().shading(all))), expected, "{:?}", names());
        assert_eq!(of(Program::Uber(uber.shading(all))), expected, "{:?}", names());
        assert_eq!(plan.has_filters(all), has(EffectKind::Filter), "{:?}", names());
        let asks = pair.iter().any(|&e| all[e as usize].asks_most_layers);
        assert_eq!(asks, names().contains(&"peel"), "{:?}", names());
    }
}

#[test]
fn an_effect_nobody_uses_is_not_in_the_text() {
    let greyscale = effect::number_of("greyscale").expect("there is one");
    let plan = Plan { steps: vec![step(greyscale, Scope::Everywhere, None)], ..Plan::default() };
    let uber = Uber { effects: plan.effects(), ..Uber::default() };
    for program in [Program::Specialised(plan), Program::Uber(uber)] {
        let source = Module::Shade(program).source();
        assert!(source.contains("fn greyscale"));
        assert!(!source.contains("fn sepia") && !source.contains("fn thematic") && !source.contains("fn haze"));
        assert!(!source.contains("var sprites"), "a lens that is not there is in the shader");
        assert!(!source.contains("struct Material") && !source.contains("fn blend_add"), "{source}");
    }
}
