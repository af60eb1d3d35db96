//! Fields of OpenDX put together from objects.

use std::{collections::BTreeMap, rc::Rc};

use crate::field::{
    data::{Step, Values},
    dx::{
        objects::{Array, Class, Object, Objects, Reference},
        positions::{self, Positions},
    },
    error::FieldError,
    grid::Grid,
    input::Input,
    numbers::{self, Layout, Meaning, NumberKind},
    output::Output,
    resample::Scattered,
};

/// Groups in groups, at most.
const MOST_DEPTH: usize = 8;

/// Adds all fields that no group and no series has, and these.
pub fn assemble(input: &Input<'_>, objects: &Objects, output: &mut Output) -> Result<(), FieldError> {
    let mut taken: Vec<&str> = Vec::new();
    for object in &objects.all {
        if let Class::Group(members) | Class::Series(members) = &object.class {
            taken.extend(members.iter().map(|member| member.key.as_str()));
        }
        if let Class::Other(class) = &object.class {
            output.warn(format!("the object \"{}\" is a {class}; it is left out", object.key));
        }
    }
    taken.sort_unstable();
    let mut assembly =
        Assembly { input, objects, output, positions: BTreeMap::new(), left: objects.all.len() * 4 + 64 };
    for object in &objects.all {
        if taken.binary_search(&object.key.as_str()).is_err() {
            assembly.add(object, None, 0)?;
        }
    }
    Ok(())
}

struct Assembly<'a> {
    input: &'a Input<'a>,
    objects: &'a Objects,
    output: &'a mut Output,
    /// Places that were read, by the names of positions and connections, and whether they are cells.
    positions: BTreeMap<(String, String, bool), Rc<Positions>>,
    /// Objects that may still be looked at: groups can name each other many times.
    left: usize,
}

/// One step of a field.
struct Sampled {
    grid: Grid,
    components: usize,
    values: Values,
}

impl<'a> Assembly<'a> {
    fn at(&self, object: &Object, message: impl Into<String>) -> FieldError {
        self.input.at(object.at, message)
    }

    /// Adds the fields of an object. `role`: its name in a group.
    fn add(&mut self, object: &'a Object, role: Option<&str>, depth: usize) -> Result<(), FieldError> {
        self.left = self.left.checked_sub(1).ok_or_else(|| self.at(object, "the groups name too many objects"))?;
        match &object.class {
            Class::Field(components) => {
                let sampled = self.sampled(object, components)?;
                let steps = vec![Step { time: None, values: sampled.values }];
                let name = self.name(object, role);
                let added = self.output.add_steps(name, sampled.grid, sampled.components, steps);
                added.map_err(|message| self.at(object, message))
            }
            Class::Series(members) => self.add_series(object, members, role),
            Class::Group(_) if depth >= MOST_DEPTH => Err(self.at(object, "groups are too deep in groups")),
            Class::Group(members) => {
                for member in members {
                    let inner = self.object(object, &member.key)?;
                    self.add(inner, Some(&member.role), depth + 1)?;
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn object(&self, from: &Object, key: &str) -> Result<&'a Object, FieldError> {
        self.objects
            .get(key)
            .ok_or_else(|| self.at(from, format!("it refers to the object \"{key}\", which is not there")))
    }

    fn add_series(
        &mut self,
        object: &'a Object,
        members: &'a [Reference],
        role: Option<&str>,
    ) -> Result<(), FieldError> {
        let mut steps = Vec::new();
        let mut first: Option<Sampled> = None;
        for member in members {
            let inner = self.object(object, &member.key)?;
            let Class::Field(components) = &inner.class else {
                return Err(self.at(inner, "it is a step of a series, but no field; a field belongs there"));
            };
            let mut sampled = self.sampled(inner, components)?;
            let values = std::mem::replace(&mut sampled.values, Values::U8(Vec::new()));
            let first = first.get_or_insert(sampled);
            if values.len() != first.grid.count() * first.components {
                return Err(self.at(inner, "this step of the series has another grid than the first"));
            }
            steps.push(Step { time: member.position, values });
        }
        let Some(first) = first else { return Err(self.at(object, "the series has no steps")) };
        let name = self.name(object, role);
        let added = self.output.add_steps(name, first.grid, first.components, steps);
        added.map_err(|message| self.at(object, message))
    }

    /// A name for people: what the file says, else that of the file.
    fn name(&self, object: &Object, role: Option<&str>) -> String {
        let own = object.attributes.get("name").map(String::as_str).or(role).unwrap_or(&object.key);
        let is_number = own.parse::<u64>().is_ok();
        if own == "default" || is_number { self.input.stem() } else { own.to_owned() }
    }

    fn component(
        &self,
        object: &Object,
        components: &[Reference],
        role: &str,
    ) -> Result<Option<&'a Object>, FieldError> {
        let found = components.iter().find(|component| component.role == role);
        found.map(|component| self.object(object, &component.key)).transpose()
    }

    /// The values of a field on a regular grid.
    fn sampled(&mut self, object: &'a Object, components: &'a [Reference]) -> Result<Sampled, FieldError> {
        let needed = |found: Option<&'a Object>, role: &str| {
            found.ok_or_else(|| self.at(object, format!("the field has no component \"{role}\"")))
        };
        let data = needed(self.component(object, components, "data")?, "data")?;
        let places = needed(self.component(object, components, "positions")?, "positions")?;
        let connections = self.component(object, components, "connections")?;
        let Class::Array(array) = &data.class else {
            return Err(self.at(data, "the data of a field must be an object of class array"));
        };
        let is_cells = data.attributes.get("dep").is_some_and(|dep| dep == "connections");
        let counts = match connections.map(|connections| &connections.class) {
            Some(Class::GridConnections(counts)) => Some(counts.as_slice()),
            _ => None,
        };
        let key = (places.key.clone(), connections.map(|c| c.key.clone()).unwrap_or_default(), is_cells);
        let found = match self.positions.get(&key) {
            Some(found) => found.clone(),
            None => {
                let found = Rc::new(positions::positions(self.input, self.objects, places, counts, is_cells)?);
                self.positions.insert(key, found.clone());
                found
            }
        };
        let invalid = format!("invalid {}", if is_cells { "connections" } else { "positions" });
        let invalid = self.component(object, components, &invalid)?;
        match &*found {
            Positions::Grid { size, way } => {
                let values = self.values(data, array, *size, invalid)?;
                if let Some(note) = &way.note {
                    self.output.warn(format!("\"{}\": {note}", self.name(object, None)));
                    self.reserve(object, way.grid.size, array)?;
                }
                let values = way.values(values, array.components);
                Ok(Sampled { grid: way.grid, components: array.components, values })
            }
            Positions::Scattered(points) => {
                let values = self.values(data, array, [points.len(), 1, 1], invalid)?;
                let scattered = Scattered::new(points, points.len(), array.components);
                let scattered = scattered.map_err(|message| self.at(places, message))?;
                self.output.warn(format!("\"{}\": {}", self.name(object, None), scattered.note));
                self.reserve(object, scattered.grid.size, array)?;
                let values = scattered.values(points, &values, array.components);
                Ok(Sampled { grid: scattered.grid, components: array.components, values })
            }
        }
    }

    fn reserve(&mut self, object: &Object, size: [usize; 3], array: &Array) -> Result<(), FieldError> {
        let bytes = if array.kind == NumberKind::U8 { 1 } else { 4 };
        self.output.reserve(size, array.components, bytes).map_err(|message| self.input.at(object.at, message))
    }

    /// The numbers of an array, for samples of this size.
    fn values(
        &mut self,
        object: &Object,
        array: &Array,
        size: [usize; 3],
        invalid: Option<&Object>,
    ) -> Result<Values, FieldError> {
        let count = size.iter().product::<usize>();
        if array.items != count {
            let [x, y, z] = size;
            let message = format!("the array has {} items, but the grid has {x} × {y} × {z} samples", array.items);
            return Err(self.at(object, message));
        }
        if size[1] > 1 || size[2] > 1 || size[0] <= crate::field::grid::MOST_PER_AXIS {
            self.reserve(object, size, array)?;
        }
        let numbers = self.objects.numbers(self.input, object, array)?;
        let layout = Layout::last_fastest(array.kind, size, array.components);
        let values = numbers::values(&numbers, &layout, &Meaning::PLAIN).map_err(|message| self.at(object, message))?;
        match invalid.map(|invalid| (invalid, &invalid.class)) {
            Some((invalid, Class::Array(marks))) if marks.items == count && marks.components == 1 => {
                let marks_at = self.objects.numbers(self.input, invalid, marks)?;
                let layout = Layout::last_fastest(marks.kind, size, 1);
                let marks = numbers::values(&marks_at, &layout, &Meaning::PLAIN);
                let marks = marks.map_err(|message| self.at(invalid, message))?;
                let mut values = values.into_f32();
                for (i, sample) in values.chunks_exact_mut(array.components).enumerate() {
                    if marks.get(i) != 0.0 {
                        sample.fill(f32::NAN);
                    }
                }
                Ok(Values::F32(values))
            }
            Some((invalid, _)) => {
                self.output.warn(format!("\"{}\" lists what is invalid in a way that is not read", invalid.key));
                Ok(values)
            }
            None => Ok(values),
        }
    }
}
