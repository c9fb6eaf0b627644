//! The kernel `samples` on a Vulkan device, beside its reference: each sample of pictures and of depth, of two array layers.

mod picture;

use super::{EXTENT, parts, picture::assert_matches};
use crate::vulkan::Vulkan;
use ash::vk;
use parafovea::backend::mask::{Eligible, MaskKernels, MaskMap, MaskMethod, depth_format};
use parafovea::gpu::{AppCommands, Gpu};
use parafovea::kernels::samples::SampleKernel;
use parafovea::pass_detection::{ImageKey, Part, Target};
use parafovea::rate_map::RateImage;
use parafovea_core::kernels::fill::FillFormat;
use parafovea_core::kernels::samples::{SampleParams, depth_source};
use parafovea_core::mask::{Mask, MaskView, TemplateDepths, TileRates, predict, write_template};
use parafovea_core::rate::VULKAN_RATES;
use picture::{COLOR, LAYERS, Picture, SAMPLE_COUNT, attached};
use std::sync::Arc;

/// Rings of all rates, around another point in each layer.
fn mask() -> (Mask, RateImage, Vec<u8>) {
    let rates: Vec<u8> = (0..LAYERS * 18 * 18)
        .map(|tile| {
            let (layer, tile) = (tile / (18 * 18), tile % (18 * 18));
            let away = (tile % 18).abs_diff(5 + 6 * layer) + (tile / 18).abs_diff(6);
            VULKAN_RATES[6usize.saturating_sub(away as usize / 2)].texel()
        })
        .collect();
    let mut mask = Mask::new(EXTENT, LAYERS);
    let views: Vec<_> = (0..)
        .zip(rates.chunks_exact(18 * 18))
        .map(|(layer, rates)| {
            let tiles = TileRates { texel: [8; 2], first: [0; 2], columns: 18, rates };
            MaskView { layer, offset: [0; 2], extent: EXTENT, tiles }
        })
        .collect();
    mask.resolve(&views);
    let area = [0, 0, EXTENT[0], EXTENT[1]];
    (mask, RateImage { area, texel: [8; 2], tiles: [18; 2], layers: LAYERS }, rates)
}

/// Draws, and fills by a template of this kind; the words of each layer before and after.
fn filled(
    picture: &Picture<'_>,
    eligible: Eligible,
    mask: &(Mask, RateImage, Vec<u8>),
) -> Vec<[Vec<u32>; 2]> {
    let vulkan = picture.vulkan;
    let (_, image, rates) = mask;
    picture.draw();
    let before: Vec<_> = (0..LAYERS).map(|layer| picture.read(layer)).collect();
    // SAFETY: the device is never destroyed.
    let gpu = &unsafe { Gpu::without_queue(&vulkan.record) }.unwrap();
    let kernels = Arc::new(MaskKernels::new(gpu).unwrap());
    let map = MaskMap::new(gpu, &kernels, eligible, EXTENT, LAYERS).unwrap();
    let kernel = Arc::new(SampleKernel::new(gpu, picture.kind).unwrap());
    let target = Target { image: ImageKey(1), level: 0, base_layer: 0, layers: LAYERS };
    let format = picture.kind.format;
    let fill = map.prepare_samples(target, picture.part(), (&kernel, format)).unwrap();
    let mut staging = vec![0xff; map.staging_len()];
    let parts: Vec<_> = (0..LAYERS).flat_map(|layer| parts().map(|part| Part { layer, ..part })).collect();
    map.stage(&parts, image, rates, &mut staging);
    let staged = vulkan.staging(&staging);
    vulkan.run(|commands| {
        // SAFETY: the command buffer is being recorded, and everything is kept until it has finished.
        let commands = unsafe { AppCommands::new(gpu, commands) };
        map.upload(&commands, staged, 0);
        map.fill_samples(&commands, &fill, (picture.part(), format), attached(picture.kind));
    });
    let after = (0..LAYERS).map(|layer| picture.read(layer));
    before.into_iter().zip(after).map(|(before, after)| [before, after]).collect()
}

#[test]
fn samples_of_colour_are_filled_as_in_the_reference() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let picture = Picture::new(&vulkan, COLOR, true);
    let mask = mask();
    picture.draw();
    let resolved: Vec<_> = (0..LAYERS).map(|layer| picture.resolved(layer)).collect();
    for (layer, [before, after]) in (0..).zip(filled(&picture, MaskMethod::RETURN, &mask)) {
        let mask = &mask.0;
        let mut predicted = resolved[layer as usize].clone();
        predict(&mut predicted, FillFormat::Unorm8, mask, layer);
        let of_sample = |words: &[u32], sample: usize| -> Vec<u8> {
            words.iter().skip(sample).step_by(SAMPLE_COUNT).flat_map(|word| word.to_le_bytes()).collect()
        };
        for sample in 0..SAMPLE_COUNT {
            let mut expected = of_sample(&before, sample);
            assert_ne!(expected, of_sample(&before, (sample + 1) % SAMPLE_COUNT), "samples differ");
            for (index, texel) in expected.chunks_exact_mut(4).enumerate() {
                if mask.skips(layer, pixel(index)) {
                    texel.copy_from_slice(&predicted[4 * index..][..4]);
                }
            }
            let result = of_sample(&after, sample);
            assert_matches(FillFormat::Unorm8, &expected, &result, |pixel| mask.skips(layer, pixel), EXTENT);
        }
    }
    vulkan.assert_valid();
}

#[test]
fn samples_of_depth_are_filled_as_in_the_reference() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let mask = mask();
    let formats = [vk::Format::D16_UNORM, vk::Format::D32_SFLOAT];
    for format in formats.into_iter().filter(|format| vulkan.draws_depth(*format)) {
        let picture = Picture::new(&vulkan, format, false);
        let depths = TemplateDepths { shaded: 1.0, skipped: 0.0 };
        let eligible = Eligible { format: depth_format(format).unwrap(), depths, ..MaskMethod::RETURN };
        for eligible in [MaskMethod::RETURN, eligible] {
            let params = SampleParams::new(EXTENT, eligible.format, eligible.depths).unwrap();
            let mut words = vec![0u32; (params.layer_words * LAYERS) as usize];
            for (layer, words) in (0..).zip(words.chunks_exact_mut(params.layer_words as usize)) {
                let bytes = bytemuck::cast_slice_mut(words);
                write_template(&mask.0, layer, eligible.format, eligible.depths, bytes);
            }
            for (layer, [before, after]) in (0..).zip(filled(&picture, eligible, &mask)) {
                for (index, (before_of, after_of)) in
                    before.chunks_exact(SAMPLE_COUNT).zip(after.chunks_exact(SAMPLE_COUNT)).enumerate()
                {
                    let pixel = pixel(index);
                    let source = mask.0.skips(layer, pixel).then(|| {
                        let [x, y] = depth_source(&params, &words, layer, pixel).unwrap();
                        before[(y * EXTENT[0] + x) as usize * SAMPLE_COUNT]
                    });
                    let expected = source.map_or(before_of.to_vec(), |depth| vec![depth; SAMPLE_COUNT]);
                    assert_eq!(after_of, expected, "{format:?} {eligible:?}: layer {layer}, {pixel:?}");
                }
                assert_ne!(before, after, "nothing was done");
            }
        }
    }
    vulkan.assert_valid();
}

fn pixel(index: usize) -> [u32; 2] {
    [index as u32 % EXTENT[0], index as u32 / EXTENT[0]]
}

/// An application may create its depth again, as for another resolution, and keep its colour.
#[test]
fn fills_end_with_their_images() {
    let vulkan = Vulkan::at(vk::API_VERSION_1_1);
    let picture = Picture::new(&vulkan, COLOR, true);
    // SAFETY: the device is never destroyed.
    let gpu = &unsafe { Gpu::without_queue(&vulkan.record) }.unwrap();
    let kernels = Arc::new(MaskKernels::new(gpu).unwrap());
    let map = MaskMap::new(gpu, &kernels, MaskMethod::RETURN, EXTENT, LAYERS).unwrap();
    let kernel = Arc::new(SampleKernel::new(gpu, picture.kind).unwrap());
    let prepare = |image| {
        let target = Target { image: ImageKey(image), level: 0, base_layer: 0, layers: LAYERS };
        map.prepare_samples(target, picture.part(), (&kernel, picture.kind.format)).unwrap();
        gpu.memory_used()
    };
    let of_one = prepare(1);
    let of_two = prepare(2);
    assert!(of_two > of_one && prepare(2) == of_two, "each is made once");
    map.forget_image(ImageKey(2));
    assert_eq!(gpu.memory_used(), of_one);
    assert_eq!(prepare(1), of_one, "the other one is kept");
    map.forget_image(ImageKey(1));
    assert!(gpu.memory_used() < of_one);
    vulkan.assert_valid();
}
