//! MTL libraries: [`tobj`] reads them, once the lines it would panic or give up on are set aside.

use std::path::Path;

use rustc_hash::FxHashMap;

use super::lines::{Lines, number, statement, text, words};
use crate::city::{
    load::options::{LoadOptions, Sibling},
    model::{CityModel, Material, NONE, TexelOpacity, Texture, TextureImage, TextureOpacity, Wrap},
    warning::{WarningCode, Warnings},
};

/// A material as the city holds it, with and without its texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Look {
    /// For faces with texture coordinates.
    pub textured: u32,
    /// For faces without; the same where the material has no texture.
    pub plain: u32,
}

/// Materials by name.
#[derive(Debug, Default)]
pub(super) struct Looks {
    exact: FxHashMap<String, Look>,
    /// By their names in small letters.
    in_any_case: FxHashMap<String, Look>,
}

impl Looks {
    fn insert(&mut self, name: String, look: Look) {
        self.in_any_case.entry(name.to_lowercase()).or_insert(look);
        self.exact.insert(name, look);
    }

    /// The material of this name, or else the first of this name in other letter case.
    pub fn get(&self, name: &str) -> Option<Look> {
        self.exact.get(name).or_else(|| self.in_any_case.get(&name.to_lowercase())).copied()
    }
}

/// The largest library; a longer one is no hand-written or exported list of materials.
const MAX_BYTES: u64 = 256 << 20;

/// Reads the library `name` that stands in the model file `obj` into `looks`.
pub(super) fn read(
    city: &mut CityModel,
    looks: &mut Looks,
    obj: &Path,
    name: &str,
    options: &LoadOptions,
) -> Result<(), String> {
    let path = match options.sibling(obj, name) {
        Sibling::Found(path) => path,
        Sibling::Missing(path) => return Err(format!("{} does not exist", path.display())),
        Sibling::Outside(path) => {
            let message = format!("{} is outside the folders you named", path.display());
            city.warnings.add(WarningCode::OutsidePath, "", || {
                format!("{}: {message}; --allow-outside reads it", obj.display())
            });
            return Err(message);
        }
    };
    let failed = |what: String| format!("{} cannot be read: {what}", path.display());
    let size = std::fs::metadata(&path).map_err(|e| failed(e.to_string()))?.len();
    if size > MAX_BYTES {
        return Err(failed(format!("{size} bytes are too many for a list of materials")));
    }
    city.read_beside.push(path.clone());
    let bytes = std::fs::read(&path).map_err(|e| failed(e.to_string()))?;
    let clean = cleaned(&bytes, &path, &mut city.warnings);
    let (materials, _) = tobj::load_mtl_buf(&mut clean.as_bytes()).map_err(|e| failed(e.to_string()))?;
    let mut known = known(city);
    for material in materials {
        let look = add(city, &mut known, &material, &path, options);
        looks.insert(material.name, look);
    }
    Ok(())
}

/// The lines that tobj can read, one statement each, in UTF-8.
fn cleaned(bytes: &[u8], path: &Path, warnings: &mut Warnings) -> String {
    let mut clean = String::with_capacity(bytes.len());
    let mut named = false;
    for (line_number, line) in Lines::new(bytes) {
        let Some((keyword, arguments)) = statement(&line) else { continue };
        let numbers: Vec<f64> =
            words(arguments).take(3).map_while(number).map_while(|n| n.is_finite().then_some(n)).collect();
        let statement = match keyword {
            b"newmtl" if !arguments.is_empty() => Some(format!("newmtl {}", text(arguments))),
            b"Kd" | b"Ke" => match numbers[..] {
                [r, g, b] => Some(format!("{} {r} {g} {b}", text(keyword))),
                // Green and blue may be left out (MTL specification): all are the same then.
                [grey] => Some(format!("{} {grey} {grey} {grey}", text(keyword))),
                _ => None,
            },
            b"Ns" => numbers.first().map(|n| format!("Ns {n}")),
            b"d" => {
                let halo = words(arguments).filter_map(number).next();
                halo.filter(|n| n.is_finite()).map(|n| format!("d {n}"))
            }
            b"Tr" => numbers.first().map(|n| format!("d {}", 1.0 - n)),
            b"map_Kd" | b"map_d" | b"map_Ke" | b"norm" if !arguments.is_empty() => {
                Some(format!("{} {}", text(keyword), text(arguments)))
            }
            // The rest changes nothing that is drawn here.
            b"newmtl" | b"map_Kd" | b"map_d" | b"map_Ke" | b"norm" => None,
            _ => continue,
        };
        named |= keyword == b"newmtl" && statement.is_some();
        match statement.filter(|_| named) {
            Some(statement) => {
                clean.push_str(&statement);
                clean.push('\n');
            }
            None => warnings.add(WarningCode::Malformed, "", || {
                let keyword = text(keyword);
                let right = if named { "numbers or a name after it" } else { "a newmtl before it" };
                format!("{}, line {line_number}: {keyword} needs {right}", path.display())
            }),
        }
    }
    clean
}

/// Textures that are there, by what they are and whether they hold normals: a texture is read as colours or as normals.
type Known = FxHashMap<(Texture, bool), u32>;

fn known(city: &CityModel) -> Known {
    let of = |material: &Material| {
        let Material { texture, emissive_texture, normal_texture, .. } = *material;
        [(texture, false), (emissive_texture, false), (normal_texture, true)]
    };
    let all = city.materials.iter().flat_map(of);
    let there = all.filter_map(|(number, has_normals)| {
        let texture = city.textures.get(number as usize).filter(|texture| !texture.image.is_missing())?;
        Some(((texture.clone(), has_normals), number))
    });
    there.collect()
}

/// Adds a material, and its untextured twin where it has a texture.
fn add(city: &mut CityModel, known: &mut Known, mtl: &tobj::Material, path: &Path, options: &LoadOptions) -> Look {
    let linear = |c: f64| srgb_to_linear(c.clamp(0.0, 1.0)) as f32;
    let kd = mtl.diffuse.unwrap_or([0.8; 3]).map(linear);
    let opacity = mtl.dissolve.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
    let other = |keyword: &str| mtl.unknown_param.get(keyword).map(String::as_str);
    let maps = Maps {
        color: mtl.diffuse_texture.as_deref(),
        opacity: mtl.dissolve_texture.as_deref(),
        light: other("map_Ke"),
        normals: other("norm"),
    };
    let ke = mtl.emissive.unwrap_or_default().map(linear);
    let plain = Material {
        name: mtl.name.clone(),
        base_color: [kd[0], kd[1], kd[2], opacity],
        // Without its picture the light would flood the whole surface.
        emissive: if maps.light.is_some() { [0.0; 3] } else { ke },
        // Blinn-Phong exponent to roughness, so that both highlights are as wide.
        roughness: mtl.shininess.map_or(0.9, |ns| (2.0 / (ns.max(0.0) + 2.0)).sqrt() as f32),
        ..Material::default()
    };
    let [texture, emissive_texture, normal_texture] =
        textures(city, &mtl.name, maps, path, options).map(|texture| number_of(city, known, texture));
    city.materials.push(plain.clone());
    let untextured = (city.materials.len() - 1) as u32;
    if [texture, emissive_texture, normal_texture] == [NONE; 3] {
        return Look { textured: untextured, plain: untextured };
    }
    // Kd and Ke multiply their textures (MTL specification), but exporters that mean "as it is" write 0.
    let shade = |own: [f32; 3], map: Option<&str>| if own == [0.0; 3] && map.is_some() { [1.0; 3] } else { own };
    let [r, g, b] = shade(kd, maps.color);
    city.materials.push(Material {
        base_color: [r, g, b, opacity],
        emissive: shade(ke, maps.light),
        texels: TexelOpacity::Translucent,
        texture,
        emissive_texture,
        normal_texture,
        ..plain
    });
    Look { textured: untextured + 1, plain: untextured }
}

/// The statements of a material that name images: options, then a file name that may hold spaces.
#[derive(Clone, Copy)]
struct Maps<'a> {
    color: Option<&'a str>,
    opacity: Option<&'a str>,
    light: Option<&'a str>,
    normals: Option<&'a str>,
}

/// Their textures, and whether they hold normals: of the colour and its opacity, of the light, of the normals.
fn textures(
    city: &mut CityModel,
    material: &str,
    maps: Maps,
    path: &Path,
    options: &LoadOptions,
) -> [Option<(Texture, bool)>; 3] {
    let mut found = |keyword, arguments| {
        let statement = MapStatement { material, keyword, arguments };
        map(&mut city.warnings, statement, path, options)
    };
    let (color, opacity) = (maps.color.map(|s| found("map_Kd", s)), maps.opacity.map(|s| found("map_d", s)));
    let (light, normals) = (maps.light.map(|s| found("map_Ke", s)), maps.normals.map(|s| found("norm", s)));
    let texture = |(image, wrap), opacity| Texture { image, wrap: [wrap; 2], opacity };
    let color = match (color, opacity) {
        (None, None) => None,
        // Exporters name one image twice: its opacity is its own.
        (Some(color), Some((other, _))) if color.0 != other => Some(texture(color, TextureOpacity::Of(other))),
        (Some(color), _) => Some(texture(color, TextureOpacity::Own)),
        (None, Some(opacity)) => Some(texture(opacity, TextureOpacity::Alone)),
    };
    let [light, normals] = [light, normals].map(|found| found.map(|found| texture(found, TextureOpacity::Own)));
    [color.map(|of| (of, false)), light.map(|of| (of, false)), normals.map(|of| (of, true))]
}

/// The number of a texture in the city: that of the same one, or a new one; [`NONE`] where there is none.
fn number_of(city: &mut CityModel, known: &mut Known, texture: Option<(Texture, bool)>) -> u32 {
    let Some(key) = texture else { return NONE };
    if let Some(number) = known.get(&key) {
        return *number;
    }
    let Ok(number) = u32::try_from(city.textures.len()) else { return NONE };
    city.textures.push(key.0.clone());
    if !key.0.image.is_missing() {
        known.insert(key, number);
    }
    number
}

/// A statement that names an image.
struct MapStatement<'a> {
    material: &'a str,
    keyword: &'a str,
    arguments: &'a str,
}

/// The image that a statement of a material names, and how it goes on.
fn map(warnings: &mut Warnings, statement: MapStatement, path: &Path, options: &LoadOptions) -> (TextureImage, Wrap) {
    let MapStatement { material, keyword, arguments } = statement;
    let (name, wrap, moved) = map_options(arguments);
    if moved {
        warnings.add(WarningCode::Unsupported, "", || {
            format!("{}, material {material:?}: -o, -s and -t of {keyword} are not applied", path.display())
        });
    }
    let image = match options.sibling(path, name) {
        Sibling::Found(file) => TextureImage::File(file),
        Sibling::Missing(file) => {
            let (path, file) = (path.display(), file.display());
            TextureImage::Missing(format!("{path}, material {material:?}: {file} does not exist"))
        }
        Sibling::Outside(file) => {
            warnings.add(WarningCode::OutsidePath, "", || {
                let file = file.display();
                format!("{}: {file} is outside the folders you named; --allow-outside reads it", path.display())
            });
            TextureImage::Missing(String::new())
        }
    };
    (image, wrap)
}

/// File name, addressing, and whether the picture is moved or scaled.
fn map_options(statement: &str) -> (&str, Wrap, bool) {
    let (mut rest, mut wrap, mut moved) = (statement.trim(), Wrap::Repeat, false);
    let next = |text: &str| text.split_whitespace().next().map(str::to_owned);
    let after = |text: &'_ str, word: &str| -> usize { text.len() - text[word.len()..].trim_start().len() };
    while let Some(option) = next(rest).filter(|w| w.starts_with('-')) {
        let (least, most) = match option.as_str() {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            "-blendu" | "-blendv" | "-boost" | "-cc" | "-clamp" | "-texres" | "-bm" | "-imfchan" | "-type" => (1, 1),
            _ => break,
        };
        moved |= matches!(option.as_str(), "-o" | "-s" | "-t");
        rest = &rest[after(rest, &option)..];
        for i in 0..most {
            let Some(word) = next(rest).filter(|w| i < least || w.parse::<f64>().is_ok()) else { break };
            if option == "-clamp" && word == "on" {
                wrap = Wrap::Clamp;
            }
            rest = &rest[after(rest, &word)..];
        }
    }
    (rest, wrap, moved)
}

/// Display value to light (IEC 61966-2-1): people pick `Kd` on screens.
fn srgb_to_linear(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_map_come_before_its_name() {
        assert_eq!(map_options("brick wall.png"), ("brick wall.png", Wrap::Repeat, false));
        assert_eq!(map_options("-clamp on -s 2 2 1 a.png"), ("a.png", Wrap::Clamp, true));
        assert_eq!(map_options("-o 0.5 tex 1.png"), ("tex 1.png", Wrap::Repeat, true));
        assert_eq!(map_options("-s"), ("", Wrap::Repeat, true));
        assert_eq!(map_options("-dash.png"), ("-dash.png", Wrap::Repeat, false));
    }

    #[test]
    fn lines_that_break_tobj_are_set_aside() {
        let mut warnings = Warnings::default();
        let clean = cleaned(
            b"Kd 1 1 1\nnewmtl\nnewmtl a\nKd 0.5\nKd x\nKe nan 0 0\nd -halo 0.5\nTr 0.25\nmap_Kd\nillum 900\n",
            Path::new("m.mtl"),
            &mut warnings,
        );
        assert_eq!(clean, "newmtl a\nKd 0.5 0.5 0.5\nd 0.5\nd 0.75\n");
        assert_eq!(warnings.count(WarningCode::Malformed), 5);
    }
}
