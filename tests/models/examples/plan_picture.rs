//! Writes a plan as a picture and prints it as text: `cargo run -p parafovea-models --example plan_picture -- FILE.png`.
//!
//! Light tiles are shaded finely, dark ones coarsely, and those with half of their brightness are re-used from an
//! earlier frame. `core/plan.png` is made by it.

use parafovea_core::image::Plane;
use parafovea_models::room;
use std::error::Error;
use std::fs::File;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args_os().nth(1).ok_or("give the file to write, such as plan.png")?;
    let plan = room::plan();
    print!("{plan}");
    write_png(Path::new(&path), &plan.picture(room::PICTURE_WIDTH))?;
    Ok(())
}

fn write_png(path: &Path, picture: &Plane<[u8; 3]>) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(File::create(path)?, picture.width(), picture.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.write_header()?.write_image_data(picture.texels().as_flattened())?;
    Ok(())
}
