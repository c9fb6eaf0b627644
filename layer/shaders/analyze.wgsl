// Kernel `analyze`: the contrast of each tile of a picture, by octave of spatial frequency.
// Reference: core/src/kernels/analyze.rs and the functions it calls. One dispatch computes luminance with the first reduction, four more compute
// one reduction each, one the tiles. Where the view has not moved, luminance alone is computed as long as picture and rates are the same too. Only
// luminance depends on the format of the picture. On GPUs the time goes into moving levels: hence half floats, and a first reduction that reads
// the picture, which is in caches, not the luminance that its neighbours write. That is slow on software devices: they compute luminance alone,
// then level 1. For the same reason there is no barrier within a workgroup, no thread waits for another, and no single numbers are read: hence
// levels are kept in blocks of two by two texels.

struct AnalyzeParams {
    rect_offset: vec2<u32>,
    extent: vec2<u32>,
    texel: vec2<u32>,
    overhang: vec2<u32>,
    weights: vec3<f32>,
    white_cd_m2: f32,
    tiles: vec2<u32>,
    dark_cd_m2: f32,
    aggregation: u32,
}

// perception::TileContrast: five numbers without a gap.
struct TileContrast {
    bands: array<f32, 4>,
    adaptation_cd_m2: f32,
}

// kernels::analyze::Shown
struct Shown {
    contrast: f32,
    rate: u32,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: AnalyzeParams;
@group(0) @binding(1) var picture: texture_2d<f32>;
// Levels 0 to 5 of the pyramid, in blocks of two by two texels, the upper two first: kernels::analyze::level_place.
@group(0) @binding(2) var levels: texture_storage_2d<rgba16float, read_write>;
// The map: of the frame before until it is written.
@group(0) @binding(3) var<storage, read_write> map: array<TileContrast>;
// The rates that the picture was shaded at, four tiles of a row in a word; rows begin with a new one.
@group(0) @binding(4) var<storage, read> rates: array<u32>;
// Contrast and shading rate of each tile in the frame before.
@group(0) @binding(5) var<storage, read_write> shown: array<Shown>;

// State of the comparison of pictures while the view is the same.
struct Same {
    // Workgroups of the reductions, then of the tiles.
    groups: array<array<u32, 3>, 6>,
    // Whether this picture is another one than that before, or a tile of it was shaded at another rate.
    is_changed: atomic<u32>,
    // For how many pictures it has been the same.
    count: u32,
}

@group(0) @binding(6) var<storage, read_write> same: Same;

const BRIGHTEST_CD_M2: f32 = 10000.0;
// kernels::analyze::DARKEST_CD_M2
const DARKEST_CD_M2: f32 = 0.00006103515625;
const LARGEST_COMPONENT: f32 = 65504.0;
const INFINITY: u32 = 0x7f800000u;

// By its bits: a compiler may take it that no number is NaN.
fn component(value: f32) -> f32 {
    let is_nan = (bitcast<u32>(value) & 0x7fffffffu) > INFINITY;
    return select(clamp(value, -LARGEST_COMPONENT, LARGEST_COMPONENT), 0.0, is_nan);
}

// kernels::analyze::half, of luminance that is within its bounds.
fn half(texels: vec4<f32>) -> vec4<f32> {
    return bitcast<vec4<f32>>((bitcast<vec4<u32>>(texels) + 0x1000u) & vec4(0xffffe000u));
}

// `is_unit`: of a format that holds 0..=1 and nothing else.
fn light(pixel: vec2<i32>, is_unit: bool) -> f32 {
    let inside = clamp(pixel, vec2(0), vec2<i32>(params.extent) - 1);
    var rgb = textureLoad(picture, vec2<i32>(params.rect_offset) + inside, 0).rgb;
    if !is_unit {
        rgb = vec3(component(rgb.r), component(rgb.g), component(rgb.b));
    }
    let relative = params.weights.x * rgb.r + params.weights.y * rgb.g + params.weights.z * rgb.b;
    return clamp(relative * params.white_cd_m2, DARKEST_CD_M2, BRIGHTEST_CD_M2);
}

// Beyond the edge the last texel repeats, in blocks too.
fn block_of_picture(at: vec2<i32>, is_unit: bool) -> vec4<f32> {
    let pixel = 2 * at;
    return half(vec4(
        light(pixel, is_unit),
        light(pixel + vec2(1, 0), is_unit),
        light(pixel + vec2(0, 1), is_unit),
        light(pixel + 1, is_unit),
    ));
}

// Luminance alone, of a picture that may be the same as the last one.
fn compare_luminance(at: vec2<u32>, is_unit: bool) {
    if any(2u * at >= params.extent) {
        return;
    }
    let block = block_of_picture(vec2<i32>(at), is_unit);
    if any(textureLoad(levels, at) != block) {
        textureStore(levels, at, block);
        atomicStore(&same.is_changed, 1u);
    }
}

@compute @workgroup_size(64)
fn compared(@builtin(global_invocation_id) id: vec3<u32>) {
    compare_luminance(id.xy, false);
}

@compute @workgroup_size(64)
fn compared_unit(@builtin(global_invocation_id) id: vec3<u32>) {
    compare_luminance(id.xy, true);
}

// Whether a tile was shaded at a different rate than its known data: its picture may be the same with less detail.
@compute @workgroup_size(64)
fn rates_compared(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.tiles.x {
        return;
    }
    let rate = shaded_at(id.xy);
    if (rate & STALE) == 0u && rate != shown[id.y * params.tiles.x + id.x].rate {
        atomicStore(&same.is_changed, 1u);
    }
}

// kernels::analyze::SETTLED
const SETTLED: u32 = 16u;

// Of all stages, how many workgroups they have: none once nothing would change.
@compute @workgroup_size(1)
fn settle() {
    same.count = select(min(same.count + 1u, SETTLED), 0u, atomicExchange(&same.is_changed, 0u) != 0u);
    let layers = select(1u, 0u, same.count == SETTLED);
    for (var level = 1u; level <= 5u; level++) {
        // A thread makes two by two blocks.
        let groups = (level_size(level + 1u) + vec2(127u, 1u)) / vec2(128u, 2u);
        same.groups[level - 1u] = array<u32, 3>(groups.x, groups.y, layers);
    }
    same.groups[5] = array<u32, 3>((params.tiles.x + 63u) / 64u, params.tiles.y, layers);
}

fn level_size(level: u32) -> vec2<u32> {
    return (params.extent + (1u << level) - 1u) >> vec2(level);
}

struct Level {
    // Its first block.
    place: vec2<i32>,
    // Its last block, from that one on.
    last: vec2<i32>,
}

// kernels::analyze::level_place, level_blocks
fn level_at(level: u32) -> Level {
    var place = vec2(0u);
    if level > 0u {
        place.y = level_size(1u).y;
        for (var finer = 1u; finer < level; finer++) {
            place.x += level_size(finer + 1u).x;
        }
    }
    return Level(vec2<i32>(place), vec2<i32>(level_size(level + 1u)) - 1);
}

// Where a block may lie along an axis: nowhere but on the level, or also before its first or after its last block. Constants, so that a device
// asks no more than it has to.
const ON: i32 = 0;
const BEFORE: i32 = -1;
const AFTER: i32 = 1;

// A block of a level: the upper two texels, then the lower two. Beyond the edges the last texels repeat.
fn block(level: Level, at: vec2<i32>, across: i32, down: i32) -> vec4<f32> {
    let inside = clamp(at, vec2(0), level.last);
    var texels = textureLoad(levels, level.place + inside);
    if across == BEFORE {
        texels = select(texels, texels.xxzz, vec4(at.x < inside.x));
    }
    if across == AFTER {
        texels = select(texels, texels.yyww, vec4(at.x > inside.x));
    }
    if down == BEFORE {
        texels = select(texels, texels.xyxy, vec4(at.y < inside.y));
    }
    if down == AFTER {
        texels = select(texels, texels.zwzw, vec4(at.y > inside.y));
    }
    return texels;
}

fn binomial(a: vec2<f32>, b: vec2<f32>, c: vec2<f32>, d: vec2<f32>, e: vec2<f32>) -> vec2<f32> {
    return c + ((a - c) + (e - c)) * 0.0625 + ((b - c) + (d - c)) * 0.25;
}

// A row of blocks, reduced along it to four texels: of two each the upper and the lower row of the first, then of the second.
struct Row {
    left: vec4<f32>,
    right: vec4<f32>,
}

// From the block before on; of the last one the left half.
fn reduced(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>, e: vec4<f32>, f: vec4<f32>) -> Row {
    return Row(
        vec4(binomial(a.xz, a.yw, b.xz, b.yw, c.xz), binomial(b.xz, b.yw, c.xz, c.yw, d.xz)),
        vec4(binomial(c.xz, c.yw, d.xz, d.yw, e.xz), binomial(d.xz, d.yw, e.xz, e.yw, f.xz)),
    );
}

// Block row `y` of the level before, around four blocks from column `x` on.
fn row_of(finer: Level, x: i32, y: i32, down: i32) -> Row {
    return reduced(
        block(finer, vec2(x - 1, y), BEFORE, down),
        block(finer, vec2(x, y), ON, down),
        block(finer, vec2(x + 1, y), AFTER, down),
        block(finer, vec2(x + 2, y), AFTER, down),
        block(finer, vec2(x + 3, y), AFTER, down),
        block(finer, vec2(x + 4, y), AFTER, down),
    );
}

// The same of the picture. `is_stored`: its four blocks too, as far as they are of the picture.
fn row_of_picture(x: i32, y: i32, is_stored: bool, is_unit: bool) -> Row {
    let a = block_of_picture(vec2(x - 1, y), is_unit);
    let b = block_of_picture(vec2(x, y), is_unit);
    let c = block_of_picture(vec2(x + 1, y), is_unit);
    let d = block_of_picture(vec2(x + 2, y), is_unit);
    let e = block_of_picture(vec2(x + 3, y), is_unit);
    let f = block_of_picture(vec2(x + 4, y), is_unit);
    if is_stored {
        store_luminance(vec2(x, y), b);
        store_luminance(vec2(x + 1, y), c);
        store_luminance(vec2(x + 2, y), d);
        store_luminance(vec2(x + 3, y), e);
    }
    return reduced(a, b, c, d, e, f);
}

fn store_luminance(at: vec2<i32>, block: vec4<f32>) {
    if all(2 * at < vec2<i32>(params.extent)) {
        textureStore(levels, at, block);
    }
}

// The block at `at` of a level of this size, from the halves of four rows around it; the lower half of the last row is not needed.
fn store(level: Level, size: vec2<u32>, at: vec2<u32>, a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>) {
    if any(2u * at >= size) {
        return;
    }
    let upper = binomial(a.xz, a.yw, b.xz, b.yw, c.xz);
    let lower = binomial(b.xz, b.yw, c.xz, c.yw, d.xz);
    let fits = 2u * at + 1u < size;
    let texels = vec4(upper, select(upper, lower, fits.y));
    textureStore(levels, level.place + vec2<i32>(at), half(select(texels, texels.xxzz, vec4(!fits.x))));
}

// Two blocks beside each other.
fn store_two(level: Level, size: vec2<u32>, at: vec2<u32>, a: Row, b: Row, c: Row, d: Row) {
    store(level, size, at, a.left, b.left, c.left, d.left);
    store(level, size, at + vec2(1u, 0u), a.right, b.right, c.right, d.right);
}

// Two by two blocks of level `index`, from the level before.
fn reduce(index: u32, id: vec2<u32>) {
    let size = level_size(index);
    let at = 2u * id;
    if any(2u * at >= size) {
        return;
    }
    let level = level_at(index);
    let finer = level_at(index - 1u);
    let source = 2 * vec2<i32>(at);
    let a = row_of(finer, source.x, source.y - 1, BEFORE);
    let b = row_of(finer, source.x, source.y, ON);
    let c = row_of(finer, source.x, source.y + 1, AFTER);
    let d = row_of(finer, source.x, source.y + 2, AFTER);
    store_two(level, size, at, a, b, c, d);
    let e = row_of(finer, source.x, source.y + 3, AFTER);
    let f = row_of(finer, source.x, source.y + 4, AFTER);
    store_two(level, size, at + vec2(0u, 1u), c, d, e, f);
}

// The same of level 1 from the picture, with the luminance below it. Row by row: neighbours should read the same cache lines at about the same
// time.
fn reduce_picture(id: vec2<u32>, is_unit: bool) {
    let size = level_size(1u);
    let at = 2u * id;
    if any(2u * at >= size) {
        return;
    }
    let level = level_at(1u);
    let source = 2 * vec2<i32>(at);
    let a = row_of_picture(source.x, source.y - 1, false, is_unit);
    let b = row_of_picture(source.x, source.y, true, is_unit);
    let c = row_of_picture(source.x, source.y + 1, true, is_unit);
    let d = row_of_picture(source.x, source.y + 2, true, is_unit);
    store_two(level, size, at, a, b, c, d);
    let e = row_of_picture(source.x, source.y + 3, true, is_unit);
    let f = row_of_picture(source.x, source.y + 4, false, is_unit);
    store_two(level, size, at + vec2(0u, 1u), c, d, e, f);
}

@compute @workgroup_size(64)
fn luminance(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce_picture(id.xy, false);
}

@compute @workgroup_size(64)
fn luminance_unit(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce_picture(id.xy, true);
}

// Luminance alone, for devices that find reading a pixel dear.
@compute @workgroup_size(64)
fn alone(@builtin(global_invocation_id) id: vec3<u32>) {
    store_luminance(vec2<i32>(id.xy), block_of_picture(vec2<i32>(id.xy), false));
}

@compute @workgroup_size(64)
fn alone_unit(@builtin(global_invocation_id) id: vec3<u32>) {
    store_luminance(vec2<i32>(id.xy), block_of_picture(vec2<i32>(id.xy), true));
}

@compute @workgroup_size(64)
fn level1(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(1u, id.xy);
}

@compute @workgroup_size(64)
fn level2(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(2u, id.xy);
}

@compute @workgroup_size(64)
fn level3(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(3u, id.xy);
}

@compute @workgroup_size(64)
fn level4(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(4u, id.xy);
}

@compute @workgroup_size(64)
fn level5(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(5u, id.xy);
}

// The pixels of a tile, the last one included. Never empty.
struct Covered {
    first: vec2<u32>,
    last: vec2<u32>,
}

fn covered(tile: vec2<u32>) -> Covered {
    let first = max(tile * params.texel, params.overhang) - params.overhang;
    let last = min((tile + 1u) * params.texel - params.overhang, params.extent) - 1u;
    return Covered(first, last);
}

// Two columns of a level for a square of four by four texels of the level before it, expanded downwards.
struct Expanded {
    left: vec4<f32>,
    right: vec4<f32>,
}

fn expanded(before: f32, upper: f32, lower: f32, after: f32) -> vec4<f32> {
    return vec4(
        upper + ((before - upper) + (lower - upper)) * 0.125,
        upper + (lower - upper) * 0.5,
        lower + ((upper - lower) + (after - lower)) * 0.125,
        lower + (after - lower) * 0.5,
    );
}

fn expanded_columns(coarse: Level, at: vec2<i32>, across: i32) -> Expanded {
    let before = block(coarse, at - vec2(0, 1), across, BEFORE);
    let here = block(coarse, at, across, ON);
    let after = block(coarse, at + vec2(0, 1), across, AFTER);
    return Expanded(expanded(before.z, here.x, here.z, after.x), expanded(before.w, here.y, here.w, after.y));
}

// Column `x` of the level after that, rows `y` and `y` + 1, interpolated downwards.
fn upsampled_column(surround: Level, x: i32, y: i32) -> vec4<f32> {
    let here = block(surround, vec2(x, y) / 2, AFTER, ON);
    let below = block(surround, vec2(x, y + 1) / 2, AFTER, AFTER);
    // Rows `y` in the upper half of a block, and in its lower half.
    let upper = select(here.xy, here.zw, vec2((y & 1) != 0));
    let lower = select(below.zw, below.xy, vec2((y & 1) != 0));
    let first = select(upper.x, upper.y, (x & 1) != 0);
    let second = select(lower.x, lower.y, (x & 1) != 0);
    return first + (second - first) * vec4(0.0, 0.25, 0.5, 0.75);
}

// Of a tile: the greatest contrast of a band, or the sum of all, and the sum of the level's texels.
struct Gathered {
    contrast: f32,
    light: f32,
}

// One column of a square, of which those `inside` count.
fn with_column(sum: Gathered, inside: vec4<bool>, values: vec4<f32>, predicted: vec4<f32>, around: vec4<f32>) -> Gathered {
    let counted = select(vec4(0.0), abs(values - predicted) / (around + params.dark_cd_m2), inside);
    let lit = select(vec4(0.0), values, inside);
    let peak = max(max(counted.x, counted.y), max(counted.z, counted.w));
    let total = counted.x + counted.y + counted.z + counted.w;
    return Gathered(
        select(sum.contrast + total, max(sum.contrast, peak), params.aggregation == 0u),
        sum.light + (lit.x + lit.y + lit.z + lit.w),
    );
}

// By squares of four by four texels: two by two blocks, a block of the level after it, a texel of the one after that.
fn gather(band: u32, tile: Covered) -> Gathered {
    let level = level_at(band);
    let coarse = level_at(band + 1u);
    let surround = level_at(band + 2u);
    let first = vec2<i32>(tile.first >> vec2(band));
    let last = vec2<i32>(tile.last >> vec2(band));
    var sum = Gathered(0.0, 0.0);
    for (var y = first.y / 4; y <= last.y / 4; y++) {
        let lines = 4 * y + vec4(0, 1, 2, 3);
        let rows = (lines >= vec4(first.y)) & (lines <= vec4(last.y));
        var before = expanded_columns(coarse, vec2(first.x / 4 - 1, y), BEFORE).right;
        var here = expanded_columns(coarse, vec2(first.x / 4, y), ON);
        var around = upsampled_column(surround, first.x / 4, y);
        for (var x = first.x / 4; x <= last.x / 4; x++) {
            let after = expanded_columns(coarse, vec2(x + 1, y), AFTER);
            let beyond = upsampled_column(surround, x + 1, y);
            let step = beyond - around;
            // Texels beyond the level do not count.
            let upper_left = block(level, 2 * vec2(x, y), ON, ON);
            let lower_left = block(level, 2 * vec2(x, y) + vec2(0, 1), ON, ON);
            let upper_right = block(level, 2 * vec2(x, y) + vec2(1, 0), ON, ON);
            let lower_right = block(level, 2 * vec2(x, y) + 1, ON, ON);
            let places = 4 * x + vec4(0, 1, 2, 3);
            let inside = (places >= vec4(first.x)) & (places <= vec4(last.x));
            sum = with_column(
                sum,
                rows & vec4(inside.x),
                vec4(upper_left.xz, lower_left.xz),
                here.left + ((before - here.left) + (here.right - here.left)) * 0.125,
                around,
            );
            sum = with_column(
                sum,
                rows & vec4(inside.y),
                vec4(upper_left.yw, lower_left.yw),
                here.left + (here.right - here.left) * 0.5,
                around + step * 0.25,
            );
            sum = with_column(
                sum,
                rows & vec4(inside.z),
                vec4(upper_right.xz, lower_right.xz),
                here.right + ((here.left - here.right) + (after.left - here.right)) * 0.125,
                around + step * 0.5,
            );
            sum = with_column(
                sum,
                rows & vec4(inside.w),
                vec4(upper_right.yw, lower_right.yw),
                here.right + (after.left - here.right) * 0.5,
                around + step * 0.75,
            );
            before = here.right;
            here = after;
            around = beyond;
        }
    }
    return sum;
}

// perception::extrapolate::EQUAL_OCTAVES, and the constants of kernels::analyze::restore.
const EQUAL_OCTAVES: array<f32, 3> = array<f32, 3>(1.70, 1.10, 1.02);
const SAME: f32 = 2.0;
const SAME_ACROSS_RATES: f32 = 4.0;
const STEADY: f32 = 1.25;
const FOLLOW: f32 = 0.1;
const FORGET: f32 = 0.25;
const FLOOR: f32 = 0.01;

// reuse::STALE
const STALE: u32 = 0x80u;

// Shading rate of a tile, if it was shaded. A value that is not a rate counts as 1x1.
fn shaded_at(tile: vec2<u32>) -> u32 {
    let row_words = (params.tiles.x + 3u) / 4u;
    let rate = (rates[tile.y * row_words + tile.x / 4u] >> (8u * (tile.x % 4u))) & 0xffu;
    let is_known = (rate & STALE) != 0u || ((rate >> 2u) <= 2u && (rate & 3u) <= 2u);
    return select(0u, rate, is_known);
}

// kernels::analyze::restored, of the tile at `index`, which was shaded at `rate`.
fn restored(index: u32, measured: vec4<f32>, rate: u32) -> vec4<f32> {
    let log2_size = vec2(rate >> 2u, rate & 3u);
    let survivor = max(log2_size.x, log2_size.y);
    let lost_entirely = min(log2_size.x, log2_size.y);
    var before = map[index].bands;
    var bands = array<f32, 4>(measured.x, measured.y, measured.z, measured.w);
    let now = bands[survivor];
    let at_same_rate = shown[index].rate == rate;
    let change = (now + FLOOR) / (select(before[survivor], shown[index].contrast, at_same_rate) + FLOOR);
    let most = select(SAME_ACROSS_RATES, SAME, at_same_rate);
    let is_same = change <= most && change * most >= 1.0;
    let is_noise = change <= STEADY && change * STEADY >= 1.0;
    let is_kept = is_noise || !at_same_rate;
    let scale = select(1.0 + (change - 1.0) * FOLLOW, 1.0, is_kept);
    let forgotten = select(FORGET, 0.0, is_kept);
    var octaves = EQUAL_OCTAVES;
    let octave = now / octaves[survivor];
    for (var i = 0u; i < survivor; i++) {
        // perception::extrapolate
        let expected = octave * octaves[i];
        let guessed = select(max(bands[i], expected), expected, i < lost_entirely);
        // Another picture at this place has other octaves.
        bands[i] = select(guessed, mix(before[i] * scale, guessed, forgotten), is_same);
    }
    // Contrast that coarse shading folds into this band is not in the picture.
    bands[survivor] = select(now, before[survivor] * scale, is_same && survivor > 0u);
    let follows = at_same_rate && is_same;
    if !(follows && is_noise) {
        let followed = max((shown[index].contrast + FLOOR) * scale - FLOOR, 0.0);
        shown[index] = Shown(select(now, followed, follows), rate);
    }
    return vec4(bands[0], bands[1], bands[2], bands[3]);
}

fn write(place: vec2<u32>, tile: Covered, bands: vec4<f32>, light: f32) {
    var measured = bands;
    if params.aggregation != 0u {
        for (var band = 0u; band < 4u; band++) {
            let size = (tile.last >> vec2(band)) - (tile.first >> vec2(band)) + 1u;
            measured[band] /= f32(size.x * size.y);
        }
    }
    let pixels = tile.last - tile.first + 1u;
    let index = place.y * params.tiles.x + place.x;
    let rate = shaded_at(place);
    // A tile that was not shaded keeps its known values.
    if (rate & STALE) != 0u {
        return;
    }
    let known = restored(index, measured, rate);
    map[index].bands = array<f32, 4>(known.x, known.y, known.z, known.w);
    map[index].adaptation_cd_m2 = light / f32(pixels.x * pixels.y);
}

@compute @workgroup_size(64)
fn tiles(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.tiles.x {
        return;
    }
    let tile = covered(id.xy);
    let finest = gather(0u, tile);
    let bands =
        vec4(finest.contrast, gather(1u, tile).contrast, gather(2u, tile).contrast, gather(3u, tile).contrast);
    write(id.xy, tile, bands, finest.light);
}
