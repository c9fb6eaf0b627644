// Kernel `compose`: the pixels of one region, drawn over a copy of the image, tile by tile.
// Reference: core/src/kernels/compose.rs and what it calls, in the same order.

struct ComposeParams {
    rect_offset: vec2<u32>,
    rect_extent: vec2<u32>,
    plane_origin: vec2<f32>,
    plane_step: vec2<f32>,
    gaze: vec3<f32>,
    plateau: f32,
    red_weight: f32,
    blue_weight: f32,
    range_scale: f32,
    cb_bound: f32,
    cr_bound: f32,
    rim_scale: f32,
    cb_fall_off: f32,
    cr_fall_off: f32,
    radius: f32,
    strength: f32,
    gamut_floor: f32,
    gamut_ceiling: f32,
}

@group(0) @binding(0) var<uniform> params: ComposeParams;
@group(1) @binding(0) var source: texture_2d<f32>;

const TILE_SIZE: u32 = 16u;
const HALF_PI: f32 = 1.5707964;
const MIN_SHIFT: f32 = 1e-6;

// geometry::eccentricity of a point of the region, in pixels from its upper left corner, less the radius of what
// counts as looked at.
fn eccentricity(point: vec2<f32>) -> f32 {
    let direction = vec3(params.plane_origin + params.plane_step * point, -1.0);
    return atan2(length(cross(direction, params.gaze)), dot(direction, params.gaze)) - params.radius;
}

// Below 90 degrees plateau and radius are a cone, hence convex: a tile lies inside where its corners do. Beyond, any
// tile may hold the hole that is left.
fn tile_has_work(low: vec2<f32>, high: vec2<f32>) -> bool {
    let farthest = max(
        max(eccentricity(low), eccentricity(high)),
        max(eccentricity(vec2(high.x, low.y)), eccentricity(vec2(low.x, high.y))),
    );
    return farthest > params.plateau || params.plateau + params.radius >= HALF_PI;
}

// One instance a tile, as a strip of four vertices. The viewport is the region.
@vertex
fn tile(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let columns = (params.rect_extent.x + TILE_SIZE - 1u) / TILE_SIZE;
    let low = vec2(instance % columns, instance / columns) * TILE_SIZE;
    let high = min(low + TILE_SIZE, params.rect_extent);
    if !tile_has_work(vec2<f32>(low), vec2<f32>(high)) {
        return vec4(-2.0, -2.0, 0.0, 1.0);
    }
    let corner = select(low, high, vec2((vertex & 1u) != 0u, (vertex & 2u) != 0u));
    return vec4(vec2<f32>(corner) / vec2<f32>(params.rect_extent) * 2.0 - 1.0, 0.0, 1.0);
}

// chroma::Curves::gains: of Cb in x, of Cr in y. The angle is above the plateau.
fn gains(angle: f32) -> vec2<f32> {
    let e = saturate((angle - params.plateau) * params.range_scale);
    let cb = pow((1.0 - e) * (1.0 + e), params.cb_bound);
    let half = cos(HALF_PI * pow(e, params.cr_bound));
    let rim = 1.0 - e * params.rim_scale;
    let floor = exp2(-vec2(params.cb_fall_off, params.cr_fall_off) * angle);
    return max(vec2(cb, max(half * half, rim)), floor);
}

// By its bits: a compiler may take it that no number is infinite or NaN.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// chroma::attenuate
fn attenuate(rgb: vec3<f32>, gain: vec2<f32>) -> vec3<f32> {
    let weights = vec3(params.red_weight, 1.0 - params.red_weight - params.blue_weight, params.blue_weight);
    let y = dot(weights, rgb);
    if !is_finite(y) {
        return rgb;
    }
    let red = rgb.r - y;
    let blue = rgb.b - y;
    let red_share = weights.r / weights.g;
    let blue_share = weights.b / weights.g;

    let without_blue = y - red_share * gain.y * red;
    let room = select(params.gamut_ceiling - without_blue, without_blue - params.gamut_floor, blue > 0.0);
    let limit = room / max(blue_share * abs(blue), MIN_SHIFT);
    let cb = min(gain.x, max(limit, gain.y));

    let lost_red = (1.0 - gain.y) * red;
    let lost_blue = (1.0 - cb) * blue;
    return vec3(rgb.r - lost_red, rgb.g + red_share * lost_red + blue_share * lost_blue, rgb.b - lost_blue);
}

// Alpha is masked off by the pipeline.
@fragment
fn pixel(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let angle = eccentricity(position.xy - vec2<f32>(params.rect_offset));
    if angle <= params.plateau {
        discard;
    }
    let rgb = textureLoad(source, vec2<i32>(position.xy), 0).rgb;
    let gain = 1.0 - params.strength * (1.0 - gains(angle));
    return vec4(attenuate(rgb, gain), 1.0);
}

// Re-use: tiles that were not rendered are taken from earlier pictures, a draw for each of those.
// Reference: core/src/kernels/compose/reuse.rs, and core/src/reuse/history.rs with the same names.

struct ReuseParams {
    matrix: array<vec4<f32>, 3>,
    earlier_offset: vec2<u32>,
    earlier_extent: vec2<f32>,
    tile_size: vec2<f32>,
    tiles: vec2<u32>,
    earlier_tiles: vec2<f32>,
    earlier_grid: vec2<u32>,
    first_word: u32,
    earlier_word: u32,
    age: u32,
    border: f32,
    matrices: array<vec4<f32>, 24>,
    extents: array<vec4<f32>, 8>,
    grids: array<vec4<u32>, 8>,
}

@group(0) @binding(1) var<uniform> reuse: ReuseParams;
// Lists of tiles, and stale tiles as bits.
@group(0) @binding(2) var<storage, read> words: array<u32>;

// One instance for each entry of a list.
fn listed_corner(vertex: u32, low: vec2<f32>, high: vec2<f32>) -> vec4<f32> {
    let corner = select(low, high, vec2((vertex & 1u) != 0u, (vertex & 2u) != 0u));
    return vec4(corner / vec2<f32>(params.rect_extent) * 2.0 - 1.0, 0.0, 1.0);
}

fn tile_low(tile: u32) -> vec2<f32> {
    return vec2<f32>(vec2(tile % reuse.tiles.x, tile / reuse.tiles.x)) * reuse.tile_size;
}

@vertex
fn listed(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let low = tile_low(words[instance]);
    let high = min(low + reuse.tile_size, vec2<f32>(params.rect_extent));
    return listed_corner(vertex, low, high);
}

// As `listed`, but for tiles in which nothing is attenuated.
@vertex
fn listed_with_work(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let low = tile_low(words[instance]);
    let high = min(low + reuse.tile_size, vec2<f32>(params.rect_extent));
    if !tile_has_work(low, high) {
        return vec4(-2.0, -2.0, 0.0, 1.0);
    }
    return listed_corner(vertex, low, high);
}

struct Strip {
    @builtin(position) position: vec4<f32>,
    // Which of the nine tiles from the upper left to the lower right of its own are stale.
    @location(0) @interpolate(flat) stale: u32,
}

// As `listed`, but for one of four strips of a tile, as wide as borders: the upper, lower, left and right one.
@vertex
fn listed_strip(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Strip {
    let entry = words[instance];
    let strip = entry >> 30u;
    let size = reuse.tile_size;
    let width = min(vec2(reuse.border), size * 0.5);
    let is_row = strip < 2u;
    let is_second = (strip & 1u) == 1u;
    let start = select(vec2(0.0), size - width, is_second);
    let end = select(width, size, is_second);
    let low = select(vec2(start.x, width.y), vec2(0.0, start.y), is_row);
    let high = select(vec2(end.x, size.y - width.y), vec2(size.x, end.y), is_row);
    let corner = tile_low(entry & 0x3fffffffu);
    let extent = vec2<f32>(params.rect_extent);
    let tile = entry & 0x3fffffffu;
    var stale = 0u;
    for (var i = 0; i < 9; i++) {
        let beside = vec2<i32>(vec2(tile % reuse.tiles.x, tile / reuse.tiles.x)) + vec2(i % 3, i / 3) - 1;
        stale |= u32(is_stale(beside, reuse.tiles, reuse.first_word)) << u32(i);
    }
    return Strip(listed_corner(vertex, min(corner + low, extent), min(corner + high, extent)), stale);
}

fn is_stale(tile: vec2<i32>, tiles: vec2<u32>, first_word: u32) -> bool {
    let is_inside = all(tile >= vec2(0)) && all(vec2<u32>(tile) < tiles);
    let index = select(0u, u32(tile.y) * tiles.x + u32(tile.x), is_inside);
    return is_inside && ((words[first_word + index / 32u] >> (index % 32u)) & 1u) == 1u;
}

// Whether a picture has what a point shows: in which tiles of that grid it was rendered, from a place of the words on.
fn has(homogeneous: vec3<f32>, extents: vec4<f32>, grid: vec3<u32>) -> bool {
    let at = homogeneous.xy / homogeneous.z;
    let is_inside = homogeneous.z > 0.0 && all(at >= vec2(0.0)) && all(at <= extents.zw);
    return is_inside && is_fresh_at(at, extents.xy, grid);
}

fn is_fresh_at(point: vec2<f32>, tiles: vec2<f32>, grid: vec3<u32>) -> bool {
    let tile = min(vec2<u32>(point * tiles), max(grid.xy, vec2(1u)) - 1u);
    return !is_stale(vec2<i32>(tile), grid.xy, grid.z);
}

// Where a point lies in the picture of this draw, not divided.
fn in_earlier(point: vec2<f32>) -> vec3<f32> {
    return reuse.matrix[0].xyz * point.x + reuse.matrix[1].xyz * point.y + reuse.matrix[2].xyz;
}

fn earlier_grid() -> vec3<u32> {
    return vec3(reuse.earlier_grid, reuse.earlier_word);
}

// Whether the picture of this draw is the newest that has what a point shows.
fn is_newest(point: vec2<f32>, homogeneous: vec3<f32>) -> bool {
    var is_newest = has(homogeneous, vec4(reuse.earlier_tiles, reuse.earlier_extent), earlier_grid());
    for (var index = 0u; index + 1u < reuse.age; index++) {
        let newer = reuse.matrices[3u * index].xyz * point.x
            + reuse.matrices[3u * index + 1u].xyz * point.y
            + reuse.matrices[3u * index + 2u].xyz;
        is_newest = is_newest && !has(newer, reuse.extents[index], reuse.grids[index].xyz);
    }
    return is_newest;
}

fn earlier_texel(texel: vec2<f32>) -> vec4<f32> {
    return textureLoad(source, vec2<i32>(texel) + vec2<i32>(reuse.earlier_offset), 0);
}

// Bilinear. A texel without weight does not count, even if it is no number.
fn weighted(texel: vec2<f32>, weight: f32) -> vec4<f32> {
    return select(vec4(0.0), earlier_texel(texel) * weight, weight > 0.0);
}

// Of texels that all were rendered.
fn whole_footprint(at: vec2<f32>) -> vec4<f32> {
    let base = floor(at - 0.5);
    let share = at - 0.5 - base;
    let low = clamp(base, vec2(0.0), reuse.earlier_extent - 1.0);
    let high = clamp(base + 1.0, vec2(0.0), reuse.earlier_extent - 1.0);
    let rest = 1.0 - share;
    return weighted(low, rest.x * rest.y)
        + weighted(vec2(high.x, low.y), share.x * rest.y)
        + weighted(vec2(low.x, high.y), rest.x * share.y)
        + weighted(high, share.x * share.y);
}

fn whole_pixel(point: vec2<f32>) -> vec4<f32> {
    let homogeneous = in_earlier(point);
    return whole_footprint(homogeneous.xy / homogeneous.z);
}

// Of those that were rendered.
fn mixed_footprint(at: vec2<f32>) -> vec4<f32> {
    let base = floor(at - 0.5);
    let share = at - 0.5 - base;
    let low = clamp(base, vec2(0.0), reuse.earlier_extent - 1.0);
    let high = clamp(base + 1.0, vec2(0.0), reuse.earlier_extent - 1.0);
    let tiles = reuse.earlier_tiles;
    let grid = earlier_grid();
    let fresh = vec4(
        f32(is_fresh_at(low + 0.5, tiles, grid)),
        f32(is_fresh_at(vec2(high.x, low.y) + 0.5, tiles, grid)),
        f32(is_fresh_at(vec2(low.x, high.y) + 0.5, tiles, grid)),
        f32(is_fresh_at(high + 0.5, tiles, grid)),
    );
    let rest = 1.0 - share;
    let weights = fresh * vec4(rest.x * rest.y, share.x * rest.y, rest.x * share.y, share.x * share.y);
    let sum = dot(weights, vec4(1.0));
    if sum <= 0.0 {
        discard;
    }
    let shares = weights / sum;
    return weighted(low, shares.x)
        + weighted(vec2(high.x, low.y), shares.y)
        + weighted(vec2(low.x, high.y), shares.z)
        + weighted(high, shares.w);
}

fn attenuated(rgba: vec4<f32>, point: vec2<f32>) -> vec4<f32> {
    let angle = eccentricity(point);
    let gain = 1.0 - params.strength * (1.0 - gains(angle));
    return vec4(select(rgba.rgb, attenuate(rgba.rgb, gain), angle > params.plateau), rgba.a);
}

fn mixed_pixel(point: vec2<f32>) -> vec4<f32> {
    let homogeneous = in_earlier(point);
    if !is_newest(point, homogeneous) {
        discard;
    }
    return mixed_footprint(homogeneous.xy / homogeneous.z);
}

// How much of a fresh pixel beside stale tiles is taken from the earlier picture.
fn border_share(point: vec2<f32>, stale: u32) -> f32 {
    let near = point - floor(point / reuse.tile_size) * reuse.tile_size;
    let far = reuse.tile_size - near;
    var nearest = reuse.border * reuse.border;
    for (var i = 0u; i < 9u; i++) {
        let x = select(select(0.0, far.x, i % 3u == 2u), near.x, i % 3u == 0u);
        let y = select(select(0.0, far.y, i / 3u == 2u), near.y, i / 3u == 0u);
        nearest = select(nearest, min(nearest, x * x + y * y), ((stale >> i) & 1u) == 1u);
    }
    return 1.0 - sqrt(nearest) / reuse.border;
}

// Multiplied by its share, which blending reads as alpha.
fn border_pixel(point: vec2<f32>, stale: u32, rgba: vec4<f32>) -> vec4<f32> {
    let share = border_share(point, stale);
    if share <= 0.0 {
        discard;
    }
    return vec4(rgba.rgb * share, share);
}

fn point_of(position: vec4<f32>) -> vec2<f32> {
    return position.xy - vec2<f32>(params.rect_offset);
}

// Where nothing has moved.
@fragment
fn still(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return earlier_texel(floor(point_of(position)));
}

@fragment
fn still_attenuated(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let point = point_of(position);
    return attenuated(earlier_texel(floor(point)), point);
}

@fragment
fn whole(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return whole_pixel(point_of(position));
}

@fragment
fn whole_attenuated(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let point = point_of(position);
    return attenuated(whole_pixel(point), point);
}

@fragment
fn mixed(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return mixed_pixel(point_of(position));
}

@fragment
fn mixed_attenuated(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let point = point_of(position);
    return attenuated(mixed_pixel(point), point);
}

@fragment
fn border(strip: Strip) -> @location(0) vec4<f32> {
    let point = point_of(strip.position);
    return border_pixel(point, strip.stale, mixed_pixel(point));
}

@fragment
fn border_attenuated(strip: Strip) -> @location(0) vec4<f32> {
    let point = point_of(strip.position);
    return border_pixel(point, strip.stale, attenuated(mixed_pixel(point), point));
}
