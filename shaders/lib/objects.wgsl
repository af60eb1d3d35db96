// What effects read of each object.

@group(2) @binding(1) var<storage, read> object_values: array<u32>;

// Whether an object is one of those that an effect chose by an attribute; `first`: its parameter of this name. The values
// begin with that of no object.
fn is_chosen(first: u32, object: u32) -> bool {
    return object_values[first + (object + 1u)] != 0u;
}
