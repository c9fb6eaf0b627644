// Kernel `fill`: the skipped blocks of a picture, in place, one thread for each block.
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
const BLOCK: i32 = 4;
const BLOCKS_PER_GROUP: u32 = 64u;
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

// A skipped block.
struct Place {
    // Whether there is one: in the list, and with sources.
    inside: bool,
    // Its first pixel.
    origin: vec2<i32>,
    layer: u32,
    // Of each source four bits a side, two's complement: blocks from the skipped one on. Zero: there is none.
    sources: u32,
}

fn place(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> Place {
    let index = (group.y * groups.x + group.x) * BLOCKS_PER_GROUP + thread;
    if index >= list.header.w {
        return Place(false, vec2(0), 0u, 0u);
    }
    let entry = list.blocks[index];
    let block = vec2<i32>(vec2(entry.x & 0xfffu, (entry.x >> 12u) & 0xfffu));
    return Place(entry.y != 0u, block * BLOCK, entry.x >> 24u, entry.y);
}

// A source block as seen from the skipped one: only four of its pixels are the nearest to any, the pixels of an edge or, four times the same, of a
// corner.
struct Source {
    // From the skipped block's first pixel on, pixels.
    first: vec2<i32>,
    there: bool,
    // Whether the nearest pixel is that of the same column, otherwise that of the same row.
    by_column: bool,
    colors: array<vec4<f32>, 4>,
    usable: vec4<bool>,
}

// A source without its colours.
fn located(place: Place, index: u32) -> Source {
    let byte = bitcast<i32>(place.sources >> (8u * index));
    let offset = vec2(extractBits(byte, 0u, 4u), extractBits(byte, 4u, 4u));
    var source: Source;
    source.first = offset * BLOCK;
    source.there = any(offset != vec2(0));
    source.by_column = offset.x == 0;
    return source;
}

// The pixel of a source block that is nearest to a pixel of the skipped one, both from that one's first pixel on.
fn nearest(source: Source, pixel: vec2<i32>) -> vec2<i32> {
    return clamp(pixel, source.first, source.first + (BLOCK - 1));
}

// A source's colour for one pixel.
struct Part {
    color: vec4<f32>,
    // 1 / squared distance; 0 where there is none.
    weight: f32,
}

fn part(source: Source, pixel: vec2<i32>) -> Part {
    let away = nearest(source, pixel) - pixel;
    let color = select(source.colors[pixel.y], source.colors[pixel.x], source.by_column);
    let usable = source.there && select(source.usable[pixel.y], source.usable[pixel.x], source.by_column);
    // Selected, not multiplied: the value that is left out may be NaN.
    return Part(select(vec4(0.0), color, usable), select(0.0, 1.0 / f32(max(dot(away, away), 1)), usable));
}

fn sum(color: vec4<f32>) -> f32 {
    let magnitude = abs(color.rgb);
    return magnitude.r + magnitude.g + magnitude.b;
}

fn blend(a: Part, b: Part, c: Part, d: Part) -> vec4<f32> {
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

struct Sources {
    a: Source,
    b: Source,
    c: Source,
    d: Source,
}

fn filled(sources: Sources, pixel: vec2<i32>) -> vec4<f32> {
    return blend(
        part(sources.a, pixel),
        part(sources.b, pixel),
        part(sources.c, pixel),
        part(sources.d, pixel),
    );
}

fn word_source(place: Place, index: u32, format: u32) -> Source {
    var source = located(place, index);
    for (var i = 0; i < BLOCK; i++) {
        let at = place.origin + nearest(source, vec2(i));
        let color = decode(textureLoad(words, at, place.layer).x, format);
        source.colors[i] = color;
        // Whole numbers have no infinity.
        source.usable[i] = format != FLOAT11 || is_finite(color);
    }
    return source;
}

fn fill_word(place: Place, sources: Sources, format: u32, pixel: vec2<i32>) {
    let word = encode(filled(sources, pixel), format);
    textureStore(words, place.origin + pixel, place.layer, vec4(word, 0u, 0u, 0u));
}

// Unrolled, like the whole block: array elements that a loop reads are in memory.
fn fill_word_row(place: Place, sources: Sources, format: u32, row: i32) {
    fill_word(place, sources, format, vec2(0, row));
    fill_word(place, sources, format, vec2(1, row));
    fill_word(place, sources, format, vec2(2, row));
    fill_word(place, sources, format, vec2(3, row));
}

fn fill_words(place: Place, format: u32) {
    if place.inside {
        let sources = Sources(
            word_source(place, 0u, format),
            word_source(place, 1u, format),
            word_source(place, 2u, format),
            word_source(place, 3u, format),
        );
        fill_word_row(place, sources, format, 0);
        fill_word_row(place, sources, format, 1);
        fill_word_row(place, sources, format, 2);
        fill_word_row(place, sources, format, 3);
    }
}

fn half_source(place: Place, index: u32) -> Source {
    var source = located(place, index);
    for (var i = 0; i < BLOCK; i++) {
        let color = textureLoad(halves, place.origin + nearest(source, vec2(i)), place.layer);
        source.colors[i] = color;
        source.usable[i] = is_finite(color);
    }
    return source;
}

fn fill_half(place: Place, sources: Sources, pixel: vec2<i32>) {
    textureStore(halves, place.origin + pixel, place.layer, filled(sources, pixel));
}

fn fill_half_row(place: Place, sources: Sources, row: i32) {
    fill_half(place, sources, vec2(0, row));
    fill_half(place, sources, vec2(1, row));
    fill_half(place, sources, vec2(2, row));
    fill_half(place, sources, vec2(3, row));
}

fn fill_halves(place: Place) {
    if place.inside {
        let sources = Sources(
            half_source(place, 0u),
            half_source(place, 1u),
            half_source(place, 2u),
            half_source(place, 3u),
        );
        fill_half_row(place, sources, 0);
        fill_half_row(place, sources, 1);
        fill_half_row(place, sources, 2);
        fill_half_row(place, sources, 3);
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
