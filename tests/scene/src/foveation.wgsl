// Fixed foveation without shading rates: what is to be skipped gets the nearest depth before the scene is drawn, so that
// every depth test there fails, and is filled from its neighbours afterwards.

struct Fovea {
    // Tangents of the view's left, right, lower and upper edge.
    tangents: vec4f,
    // Left upper corner and size of the view in the image, texels.
    rect: vec4f,
    // Direction of the gaze in the eye's own space.
    gaze: vec3f,
    // Eccentricity up to which everything is shaded, radians.
    foveal: f32,
    // Eccentricity from which on the peripheral share is shaded, radians.
    transitional: f32,
    peripheral: f32,
    // 1: in between 1, 1/4, 1/8 or 1/16 are shaded, the next that is not less; 0: whatever is between.
    stepped: f32,
    padding: f32,
    // Of two ellipses around the view's centre, instead of eccentricities: half axes of the inner and the outer one upwards, as parts of half the
    // view's height, their ratio to those sideways, and the share between them. The outer one is 0 where there are none.
    ellipses: vec4f,
}

@group(0) @binding(0) var<uniform> fovea: Fovea;

// Side of a block that is shaded or skipped as a whole, texels: a rasteriser in software shades eight texels at a time.
const BLOCK = 4u;
// In this order the blocks of a cell of 4 x 4 are shaded (Bayer 1973): the first is its corner, the first four are every
// other block.
const ORDER = array<u32, 16>(0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5);

@vertex
fn screen_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    return vec4f(corner, 0.0, 1.0);
}

// The share of blocks that is shaded at a texel of the view. Without a branch on uniforms alone: lavapipe of Mesa 22.3 compiles such a
// shader anew whenever they are written.
fn share(texel: vec2f) -> f32 {
    let at = texel / fovea.rect.zw;
    let offset = at * 2.0 - 1.0;
    let radius = length(vec2f(offset.x / fovea.ellipses.z, offset.y));
    let outside = select(fovea.ellipses.w, fovea.peripheral, radius > fovea.ellipses.y);
    let of_ellipses = select(1.0, outside, radius > fovea.ellipses.x);

    let across = mix(fovea.tangents.xw, fovea.tangents.yz, at);
    let eccentricity = acos(clamp(dot(normalize(vec3f(across, -1.0)), fovea.gaze), -1.0, 1.0));
    // No wider than a texel, the step of radii that are equal.
    let into = (eccentricity - fovea.foveal) / max(fovea.transitional - fovea.foveal, 1e-4);
    let ramp = mix(1.0, fovea.peripheral, clamp(into, 0.0, 1.0));
    let least = ramp - 1e-3;
    let step = select(select(select(0.0625, 0.125, least > 0.0625), 0.25, least > 0.125), 1.0, least > 0.25);
    let of_rings = mix(ramp, step, fovea.stepped);
    return select(of_rings, of_ellipses, fovea.ellipses.y > 0.0);
}

@fragment
fn template_fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let block = vec2u(position.xy - fovea.rect.xy) / BLOCK;
    let shaded = ceil(share((vec2f(block) + 0.5) * f32(BLOCK)) * 16.0 - 1e-3);
    let rank = ORDER[(block.y & 3u) * 4u + (block.x & 3u)];
    return select(0.0, 1.0, f32(rank) < shaded);
}

@group(0) @binding(1) var template_map: texture_depth_2d;
@group(0) @binding(2) var drawn_map: texture_2d<f32>;

// The texels between which one is interpolated along an axis, and how far it is from the first: the facing edges of the
// blocks at the corners of the cells before and behind it.
fn ends(texel: u32, cell: u32, size: u32) -> vec3f {
    let edge = texel / cell * cell + BLOCK - 1u;
    if texel <= edge {
        return vec3f(f32(texel), f32(texel), 0.0);
    }
    let next = edge + 1u + cell - BLOCK;
    if next >= size {
        return vec3f(f32(edge), f32(edge), 0.0);
    }
    return vec3f(f32(edge), f32(next), f32(texel - edge) / f32(next - edge));
}

@fragment
fn fill_fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let origin = vec2u(fovea.rect.xy);
    let size = vec2u(fovea.rect.zw);
    let texel = vec2u(position.xy) - origin;
    // Every other block where those are shaded, else the corners of the cells, which always are.
    var x = ends(texel.x, 2u * BLOCK, size.x);
    var y = ends(texel.y, 2u * BLOCK, size.y);
    let fine = textureLoad(template_map, origin + vec2u(u32(x.x), u32(y.x)), 0)
        * textureLoad(template_map, origin + vec2u(u32(x.y), u32(y.x)), 0)
        * textureLoad(template_map, origin + vec2u(u32(x.x), u32(y.y)), 0)
        * textureLoad(template_map, origin + vec2u(u32(x.y), u32(y.y)), 0);
    if fine == 0.0 {
        x = ends(texel.x, 4u * BLOCK, size.x);
        y = ends(texel.y, 4u * BLOCK, size.y);
    }
    let upper = mix(
        textureLoad(drawn_map, origin + vec2u(u32(x.x), u32(y.x)), 0),
        textureLoad(drawn_map, origin + vec2u(u32(x.y), u32(y.x)), 0),
        x.z,
    );
    let lower = mix(
        textureLoad(drawn_map, origin + vec2u(u32(x.x), u32(y.y)), 0),
        textureLoad(drawn_map, origin + vec2u(u32(x.y), u32(y.y)), 0),
        x.z,
    );
    return mix(upper, lower, y.z);
}
