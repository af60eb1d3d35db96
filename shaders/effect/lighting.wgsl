//! name = "lighting"
//! kind = "light"
//! spec = "Tiesel §3"
//! doc = "Another light: a sun of one's own, or a lamp at the eye that leaves nothing in the dark."
//!
//! [[parameter]]
//! name = "source"
//! type = "word"
//! words = ["sun", "eye"]
//! default = "sun"
//! doc = "Where it comes from: a direction, or the eye."
//!
//! [[parameter]]
//! name = "azimuth"
//! type = "number"
//! range = [-360, 360]
//! default = 255
//! unit = "degrees"
//! doc = "Direction of the sun, clockwise from north."
//!
//! [[parameter]]
//! name = "elevation"
//! type = "number"
//! range = [-90, 90]
//! default = 22
//! unit = "degrees"
//! doc = "Height of the sun above the horizon."
//!
//! [[parameter]]
//! name = "color"
//! type = "color"
//! default = "#ffd9a0"
//! doc = "Its colour."
//!
//! [[parameter]]
//! name = "brightness"
//! type = "number"
//! range = [0, 4]
//! default = 1.1
//! doc = "How bright it is."
//!
//! [[parameter]]
//! name = "ambient"
//! type = "number"
//! range = [0, 2]
//! default = 0.45
//! doc = "How much of the scene's own light of sky and ground is left."

// The scene's shadows belong to the scene's sun: this light casts none.
fn effect(arriving: vec3f, point: Point, p: Parameters) -> vec3f {
    let a = radians(p.azimuth);
    let e = radians(p.elevation);
    let sun = vec3f(sin(a) * cos(e), cos(a) * cos(e), sin(e));
    let direction = select(sun, -normalize(point.relative), p.source == SOURCE_EYE);
    return p.ambient * irradiance(point.normal, 0.0)
        + p.color * (p.brightness * max(dot(point.normal, direction), 0.0));
}
