//! Pictures: PNG files of 8-bit RGBA.

use crate::fault::Fault;
use crate::vulkan::render::Pixels;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Writes a picture.
pub(super) fn save(path: &Path, pixels: &Pixels) -> Result<(), Fault> {
    write(path, pixels).map_err(|error| Fault::runtime(format!("{}: {error}", path.display())))
}

fn write(path: &Path, pixels: &Pixels) -> Result<(), png::EncodingError> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), pixels.width, pixels.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.rgba)?;
    writer.finish()
}
