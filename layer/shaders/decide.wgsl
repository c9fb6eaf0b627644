// Kernel `decide`: from one view's parameters to a rate for each of its tiles.
// Reference: core/src/kernels/decide.rs and the functions it calls. A thread decides four tiles of a row, which share a word.

struct DecideParams {
    gaze_left: vec3<f32>,
    inflation_deg: f32,
    gaze_right: vec3<f32>,
    coarsening: u32,
    ring_chords: vec4<f32>,
    coarsening_chords: vec4<f32>,
    levels: vec4<u32>,
    texels: vec4<u32>,
    budget: f32,
    coarsening_budget: f32,
    sensitivity: u32,
    full_rate_period: u32,
    plane_origin: vec2<f32>,
    plane_step: vec2<f32>,
    extent: vec2<u32>,
    overhang: vec2<u32>,
    texel: vec2<u32>,
    tiles: vec2<u32>,
    full_rate_phase: u32,
    is_turned: u32,
    has_stale: u32,
    holding_budget: f32,
    measured_column: vec3<f32>,
    elapsed_ms: u32,
    measured_row: vec3<f32>,
    flat_contrast: f32,
    measured_depth: vec3<f32>,
    is_marginal: u32,
    axis_tile: vec2<u32>,
    unused: vec2<u32>,
}

// perception::TileContrast
struct TileContrast {
    bands: array<f32, 4>,
    adaptation_cd_m2: f32,
}

// Storage: lavapipe of Mesa 22.3 recompiles a shader that branches on uniforms for each dispatch.
@group(0) @binding(0) var<storage, read> params: DecideParams;
@group(0) @binding(1) var<storage, read> contrast: array<TileContrast>;
// castle::FovealTable
@group(0) @binding(2) var<storage, read> foveal: array<f32>;
// Of each tile its coarseness and then the time since its rate changed, and its rate: four tiles of a row in a word; rows begin with a
// new one.
@group(0) @binding(3) var<storage, read_write> memory: array<u32>;
@group(0) @binding(4) var<storage, read_write> rates: array<u32>;
// Whether each tile is left out: reuse::StaleTiles.
@group(0) @binding(5) var<storage, read> stale: array<u32>;

// reuse::STALE
const STALE: u32 = 0x80u;
// kernels::decide::STEADY_MS
const STEADY_MS: u32 = 100u;
// kernels::decide::STILL
const STILL: f32 = 0.125;

// DecideParams::sensitivity
const RINGS_ONLY: u32 = 0u;
const CASTLE_CSF: u32 = 1u;
const TURSUN: u32 = 2u;
const LOG2_10: f32 = 3.3219281;
const LOG2_E: f32 = 1.442695;
const NOT_FINITE: u32 = 0x7f800000u;

fn is_finite(value: f32) -> bool {
    return (bitcast<u32>(value) & NOT_FINITE) != NOT_FINITE;
}

// A corner of the lattice of tiles, pixels of the view.
fn corner_pixel(corner: vec2<u32>) -> vec2<f32> {
    let pixels = corner * params.texel;
    return vec2<f32>(min(max(pixels, params.overhang) - params.overhang, params.extent));
}

fn direction(point: vec2<f32>) -> vec3<f32> {
    return normalize(vec3(point, -1.0));
}

fn squared_chord(direction: vec3<f32>, gaze: vec3<f32>) -> f32 {
    let away = direction - gaze;
    return dot(away, away);
}

// The pixels of a tile along an axis: from one line up to another, and the last one of a view ends on it.
struct Span {
    low: f32,
    high: f32,
    is_last: bool,
}

// Where a direction meets the picture, pixels along an axis; before all tiles where it is not ahead. No division of whole numbers: software
// devices do those one by one.
fn pixel_of(direction: vec3<f32>, axis: u32) -> f32 {
    let pixel = (direction[axis] / -direction.z - params.plane_origin[axis]) / params.plane_step[axis];
    return select(-1.0, pixel, direction.z < 0.0);
}

fn meets(pixel: f32, span: Span) -> bool {
    return pixel >= span.low && (pixel < span.high || (span.is_last && pixel == span.high));
}

// Where a gaze is.
struct Gaze {
    direction: vec3<f32>,
    pixel: vec2<f32>,
}

fn gaze_at(direction: vec3<f32>) -> Gaze {
    return Gaze(direction, vec2(pixel_of(direction, 0u), pixel_of(direction, 1u)));
}

// The point nearest to a gaze on the great circle across `normal`: its pixel along an axis, and its squared chord.
fn foot(gaze: vec3<f32>, normal: vec3<f32>, axis: u32) -> vec2<f32> {
    let length_squared = dot(normal, normal);
    let along = dot(gaze, normal) / length_squared;
    let sin_squared = min(along * along * length_squared, 1.0);
    return vec2(pixel_of(gaze - normal * along, axis), 2.0 * sin_squared / (1.0 + sqrt(1.0 - sin_squared)));
}

// A line between tiles: the feet of both gazes on it.
struct Line {
    of_left: vec2<f32>,
    of_right: vec2<f32>,
}

fn line_of_rows(y: f32) -> Line {
    let normal = vec3(0.0, 1.0, y);
    return Line(foot(params.gaze_left, normal, 0u), foot(params.gaze_right, normal, 0u));
}

fn line_of_columns(x: f32) -> Line {
    let normal = vec3(1.0, 0.0, x);
    return Line(foot(params.gaze_left, normal, 1u), foot(params.gaze_right, normal, 1u));
}

// The corners of a tile, as directions: upper left, upper right, lower left, lower right.
struct Corners {
    directions: array<vec3<f32>, 4>,
}

fn lowered(chord: f32, foot: vec2<f32>, span: Span) -> f32 {
    return select(chord, min(chord, foot.y), meets(foot.x, span));
}

// Squared chord between the nearest point of a tile and a gaze, whose feet are those on the tile's upper and lower, left and right line.
fn chord_to(
    corners: Corners,
    columns: Span,
    rows: Span,
    gaze: Gaze,
    upper: vec2<f32>,
    lower: vec2<f32>,
    left: vec2<f32>,
    right: vec2<f32>,
) -> f32 {
    if meets(gaze.pixel.x, columns) && meets(gaze.pixel.y, rows) {
        return 0.0;
    }
    var chord = min(
        min(squared_chord(corners.directions[0], gaze.direction), squared_chord(corners.directions[1], gaze.direction)),
        min(squared_chord(corners.directions[2], gaze.direction), squared_chord(corners.directions[3], gaze.direction)),
    );
    chord = lowered(chord, upper, columns);
    chord = lowered(chord, lower, columns);
    chord = lowered(chord, left, rows);
    chord = lowered(chord, right, rows);
    return chord;
}

// Arc sine of 0..=1 to 2e-8 (Abramowitz and Stegun, 4.4.46): that of drivers may be off by a hundredth of a degree.
fn arc_sine(x: f32) -> f32 {
    let a = 1.5707963 + x * (-0.2145988 + x * (0.0889790 + x * (-0.0501743 + x * (0.0308919
        + x * (-0.0170881 + x * (0.0066701 + x * -0.0012625))))));
    return 1.5707963 - sqrt(1.0 - x) * a;
}

fn deg_of_chord(chord: f32) -> f32 {
    return degrees(2.0 * arc_sine(min(sqrt(chord) * 0.5, 1.0)));
}

// Pixels per degree along one axis, from the step of a pixel and the coordinate across.
fn along(reach: f32, step: f32, across: f32) -> f32 {
    return select(radians(reach / (sqrt(1.0 + across) * abs(step))), 0.0, step == 0.0);
}

// geometry::pixels_per_degree
fn pixels_per_degree(point: vec2<f32>) -> f32 {
    let squared = point * point;
    let reach = 1.0 + squared.x + squared.y;
    return min(along(reach, params.plane_step.x, squared.y), along(reach, params.plane_step.y, squared.x));
}

// castle::FovealTable's nodes.
const STEPS: f32 = 4.0;
const FREQUENCY: vec2<f32> = vec2(-4.0, 6.0);
const LUMINANCE: vec2<f32> = vec2(-10.0, 13.5);
const COLUMNS: u32 = 41u;
const ROWS: u32 = 95u;

struct Cell {
    index: u32,
    along: f32,
}

fn cell(value: f32, ends: vec2<f32>, nodes: u32) -> Cell {
    let position = (clamp(value, ends.x, ends.y) - ends.x) * STEPS;
    let index = min(u32(position), nodes - 2u);
    return Cell(index, position - f32(index));
}

fn row_at(column: u32, row: u32, along: f32) -> f32 {
    let left = foveal[row * COLUMNS + column];
    return left + (foveal[row * COLUMNS + column + 1u] - left) * along;
}

// Octaves that rates remove, and whose contrast therefore counts: two of the four.
const REMOVED: u32 = 2u;

// FovealTable::sensitivities to them, in the field where more is seen.
fn castle_csf(finest_cpd: f32, luminance: f32, eccentricity: f32) -> vec2<f32> {
    let row = cell(log2(clamp(luminance, 1e-3, 1e4)), LUMINANCE, ROWS);
    let finest = clamp(finest_cpd, 0.0625, 64.0);
    let column = cell(log2(finest), FREQUENCY, COLUMNS);
    var seen = vec2(0.0);
    for (var band = 0u; band < REMOVED; band++) {
        let inside = column.index >= 4u * band;
        let first = select(0u, column.index - 4u * band, inside);
        let within = select(0.0, column.along, inside);
        let above = row_at(first, row.index, within);
        let below = row_at(first, row.index + 1u, within);
        let cpd = max(finest / f32(1u << band), 0.0625);
        let fall = LOG2_10 * min(0.0239853 + 0.0189038 * cpd, 0.0400662 + 0.00813619 * cpd);
        seen[band] = exp2(above + (below - above) * row.along - fall * eccentricity);
    }
    return seen;
}

// tursun::Fit::QUARTER at its knots, and the slopes there of the curve that Fritsch and Carlson put through them.
const KNOTS: array<f32, 5> = array<f32, 5>(5.28964, 6.22567, 3.40410, 4.01061, -32.0);
const SLOPES: array<f32, 5> = array<f32, 5>(0.0, 0.0, 0.0, 0.0, -54.31917);
const TURSUN_FALL: f32 = 0.0398141;

fn tursun(finest_cpd: f32, luminance: f32, eccentricity: f32) -> vec2<f32> {
    let adapted = 0.2 * log2(1.0 + 0.7 / clamp(luminance, 1e-3, 1e4));
    var knots = KNOTS;
    var slopes = SLOPES;
    var seen = vec2(0.0);
    for (var band = 0u; band < REMOVED; band++) {
        let cpd = clamp(finest_cpd / f32(1u << band), 0.0, 64.0);
        let octave = log2(max(cpd, 4.0)) - 2.0;
        let i = min(u32(octave), 3u);
        let t = octave - f32(i);
        let rise = knots[i + 1u] - knots[i];
        let quadratic = 3.0 * rise - 2.0 * slopes[i] - slopes[i + 1u];
        let cubic = slopes[i] + slopes[i + 1u] - 2.0 * rise;
        let log10 = knots[i] + t * (slopes[i] + t * (quadratic + t * cubic));
        let exponent = log10 * LOG2_10 - adapted - TURSUN_FALL * cpd * LOG2_E * eccentricity;
        // BAND_GAIN
        seen[band] = f32(1u << band) * exp2(max(exponent, -126.0));
    }
    return seen;
}

// Coarseness within a budget: frco::Allocation::half_octaves, in steps of half an octave.
fn level_within(visible: vec2<f32>, budget: f32) -> u32 {
    if !is_finite(visible.x + visible.y) || !is_finite(budget) {
        return 0u;
    }
    let losses =
        vec4(0.5 * visible.x, visible.x, visible.x + 0.5 * visible.y, visible.x + visible.y);
    let within = dot(vec4<u32>(losses <= vec4(budget)), vec4(1u));
    // frco::half_octaves_at
    let costs = losses + budget * vec4(0.5, 0.25, 0.125, 0.0625);
    var cheapest = 0u;
    var least = budget;
    for (var i = 0u; i < 4u; i++) {
        cheapest = select(cheapest, i + 1u, costs[i] <= least);
        least = min(least, costs[i]);
    }
    return 32u * select(within, cheapest, params.is_marginal != 0u);
}

// The level of the last ring that `chord` has reached.
fn level_at(chord: f32, rings: vec4<f32>) -> u32 {
    var level = 0u;
    for (var i = 0u; i < 4u; i++) {
        level = select(level, params.levels[i], chord >= rings[i]);
    }
    return level;
}

// Whether a tile is shaded at 1x1 in this frame to measure its contrast.
fn is_full_rate_frame(tile: vec2<u32>) -> bool {
    let away = tile - params.axis_tile;
    let phase = (away.x * 0x9e3779b1u + away.y * 0x85ebca6bu) >> 8u;
    return params.full_rate_period > 0u && phase % max(params.full_rate_period, 1u) == params.full_rate_phase;
}

fn contrast_of(tile: vec2<u32>) -> TileContrast {
    return contrast[tile.y * params.tiles.x + tile.x];
}

fn within(at: vec2<f32>) -> vec2<u32> {
    return vec2<u32>(clamp(at, vec2(0.0), vec2<f32>(params.tiles - 1u)));
}

fn bands_of(tile: vec2<u32>) -> vec4<f32> {
    let bands = contrast_of(tile).bands;
    return vec4(bands[0], bands[1], bands[2], bands[3]);
}

// Contrast by band, and the luminance that eyes are adapted to: DecideParams::contrast.
struct Shown {
    bands: vec4<f32>,
    luminance: f32,
    // Not behind the view in which it was measured.
    is_known: bool,
}

fn shown_by(tile: vec2<u32>, is_turned: bool) -> Shown {
    if !is_turned {
        return Shown(bands_of(tile), contrast_of(tile).adaptation_cd_m2, true);
    }
    let pixel = (vec2<f32>(tile) + 0.5) * vec2<f32>(params.texel) - vec2<f32>(params.overhang);
    let point = vec3(params.plane_origin + params.plane_step * pixel, 1.0);
    let depth = dot(params.measured_depth, point);
    if !(depth > 0.0) {
        return Shown(vec4(0.0), 0.0, false);
    }
    let at = vec2(dot(params.measured_column, point), dot(params.measured_row, point)) / depth - 0.5;
    let first = within(floor(at + STILL));
    let end = within(ceil(at - STILL));
    let nearest = within(floor(at + 0.5));
    var bands = max(bands_of(nearest), max(bands_of(first), bands_of(end)));
    bands = max(bands, max(bands_of(vec2(end.x, first.y)), bands_of(vec2(first.x, end.y))));
    return Shown(bands, contrast_of(nearest).adaptation_cd_m2, true);
}

// State of a tile from frame to frame.
struct Tile {
    level: u32,
    age_ms: u32,
}

// The coarseness of the coarsest rate that a tile has reached.
fn reached(level: u32) -> u32 {
    var rate = 0u;
    for (var i = 0u; i < 4u; i++) {
        rate = select(rate, params.levels[i], level >= params.levels[i]);
    }
    return rate;
}

// Sensitivities at a point of the plane one unit ahead.
fn seen_at(point: vec2<f32>, luminance: f32, eccentricity: f32, sensitivity: u32) -> vec2<f32> {
    let pixels = pixels_per_degree(point);
    let is_known = is_finite(pixels) && pixels > 0.0;
    if sensitivity == CASTLE_CSF {
        return castle_csf(select(4.0, pixels / 4.0, is_known), luminance, eccentricity);
    }
    return tursun(select(4.0, pixels / 2.0, is_known), luminance, eccentricity);
}

// New state of a tile, whose middle is at a point of the plane one unit ahead, from its state in the frame before and its squared chord to the
// nearer gaze.
fn decided(tile: vec2<u32>, middle: vec2<f32>, chord: f32, before: Tile, sensitivity: u32, is_turned: bool) -> Tile {
    var keep = level_at(chord, params.ring_chords);
    var grow = level_at(chord, params.coarsening_chords);
    if sensitivity != RINGS_ONLY {
        let shown = shown_by(tile, is_turned);
        var visible = vec2(0.0);
        let removed = shown.bands.x + shown.bands.y;
        if !(is_finite(removed) && removed <= params.flat_contrast) {
            let eccentricity = clamp(deg_of_chord(chord) - params.inflation_deg, 0.0, 120.0);
            visible = seen_at(middle, shown.luminance, eccentricity, sensitivity) * shown.bands.xy;
        }
        let is_steady = before.age_ms >= STEADY_MS;
        keep = min(keep, level_within(visible, select(params.holding_budget, params.budget, is_steady)));
        grow = min(grow, level_within(visible, params.coarsening_budget));
        // Contrast that is not a number in one octave is not to be trusted in the others.
        let is_sound = shown.is_known && is_finite(shown.bands.z + shown.bands.w);
        if (is_steady && is_full_rate_frame(tile)) || !is_sound {
            keep = 0u;
        }
    }
    grow = min(grow, keep);
    let rate = reached(before.level);
    let level = max(min(rate, keep), min(grow, before.level + min(params.coarsening, 255u)));
    return Tile(level, select(0u, min(before.age_ms + params.elapsed_ms, 255u), reached(level) == rate));
}

// The coarsest rate whose coarseness a tile has reached.
fn texel_of(level: u32) -> u32 {
    var rate = 0u;
    for (var i = 0u; i < 4u; i++) {
        rate = select(rate, params.texels[i], level >= params.levels[i]);
    }
    return rate;
}

// The tiles of a word.
fn decide(word: u32, sensitivity: u32, is_turned: bool) {
    let row_words = (params.tiles.x + 3u) / 4u;
    if word >= row_words * params.tiles.y {
        return;
    }
    let first = vec2(word % row_words * 4u, word / row_words);
    let before = vec2(memory[2u * word], memory[2u * word + 1u]);
    let start = corner_pixel(first);
    let end_row = corner_pixel(first + 1u).y;
    let rows = Span(start.y, end_row, first.y + 1u == params.tiles.y);
    let low = params.plane_origin.y + params.plane_step.y * start.y;
    let high = params.plane_origin.y + params.plane_step.y * end_row;
    let upper = line_of_rows(low);
    let lower = line_of_rows(high);
    let gaze_left = gaze_at(params.gaze_left);
    let gaze_right = gaze_at(params.gaze_right);
    // Of tiles beside one another each has the line and the corners between them from the one before.
    var start_column = start.x;
    var x = params.plane_origin.x + params.plane_step.x * start_column;
    var left = line_of_columns(x);
    var upper_left = direction(vec2(x, low));
    var lower_left = direction(vec2(x, high));
    var levels = 0u;
    var ages = 0u;
    var texels = 0u;
    for (var i = 0u; i < 4u; i++) {
        let tile = vec2(first.x + i, first.y);
        let end_column = corner_pixel(tile + 1u).x;
        x = params.plane_origin.x + params.plane_step.x * end_column;
        let right = line_of_columns(x);
        let upper_right = direction(vec2(x, low));
        let lower_right = direction(vec2(x, high));
        if tile.x < params.tiles.x {
            let columns = Span(start_column, end_column, tile.x + 1u == params.tiles.x);
            let corners = Corners(array<vec3<f32>, 4>(upper_left, upper_right, lower_left, lower_right));
            let chord = min(
                chord_to(corners, columns, rows, gaze_left, upper.of_left, lower.of_left, left.of_left, right.of_left),
                chord_to(corners, columns, rows, gaze_right, upper.of_right, lower.of_right, left.of_right, right.of_right),
            );
            let middle = params.plane_origin
                + params.plane_step * (vec2(start_column + end_column, start.y + end_row) * 0.5);
            let known = (before >> vec2(8u * i)) & vec2(0xffu);
            let next = decided(tile, middle, chord, Tile(known.x, known.y), sensitivity, is_turned);
            levels |= next.level << (8u * i);
            ages |= next.age_ms << (8u * i);
            let index = tile.y * params.tiles.x + tile.x;
            let is_stale = params.has_stale != 0u && ((stale[index / 32u] >> (index % 32u)) & 1u) != 0u;
            texels |= (texel_of(next.level) | select(0u, STALE, is_stale)) << (8u * i);
        }
        left = right;
        upper_left = upper_right;
        lower_left = lower_right;
        start_column = end_column;
    }
    memory[2u * word] = levels;
    memory[2u * word + 1u] = ages;
    rates[word] = texels;
}

// An entry point for each DecideParams::sensitivity, and whether DecideParams::is_turned: a device in software goes both ways at every branch.

@compute @workgroup_size(64)
fn decide_rings(@builtin(global_invocation_id) id: vec3<u32>) {
    decide(id.x, RINGS_ONLY, false);
}

@compute @workgroup_size(64)
fn decide_castle(@builtin(global_invocation_id) id: vec3<u32>) {
    decide(id.x, CASTLE_CSF, false);
}

@compute @workgroup_size(64)
fn decide_castle_turned(@builtin(global_invocation_id) id: vec3<u32>) {
    decide(id.x, CASTLE_CSF, true);
}

@compute @workgroup_size(64)
fn decide_tursun(@builtin(global_invocation_id) id: vec3<u32>) {
    decide(id.x, TURSUN, false);
}

@compute @workgroup_size(64)
fn decide_tursun_turned(@builtin(global_invocation_id) id: vec3<u32>) {
    decide(id.x, TURSUN, true);
}
