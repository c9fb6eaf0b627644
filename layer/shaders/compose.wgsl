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
// Interpolates.
@group(1) @binding(1) var between: sampler;

const TILE_SIZE: u32 = 64u;
const HALF_PI: f32 = 1.5707964;
const MIN_SHIFT: f32 = 1e-6;
const LEAST: f32 = 1e-30;

// Within 1e-6 radians (Abramowitz and Stegun, 4.4.46).
fn arc_cosine(x: f32) -> f32 {
    let t = min(abs(x), 1.0);
    let high = 0.0308918810 + t * (-0.0170881256 + t * (0.0066700901 - t * 0.0012624911));
    let low = 1.5707963050 + t * (-0.2145988016 + t * (0.0889789874 + t * (-0.0501743046 + t * high)));
    let positive = sqrt(1.0 - t) * low;
    return select(positive, 2.0 * HALF_PI - positive, x < 0.0);
}

// geometry::eccentricity of a point of the region, in pixels from its upper left corner, less the radius of what
// counts as looked at.
fn eccentricity(point: vec2<f32>) -> f32 {
    let direction = vec3(params.plane_origin + params.plane_step * point, -1.0);
    return arc_cosine(dot(direction, params.gaze) * inverseSqrt(dot(direction, direction))) - params.radius;
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

// cos(x pi / 2) within 3e-5, for x of 0 to 1.
fn quarter_cosine(x: f32) -> f32 {
    let square = x * x;
    return 1.0 - square * (1.2337006 - square * (0.2536695 - square * (0.0208635 - square * 0.0009193)));
}

// chroma::Curves::gains: of Cb in x, of Cr in y. The angle is above the plateau. The larger of two powers is that of the larger
// exponent.
fn gains(angle: f32) -> vec2<f32> {
    let e = saturate((angle - params.plateau) * params.range_scale);
    let cb = params.cb_bound * log2(max((1.0 - e) * (1.0 + e), LEAST));
    let half = quarter_cosine(exp2(params.cr_bound * log2(max(e, LEAST))));
    let rim = 1.0 - e * params.rim_scale;
    let floor = exp2(vec2(max(cb, -params.cb_fall_off * angle), -params.cr_fall_off * angle));
    return vec2(floor.x, max(max(half * half, rim), floor.y));
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
    let green_part = 1.0 / weights.g;
    let red_share = weights.r * green_part;
    let blue_share = weights.b * green_part;

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
// Reference: core/src/kernels/compose/reuse.rs, and core/src/reuse/{history,rects}.rs with the same names.

struct ReuseParams {
    matrix: array<vec4<f32>, 3>,
    to_texture: array<vec4<f32>, 3>,
    earlier_offset: vec2<u32>,
    earlier_extent: vec2<f32>,
    tile_size: vec2<f32>,
    earlier_tiles: vec2<f32>,
    earlier_grid: vec2<u32>,
    earlier_word: u32,
    border: f32,
}

@group(0) @binding(1) var<uniform> reuse: ReuseParams;
// Rectangles of tiles, two words each, and stale tiles as bits.
@group(0) @binding(2) var<storage, read> words: array<u32>;

// Rectangle of tiles.
struct TileRect {
    low: vec2<f32>,
    high: vec2<f32>,
    // For each axis: 0 for all of it, 1 for its beginning, 2 for its end.
    edge: vec2<u32>,
}

fn tile_rect(instance: u32) -> TileRect {
    let place = words[2u * instance];
    let size = words[2u * instance + 1u];
    let first = vec2(place & 0xffffu, place >> 16u);
    let end = first + vec2(size & 0x3fffu, (size >> 14u) & 0x3fffu);
    let extent = vec2<f32>(params.rect_extent);
    let edge = vec2((size >> 28u) & 3u, size >> 30u);
    return TileRect(
        min(vec2<f32>(first) * reuse.tile_size, extent),
        min(vec2<f32>(end) * reuse.tile_size, extent),
        edge,
    );
}

fn on_screen(point: vec2<f32>) -> vec4<f32> {
    return vec4(point / vec2<f32>(params.rect_extent) * 2.0 - 1.0, 0.0, 1.0);
}

// Of the corners that a strip of four vertices has, in turn.
fn is_far(vertex: u32) -> vec2<bool> {
    return vec2((vertex & 1u) != 0u, (vertex & 2u) != 0u);
}

// One instance for each entry of a list.
@vertex
fn listed(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let rect = tile_rect(instance);
    return on_screen(select(rect.low, rect.high, is_far(vertex)));
}

// As `listed`, but for rectangles in which nothing is attenuated.
@vertex
fn listed_with_work(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> @builtin(position) vec4<f32> {
    let rect = tile_rect(instance);
    if !tile_has_work(rect.low, rect.high) {
        return vec4(-2.0, -2.0, 0.0, 1.0);
    }
    return on_screen(select(rect.low, rect.high, is_far(vertex)));
}

struct Found {
    @builtin(position) position: vec4<f32>,
    // Where it lies in the texture, from 0 to 1, not divided: linear in the position.
    @location(0) @interpolate(linear) at: vec3<f32>,
}

fn found(point: vec2<f32>) -> Found {
    return Found(on_screen(point), homogeneous(reuse.to_texture, point));
}

@vertex
fn listed_found(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    let rect = tile_rect(instance);
    return found(select(rect.low, rect.high, is_far(vertex)));
}

struct Border {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(linear) at: vec3<f32>,
    // How much is taken from there: the product of both.
    @location(1) @interpolate(linear) share: vec2<f32>,
}

// Edges and corners of tiles.
@vertex
fn listed_border(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Border {
    let rect = tile_rect(instance);
    let width = min(vec2(reuse.border), reuse.tile_size * 0.5);
    let low = select(rect.low, rect.high - width, rect.edge == vec2(2u));
    let high = select(rect.high, rect.low + width, rect.edge == vec2(1u));
    let at_high = select(vec2(0.0), vec2(1.0), rect.edge != vec2(1u));
    let at_low = select(vec2(0.0), vec2(1.0), rect.edge != vec2(2u));
    let corner = is_far(vertex);
    let found = found(select(low, high, corner));
    return Border(found.position, found.at, select(at_low, at_high, corner));
}

// Where a point lies, not divided.
fn homogeneous(matrix: array<vec4<f32>, 3>, point: vec2<f32>) -> vec3<f32> {
    return matrix[0].xyz * point.x + matrix[1].xyz * point.y + matrix[2].xyz;
}

// Whether the picture of this draw was rendered there, of which the point is.
fn is_fresh_at(point: vec2<f32>) -> bool {
    let tile = min(vec2<u32>(point * reuse.earlier_tiles), max(reuse.earlier_grid, vec2(1u)) - 1u);
    let index = tile.y * reuse.earlier_grid.x + tile.x;
    let has_tiles = all(reuse.earlier_grid > vec2(0u));
    // No branch on uniforms alone: lavapipe of Mesa 22.3 compiles such a shader anew whenever they are written.
    return !has_tiles | (((words[reuse.earlier_word + index / 32u] >> (index % 32u)) & 1u) == 0u);
}

fn earlier_texel(texel: vec2<f32>) -> vec4<f32> {
    return textureLoad(source, vec2<i32>(texel) + vec2<i32>(reuse.earlier_offset), 0);
}

// Of texels that all were rendered.
fn whole_pixel(at: vec3<f32>) -> vec4<f32> {
    return textureSampleLevel(source, between, at.xy / at.z, 0.0);
}

// A texel without weight does not count, even if it is no number.
fn weighted(texel: vec2<f32>, weight: f32) -> vec4<f32> {
    return select(vec4(0.0), earlier_texel(texel) * weight, weight > 0.0);
}

// Bilinear, of those that were rendered.
fn mixed_footprint(at: vec2<f32>) -> vec4<f32> {
    let base = floor(at - 0.5);
    let share = at - 0.5 - base;
    let low = clamp(base, vec2(0.0), reuse.earlier_extent - 1.0);
    let high = clamp(base + 1.0, vec2(0.0), reuse.earlier_extent - 1.0);
    let fresh = vec4(
        f32(is_fresh_at(low + 0.5)),
        f32(is_fresh_at(vec2(high.x, low.y) + 0.5)),
        f32(is_fresh_at(vec2(low.x, high.y) + 0.5)),
        f32(is_fresh_at(high + 0.5)),
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

fn mixed_pixel(point: vec2<f32>) -> vec4<f32> {
    let found = homogeneous(reuse.matrix, point);
    let at = found.xy / found.z;
    let is_inside = found.z > 0.0 && all(at >= vec2(0.0)) && all(at <= reuse.earlier_extent);
    if !is_inside || !is_fresh_at(at) {
        discard;
    }
    return mixed_footprint(at);
}

fn attenuated(rgba: vec4<f32>, point: vec2<f32>) -> vec4<f32> {
    let angle = eccentricity(point);
    let gain = 1.0 - params.strength * (1.0 - gains(angle));
    return vec4(select(rgba.rgb, attenuate(rgba.rgb, gain), angle > params.plateau), rgba.a);
}

fn point_of(position: vec4<f32>) -> vec2<f32> {
    return position.xy - vec2<f32>(params.rect_offset);
}

// Where nothing has moved. What is not attenuated there is copied.
@fragment
fn still_attenuated(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let point = point_of(position);
    return attenuated(earlier_texel(floor(point)), point);
}

@fragment
fn whole(found: Found) -> @location(0) vec4<f32> {
    return whole_pixel(found.at);
}

@fragment
fn whole_attenuated(found: Found) -> @location(0) vec4<f32> {
    return attenuated(whole_pixel(found.at), point_of(found.position));
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

// Multiplied by its share, which blending reads as alpha.
fn border_pixel(rgba: vec4<f32>, shares: vec2<f32>) -> vec4<f32> {
    let share = shares.x * shares.y;
    return vec4(rgba.rgb * share, share);
}

@fragment
fn border(border: Border) -> @location(0) vec4<f32> {
    return border_pixel(whole_pixel(border.at), border.share);
}

@fragment
fn border_attenuated(border: Border) -> @location(0) vec4<f32> {
    let rgba = attenuated(whole_pixel(border.at), point_of(border.position));
    return border_pixel(rgba, border.share);
}
