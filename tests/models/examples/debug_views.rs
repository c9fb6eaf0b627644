//! Writes the pictures of `manifest/HOW-IT-WORKS.md`: `cargo run -p parafovea-models --example debug_views -- manifest/pictures`.

use parafovea_core::image::Plane;
use parafovea_models::debug_views::{VIEWS, picture};
use std::error::Error;
use std::fs::{File, create_dir_all};
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("give the folder to write to")?;
    let folder = Path::new(&folder);
    create_dir_all(folder)?;
    for (view, name) in VIEWS {
        write_png(&folder.join(name).with_extension("png"), &picture(view))?;
    }
    Ok(())
}

fn write_png(path: &Path, picture: &Plane<[u8; 3]>) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(File::create(path)?, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(picture.texels().as_flattened())?;
    Ok(())
}
