// Kernel `compose`: the pixels of one region, drawn over a copy of the image, tile by tile.
// Reference: core/src/kernels/compose.rs and the functions it calls, in the same order.

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
    rim_scale: f32,
    cb_loss: vec4<f32>,
    cr_loss: vec4<f32>,
    cr_loss_last: f32,
    cb_fall_off: f32,
    cr_fall_off: f32,
    radius: f32,
    strength: f32,
    gamut_floor: f32,
    gamut_ceiling: f32,
    unused: u32,
}

@group(0) @binding(0) var<uniform> params: ComposeParams;
@group(1) @binding(0) var source: texture_2d<f32>;
// Interpolates.
@group(1) @binding(1) var between: sampler;

const TILE_SIZE: u32 = 64u;
const HALF_PI: f32 = 1.5707964;

// Within 1e-6 radians (Abramowitz and Stegun, 4.4.46).
fn arc_cosine(x: f32) -> f32 {
    let t = min(abs(x), 1.0);
    let high = 0.0308918810 + t * (-0.0170881256 + t * (0.0066700901 - t * 0.0012624911));
    let low = 1.5707963050 + t * (-0.2145988016 + t * (0.0889789874 + t * (-0.0501743046 + t * high)));
    let positive = sqrt(1.0 - t) * low;
    return select(positive, 2.0 * HALF_PI - positive, x < 0.0);
}

// Direction of a point of the region, in pixels from its upper left corner, where it meets the plane z = -1.
fn direction(point: vec2<f32>) -> vec2<f32> {
    return params.plane_origin + params.plane_step * point;
}

// geometry::eccentricity of a direction, less the radius of the gaze region.
fn eccentricity(direction: vec2<f32>, gaze: vec3<f32>, radius: f32) -> f32 {
    let ray = vec3(direction, -1.0);
    return arc_cosine(dot(ray, gaze) * inverseSqrt(dot(ray, ray))) - radius;
}

fn eccentricity_of(point: vec2<f32>) -> f32 {
    return eccentricity(direction(point), params.gaze, params.radius);
}

// Below 90 degrees plateau and radius are a cone, hence convex: a tile lies inside where its corners do. Beyond, any
// tile may hold the hole that is left.
fn tile_has_work(low: vec2<f32>, high: vec2<f32>) -> bool {
    let farthest = max(
        max(eccentricity_of(low), eccentricity_of(high)),
        max(eccentricity_of(vec2(high.x, low.y)), eccentricity_of(vec2(low.x, high.y))),
    );
    return farthest > params.plateau || params.plateau + params.radius >= HALF_PI;
}

// Whether each pixel reads its parameters by itself, or the vertices hand them on; the build makes one shader of each. A parameter that a
// pixel reads costs lavapipe of Mesa 22.3 some 25 instructions a vector, and there are over twenty; on a GPU it is read once for
// all pixels of a subgroup, while each that is handed on takes two or three instructions a pixel.
const PIXELS_READ_PARAMETERS: bool = false;

struct Seen {
    @builtin(position) position: vec4<f32>,
    // direction(): linear in the position.
    @location(0) @interpolate(linear) direction: vec2<f32>,
    // Gaze, and radius.
    @location(1) @interpolate(flat) gaze: vec4<f32>,
    // Plateau, range_scale, rim_scale and strength.
    @location(2) @interpolate(flat) range: vec4<f32>,
    @location(3) @interpolate(flat) cb_loss: vec4<f32>,
    @location(4) @interpolate(flat) cr_loss: vec4<f32>,
    // cr_loss_last, and the fall-offs of Cb and Cr.
    @location(5) @interpolate(flat) rest: vec3<f32>,
    // Kr, Kb, Kr / Kg and Kb / Kg.
    @location(6) @interpolate(flat) light: vec4<f32>,
    // Floor and ceiling of the gamut, and Kg / Kb.
    @location(7) @interpolate(flat) gamut: vec3<f32>,
}

fn seen_at(point: vec2<f32>) -> Seen {
    let weights = vec2(params.red_weight, params.blue_weight);
    let green_weight = 1.0 - weights.x - weights.y;
    return Seen(
        on_screen(point),
        direction(point),
        vec4(params.gaze, params.radius),
        vec4(params.plateau, params.range_scale, params.rim_scale, params.strength),
        params.cb_loss,
        params.cr_loss,
        vec3(params.cr_loss_last, params.cb_fall_off, params.cr_fall_off),
        vec4(weights, weights / green_weight),
        vec3(params.gamut_floor, params.gamut_ceiling, green_weight / weights.y),
    );
}

// With the parameters that a pixel reads.
fn seen_by_pixel(handed: Seen) -> Seen {
    if !PIXELS_READ_PARAMETERS {
        return handed;
    }
    var seen = seen_at(vec2(0.0));
    seen.position = handed.position;
    seen.direction = handed.direction;
    return seen;
}

fn unseen() -> Seen {
    var none: Seen;
    none.position = vec4(-2.0, -2.0, 0.0, 1.0);
    return none;
}

fn on_screen(point: vec2<f32>) -> vec4<f32> {
    return vec4(point / vec2<f32>(params.rect_extent) * 2.0 - 1.0, 0.0, 1.0);
}

// Of the corners that a strip of four vertices has, in turn.
fn is_far(vertex: u32) -> vec2<bool> {
    return vec2((vertex & 1u) != 0u, (vertex & 2u) != 0u);
}

// One instance a tile, as a strip of four vertices. The viewport is the region.
@vertex
fn tile(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Seen {
    let columns = (params.rect_extent.x + TILE_SIZE - 1u) / TILE_SIZE;
    let low = vec2(instance % columns, instance / columns) * TILE_SIZE;
    let high = min(low + TILE_SIZE, params.rect_extent);
    if !tile_has_work(vec2<f32>(low), vec2<f32>(high)) {
        return unseen();
    }
    return seen_at(vec2<f32>(select(low, high, is_far(vertex))));
}

// Difference of chroma::Polynomials::gains from 1, in proportion to the strength: of Cb in x, of Cr in y. The angle is above the plateau.
fn losses(angle: f32, seen: Seen) -> vec2<f32> {
    let e = saturate((angle - seen.range.x) * seen.range.y);
    let w = 1.0 - sqrt((1.0 - e) * (1.0 + e));
    let v = sqrt(e);
    let c = seen.cr_loss;
    let cb = w * (seen.cb_loss.x + w * (seen.cb_loss.y + w * (seen.cb_loss.z + w * seen.cb_loss.w)));
    let cr = v * (c.x + v * (c.y + v * (c.z + v * (c.w + v * seen.rest.x))));
    let below_floor = 1.0 - exp2(-seen.rest.yz * angle);
    return seen.range.w * min(vec2(cb, min(cr, e * seen.range.z)), below_floor);
}

// By its bits: a compiler may take it that no number is infinite or NaN.
fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// chroma::attenuate
fn attenuate(rgb: vec3<f32>, loss: vec2<f32>, seen: Seen) -> vec3<f32> {
    let light = seen.light;
    let y = light.x * rgb.r + light.y * rgb.b + (1.0 - light.x - light.y) * rgb.g;
    if !is_finite(y) {
        return rgb;
    }
    let lost_red = loss.y * (rgb.r - y);
    let green = rgb.g + light.z * lost_red;
    let least = loss * (light.w * (rgb.b - y));
    let room = seen.gamut.xy - green;
    let lost_blue = clamp(clamp(least.x, room.x, room.y), min(least.x, least.y), max(least.x, least.y));
    return vec3(rgb.r - lost_red, green + lost_blue, rgb.b - lost_blue * seen.gamut.z);
}

// Alpha is masked off by the pipeline.
@fragment
fn pixel(handed: Seen) -> @location(0) vec4<f32> {
    let seen = seen_by_pixel(handed);
    let angle = eccentricity(seen.direction, seen.gaze.xyz, seen.gaze.w);
    if angle <= seen.range.x {
        discard;
    }
    let rgb = textureLoad(source, vec2<i32>(seen.position.xy), 0).rgb;
    return vec4(attenuate(rgb, losses(angle, seen), seen), 1.0);
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
    parallax: vec4<f32>,
    nearness: vec4<f32>,
    earlier_nearness: vec4<f32>,
    depth_offset: vec2<u32>,
    earlier_depth_offset: vec2<u32>,
    depth_scale: vec2<f32>,
    earlier_depth_scale: vec2<f32>,
    whole_first: u32,
    mixed_first: u32,
    border_first: u32,
    unused: u32,
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

// Each list begins at a place of its own: instances count from 0.
fn tile_rect(index: u32) -> TileRect {
    let place = words[2u * index];
    let size = words[2u * index + 1u];
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

// As `tile`, but one instance for each entry of a list.
@vertex
fn listed_with_work(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Seen {
    let rect = tile_rect(reuse.whole_first + instance);
    if !tile_has_work(rect.low, rect.high) {
        return unseen();
    }
    return seen_at(select(rect.low, rect.high, is_far(vertex)));
}

// `Seen`, and where in an earlier picture.
struct Found {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(linear) direction: vec2<f32>,
    @location(1) @interpolate(flat) gaze: vec4<f32>,
    @location(2) @interpolate(flat) range: vec4<f32>,
    @location(3) @interpolate(flat) cb_loss: vec4<f32>,
    @location(4) @interpolate(flat) cr_loss: vec4<f32>,
    @location(5) @interpolate(flat) rest: vec3<f32>,
    @location(6) @interpolate(flat) light: vec4<f32>,
    @location(7) @interpolate(flat) gamut: vec3<f32>,
    // Where it lies there, not divided: linear in the position. In pixels of the rectangle where pixels of it are asked for one by
    // one, otherwise from 0 to 1 in the texture.
    @location(8) @interpolate(linear) at: vec3<f32>,
    // Of an edge, how much is taken from there: the product of both.
    @location(9) @interpolate(linear) share: vec2<f32>,
    // earlier_extent and earlier_tiles.
    @location(10) @interpolate(flat) earlier: vec4<f32>,
    // earlier_grid, at least 1, whether it has tiles, and earlier_word.
    @location(11) @interpolate(flat) tiles: vec4<u32>,
    // Offset from pixels of the target to pixels of an unmoved earlier picture, and earlier_offset.
    @location(12) @interpolate(flat) offsets: vec4<i32>,
}

fn found_at(point: vec2<f32>, at: vec3<f32>, share: vec2<f32>) -> Found {
    let seen = seen_at(point);
    let offset = vec2<i32>(reuse.earlier_offset);
    return Found(
        seen.position,
        seen.direction,
        seen.gaze,
        seen.range,
        seen.cb_loss,
        seen.cr_loss,
        seen.rest,
        seen.light,
        seen.gamut,
        at,
        share,
        vec4(reuse.earlier_extent, reuse.earlier_tiles),
        vec4(max(reuse.earlier_grid, vec2(1u)), u32(all(reuse.earlier_grid > vec2(0u))), reuse.earlier_word),
        vec4(offset - vec2<i32>(params.rect_offset), offset),
    );
}

// With the parameters that a pixel reads.
fn found_by_pixel(handed: Found) -> Found {
    if !PIXELS_READ_PARAMETERS {
        return handed;
    }
    var found = found_at(vec2(0.0), handed.at, handed.share);
    found.position = handed.position;
    found.direction = handed.direction;
    return found;
}

fn corner_found(rect: TileRect, vertex: u32) -> Found {
    let point = select(rect.low, rect.high, is_far(vertex));
    return found_at(point, homogeneous(reuse.matrix, point), vec2(1.0));
}

// One instance for each rectangle of partial tiles, for pixels one by one.
@vertex
fn listed_mixed(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    return corner_found(tile_rect(reuse.mixed_first + instance), vertex);
}

// The same for whole tiles of an unmoved picture.
@vertex
fn listed_still(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    return corner_found(tile_rect(reuse.whole_first + instance), vertex);
}

// The same for whole tiles of any picture, for the texture.
@vertex
fn listed_whole(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    let rect = tile_rect(reuse.whole_first + instance);
    let point = select(rect.low, rect.high, is_far(vertex));
    return found_at(point, homogeneous(reuse.to_texture, point), vec2(1.0));
}

struct BorderCorner {
    point: vec2<f32>,
    share: vec2<f32>,
}

fn border_corner(vertex: u32, instance: u32) -> BorderCorner {
    let rect = tile_rect(reuse.border_first + instance);
    let width = min(vec2(reuse.border), reuse.tile_size * 0.5);
    let low = select(rect.low, rect.high - width, rect.edge == vec2(2u));
    let high = select(rect.high, rect.low + width, rect.edge == vec2(1u));
    let at_high = select(vec2(0.0), vec2(1.0), rect.edge != vec2(1u));
    let at_low = select(vec2(0.0), vec2(1.0), rect.edge != vec2(2u));
    let corner = is_far(vertex);
    return BorderCorner(select(low, high, corner), select(at_low, at_high, corner));
}

// Edges and corners of tiles, for the texture.
@vertex
fn listed_border(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    let corner = border_corner(vertex, instance);
    return found_at(corner.point, homogeneous(reuse.to_texture, corner.point), corner.share);
}

// The same for pixels one by one.
@vertex
fn listed_moved_border(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Found {
    let corner = border_corner(vertex, instance);
    return found_at(corner.point, homogeneous(reuse.matrix, corner.point), corner.share);
}

fn seen_of(found: Found) -> Seen {
    return Seen(
        found.position,
        found.direction,
        found.gaze,
        found.range,
        found.cb_loss,
        found.cr_loss,
        found.rest,
        found.light,
        found.gamut,
    );
}

// Where a point lies, not divided.
fn homogeneous(matrix: array<vec4<f32>, 3>, point: vec2<f32>) -> vec3<f32> {
    return matrix[0].xyz * point.x + matrix[1].xyz * point.y + matrix[2].xyz;
}

// Whether the picture of this draw was rendered there, of which the point is.
fn is_fresh_at(found: Found, point: vec2<f32>) -> bool {
    let tile = min(vec2<u32>(point * found.earlier.zw), found.tiles.xy - 1u);
    let index = tile.y * found.tiles.x + tile.x;
    return (found.tiles.z == 0u) | (((words[found.tiles.w + index / 32u] >> (index % 32u)) & 1u) == 0u);
}

fn earlier_texel(found: Found, texel: vec2<f32>) -> vec4<f32> {
    return textureLoad(source, vec2<i32>(texel) + found.offsets.zw, 0);
}

// Of texels that all were rendered.
fn whole_pixel(found: Found) -> vec4<f32> {
    return textureSampleLevel(source, between, found.at.xy / found.at.z, 0.0);
}

// A texel without weight does not count, even if it is not a number.
fn weighted(found: Found, texel: vec2<f32>, weight: f32) -> vec4<f32> {
    return select(vec4(0.0), earlier_texel(found, texel), weight > 0.0) * weight;
}

// The texels around a point, and how much of each is taken.
struct Footprint {
    low: vec2<f32>,
    high: vec2<f32>,
    weights: vec4<f32>,
}

// Bilinear, over the rendered texels alone.
fn footprint(found: Found, at: vec2<f32>) -> Footprint {
    let base = floor(at - 0.5);
    let share = at - 0.5 - base;
    let low = clamp(base, vec2(0.0), found.earlier.xy - 1.0);
    let high = clamp(base + 1.0, vec2(0.0), found.earlier.xy - 1.0);
    let fresh = vec4(
        is_fresh_at(found, low + 0.5),
        is_fresh_at(found, vec2(high.x, low.y) + 0.5),
        is_fresh_at(found, vec2(low.x, high.y) + 0.5),
        is_fresh_at(found, high + 0.5),
    );
    let rest = 1.0 - share;
    let weights = vec4(rest.x * rest.y, share.x * rest.y, rest.x * share.y, share.x * share.y);
    return Footprint(low, high, select(vec4(0.0), weights, fresh));
}

fn mixed_footprint(found: Found, texels: Footprint) -> vec4<f32> {
    let sum = dot(texels.weights, vec4(1.0));
    if sum <= 0.0 {
        discard;
    }
    let weights = texels.weights;
    let all = weighted(found, texels.low, weights.x)
        + weighted(found, vec2(texels.high.x, texels.low.y), weights.y)
        + weighted(found, vec2(texels.low.x, texels.high.y), weights.z)
        + weighted(found, texels.high, weights.w);
    return all / sum;
}

fn is_shown_at(found: Found, homogeneous: vec3<f32>, at: vec2<f32>) -> bool {
    let is_inside = homogeneous.z > 0.0 && all(at >= vec2(0.0)) && all(at <= found.earlier.xy);
    return is_inside && is_fresh_at(found, at);
}

fn mixed_pixel(found: Found) -> vec4<f32> {
    let at = found.at.xy / found.at.z;
    if !is_shown_at(found, found.at, at) {
        discard;
    }
    return mixed_footprint(found, footprint(found, at));
}

// Where the head has moved: the depth of the newest picture, and of the earlier one.
@group(2) @binding(0) var depth: texture_2d<f32>;
@group(3) @binding(0) var earlier_depth: texture_2d<f32>;

// Greatest distance, pixels of the newest picture, at which a found surface still counts as the one that is searched for.
const SAME_PIXELS: f32 = 0.25;

fn nearness(value: f32, of_values: vec4<f32>) -> f32 {
    return of_values.x + of_values.y * min(max(value, of_values.z), of_values.w);
}

fn nearness_at(point: vec2<f32>) -> f32 {
    let pixel = reuse.depth_offset + vec2<u32>(point * reuse.depth_scale);
    return nearness(textureLoad(depth, vec2<i32>(pixel), 0).r, reuse.nearness);
}

// Less nearness at zero.
fn earlier_nearness_at(texel: vec2<f32>) -> f32 {
    let pixel = reuse.earlier_depth_offset + vec2<u32>((texel + 0.5) * reuse.earlier_depth_scale);
    let of_values = reuse.earlier_nearness;
    return of_values.y * min(max(textureLoad(earlier_depth, vec2<i32>(pixel), 0).r, of_values.z), of_values.w);
}

// Reuse::moved_source and moved_footprint
fn moved_pixel(found: Found) -> vec4<f32> {
    let here = nearness_at(found.position.xy - vec2<f32>(params.rect_offset));
    let homogeneous = found.at + reuse.parallax.xyz * here;
    let at = homogeneous.xy / homogeneous.z;
    if !is_shown_at(found, homogeneous, at) {
        discard;
    }
    // Less nearness at zero, too.
    let there = here / homogeneous.z - reuse.earlier_nearness.x;
    let limit = SAME_PIXELS / length(reuse.parallax.xy - at * reuse.parallax.z);
    var texels = footprint(found, at);
    let near = vec4(
        earlier_nearness_at(texels.low),
        earlier_nearness_at(vec2(texels.high.x, texels.low.y)),
        earlier_nearness_at(vec2(texels.low.x, texels.high.y)),
        earlier_nearness_at(texels.high),
    );
    texels.weights = select(vec4(0.0), texels.weights, abs(near - there) <= vec4(limit));
    return mixed_footprint(found, texels);
}

fn attenuated(found: Found, rgba: vec4<f32>) -> vec4<f32> {
    let seen = seen_of(found);
    let angle = eccentricity(seen.direction, seen.gaze.xyz, seen.gaze.w);
    let rgb = attenuate(rgba.rgb, losses(angle, seen), seen);
    return vec4(select(rgba.rgb, rgb, angle > seen.range.x), rgba.a);
}

// Tiles of an unmoved earlier picture. Their pixels without attenuation are copied.
@fragment
fn still_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return attenuated(found, textureLoad(source, vec2<i32>(found.position.xy) + found.offsets.xy, 0));
}

@fragment
fn whole(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return whole_pixel(found);
}

@fragment
fn whole_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return attenuated(found, whole_pixel(found));
}

@fragment
fn mixed(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return mixed_pixel(found);
}

@fragment
fn mixed_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return attenuated(found, mixed_pixel(found));
}

// Multiplied by its share, which blending reads as alpha.
fn border_pixel(found: Found, rgba: vec4<f32>) -> vec4<f32> {
    let share = found.share.x * found.share.y;
    return vec4(rgba.rgb * share, share);
}

@fragment
fn border(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return border_pixel(found, whole_pixel(found));
}

@fragment
fn border_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return border_pixel(found, attenuated(found, whole_pixel(found)));
}

@fragment
fn moved(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return moved_pixel(found);
}

@fragment
fn moved_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return attenuated(found, moved_pixel(found));
}

@fragment
fn moved_border(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return border_pixel(found, moved_pixel(found));
}

@fragment
fn moved_border_attenuated(handed: Found) -> @location(0) vec4<f32> {
    let found = found_by_pixel(handed);
    return border_pixel(found, attenuated(found, moved_pixel(found)));
}
