//! The materials' textures on the device.

use std::collections::HashMap;

use crate::scene::materials::{self, Material, Surface};
use crate::scene::texture::{Encoding, Texture};

/// Views of the two textures of a material.
#[derive(Debug)]
pub struct MaterialImages {
    pub albedo: wgpu::TextureView,
    pub relief: wgpu::TextureView,
}

#[derive(Debug)]
pub struct Images {
    pub detail: wgpu::TextureView,
    materials: HashMap<Material, MaterialImages>,
}

impl Images {
    /// Generates and uploads the textures of these materials.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, materials: &[Material]) -> Self {
        let materials = materials
            .iter()
            .map(|&material| {
                let Surface { albedo, relief } = materials::surface_of(material);
                let images = MaterialImages {
                    albedo: upload(device, queue, &albedo),
                    relief: upload(device, queue, &relief),
                };
                (material, images)
            })
            .collect();
        Self { detail: upload(device, queue, &materials::detail()), materials }
    }

    /// The images of all materials that were given.
    pub fn materials(&self) -> impl Iterator<Item = (Material, &MaterialImages)> {
        self.materials.iter().map(|(material, images)| (*material, images))
    }
}

fn upload(device: &wgpu::Device, queue: &wgpu::Queue, texture: &Texture) -> wgpu::TextureView {
    let [width, height] = texture.size;
    let image = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("surface"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: texture.levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: match texture.encoding {
            Encoding::Srgb => wgpu::TextureFormat::Rgba8UnormSrgb,
            Encoding::Linear => wgpu::TextureFormat::Rgba8Unorm,
        },
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, texels) in texture.levels.iter().enumerate() {
        let (width, height) = ((width >> level).max(1), (height >> level).max(1));
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &image,
                mip_level: level as u32,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
    }
    image.create_view(&wgpu::TextureViewDescriptor::default())
}
