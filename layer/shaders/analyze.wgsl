// Kernel `analyze`: the contrast of each tile of a picture, by octave of spatial frequency.
// Reference: core/src/kernels/analyze.rs and what it calls. One dispatch for luminance, one for each of five reductions, one for the
// parts of tiles, one for the tiles. Only the first depends on the format of the picture. No barrier within a workgroup, and no
// thread that waits for another: software devices find both dear.

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

// Storage: lavapipe of Mesa 22.3 compiles a shader that branches on uniforms anew for each dispatch.
@group(0) @binding(0) var<storage, read> params: AnalyzeParams;
@group(0) @binding(1) var picture: texture_2d<f32>;
// Levels 0 to 5 of the pyramid, one after the other, then PARTS parts of each tile.
@group(0) @binding(2) var<storage, read_write> levels: array<f32>;
// The map: of the frame before until it is written.
@group(0) @binding(3) var<storage, read_write> map: array<TileContrast>;
// The rates that the picture was shaded at, four tiles of a row in a word; rows begin with a new one.
@group(0) @binding(4) var<storage, read> rates: array<u32>;
// What each tile showed in the frame before.
@group(0) @binding(5) var<storage, read_write> shown: array<Shown>;

// Threads of a workgroup.
const THREADS: u32 = 64u;
// Parts that a tile is gathered in, a thread each.
const PARTS: u32 = 8u;

const BRIGHTEST_CD_M2: f32 = 10000.0;
const LARGEST_COMPONENT: f32 = 65504.0;
const INFINITY: u32 = 0x7f800000u;

// By its bits: a compiler may take it that no number is NaN.
fn component(value: f32) -> f32 {
    let is_nan = (bitcast<u32>(value) & 0x7fffffffu) > INFINITY;
    return select(clamp(value, -LARGEST_COMPONENT, LARGEST_COMPONENT), 0.0, is_nan);
}

@compute @workgroup_size(8, 8)
fn luminance(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= params.extent) {
        return;
    }
    let color = textureLoad(picture, params.rect_offset + id.xy, 0);
    let rgb = vec3(component(color.r), component(color.g), component(color.b));
    let relative = params.weights.x * rgb.r + params.weights.y * rgb.g + params.weights.z * rgb.b;
    levels[id.y * params.extent.x + id.x] = clamp(relative * params.white_cd_m2, 0.0, BRIGHTEST_CD_M2);
}

fn level_size(level: u32) -> vec2<u32> {
    return (params.extent + (1u << level) - 1u) >> vec2(level);
}

fn level_offset(level: u32) -> u32 {
    var offset = 0u;
    for (var finer = 0u; finer < level; finer++) {
        let size = level_size(finer);
        offset += size.x * size.y;
    }
    return offset;
}

fn binomial(a: f32, b: f32, c: f32, d: f32, e: f32) -> f32 {
    return c + ((a - c) + (e - c)) * 0.0625 + ((b - c) + (d - c)) * 0.25;
}

// Column or row `step` of seven that begin two before `first`; beyond the edge the last one repeats.
fn around(first: u32, step: u32, count: u32) -> u32 {
    return min(max(first + step, 2u) - 2u, count - 1u);
}

// Two by two texels of level `index`, from the level before.
fn reduce(index: u32, id: vec2<u32>) {
    let size = level_size(index);
    let at = 2u * id;
    if any(at >= size) {
        return;
    }
    let finer = Level(level_offset(index - 1u), level_size(index - 1u));
    var upper: array<f32, 7>;
    var lower: array<f32, 7>;
    for (var i = 0u; i < 7u; i++) {
        let x = around(2u * at.x, i, finer.size.x);
        var column: array<f32, 7>;
        for (var j = 0u; j < 7u; j++) {
            column[j] = texel(finer, x, around(2u * at.y, j, finer.size.y));
        }
        upper[i] = binomial(column[0], column[1], column[2], column[3], column[4]);
        lower[i] = binomial(column[2], column[3], column[4], column[5], column[6]);
    }
    let to = level_offset(index) + at.y * size.x + at.x;
    let fits = at + 1u < size;
    levels[to] = binomial(upper[0], upper[1], upper[2], upper[3], upper[4]);
    if fits.x {
        levels[to + 1u] = binomial(upper[2], upper[3], upper[4], upper[5], upper[6]);
    }
    if fits.y {
        levels[to + size.x] = binomial(lower[0], lower[1], lower[2], lower[3], lower[4]);
    }
    if all(fits) {
        levels[to + size.x + 1u] = binomial(lower[2], lower[3], lower[4], lower[5], lower[6]);
    }
}

@compute @workgroup_size(8, 8)
fn level1(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(1u, id.xy);
}

@compute @workgroup_size(8, 8)
fn level2(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(2u, id.xy);
}

@compute @workgroup_size(8, 8)
fn level3(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(3u, id.xy);
}

@compute @workgroup_size(8, 8)
fn level4(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(4u, id.xy);
}

@compute @workgroup_size(8, 8)
fn level5(@builtin(global_invocation_id) id: vec3<u32>) {
    reduce(5u, id.xy);
}

struct Level {
    offset: u32,
    size: vec2<u32>,
}

fn texel(level: Level, x: u32, y: u32) -> f32 {
    return levels[level.offset + y * level.size.x + x];
}

// Three texels of a row.
fn texels(level: Level, x: vec3<u32>, y: u32) -> vec3<f32> {
    return vec3(texel(level, x.x, y), texel(level, x.y, y), texel(level, x.z, y));
}

// What level `band` + 1 predicts for the four texels (2k, 2k + 1) of level `band`: upper row, then lower row.
fn expanded(level: Level, k: vec2<u32>) -> vec4<f32> {
    let last = level.size - 1u;
    let x = vec3(max(k.x, 1u) - 1u, k.x, min(k.x + 1u, last.x));
    let before = texels(level, x, max(k.y, 1u) - 1u);
    let at = texels(level, x, k.y);
    let after = texels(level, x, min(k.y + 1u, last.y));
    let even = at + ((before - at) + (after - at)) * 0.125;
    let odd = at + (after - at) * 0.5;
    return vec4(
        even.y + ((even.x - even.y) + (even.z - even.y)) * 0.125,
        even.y + (even.z - even.y) * 0.5,
        odd.y + ((odd.x - odd.y) + (odd.z - odd.y)) * 0.125,
        odd.y + (odd.z - odd.y) * 0.5,
    );
}

// Level `band` + 2 at the same texels, interpolated.
fn upsampled(level: Level, k: vec2<u32>) -> vec4<f32> {
    let first = k / 2u;
    let second = min(first + 1u, level.size - 1u);
    let along = vec2<f32>(k % 2u) * 0.5;
    let upper = vec2(texel(level, first.x, first.y), texel(level, second.x, first.y));
    let lower = vec2(texel(level, first.x, second.y), texel(level, second.x, second.y));
    let down = lower - upper;
    let rows = array<vec2<f32>, 2>(upper + down * along.y, upper + down * (along.y + 0.25));
    let steps = vec2(rows[0].y - rows[0].x, rows[1].y - rows[1].x);
    return vec4(
        rows[0].x + steps.x * along.x,
        rows[0].x + steps.x * (along.x + 0.25),
        rows[1].x + steps.y * along.x,
        rows[1].x + steps.y * (along.x + 0.25),
    );
}

// The four texels of level `band`.
fn fine(level: Level, k: vec2<u32>) -> vec4<f32> {
    let first = 2u * k;
    let second = min(first + 1u, level.size - 1u);
    return vec4(
        texel(level, first.x, first.y),
        texel(level, second.x, first.y),
        texel(level, first.x, second.y),
        texel(level, second.x, second.y),
    );
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

// Of a part, or of all: for each band the greatest contrast or the sum, and in the picture the sum of luminance.
struct Gathered {
    bands: vec4<f32>,
    light: f32,
}

fn gather(band: u32, tile: Covered, part: u32) -> vec2<f32> {
    let level = Level(level_offset(band), level_size(band));
    let coarse = Level(level_offset(band + 1u), level_size(band + 1u));
    let surround = Level(level_offset(band + 2u), level_size(band + 2u));
    let first = tile.first >> vec2(band);
    let last = tile.last >> vec2(band);
    let corner = first / 2u;
    let blocks = last / 2u - corner + 1u;
    var contrast = 0.0;
    var light = 0.0;
    for (var i = part; i < blocks.x * blocks.y; i += PARTS) {
        let k = corner + vec2(i % blocks.x, i / blocks.x);
        let x = vec2(2u * k.x, 2u * k.x + 1u);
        let y = vec2(2u * k.y, 2u * k.y + 1u);
        let columns = (x >= first.xx) & (x <= last.xx);
        let rows = (y >= first.yy) & (y <= last.yy);
        let inside = columns.xyxy & rows.xxyy;
        let values = fine(level, k);
        let contrasts = abs(values - expanded(coarse, k)) / (upsampled(surround, k) + params.dark_cd_m2);
        let counted = select(vec4(0.0), contrasts, inside);
        if params.aggregation == 0u {
            contrast = max(contrast, max(max(counted.x, counted.y), max(counted.z, counted.w)));
        } else {
            contrast += counted.x + counted.y + counted.z + counted.w;
        }
        let lit = select(vec4(0.0), values, inside);
        light += lit.x + lit.y + lit.z + lit.w;
    }
    return vec2(contrast, light);
}

fn joined(a: Gathered, b: Gathered) -> Gathered {
    return Gathered(select(a.bands + b.bands, max(a.bands, b.bands), params.aggregation == 0u), a.light + b.light);
}

// perception::extrapolate::EQUAL_OCTAVES, and the constants of kernels::analyze::restore.
const EQUAL_OCTAVES: array<f32, 3> = array<f32, 3>(1.70, 1.10, 1.02);
const SAME: f32 = 2.0;
const SAME_ACROSS_RATES: f32 = 4.0;
const STEADY: f32 = 1.25;
const FOLLOW: f32 = 0.1;
const FLOOR: f32 = 0.01;

// reuse::STALE
const STALE: u32 = 0x80u;

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
    let scale = select(1.0 + (change - 1.0) * FOLLOW, 1.0, is_noise || !at_same_rate);
    var octaves = EQUAL_OCTAVES;
    let octave = now / octaves[survivor];
    for (var i = 0u; i < survivor; i++) {
        // perception::extrapolate
        let expected = octave * octaves[i];
        let guessed = select(max(bands[i], expected), expected, i < lost_entirely);
        bands[i] = select(guessed, before[i] * scale, is_same);
    }
    // What blocks fold into it is not in the picture.
    bands[survivor] = select(now, before[survivor] * scale, is_same && survivor > 0u);
    let follows = at_same_rate && is_same;
    if !(follows && is_noise) {
        let followed = max((shown[index].contrast + FLOOR) * scale - FLOOR, 0.0);
        shown[index] = Shown(select(now, followed, follows), rate);
    }
    return vec4(bands[0], bands[1], bands[2], bands[3]);
}

fn write(place: vec2<u32>, tile: Covered, sum: Gathered) {
    var measured = sum.bands;
    if params.aggregation != 0u {
        for (var band = 0u; band < 4u; band++) {
            let size = (tile.last >> vec2(band)) - (tile.first >> vec2(band)) + 1u;
            measured[band] /= f32(size.x * size.y);
        }
    }
    let pixels = tile.last - tile.first + 1u;
    let index = place.y * params.tiles.x + place.x;
    let row_words = (params.tiles.x + 3u) / 4u;
    let rate = (rates[place.y * row_words + place.x / 4u] >> (8u * (place.x % 4u))) & 0xffu;
    // What was not shaded stays as it was known.
    if (rate & STALE) != 0u {
        return;
    }
    // What is no rate counts as 1x1.
    let is_rate = (rate >> 2u) <= 2u && (rate & 3u) <= 2u;
    let known = restored(index, measured, select(0u, rate, is_rate));
    map[index].bands = array<f32, 4>(known.x, known.y, known.z, known.w);
    map[index].adaptation_cd_m2 = sum.light / f32(pixels.x * pixels.y);
}

// Where a part of a tile is kept: its bands, then its light.
fn part_offset(index: u32, part: u32) -> u32 {
    return level_offset(6u) + (index * PARTS + part) * 5u;
}

fn gathered(index: u32, part: u32) -> Gathered {
    let at = part_offset(index, part);
    return Gathered(vec4(levels[at], levels[at + 1u], levels[at + 2u], levels[at + 3u]), levels[at + 4u]);
}

@compute @workgroup_size(64)
fn parts(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let place = vec2(group.x * (THREADS / PARTS) + thread / PARTS, group.y);
    if place.x >= params.tiles.x {
        return;
    }
    let part = thread % PARTS;
    let tile = covered(place);
    let finest = gather(0u, tile, part);
    let at = part_offset(place.y * params.tiles.x + place.x, part);
    levels[at] = finest.x;
    levels[at + 1u] = gather(1u, tile, part).x;
    levels[at + 2u] = gather(2u, tile, part).x;
    levels[at + 3u] = gather(3u, tile, part).x;
    levels[at + 4u] = finest.y;
}

@compute @workgroup_size(64)
fn tiles(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= params.tiles.x {
        return;
    }
    let index = id.y * params.tiles.x + id.x;
    var sum = gathered(index, 0u);
    for (var part = 1u; part < PARTS; part++) {
        sum = joined(sum, gathered(index, part));
    }
    write(id.xy, covered(id.xy), sum);
}
