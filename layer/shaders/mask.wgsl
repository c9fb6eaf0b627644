// Kernel `mask`: from the rates of tiles to the blocks that a pass skips: the depth template, and the list that `fill` reads.
// Reference: core/src/mask.rs and the functions it calls. First the shaded blocks, a bit each; then the list, a thread for each block; then the
// sources of the listed blocks, and their template, which before that marks everything as shaded. No work is under a branch that few threads take:
// software devices run it with all threads.

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
    bit_row_words: u32,
    bit_rows: u32,
    row_words: u32,
    block_rows: u32,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: MaskParams;
// Six words for each view, see view_words.
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
// Whether blocks are shaded, a bit each, with REACH more on each side of each layer, which are not.
@group(0) @binding(5) var<storage, read_write> bits: array<u32>;

const VIEW_WORDS: u32 = 6u;
const BLOCKS_PER_GROUP: u32 = 64u;
const GROUPS_PER_ROW: u32 = 2048u;
const REACH: u32 = 7u;
const WINDOW: u32 = 15u;
const FAR: i32 = 2147483647;
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

// The first view that a block of a layer is in, or how many there are.
fn view_of(block: vec2<u32>, layer: u32) -> u32 {
    for (var i = 0u; i < params.views; i++) {
        let at = i * VIEW_WORDS;
        let first = vec2(views[at + 2u], views[at + 3u]);
        let end = vec2(views[at + 4u], views[at + 5u]);
        if views[at] == layer && all(block >= first) && all(block < end) {
            return i;
        }
    }
    return params.views;
}

fn view_at(index: u32) -> View {
    let at = index * VIEW_WORDS;
    return View(views[at + 1u], vec2(views[at + 2u], views[at + 3u]), vec2(views[at + 4u], views[at + 5u]));
}

// Fate of a block: OUTSIDE of any view it is shaded; STALE blocks are skipped and not filled.
const OUTSIDE: u32 = 0u;
const SHADED: u32 = 1u;
const FILLED: u32 = 2u;
const LEFT_OUT: u32 = 3u;

fn fate(block: vec2<u32>, layer: u32) -> u32 {
    let index = view_of(block, layer);
    if index >= params.views {
        return OUTSIDE;
    }
    let view = view_at(index);
    let rate = rate_of(view, block / params.tile);
    if (rate & STALE) != 0u {
        return LEFT_OUT;
    }
    return select(FILLED, SHADED, shades(view, pattern_of(rate), block));
}

@compute @workgroup_size(64)
fn shaded(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x / params.bit_row_words;
    let layer = row / params.bit_rows;
    if layer >= params.layers {
        return;
    }
    let corner = vec2(id.x % params.bit_row_words * 32u, row % params.bit_rows);
    var word = 0u;
    for (var i = 0u; i < 32u; i++) {
        let place = vec2(corner.x + i, corner.y);
        let block = place - REACH;
        if all(place >= vec2(REACH)) && all(block < params.blocks) && fate(block, layer) == SHADED {
            word |= 1u << i;
        }
    }
    bits[id.x] = word;
}

// Marks `rows` rows of a block as skipped in the template: all of it, or nothing. A loop that no thread goes through ends at once.
fn mark(block: vec2<u32>, layer: u32, rows: u32) {
    let row_words = params.row_words;
    let first = layer * params.layer_words + block.y * params.block_rows * row_words + block.x * params.block_words;
    for (var y = 0u; y < rows; y++) {
        for (var x = 0u; x < params.block_words; x++) {
            depth[first + y * row_words + x] = params.skipped;
        }
    }
}

@compute @workgroup_size(8, 8)
fn blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= params.blocks) {
        return;
    }
    for (var layer = 0u; layer < params.layers; layer++) {
        let becomes = fate(id.xy, layer);
        if becomes == FILLED {
            let index = atomicAdd(&list.count, 1u);
            list.blocks[index] = vec2(id.x | (id.y << 12u) | (layer << 24u), 0u);
        }
        mark(id.xy, layer, select(0u, params.block_rows, becomes == LEFT_OUT));
    }
}

@compute @workgroup_size(1)
fn seal() {
    let groups = (atomicLoad(&list.count) + BLOCKS_PER_GROUP - 1u) / BLOCKS_PER_GROUP;
    list.columns = min(groups, GROUPS_PER_ROW);
    list.rows = max((groups + GROUPS_PER_ROW - 1u) / GROUPS_PER_ROW, 1u);
    list.one = 1u;
}

// Which blocks of a row of a view are shaded, a bit each, from REACH before column `x` on.
fn window(view: View, layer: u32, x: u32, y: i32) -> u32 {
    if y < i32(view.first.y) || y >= i32(view.end.y) {
        return 0u;
    }
    let at = (layer * params.bit_rows + u32(y) + REACH) * params.bit_row_words + x / 32u;
    let shift = x % 32u;
    let found = (bits[at] >> shift) | ((bits[at + 1u] << (31u - shift)) << 1u);
    // Nothing beyond the view's own columns.
    let before = REACH - min(x - view.first.x, REACH);
    let count = min(REACH + view.end.x - x, WINDOW);
    return found & ((1u << count) - 1u) & ~((1u << before) - 1u);
}

// The nearest block found so far in a quarter around another: its offset in xy, and the square of its distance.
fn nearer(found: vec3<i32>, there: bool, x: i32, y: i32, equal_counts: bool) -> vec3<i32> {
    let distance = x * x + y * y;
    let is_nearer = distance < found.z || (equal_counts && distance == found.z);
    return select(found, vec3(x, y, distance), there && is_nearer);
}

fn source_byte(found: vec3<i32>) -> u32 {
    return (u32(found.x) & 15u) | ((u32(found.y) & 15u) << 4u);
}

// mask::sources::nearest: of two at one distance the one farther from the quarter's axis counts.
fn nearest(view: View, layer: u32, block: vec2<u32>) -> u32 {
    var right = vec3(0, 0, FAR);
    var below = vec3(0, 0, FAR);
    var left = vec3(0, 0, FAR);
    var above = vec3(0, 0, FAR);
    for (var rows = 0; rows <= i32(REACH); rows++) {
        let lower = window(view, layer, block.x, i32(block.y) + rows);
        let upper = window(view, layer, block.x, i32(block.y) - rows);
        let to_right = lower >> (REACH + 1u);
        right = nearer(right, to_right != 0u, i32(firstTrailingBit(to_right)) + 1, rows, true);
        let to_left = upper & ((1u << REACH) - 1u);
        left = nearer(left, to_left != 0u, i32(firstLeadingBit(to_left)) - i32(REACH), -rows, true);
        if rows > 0 {
            let lower_left = lower & ((1u << (REACH + 1u)) - 1u);
            below = nearer(below, lower_left != 0u, i32(firstLeadingBit(lower_left)) - i32(REACH), rows, false);
            let upper_right = upper >> REACH;
            above = nearer(above, upper_right != 0u, i32(firstTrailingBit(upper_right)), -rows, false);
        }
    }
    return source_byte(right) | (source_byte(below) << 8u) | (source_byte(left) << 16u) | (source_byte(above) << 24u);
}

// A thread for each block of the list, as for `fill`. A block without sources stays shaded, and `fill` leaves it.
@compute @workgroup_size(64)
fn sources(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = (group.y * groups.x + group.x) * BLOCKS_PER_GROUP + thread;
    if index >= atomicLoad(&list.count) {
        return;
    }
    let place = list.blocks[index].x;
    let block = vec2(place & 0xfffu, (place >> 12u) & 0xfffu);
    let layer = place >> 24u;
    let found = nearest(view_at(view_of(block, layer)), layer, block);
    list.blocks[index].y = found;
    mark(block, layer, select(0u, params.block_rows, found != 0u));
}
