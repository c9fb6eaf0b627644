// Kernel `nearest`: copies of the nearest texels into skipped blocks of a copied picture, in place, one thread for each block.
// Reference: core/src/kernels/nearest.rs; core/src/mask/list.rs has the layout of the list.

struct NearestParams {
    row_words: u32,
    layer_words: u32,
    texel_size: u32,
    near: u32,
}

struct SkipList {
    // The indirect dispatch, and in w the number of blocks.
    header: vec4<u32>,
    blocks: array<vec2<u32>>,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: NearestParams;
@group(0) @binding(1) var<storage, read> list: SkipList;
@group(0) @binding(2) var<storage, read_write> words: array<u32>;

// core::mask::BLOCK, core::mask::BLOCKS_PER_GROUP
const BLOCK: i32 = 4;
const BLOCKS_PER_GROUP: u32 = 64u;

// A skipped block.
struct Place {
    // Whether there is one: in the list, and with sources.
    inside: bool,
    // Its first pixel.
    origin: vec2<i32>,
    // The first word of its layer.
    first_word: u32,
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
    return Place(entry.y != 0u, block * BLOCK, (entry.x >> 24u) * params.layer_words, entry.y);
}

// The word in which a texel begins.
fn word_of(place: Place, pixel: vec2<i32>) -> u32 {
    return place.first_word + u32(pixel.y) * params.row_words + u32(pixel.x) * params.texel_size / 4u;
}

// The nearest source pixel, of equally near ones the first.
fn nearest_pixel(place: Place, pixel: vec2<i32>) -> vec2<i32> {
    var least = 0x7fffffff;
    var source = pixel;
    for (var index = 0u; index < 4u; index++) {
        let byte = bitcast<i32>(place.sources >> (8u * index));
        let offset = vec2(extractBits(byte, 0u, 4u), extractBits(byte, 4u, 4u));
        let first = place.origin + offset * BLOCK;
        let nearest = clamp(pixel, first, first + (BLOCK - 1));
        let away = nearest - pixel;
        let distance = dot(away, away);
        let is_nearer = any(offset != vec2(0)) && distance < least;
        least = select(least, distance, is_nearer);
        source = select(source, nearest, vec2(is_nearer));
    }
    return source;
}

// A word of several texels, the first one of `pixel`.
fn packed(place: Place, pixel: vec2<i32>) -> u32 {
    let bits = 8u * params.texel_size;
    let texels = 4u / params.texel_size;
    var value = 0u;
    for (var texel = 0u; texel < texels; texel++) {
        let source = nearest_pixel(place, pixel + vec2(i32(texel), 0));
        let shift = bits * (u32(source.x) % texels);
        value |= extractBits(words[word_of(place, source)], shift, bits) << (bits * texel);
    }
    return value;
}

@compute @workgroup_size(64)
fn cover(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let place = place(group, groups, thread);
    if place.inside {
        for (var y = 0; y < BLOCK; y++) {
            let first = word_of(place, place.origin + vec2(0, y));
            for (var word = 0u; word < params.texel_size; word++) {
                words[first + word] = params.near;
            }
        }
    }
}

@compute @workgroup_size(64)
fn fill(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let place = place(group, groups, thread);
    if !place.inside {
        return;
    }
    let step = i32(max(4u / params.texel_size, 1u));
    for (var y = 0; y < BLOCK; y++) {
        for (var x = 0; x < BLOCK; x += step) {
            let pixel = place.origin + vec2(x, y);
            let first = word_of(place, pixel);
            if params.texel_size < 4u {
                words[first] = packed(place, pixel);
                continue;
            }
            let source = word_of(place, nearest_pixel(place, pixel));
            for (var word = 0u; word < params.texel_size / 4u; word++) {
                words[first + word] = words[source + word];
            }
        }
    }
}
