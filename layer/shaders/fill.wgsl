// Kernel `fill`: the skipped blocks of a picture, in place, one thread for each pixel.
// Reference: core/src/kernels/fill.rs, in the same order; core/src/mask/list.rs has the layout of the list.

struct SkipList {
    // The indirect dispatch, and in w the number of blocks.
    header: vec4<u32>,
    blocks: array<vec2<u32>>,
}

@group(0) @binding(0) var<storage, read> list: SkipList;
// Any format of 32 bits, as its bits; or four half floats. A pipeline uses one of them.
@group(0) @binding(1) var words: texture_storage_2d_array<r32uint, read_write>;
@group(0) @binding(2) var halves: texture_storage_2d_array<rgba16float, read_write>;

// core::mask::BLOCK, core::mask::BLOCKS_PER_GROUP
const BLOCK: u32 = 4u;
const BLOCKS_PER_GROUP: u32 = 4u;
const PIXELS: u32 = BLOCK * BLOCK;
const CONTRAST_FLOOR: f32 = 0.25;
const LEAST_CONTRAST: f32 = 1e-6;

const UNORM8: u32 = 0u;
const SRGB8: u32 = 1u;
const UNORM10: u32 = 2u;
const FLOAT11: u32 = 3u;

// By its bits: a compiler may take it that no number is infinite or NaN.
fn is_finite(color: vec4<f32>) -> bool {
    return all((bitcast<vec4<u32>>(color) & vec4(0x7f800000u)) != vec4(0x7f800000u));
}

fn decode(word: u32, format: u32) -> vec4<f32> {
    if format == UNORM10 {
        let bits = vec4(word, word >> 10u, word >> 20u, word >> 30u) & vec4(0x3ffu, 0x3ffu, 0x3ffu, 3u);
        return vec4<f32>(bits) / vec4(1023.0, 1023.0, 1023.0, 3.0);
    }
    if format == FLOAT11 {
        // As half floats: the same exponent, fewer bits of mantissa, no sign.
        let red_green = unpack2x16float(((word & 0x7ffu) << 4u) | (((word >> 11u) & 0x7ffu) << 20u));
        return vec4(red_green, unpack2x16float((word >> 22u) << 5u).x, 1.0);
    }
    let stored = unpack4x8unorm(word);
    if format == SRGB8 {
        return vec4(stored.rgb * stored.rgb, stored.a);
    }
    return stored;
}

fn encode(color: vec4<f32>, format: u32) -> u32 {
    if format == UNORM10 {
        let steps = vec4(1023.0, 1023.0, 1023.0, 3.0);
        let bits = vec4<u32>(floor(clamp(color, vec4(0.0), vec4(1.0)) * steps + 0.5));
        return bits.r | (bits.g << 10u) | (bits.b << 20u) | (bits.a << 30u);
    }
    if format == FLOAT11 {
        let rgb = max(color.rgb, vec3(0.0));
        // Half floats without their lowest bits, rounded.
        let red_green = pack2x16float(rgb.rg);
        let red = ((red_green & 0xffffu) + 8u) >> 4u;
        let green = ((red_green >> 16u) + 8u) >> 4u;
        let blue = (pack2x16float(vec2(rgb.b, 0.0)) + 16u) >> 5u;
        return red | (green << 11u) | (blue << 22u);
    }
    if format == SRGB8 {
        return pack4x8unorm(vec4(sqrt(max(color.rgb, vec3(0.0))), color.a));
    }
    return pack4x8unorm(color);
}

// Where a source block is, from the skipped one on: four bits each, two's complement. Zero: there is none.
fn source_offset(sources: u32, index: u32) -> vec2<i32> {
    let byte = bitcast<i32>(sources >> (8u * index));
    return vec2(extractBits(byte, 0u, 4u), extractBits(byte, 4u, 4u));
}

// What one thread fills.
struct Place {
    inside: bool,
    block: vec2<i32>,
    layer: u32,
    pixel: vec2<i32>,
    sources: u32,
}

fn place(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> Place {
    let index = (group.y * groups.x + group.x) * BLOCKS_PER_GROUP + thread / PIXELS;
    if index >= list.header.w {
        return Place(false, vec2(0), 0u, vec2(0), 0u);
    }
    let entry = list.blocks[index];
    let block = vec2<i32>(vec2(entry.x & 0xfffu, (entry.x >> 12u) & 0xfffu));
    let pixel = block * i32(BLOCK) + vec2<i32>(vec2(thread % BLOCK, thread % PIXELS / BLOCK));
    return Place(true, block, entry.x >> 24u, pixel, entry.y);
}

// The pixel of a source block that is nearest.
fn nearest(place: Place, index: u32) -> vec2<i32> {
    let first = (place.block + source_offset(place.sources, index)) * i32(BLOCK);
    return clamp(place.pixel, first, first + i32(BLOCK) - 1);
}

struct Source {
    color: vec4<f32>,
    // 1 / squared distance; 0 where there is none.
    weight: f32,
}

fn source(place: Place, index: u32, color: vec4<f32>, usable: bool) -> Source {
    let away = nearest(place, index) - place.pixel;
    let there = usable && any(source_offset(place.sources, index) != vec2(0));
    // Selected, not multiplied: what is left out may be NaN.
    return Source(select(vec4(0.0), color, there), select(0.0, 1.0 / f32(max(dot(away, away), 1)), there));
}

fn sum(color: vec4<f32>) -> f32 {
    let magnitude = abs(color.rgb);
    return magnitude.r + magnitude.g + magnitude.b;
}

fn blend(a: Source, b: Source, c: Source, d: Source) -> vec4<f32> {
    let there = vec4(a.weight, b.weight, c.weight, d.weight) > vec4(0.0);
    let count = dot(select(vec4(0.0), vec4(1.0), there), vec4(1.0));
    let total = sum(a.color) + sum(b.color) + sum(c.color) + sum(d.color);
    let floor = CONTRAST_FLOOR * total / max(count, 1.0) + LEAST_CONTRAST;
    // Where one of the pairs is incomplete, none is preferred.
    let complete = all(there);
    let level = floor + select(0.0, sum(a.color - c.color), complete);
    let upright = floor + select(0.0, sum(b.color - d.color), complete);
    let weights = vec4(a.weight * upright, b.weight * level, c.weight * upright, d.weight * level);
    let weighted = a.color * weights.x + b.color * weights.y + c.color * weights.z + d.color * weights.w;
    let all_weights = dot(weights, vec4(1.0));
    if all_weights > 0.0 {
        return weighted * (1.0 / all_weights);
    }
    return vec4(0.0);
}

fn word(place: Place, index: u32, format: u32) -> Source {
    let color = decode(textureLoad(words, nearest(place, index), place.layer).x, format);
    // Whole numbers have no infinity.
    return source(place, index, color, format != FLOAT11 || is_finite(color));
}

fn fill_words(place: Place, format: u32) {
    if place.inside {
        let color = blend(
            word(place, 0u, format),
            word(place, 1u, format),
            word(place, 2u, format),
            word(place, 3u, format),
        );
        textureStore(words, place.pixel, place.layer, vec4(encode(color, format), 0u, 0u, 0u));
    }
}

fn half(place: Place, index: u32) -> Source {
    let color = textureLoad(halves, nearest(place, index), place.layer);
    return source(place, index, color, is_finite(color));
}

fn fill_halves(place: Place) {
    if place.inside {
        let color = blend(half(place, 0u), half(place, 1u), half(place, 2u), half(place, 3u));
        textureStore(halves, place.pixel, place.layer, color);
    }
}

@compute @workgroup_size(64)
fn unorm8(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    fill_words(place(group, groups, thread), UNORM8);
}

@compute @workgroup_size(64)
fn srgb8(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    fill_words(place(group, groups, thread), SRGB8);
}

@compute @workgroup_size(64)
fn unorm10(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    fill_words(place(group, groups, thread), UNORM10);
}

@compute @workgroup_size(64)
fn float11(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    fill_words(place(group, groups, thread), FLOAT11);
}

@compute @workgroup_size(64)
fn float16(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    fill_halves(place(group, groups, thread));
}
