//! Values of a scene's uniforms that fragments of the specialised back end read, carried to them flat with the triangle:
//! `pass/shade.wgsl` says why.

use std::fmt::Write as _;

use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    forms::rows_of,
    plan::{Bends, Plan},
    rays,
};

/// How many vectors `pass/shade.wgsl` itself carries.
const FIRST: u32 = 14;
/// How many an adapter carries at least: that of OpenGL ES 3.0 and of WebGPU's compatibility mode; full WebGPU has 16.
pub const LEAST_CARRIED: u32 = 15;
const AXES: [&str; 4] = ["x", "y", "z", "w"];

/// A vector or a number of one of the uniform arrays.
struct Item {
    array: &'static str,
    place: String,
    width: usize,
}

impl Item {
    /// Takes these numbers of a vector: WGSL assigns them one by one, where they are not a whole one.
    fn taken(&self, vector: &str, numbers: &str) -> String {
        let Some((own, own_numbers)) = self.place.rsplit_once('.') else {
            return format!("    {}{} = {vector}{numbers};\n", self.array, self.place);
        };
        let one = |(to, from): (char, char)| format!("    {}{own}.{to} = {vector}{from};\n", self.array);
        own_numbers.chars().zip(numbers.chars()).map(one).collect()
    }
}

/// Members of `Corner`; `carry`, which fills them; `take_own`, which gives them to what reads them.
pub(super) struct Carried {
    pub(super) members: String,
    pub(super) functions: String,
}

/// Where nothing of the scene is carried, but for the only lens that bends rays.
pub(super) fn nothing(bends: Bends, room: u32) -> Carried {
    carried(Vec::new(), room.saturating_sub(FIRST), bends)
}

/// The only lens that bends rays, behind so many vectors.
pub(super) fn of_lens(bends: Bends, first: u32) -> Carried {
    let has_lens = bends.is_one();
    let [members, filled, taken] = if has_lens { rays::carried(first) } else { Default::default() };
    let carry = format!("fn carry(corner: ptr<function, Place>) {{\n{filled}}}");
    Carried { members, functions: format!("{carry}\n\nfn take_own(in: Place) {{\n{taken}}}\n\n") }
}

/// The parameters of a filter's kernel, which stand from `first` on.
pub(super) fn of_filter(filter: &EffectDefinition) -> Carried {
    let (mut members, mut carry, mut take) = (String::new(), String::new(), String::new());
    const OWN: u32 = 2;
    for i in 0..filter.slots() {
        if OWN + i >= LEAST_CARRIED {
            let _ = writeln!(take, "    parameters[{i}] = parameters_uniform[stage_uniform.first + {i}u];");
            continue;
        }
        let _ = writeln!(members, "    @location({}) @interpolate(flat, either) own_{i}: vec4f,", OWN + i);
        let _ = writeln!(carry, "    (*corner).own_{i} = parameters_uniform[first + {i}u];");
        let _ = writeln!(take, "    parameters[{i}] = in.own_{i};");
    }
    let carry = format!("fn carry(corner: ptr<function, Corner>, first: u32) {{\n{carry}}}");
    Carried { members, functions: format!("{carry}\n\nfn take_own(in: Corner) {{\n{take}}}\n\n") }
}

/// The values that a plan reads; `room` is how many vectors the adapter carries. Values without room are read where they stand.
pub(super) fn of_plan(plan: &Plan, handlers: &[EffectDefinition], room: u32) -> Carried {
    let mut items = Vec::new();
    for (i, test) in plan.tests().enumerate() {
        let item =
            |(place, width): (&str, usize)| Item { array: "lens_regions", place: format!("[{i}].{place}"), width };
        items.extend(rows_of(test).into_iter().flat_map(|rows| rows.places()).map(item));
    }
    for (slot, floats) in slots_read(plan, handlers) {
        match floats {
            4 => items.push(Item { array: "parameters", place: format!("[{slot}]"), width: 4 }),
            _ => items.extend(AXES[..floats].iter().map(|axis| Item {
                array: "parameters",
                place: format!("[{slot}].{axis}"),
                width: 1,
            })),
        }
    }
    carried(items, room.saturating_sub(FIRST), plan.bends)
}

/// The parameters' slots that a plan reads, and how many numbers of each, at most 4.
fn slots_read(plan: &Plan, handlers: &[EffectDefinition]) -> Vec<(u32, usize)> {
    let mut slots = Vec::new();
    for step in &plan.steps {
        let handler = &handlers[step.effect as usize];
        match handler.kind {
            EffectKind::Filter => slots.push((step.image(handler), 1)),
            _ => slots.extend(
                (step.parameters..).zip((0..handler.floats()).step_by(4).map(|d| (handler.floats() - d).min(4))),
            ),
        }
        slots.extend(step.weight(handler).map(|slot| (slot, 1)));
    }
    let bodies = plan.lenses.iter().filter_map(|l| l.body);
    slots.extend(bodies.flat_map(|body| [(body.parameters, 4), (body.parameters + 1, 1)]));
    let borders = (0..plan.lenses.len() as u32).filter_map(|lens| plan.border_of(lens));
    slots.extend(borders.map(|border| (border.parameters, 4)));
    slots
}

fn carried(items: Vec<Item>, room: u32, bends: Bends) -> Carried {
    let has_lens = bends.is_one();
    let carries_lens = has_lens && room >= rays::CARRIED_VECTORS;
    let [lens_members, lens_filled, lens_taken] = match carries_lens {
        true => rays::carried(FIRST),
        false if has_lens => [String::new(), String::new(), rays::TAKEN_FROM_UNIFORM.to_owned()],
        false => Default::default(),
    };
    let of_lens = if carries_lens { rays::CARRIED_VECTORS } else { 0 };
    let (first, room) = (FIRST + of_lens, (room - of_lens) as usize);
    // First fit: a sphere is one vector, and so are four numbers of four effects.
    let mut vectors: Vec<(usize, Vec<Item>)> = Vec::new();
    let mut left = Vec::new();
    for item in items {
        match vectors.iter().position(|(width, _)| width + item.width <= 4) {
            Some(i) => {
                vectors[i].0 += item.width;
                vectors[i].1.push(item);
            }
            None if vectors.len() < room => vectors.push((item.width, vec![item])),
            None => left.push(item),
        }
    }
    let mut members = lens_members;
    let mut carry = format!("fn carry(corner: ptr<function, Corner>) {{\n{lens_filled}");
    let mut take = format!("fn take_own(in: Corner) {{\n{lens_taken}");
    for (i, (width, held)) in vectors.iter().enumerate() {
        let _ = writeln!(members, "    @location({}) @interpolate(flat, either) own_{i}: vec4f,", first as usize + i);
        let given: Vec<String> = held.iter().map(|item| format!("{}_uniform{}", item.array, item.place)).collect();
        let _ = writeln!(carry, "    (*corner).own_{i} = vec4f({}{});", given.join(", "), ", 0.0".repeat(4 - width));
        let mut at = 0;
        for item in held {
            let of = AXES[at..at + item.width].concat();
            take.push_str(&item.taken(&format!("in.own_{i}."), &of));
            at += item.width;
        }
    }
    for item in &left {
        let from = item.place.rsplit_once('.');
        take.push_str(&match from {
            Some((vector, numbers)) => item.taken(&format!("{}_uniform{vector}.", item.array), numbers),
            None => format!("    {0}{1} = {0}_uniform{1};\n", item.array, item.place),
        });
    }
    Carried { members, functions: format!("{carry}}}\n\n{take}}}\n\n") }
}
