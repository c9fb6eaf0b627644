// Kernel `mask`: from the rates of tiles to the blocks that a pass skips: the depth template, and the list that `fill` reads.
// Reference: core/src/mask.rs and what it calls. A thread for each block.

struct MaskParams {
    extent: vec2<u32>,
    blocks: vec2<u32>,
    tile: vec2<u32>,
    tile_columns: u32,
    layer_tiles: u32,
    layers: u32,
    views: u32,
    layer_words: u32,
    block_words: u32,
    shaded: u32,
    skipped: u32,
    reserved: vec2<u32>,
}

// Storage: lavapipe of Mesa 22.3 compiles a shader that branches on uniforms anew for each dispatch.
@group(0) @binding(0) var<storage, read> params: MaskParams;
// Six words for each view, see view_words; after those of all views the sources of each pattern, see pattern_sources.
@group(0) @binding(1) var<storage, read> views: array<u32>;
// Four texels in a word, row by row, layer by layer.
@group(0) @binding(2) var<storage, read> rates: array<u32>;

struct SkipList {
    columns: u32,
    rows: u32,
    one: u32,
    count: atomic<u32>,
    blocks: array<vec2<u32>>,
}

// core::mask::SkipList
@group(0) @binding(3) var<storage, read_write> list: SkipList;
@group(0) @binding(4) var<storage, read_write> depth: array<u32>;

const BLOCK: u32 = 4u;
const VIEW_WORDS: u32 = 6u;
const BLOCKS_PER_GROUP: u32 = 64u;
const GROUPS_PER_ROW: u32 = 2048u;
const REACH: i32 = 7;
const REACH_IN_PATTERN: u32 = 4u;
// reuse::STALE
const STALE: u32 = 0x80u;

struct View {
    rate_layer: u32,
    first: vec2<u32>,
    end: vec2<u32>,
}

fn rate_of(view: View, tile: vec2<u32>) -> u32 {
    let index = view.rate_layer * params.layer_tiles + tile.y * params.tile_columns + tile.x;
    return (rates[index / 4u] >> (8u * (index % 4u))) & 0xffu;
}

// Blocks from one shaded block to the next, as powers of two: mask::Pattern::of.
fn pattern_of(rate: u32) -> vec2<u32> {
    let octaves = ((rate >> 2u) & 3u) + (rate & 3u);
    return vec2(min((octaves + 1u) / 2u, 2u), min(octaves / 2u, 2u));
}

fn shades_inside(pattern: vec2<u32>, block: vec2<u32>) -> bool {
    let step = vec2(1u) << pattern;
    let is_shifted = (block.y & step.y) != 0u;
    let shift = select(0u, step.x / 2u, is_shifted);
    return (block.y & (step.y - 1u)) == 0u && (block.x & (step.x - 1u)) == shift;
}

// Pattern::shades
fn shades(view: View, pattern: vec2<u32>, block: vec2<u32>) -> bool {
    let step = vec2(1u) << pattern;
    let on_edge = (block == view.first) | (block + 1u == view.end);
    if on_edge.x && on_edge.y {
        return true;
    }
    if on_edge.x {
        return (block.y & (step.y - 1u)) == 0u;
    }
    if on_edge.y {
        return (block.x & (step.x - 1u)) == 0u;
    }
    return shades_inside(pattern, block);
}

fn is_shaded(view: View, block: vec2<u32>) -> bool {
    let rate = rate_of(view, block / params.tile);
    return (rate & STALE) == 0u && shades(view, pattern_of(rate), block);
}

// One byte: the nearest shaded block in a quarter around `block`; 0 where there is none.
fn nearest(view: View, block: vec2<u32>, along: vec2<i32>) -> u32 {
    let across = vec2(-along.y, along.x);
    var found = vec2(0);
    var limit = 2147483647;
    for (var side = 0; side <= REACH; side++) {
        for (var ahead = 1; ahead <= REACH; ahead++) {
            let distance = ahead * ahead + side * side;
            if distance >= limit {
                break;
            }
            let offset = along * ahead + across * side;
            let source = vec2<i32>(block) + offset;
            if all(source >= vec2<i32>(view.first)) && all(source < vec2<i32>(view.end))
                && is_shaded(view, vec2<u32>(source)) {
                found = offset;
                limit = distance;
                break;
            }
        }
    }
    return (u32(found.x) & 15u) | ((u32(found.y) & 15u) << 4u);
}

// Whether the sources of a block are those of its tile's pattern: all tiles within reach have that one.
fn is_within_pattern(view: View, block: vec2<u32>, rate: u32) -> bool {
    let margin = REACH_IN_PATTERN + 1u;
    if any(block < view.first + margin) || any(block + margin >= view.end) {
        return false;
    }
    let pattern = pattern_of(rate);
    let first = (block - REACH_IN_PATTERN) / params.tile;
    let last = (block + REACH_IN_PATTERN) / params.tile;
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let other = rate_of(view, vec2(x, y));
            if (other & STALE) != 0u || any(pattern_of(other) != pattern) {
                return false;
            }
        }
    }
    return true;
}

fn sources_of(view: View, block: vec2<u32>, rate: u32) -> u32 {
    if is_within_pattern(view, block, rate) {
        let pattern = pattern_of(rate);
        let row = (pattern.x + pattern.y) * 8u + block.y % 8u;
        return views[params.views * VIEW_WORDS + row * 4u + block.x % 4u];
    }
    return nearest(view, block, vec2(1, 0)) | (nearest(view, block, vec2(0, 1)) << 8u)
        | (nearest(view, block, vec2(-1, 0)) << 16u) | (nearest(view, block, vec2(0, -1)) << 24u);
}

// Whether a block is skipped; adds it to the list where it is filled.
fn skips(block: vec2<u32>, layer: u32) -> bool {
    for (var i = 0u; i < params.views; i++) {
        let at = i * VIEW_WORDS;
        let view = View(
            views[at + 1u],
            vec2(views[at + 2u], views[at + 3u]),
            vec2(views[at + 4u], views[at + 5u]),
        );
        if views[at] == layer && all(block >= view.first) && all(block < view.end) {
            let rate = rate_of(view, block / params.tile);
            if (rate & STALE) != 0u {
                return true;
            }
            if shades(view, pattern_of(rate), block) {
                return false;
            }
            let sources = sources_of(view, block, rate);
            if sources == 0u {
                return false;
            }
            let index = atomicAdd(&list.count, 1u);
            list.blocks[index] = vec2(block.x | (block.y << 12u) | (layer << 24u), sources);
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(8, 8)
fn blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= params.blocks) {
        return;
    }
    for (var layer = 0u; layer < params.layers; layer++) {
        let word = select(params.shaded, params.skipped, skips(id.xy, layer));
        let row_words = params.extent.x * params.block_words / BLOCK;
        let first = layer * params.layer_words + id.y * BLOCK * row_words + id.x * params.block_words;
        for (var y = 0u; y < BLOCK; y++) {
            for (var x = 0u; x < params.block_words; x++) {
                depth[first + y * row_words + x] = word;
            }
        }
    }
}

@compute @workgroup_size(1)
fn seal() {
    let groups = (atomicLoad(&list.count) + BLOCKS_PER_GROUP - 1u) / BLOCKS_PER_GROUP;
    list.columns = min(groups, GROUPS_PER_ROW);
    list.rows = max((groups + GROUPS_PER_ROW - 1u) / GROUPS_PER_ROW, 1u);
    list.one = 1u;
}
