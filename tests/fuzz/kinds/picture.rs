//! Pictures that surfaces wear.

use std::{io::Cursor, path::Path, sync::Arc};

use image::{DynamicImage, ImageFormat, Rgba, RgbaImage};
use veduta::city::{Texture, TextureImage, TextureOpacity, Wrap, texture};

use super::{Kind, READ_S, Seed, always, files_of, refused};

pub fn kind() -> Kind {
    let mut files = files_of("citydata", |name| name.ends_with(".png"));
    let small = RgbaImage::from_fn(9, 7, |x, y| Rgba([(x * 28) as u8, (y * 36) as u8, 99, (255 - 30 * x) as u8]));
    let small = DynamicImage::from(small);
    for (format, ending) in [
        (ImageFormat::Png, "png"),
        (ImageFormat::Jpeg, "jpg"),
        (ImageFormat::Tiff, "tif"),
        (ImageFormat::WebP, "webp"),
        (ImageFormat::Bmp, "bmp"),
        (ImageFormat::Gif, "gif"),
        (ImageFormat::Tga, "tga"),
    ] {
        let picture = if ending == "jpg" { DynamicImage::from(small.to_rgb8()) } else { small.clone() };
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, format).expect("a small picture can be written");
        files.push(Seed { name: format!("small.{ending}"), bytes: bytes.into_inner() });
    }
    Kind { name: "pictures", files, sample: 200, is_worth: always, most_s: READ_S, read: Box::new(read) }
}

fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<bool, String> {
    // A TGA alone says by its name what it is.
    let image = match name.ends_with(".tga") {
        true => TextureImage::File(folder.join(name)),
        false => TextureImage::Bytes(Arc::from(bytes)),
    };
    match texture::decode(&Texture { image, wrap: [Wrap::Repeat; 2], opacity: TextureOpacity::Own }) {
        Ok(pixels) if pixels.levels[0].len() != pixels.width as usize * pixels.height as usize * 4 => {
            Err("a picture of the wrong size".into())
        }
        Ok(_) => Ok(true),
        Err(message) => refused(&message),
    }
}
