// Values of objects that are the same at all moments.

fn value_then(first: u32, value: u32) -> u32 {
    return value;
}
