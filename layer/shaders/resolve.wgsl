// Kernel `resolve`: from the rates of the tiles of both eyes to the texels of one rate image.
// Reference: core/src/kernels/resolve.rs. A thread writes four texels that follow each other, which share a word.

struct ResolveParams {
    texels: vec2<u32>,
    layers: u32,
    pictures: u32,
    row_words: vec2<u32>,
    leaves_out: u32,
    reserved: u32,
    available: vec4<u32>,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: ResolveParams;
// kernels::resolve::RateMapTable
@group(0) @binding(1) var<storage, read> pictures: array<u32>;
// Rates of tiles, four of a row in a word; rows begin with a new one.
@group(0) @binding(2) var<storage, read> left: array<u32>;
@group(0) @binding(3) var<storage, read> right: array<u32>;
@group(0) @binding(4) var<storage, read_write> resolved: array<u32>;

// reuse::STALE
const STALE: u32 = 0x80u;
// Unary of 4x4, stale.
const COARSEST: u32 = 0x8fu;

fn rate_at(eye: u32, x: u32, y: u32) -> u32 {
    let index = y * params.row_words[eye] + x / 4u;
    var word = 0u;
    if eye == 0u {
        word = left[index];
    } else {
        word = right[index];
    }
    return (word >> (8u * (x % 4u))) & 0xffu;
}

// 1x1 for a value that is not a rate.
fn unary(texel: u32) -> u32 {
    let log2_size = vec2((texel >> 2u) & 0x1fu, texel & 3u);
    let sides = (vec2(1u) << min(log2_size, vec2(2u))) - 1u;
    let is_rate = all(log2_size <= vec2(2u));
    return select(0u, (sides.x << 2u) | sides.y, is_rate) | (texel & STALE);
}

fn offered(permitted: u32) -> u32 {
    return (params.available[permitted / 4u] >> (8u * (permitted % 4u))) & 0xffu;
}

fn texel_at(index: u32) -> u32 {
    let per_picture = 1u + params.texels.x + params.texels.y;
    if ((pictures[params.pictures * per_picture + index / 32u] >> (index % 32u)) & 1u) == 0u {
        return 0u;
    }
    let column = index % params.texels.x;
    let row = index / params.texels.x % params.texels.y;
    let layer = index / params.texels.x / params.texels.y;
    var finest = COARSEST;
    for (var picture = 0u; picture < params.pictures; picture++) {
        let first = picture * per_picture;
        let place = pictures[first];
        if (place >> 1u) != layer {
            continue;
        }
        let columns = pictures[first + 1u + column];
        let rows = pictures[first + 1u + params.texels.x + row];
        for (var y = rows & 0xffffu; y < (rows >> 16u); y++) {
            for (var x = columns & 0xffffu; x < (columns >> 16u); x++) {
                finest &= unary(rate_at(place & 1u, x, y));
            }
        }
    }
    if (finest & STALE) != 0u && params.leaves_out == 0u {
        return offered(15u);
    }
    return offered(finest & 15u) | (finest & STALE);
}

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    let texels = params.texels.x * params.texels.y * params.layers;
    if 4u * id.x >= texels {
        return;
    }
    var word = 0u;
    for (var i = 0u; i < 4u; i++) {
        let index = 4u * id.x + i;
        if index < texels {
            word |= texel_at(index) << (8u * i);
        }
    }
    resolved[id.x] = word;
}
