//! Regions told apart by a module's text, for the techniques that are kept for reference: a branch for each, or the number of the
//! region of a place.

use std::fmt::Write as _;

use crate::shader::{
    effect::definition::EffectDefinition,
    lens_test,
    names::one_line,
    plan::{
        Plan,
        program::Program,
        regions::Regions,
        step::{ClassTest, Scope},
    },
    writer::Writer,
};

impl Regions {
    /// All combinations of what the lenses of a plan act on.
    pub fn combinations(plan: &Plan) -> Self {
        let asked = |lens: u32, class| plan.steps.iter().any(|s| s.scope == Scope::Lens(lens, class));
        let of = |lens: u32| ClassTest::ALL.into_iter().filter(|&class| asked(lens, class)).collect();
        Self::Combinations((0..plan.lenses.len() as u32).map(of).collect())
    }

    /// The passes of Ropinski & Hinrichs §3: what is inside of a lens, what is in front of it, and all else, which is behind it or
    /// beside it; that in two passes where the lens treats these differently. Of several lenses, two further passes each.
    pub fn passes(plan: &Plan) -> Self {
        let lenses = 0..plan.lenses.len() as u32;
        let of = |class| lenses.clone().map(move |lens| (lens, class));
        let is_far_side = |scope| matches!(scope, Scope::Lens(_, ClassTest::Behind | ClassTest::Rest));
        let asks_far_side = plan.steps.iter().any(|s| is_far_side(s.scope));
        let behind = of(ClassTest::Behind).filter(|_| asks_far_side);
        Self::Passes(of(ClassTest::Inside).chain(of(ClassTest::Front)).chain(behind).collect())
    }
}

/// The lines of a function that returns the number; `classes`: those of a lens of the plan.
fn body(regions: &Regions, classes: impl Fn(u32) -> String) -> String {
    let mut text = String::new();
    match regions {
        Regions::Combinations(asked) => {
            text.push_str("    var region = 0u;\n");
            let mut place = 1;
            for (lens, asked) in asked.iter().enumerate().filter(|(_, asked)| !asked.is_empty()) {
                let _ = writeln!(text, "    let classes_{lens} = {};", classes(lens as u32));
                for (i, class) in (1..).zip(asked) {
                    let number: u32 = place * i;
                    let test = class.function();
                    let _ = writeln!(text, "    region += select(0u, {number}u, {test}(classes_{lens}));");
                }
                place *= asked.len() as u32 + 1;
            }
            text.push_str("    return region;\n");
        }
        Regions::Passes(passes) => {
            let mut lenses: Vec<u32> = passes.iter().map(|(lens, _)| *lens).collect();
            lenses.sort_unstable();
            lenses.dedup();
            for lens in lenses {
                let _ = writeln!(text, "    let classes_{lens} = {};", classes(lens));
            }
            for (number, (lens, class)) in (1..).zip(passes) {
                let test = class.function();
                let _ = writeln!(text, "    if {test}(classes_{lens}) {{\n        return {number}u;\n    }}");
            }
            text.push_str("    return 0u;\n");
        }
    }
    text
}

/// `shade` and `styled`, for `pass/shade.wgsl`: a branch for each region, in which its effects are written out (Tiesel
/// §3.4.5).
pub(super) fn branches(plan: &Plan, regions: &Regions, handlers: &[EffectDefinition]) -> String {
    let body = body(regions, |lens| format!("classes.lens_{lens}"));
    let mut text = format!("fn region_of(classes: Classes) -> u32 {{\n{body}}}\n\n");
    let count = regions.count().unwrap_or(1);
    for region in 0..count {
        let own = plan.of_region(region);
        let writer = Writer { plan: &own, handlers, names: &[] };
        let suffix = format!("_{region}");
        text.push_str(&writer.styled(&suffix));
        text.push_str(&writer.shade(&suffix));
    }
    let mut switch = |head: &str, call: &dyn Fn(u32) -> String| {
        let _ = writeln!(text, "{head}\n    switch region_of(classes) {{");
        for region in 1..count {
            let _ = writeln!(text, "        case {region}u: {{ return {}; }}", call(region));
        }
        let _ = writeln!(text, "        default: {{ return {}; }}\n    }}\n}}\n", call(0));
    };
    switch("fn shade(point: ptr<function, Point>, classes: Classes) -> vec3f {", &|region| {
        format!("shade_{region}(point, classes)")
    });
    switch("fn styled(start: vec3f, point: Point, classes: Classes) -> vec3f {", &|region| {
        format!("styled_{region}(start, point, classes)")
    });
    text
}

/// `region_at`, which tells places apart by the lens tests of a plan; `names` of its lenses become comments.
fn region_at(plan: &Plan, regions: &Regions, names: &[&str]) -> String {
    let mut text = String::new();
    for (lens, name) in names.iter().enumerate() {
        let _ = writeln!(text, "// classes_{lens}: {}", one_line(name));
    }
    let body = body(regions, |lens| lens_test::classes(plan, lens, "sight"));
    text + &format!("fn region_at(sight: Sight) -> u32 {{\n{body}}}\n\n")
}

/// `visible` and what it calls, for the geometry pass: what is not in the region that is drawn is hidden.
pub(super) fn visible(plan: &Plan, regions: &Regions, names: &[&str]) -> String {
    let program = Program::Specialised(plan.clone());
    lens_test::bindings(&program, false) + "\n" + &region_at(plan, regions, names) + VISIBLE
}

const VISIBLE: &str = "@group(0) @binding(1) var<uniform> drawn: vec4u;     // x: the number of the region

fn visible(fragment: Fragment) -> bool {
    return region_at(sight_of(fragment)) == drawn.x;
}
";

/// `region_at` and what it calls, for the pass that marks regions.
pub(super) fn marks(plan: &Plan, regions: &Regions, names: &[&str]) -> String {
    lens_test::bindings(&Program::Specialised(plan.clone()), false) + "\n" + &region_at(plan, regions, names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        geom::shape::VolumeForm,
        shader::plan::{lens::PlanLens, lens_test::LensTest, step::Step},
    };

    fn plan(scopes: &[(u32, ClassTest)]) -> Plan {
        let lens = |number| PlanLens {
            number,
            volumes: vec![LensTest::volume(VolumeForm::Sphere)],
            leaves: vec![],
            body: None,
            border: None,
        };
        let step = |(i, &(lens, class)): (usize, &(u32, ClassTest))| Step {
            effect: i as u32,
            scope: Scope::Lens(lens, class),
            parameters: 0,
            blend: None,
        };
        let steps = scopes.iter().enumerate().map(step).collect();
        Plan { lenses: (0..3).map(lens).collect(), steps, ..Plan::default() }
    }

    #[test]
    fn the_number_of_lenses_with_one_class_each_is_a_bitmask() {
        let inside = [0, 1, 2].map(|lens| (lens, ClassTest::Inside));
        let mut plan = plan(&inside);
        let regions = Regions::combinations(&plan);
        plan.regions = Some(regions.clone());
        assert_eq!(regions.count(), Some(8));
        for region in 0..8 {
            let own: Vec<_> = inside.iter().filter(|(lens, _)| region >> lens & 1 == 1).copied().collect();
            assert_eq!(regions.classes_of(region), own);
            let done: Vec<u32> = plan.of_region(region).steps.iter().map(|s| s.effect).collect();
            assert_eq!(done, own.iter().map(|(lens, _)| *lens).collect::<Vec<_>>(), "in the lenses' order");
        }
    }

    #[test]
    fn every_combination_of_classes_has_its_own_number() {
        use ClassTest::{Behind, Front, Inside, Rest};
        let plan = plan(&[(0, Rest), (0, Inside), (2, Front), (2, Behind), (2, Inside)]);
        let regions = Regions::combinations(&plan);
        assert_eq!(regions.count(), Some(3 * 4), "a lens that does nothing has no part in it");
        let mut all: Vec<_> = (0..12).map(|region| regions.classes_of(region)).collect();
        all.sort_by_key(|classes| format!("{classes:?}"));
        all.dedup();
        assert_eq!(all.len(), 12);
        assert!(regions.asks_sides(0) && !regions.asks_sides(1));
    }

    #[test]
    fn three_passes_are_four_where_behind_and_rest_differ() {
        use ClassTest::{Behind, Front, Inside, Rest};
        let mut one = plan(&[(0, Inside)]);
        one.lenses.truncate(1);
        assert_eq!(Regions::passes(&one), Regions::Passes(vec![(0, Inside), (0, Front)]));
        let mut four = plan(&[(0, Rest), (0, Front)]);
        four.lenses.truncate(1);
        four.regions = Some(Regions::passes(&four));
        let regions = four.regions.as_ref().expect("just made");
        assert_eq!(*regions, Regions::Passes(vec![(0, Inside), (0, Front), (0, Behind)]));
        let done = [0, 1, 2, 3].map(|region| four.of_region(region).steps.iter().map(|s| s.effect).collect::<Vec<_>>());
        assert_eq!(done, [vec![0], vec![], vec![1], vec![]], "rest, inside, front, behind");
    }
}
