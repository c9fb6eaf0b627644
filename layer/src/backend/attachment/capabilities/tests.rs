use super::*;

type Properties = vk::PhysicalDeviceFragmentShadingRatePropertiesKHR<'static>;

fn square(side: u32) -> vk::Extent2D {
    vk::Extent2D { width: side, height: side }
}

fn texels(least: u32, most: u32) -> Properties {
    Properties::default()
        .min_fragment_shading_rate_attachment_texel_size(square(least))
        .max_fragment_shading_rate_attachment_texel_size(square(most))
        .max_fragment_shading_rate_attachment_texel_size_aspect_ratio(1)
        .max_fragment_shading_rate_rasterization_samples(vk::SampleCountFlags::TYPE_4)
}

fn rates(sizes: &[[u32; 2]]) -> Vec<vk::PhysicalDeviceFragmentShadingRateKHR<'static>> {
    let rate = |&[width, height]: &[u32; 2]| {
        vk::PhysicalDeviceFragmentShadingRateKHR::default()
            .sample_counts(vk::SampleCountFlags::TYPE_1)
            .fragment_size(vk::Extent2D { width, height })
    };
    sizes.iter().map(rate).collect()
}

/// The capabilities of a device with texels of that size.
pub fn offered(texel: [u32; 2]) -> RateCapabilities {
    let properties = texels(texel[0], texel[0]).fragment_shading_rate_non_trivial_combiner_ops(true);
    RateCapabilities { texel, ..RateCapabilities::new(&properties, &rates(&UP_TO_4X4)).unwrap() }
}

const UP_TO_4X4: [[u32; 2]; 7] = [[4, 4], [4, 2], [2, 4], [2, 2], [2, 1], [1, 2], [1, 1]];
const UP_TO_2X2: [[u32; 2]; 4] = [[2, 2], [2, 1], [1, 2], [1, 1]];

#[test]
fn texels_are_16x16_where_the_device_has_them() {
    for (least, most, expected) in [(8, 8, 8), (16, 16, 16), (8, 32, 16), (4, 8, 8), (32, 64, 32)] {
        let capabilities = RateCapabilities::new(&texels(least, most), &rates(&UP_TO_4X4)).unwrap();
        assert_eq!(capabilities.texel, [expected; 2]);
        assert_eq!(capabilities.texels([256, 250]), [256u32.div_ceil(expected), 250u32.div_ceil(expected)]);
    }
}

#[test]
fn invalid_capabilities_are_refused() {
    let refused = |properties: &Properties, sizes: &[[u32; 2]]| {
        RateCapabilities::new(properties, &rates(sizes)).is_err()
    };
    assert!(refused(&texels(0, 0), &UP_TO_4X4), "no attachments");
    assert!(refused(&texels(12, 12), &UP_TO_4X4), "not a power of two");
    assert!(refused(&texels(16, 16), &[]) && refused(&texels(16, 16), &[[1, 1]]), "nothing to gain");
    let mut oblong = texels(8, 8);
    oblong.max_fragment_shading_rate_attachment_texel_size.width = 16;
    oblong.min_fragment_shading_rate_attachment_texel_size.width = 16;
    assert!(refused(&oblong, &UP_TO_4X4), "aspect ratio 1");
    oblong.max_fragment_shading_rate_attachment_texel_size_aspect_ratio = 2;
    assert!(!refused(&oblong, &UP_TO_4X4), "aspect ratio 2");
}

#[test]
fn rates_without_one_sample_or_beyond_4_are_not_offered() {
    let mut listed = rates(&[[8, 8], [4, 4], [2, 2], [1, 1]]);
    listed[1].sample_counts = vk::SampleCountFlags::TYPE_4;
    let capabilities = RateCapabilities::new(&texels(16, 16), &listed).unwrap();
    assert_eq!(*capabilities.rates, [ShadingRate::R2X2, ShadingRate::R1X1]);
}

#[test]
fn without_non_trivial_combiners_the_attachment_replaces() {
    let with = texels(16, 16).fragment_shading_rate_non_trivial_combiner_ops(true);
    for (properties, expected) in [
        (with, vk::FragmentShadingRateCombinerOpKHR::MAX),
        (texels(16, 16), vk::FragmentShadingRateCombinerOpKHR::REPLACE),
    ] {
        assert_eq!(RateCapabilities::new(&properties, &rates(&UP_TO_2X2)).unwrap().combiner(), expected);
    }
}
