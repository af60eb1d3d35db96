//! The forms that a module calls for: their files, loaders of their numbers, and the choice between them.

use std::fmt::Write as _;

use crate::{
    geom::shape::VolumeForm,
    shader::{
        library::{COMBINED, FADING_MEMBERS, File, MEMBERS, OWN, OWN_SPRITE, file_of},
        own_region,
        plan::{form::Form, lens_test::LensTest},
        rows::Rows,
    },
};

/// Lens tests and leaves that a module calls for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Forms {
    /// How they are tested, each once.
    pub(super) tests: Vec<LensTest>,
    /// Forms of the leaves of combinations, each once.
    pub(super) leaves: Vec<Form>,
    /// Whether it asks how far places are from them.
    pub(super) distances: bool,
    /// Whether it draws their outlines.
    pub(super) outlines: bool,
}

impl Forms {
    /// A combination of such leaves alone.
    pub(super) fn of_leaves(leaves: &[Form]) -> Self {
        Self { tests: vec![LensTest::Numbers(Form::Combined)], leaves: leaves.to_vec(), ..Self::default() }
    }

    /// Forms that know where rays enter and leave, which are tested by that, not as leaves.
    fn spanned(&self) -> Vec<Form> {
        self.tests.iter().filter_map(|test| test.spanned()).collect()
    }

    /// Users' region tests that are called for, as their handlers' numbers, ascending.
    fn own(&self) -> Vec<u32> {
        let forms = self.tests.iter().filter_map(|test| test.form()).chain(self.leaves.iter().copied());
        let mut all: Vec<u32> = forms.filter_map(|form| if let Form::Own(n) = form { Some(n) } else { None }).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn has_combinations(&self) -> bool {
        self.tests.iter().any(|test| test.has_leaves())
    }

    /// Forms of volumes that are called for, ascending.
    fn volumes(&self) -> Vec<VolumeForm> {
        let own = self.tests.iter().filter_map(|test| test.form());
        let mut all: Vec<VolumeForm> = Vec::new();
        for form in own.chain(self.leaves.iter().copied()) {
            match form {
                Form::Volume(form) => all.push(form),
                // Combinations ask for the faces of solids.
                Form::Combined => all.push(VolumeForm::Solid),
                Form::Members | Form::FadingMembers | Form::Own(_) => {}
            }
        }
        // The box around them stands for them there.
        if self.leaves.iter().any(|form| matches!(form, Form::Members | Form::FadingMembers)) {
            all.push(VolumeForm::Box);
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The files of volumes.
    pub(super) fn files(&self) -> Vec<File> {
        let own = (!self.own().is_empty()).then_some(OWN);
        self.volumes().into_iter().map(file_of).chain(own).collect()
    }

    /// Constants, loaders, and the functions that choose between forms.
    pub(super) fn functions(&self) -> String {
        let own: String = self.own().into_iter().map(own_region::functions).collect();
        self.constants() + &self.loaders() + &own + &self.choices() + &self.leaf_choices()
    }

    fn constants(&self) -> String {
        let mut all = self.tests.clone();
        all.extend(self.leaves.iter().map(|form| LensTest::Numbers(*form)));
        if self.has_combinations() {
            all.push(LensTest::volume(VolumeForm::Solid));
        }
        all.sort_unstable();
        all.dedup();
        let lines = all.iter().map(|test| format!("const {}: u32 = {}u;\n", test.constant(), test.number()));
        lines.collect::<String>() + "\n"
    }

    fn loaders(&self) -> String {
        let mut text: String = self.volumes().into_iter().map(|form| rows_of_volume(form).loader()).collect();
        if let Some(own) = self.own().first() {
            text.extend(rows_of(LensTest::Numbers(Form::Own(*own))).map(|rows| rows.loader()));
        }
        for test in [Form::Members, Form::FadingMembers].map(LensTest::Numbers).into_iter().chain([LensTest::OwnSprite])
        {
            if self.tests.contains(&test) {
                text.extend(rows_of(test).map(|rows| rows.loader()));
            }
        }
        if self.has_combinations() {
            text.extend(rows_of(LensTest::Numbers(Form::Combined)).map(|rows| rows.loader()));
        }
        text
    }

    /// `form_holds`, `span_of_form`, `distance_to_form` and `form_is_clear`.
    fn choices(&self) -> String {
        let spanned = self.spanned();
        if spanned.is_empty() {
            return String::new();
        }
        let choice = |head: &str, answer: &dyn Fn(Form) -> String| {
            let answers: Vec<_> = spanned.iter().map(|f| (f.constant(), answer(*f))).collect();
            choice(head, "form", &answers)
        };
        let mut text = choice("form_holds(s: Region, form: u32, sight: Sight) -> bool", &|f| holds(f, "s", "sight"));
        text += &choice("span_of_form(ray: Ray, s: Region, form: u32) -> Span", &|f| span(f, "ray", "s"));
        if self.distances {
            let head = "distance_to_form(s: Region, form: u32, sight: Sight, border: vec4f) -> f32";
            text += &choice(head, &|f| distance(f, "s"));
        }
        if self.outlines {
            let head = "form_is_clear(ray: Ray, s: Region, form: u32, turn: f32) -> bool";
            text += &choice(head, &|f| is_clear(f, "s"));
        }
        text
    }

    /// `leaf_holds`, `span_of_leaf` and `distance_to_leaf`.
    fn leaf_choices(&self) -> String {
        if !self.has_combinations() {
            return String::new();
        }
        let choice = |head: &str, of: &str, end: &str, answer: &dyn Fn(Form) -> String| {
            let mut text = format!("fn {head} {{\n");
            match self.leaves[..] {
                [only] => {
                    let _ = writeln!(text, "    return {};", answer(only));
                }
                _ => {
                    let _ = writeln!(text, "    switch {of}.test {{");
                    for form in &self.leaves {
                        let _ = writeln!(text, "        case {}: {{ return {}; }}", form.constant(), answer(*form));
                    }
                    let _ = writeln!(text, "        default: {{ return {end}; }}\n    }}");
                }
            }
            text + "}\n\n"
        };
        let mut text = choice("leaf_holds(leaf: Leaf, sight: Sight) -> bool", "leaf.region", "false", &|form| {
            match form {
                _ if form.has_span() => holds(form, "leaf.region", "sight"),
                Form::Members | Form::FadingMembers => {
                    format!("sight.distance < FAR_AWAY && {}", is_member(form))
                }
                _ => "sight.distance < FAR_AWAY && solid_holds(solid_of(leaf.region), sight.position, sight.distance, sight.off)"
                    .to_owned(),
            }
        });
        // A solid's ends are not asked for here; a choice of objects is the box around them.
        text += &choice("span_of_leaf(ray: Ray, s: Region) -> Span", "s", "EMPTY_SPAN", &|form| match form {
            _ if form.has_span() => span(form, "ray", "s"),
            Form::Members | Form::FadingMembers => span(Form::Volume(VolumeForm::Box), "ray", "s"),
            _ => "EMPTY_SPAN".to_owned(),
        });
        if self.distances {
            let head = "distance_to_leaf(leaf: Leaf, sight: Sight, border: vec4f) -> f32";
            text += &choice(head, "leaf.region", "FAR_AWAY", &|form| match form {
                _ if form.has_span() => distance(form, "leaf.region"),
                Form::Members | Form::FadingMembers => {
                    format!("select(FAR_AWAY, -FAR_AWAY, {})", is_member(form))
                }
                _ => "distance_to_solid(solid_of(leaf.region), sight, border)".to_owned(),
            });
        }
        text
    }
}

/// A function that chooses between forms by a number; the first stands for all that are not there.
fn choice(head: &str, number: &str, answers: &[(String, String)]) -> String {
    let mut text = format!("fn {head} {{\n");
    match answers {
        [] => {}
        [(_, only)] => {
            let _ = writeln!(text, "    return {only};");
        }
        [(_, first), rest @ ..] => {
            let _ = writeln!(text, "    switch {number} {{");
            for (constant, answer) in rest {
                let _ = writeln!(text, "        case {constant}: {{ return {answer}; }}");
            }
            let _ = writeln!(text, "        default: {{ return {first}; }}\n    }}");
        }
    }
    text + "}\n\n"
}

/// Whether an object is one of a leaf's.
fn is_member(form: Form) -> &'static str {
    match form {
        Form::FadingMembers => "is_fading_member(u32(leaf.first), sight.object, sight.pixel)",
        _ => "is_chosen(u32(leaf.first), sight.object)",
    }
}

/// The struct of a volume's form.
pub(super) fn rows_of_volume(form: VolumeForm) -> Rows<'static> {
    Rows::of(&file_of(form), form.struct_name())
}

/// The struct of the numbers that a test reads of a region; `None` where it reads none.
pub(super) fn rows_of(test: LensTest) -> Option<Rows<'static>> {
    let form = match test {
        LensTest::Numbers(form) | LensTest::Sides(form) => form,
        LensTest::OwnSprite => return Some(Rows::of(&OWN_SPRITE, "OwnRows")),
        LensTest::Sprite | LensTest::LayeredSprite => return None,
    };
    Some(match form {
        Form::Volume(form) => rows_of_volume(form),
        Form::Members => Rows::of(&MEMBERS, "Members"),
        Form::FadingMembers => Rows::of(&FADING_MEMBERS, "FadingMembers"),
        Form::Combined => Rows::of(&COMBINED, "Combination"),
        Form::Own(_) => Rows::of(&OWN, "OwnRegion"),
    })
}

/// A region's numbers as the struct that a test reads.
pub(super) fn loaded(test: LensTest, region: &str) -> String {
    rows_of(test).map_or_else(String::new, |rows| format!("{}({region})", rows.loader_name()))
}

/// The struct of a volume's form and its loader, without its functions.
pub(super) fn numbers_of(form: VolumeForm) -> String {
    let rows = rows_of_volume(form);
    rows.declaration() + &rows.loader()
}

/// `span_of_stage`, for `lib/stored-form.wgsl`.
pub(super) fn of_stage(form: VolumeForm) -> String {
    let span = span(Form::Volume(form), "ray", "stage.region");
    rows_of_volume(form).loader() + &format!("fn span_of_stage(ray: Ray) -> Span {{\n    return {span};\n}}\n")
}

/// What the functions about a form are called after.
fn name(form: Form) -> String {
    match form {
        Form::Volume(form) => form.name().to_owned(),
        Form::Own(handler) => own_region::name(handler),
        Form::Members | Form::FadingMembers | Form::Combined => form.constant().to_lowercase(),
    }
}

/// Whether a form holds no place where nothing is: flat lenses do.
fn ends(form: Form) -> bool {
    form.is_convex() || matches!(form, Form::Own(_))
}

fn region_of(form: Form, region: &str) -> String {
    loaded(LensTest::Numbers(form), region)
}

/// Whether a form that has a span holds a place. What has no end holds also where nothing is.
fn holds(form: Form, region: &str, sight: &str) -> String {
    let own = format!("{}_holds({}, {sight})", name(form), region_of(form, region));
    if ends(form) { format!("{sight}.distance < FAR_AWAY && {own}") } else { own }
}

/// Whether a form tells which rays are clear of its silhouette.
pub(super) fn has_clear(form: Form) -> bool {
    matches!(form, Form::Volume(own) if file_of(own).says(&format!("fn {}_is_clear(", name(form))))
}

/// Whether all rays that turn from one by no more than `turn` (parallel ones: that are so much aside, metres) surely meet a form as it does.
fn is_clear(form: Form, region: &str) -> String {
    match has_clear(form) {
        true => format!("{}_is_clear(ray, {}, turn)", name(form), region_of(form, region)),
        false => "false".to_owned(),
    }
}

/// Where a ray is in a form that has a span.
pub(super) fn span(form: Form, ray: &str, region: &str) -> String {
    format!("span_of_{}({ray}, {})", name(form), region_of(form, region))
}

/// How far a place is from a form that has a span.
fn distance(form: Form, region: &str) -> String {
    let own = |sight| format!("distance_to_{}({}, {sight}, border)", name(form), region_of(form, region));
    match ends(form) {
        true => format!("select({}, FAR_AWAY, sight.distance >= FAR_AWAY)", own("with_place(sight)")),
        false => own("sight"),
    }
}
