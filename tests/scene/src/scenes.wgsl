// What the scenes besides the courtyard add to its shader, which stands before this text in the same module: metals,
// reflections, a mirror, tints, leaves cut out by alpha that move in the wind, and skies.

struct Environment {
    sun_direction: vec3f,
    fog_per_m: f32,
    sun: vec3f,
    cloud: f32,
    sky_light: vec3f,
    wind: f32,
    ground_light: vec3f,
    mirror_z: f32,
    zenith: vec3f,
    has_mirror: f32,
    horizon: vec3f,
    stars: f32,
    room_min: vec3f,
    panels: f32,
    room_max: vec3f,
    exposure: f32,
}

@group(0) @binding(4) var<uniform> environment: Environment;

struct Lit {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec3f,
    @location(3) uv: vec2f,
    @location(4) sky: f32,
    @location(5) emission: vec3f,
    @location(6) tint: vec3f,
}

fn placed(in: VertexIn, tint: vec3f) -> Lit {
    let world = mat4x4f(in.world_x, in.world_y, in.world_z, in.world_w);
    var out: Lit;
    out.position = (world * vec4f(in.position, 1.0)).xyz;
    out.normal = (world * vec4f(in.normal, 0.0)).xyz;
    out.tangent = (world * vec4f(in.tangent, 0.0)).xyz;
    out.uv = in.uv;
    out.sky = in.sky;
    out.emission = in.emission;
    out.tint = tint;
    return out;
}

@vertex
fn lit_vertex(in: VertexIn, @location(10) tint: vec3f) -> Lit {
    var out = placed(in, tint);
    out.clip = view.clip_from_world * vec4f(out.position, 1.0);
    return out;
}

// The root of a card, where v is 1, stays; its tip swings with the gusts that pass over the place.
@vertex
fn leaf_vertex(in: VertexIn, @location(10) tint: vec3f) -> Lit {
    var out = placed(in, tint);
    let at = dot(out.position, vec3f(0.7, 0.2, 0.9));
    let gust = 0.6 + 0.4 * sin(view.time * 0.7 - at * 0.35);
    let swing = sin(view.time * 2.3 + at * 3.1) + 0.5 * sin(view.time * 5.1 + at * 7.7);
    let reach = environment.wind * gust * (1.0 - in.uv.y);
    out.position += reach * vec3f(0.5 + 0.5 * swing, -0.15 * abs(swing), 0.4 * swing);
    out.clip = view.clip_from_world * vec4f(out.position, 1.0);
    return out;
}

// The world behind the mirror's plane, seen through the opening in front of it; lit as the world before it is.
@vertex
fn mirror_vertex(in: VertexIn, @location(10) tint: vec3f) -> Lit {
    var out = placed(in, tint);
    out.clip = view.clip_from_world * vec4f(mirrored(out.position), 1.0);
    return out;
}

fn mirrored(position: vec3f) -> vec3f {
    return vec3f(position.xy, 2.0 * environment.mirror_z - position.z);
}

// As `shade` in the courtyard, with a coloured reflectance at normal incidence.
fn glossy(n_v: f32, n_l: f32, v_l: f32, diffuse: vec3f, f0: vec3f, alpha: f32) -> vec3f {
    let v_h = sqrt(max(0.5 + 0.5 * v_l, 1e-4));
    let n_h = min(0.5 * (n_v + n_l) / v_h, 1.0);
    let alpha_2 = alpha * alpha;
    let d = n_h * n_h * (alpha_2 - 1.0) + 1.0;
    let specular = 0.5 * alpha_2 / (PI * d * d * mix(2.0 * n_l * n_v, n_l + n_v, alpha));
    let one_minus = 1.0 - v_h;
    let square = one_minus * one_minus;
    let fresnel = f0 + (1.0 - f0) * square * square * one_minus;
    return (diffuse * (1.0 - fresnel) / PI + specular * fresnel) * n_l;
}

fn sky_towards(ray: vec3f) -> vec3f {
    return mix(environment.horizon, environment.zenith, sqrt(max(ray.y, 0.0)));
}

// What a reflected ray meets: the room's box with panels of light in the ceiling and a skirting board, or the sky over
// the ground. Edges are as soft as the surface is rough.
fn surroundings(position: vec3f, ray: vec3f, roughness: f32) -> vec3f {
    if environment.room_max.y <= environment.room_min.y {
        let down = environment.ground_light + environment.sky_light * 0.3;
        return mix(down, sky_towards(ray), smoothstep(-0.05 - roughness, 0.05 + roughness, ray.y));
    }
    let inverse = 1.0 / select(ray, vec3f(1e-5), abs(ray) < vec3f(1e-5));
    let far = max((environment.room_min - position) * inverse, (environment.room_max - position) * inverse);
    let distance = min(far.x, min(far.y, far.z));
    let hit = position + ray * distance;
    let soft = 0.02 + roughness * min(distance, 4.0) * 0.5;
    if far.y <= min(far.x, far.z) && ray.y > 0.0 {
        let off = abs(fract(hit.xz * 0.5) - 0.5);
        let panel = smoothstep(0.3 + soft, 0.3 - soft, off.x) * smoothstep(0.18 + soft, 0.18 - soft, off.y);
        return vec3f(0.10) + environment.panels * panel;
    }
    let height = (hit.y - environment.room_min.y) / (environment.room_max.y - environment.room_min.y);
    return mix(vec3f(0.05, 0.045, 0.04), vec3f(0.24, 0.25, 0.26), smoothstep(0.1 - soft, 0.1 + soft, height));
}

// All light from a point of a surface towards `eye`. `leaf` is how much of the sun's light shines through.
fn lit(in: Lit, eye: vec3f, base: vec4f, n: vec3f, roughness: f32, leaf: f32) -> vec3f {
    let albedo = base.rgb * in.tint;
    let diffuse = albedo * base.a;
    let f0 = mix(albedo, vec3f(0.04), base.a);
    let to_eye = eye - in.position;
    let v = normalize(to_eye);
    let n_v = max(dot(n, v), 1e-3);
    let alpha = max(roughness * roughness, 0.004);

    var light = in.emission * albedo;
    light += diffuse * mix(environment.ground_light, environment.sky_light, 0.5 + 0.5 * n.y) * in.sky;
    let n_sun = dot(n, environment.sun_direction);
    let sun = glossy(n_v, max(n_sun, 1e-4), dot(v, environment.sun_direction), diffuse, f0, alpha);
    light += (sun + diffuse * (leaf * max(-n_sun, 0.0))) * environment.sun * in.sky;
    for (var i = 0u; i < view.light_count; i++) {
        let lamp = lights[i];
        let to_lamp = lamp.position - in.position;
        let distance_2 = dot(to_lamp, to_lamp);
        let l = to_lamp * inverseSqrt(distance_2);
        let reflected = glossy(n_v, max(dot(n, l), 1e-4), dot(v, l), diffuse, f0, alpha);
        light += reflected * lamp.colour * falloff(distance_2, lamp.inverse_range_2);
    }
    let one_minus = 1.0 - n_v;
    let square = one_minus * one_minus;
    // Schlick's Fresnel, less steep on rough surfaces (Lagarde 2011).
    let fresnel = f0 + (max(vec3f(1.0 - roughness), f0) - f0) * square * square * one_minus;
    let smoothness = 1.0 - roughness;
    light += surroundings(in.position, reflect(-v, n), roughness) * fresnel * smoothness * max(in.sky, 0.15);
    let clear = exp2(-environment.fog_per_m * length(to_eye));
    return mix(environment.horizon, light, clear) * environment.exposure;
}

fn bumped(in: Lit, relief: vec4f) -> vec3f {
    let tilt = relief.xyz * 2.0 - 1.0;
    return normalize(in.tangent * tilt.x + cross(in.normal, in.tangent) * tilt.y + in.normal * tilt.z);
}

@fragment
fn lit_fragment(in: Lit) -> @location(0) vec4f {
    let base = textureSample(albedo_map, repeating, in.uv);
    let relief = textureSample(relief_map, repeating, in.uv);
    return shown(lit(in, view.eye, base, bumped(in, relief), relief.a, 0.0));
}

@fragment
fn mirror_fragment(in: Lit) -> @location(0) vec4f {
    let base = textureSample(albedo_map, repeating, in.uv);
    let relief = textureSample(relief_map, repeating, in.uv);
    return shown(lit(in, mirrored(view.eye), base, bumped(in, relief), relief.a, 0.0) * 0.88);
}

@fragment
fn leaf_fragment(in: Lit, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let base = textureSample(albedo_map, repeating, in.uv);
    let relief = textureSample(relief_map, repeating, in.uv);
    if base.a >= 0.5 {
        let n = select(-in.normal, in.normal, front);
        return shown(lit(in, view.eye, vec4f(base.rgb, 1.0), normalize(n), relief.a, 0.35));
    }
    discard;
    return vec4f(0.0);
}

@fragment
fn weather_fragment(in: Sky) -> @location(0) vec4f {
    let ray = normalize(in.ray);
    let height = max(ray.y, 0.0);
    let plane = ray.xz / (height + 0.12);
    let sheet = textureSample(detail_map, repeating, plane * 0.22 + view.time * vec2f(0.002, 0.0)).r;
    let grain = textureSample(detail_map, repeating, plane * 3.0).b;
    var light = sky_towards(ray);
    let edge = 1.0 - environment.cloud;
    let cloud = smoothstep(edge * 0.95, edge * 0.95 + 0.16, sheet) * smoothstep(0.0, 0.15, height);
    light = mix(light, environment.sky_light * 2.2 + environment.sun * 0.15, cloud * 0.8);
    light += environment.stars * smoothstep(0.78, 0.86, grain) * (1.0 - cloud) * smoothstep(0.02, 0.2, height);
    let to_sun = dot(ray, environment.sun_direction);
    let glow_2 = max(to_sun, 0.0) * max(to_sun, 0.0);
    let glow_8 = glow_2 * glow_2 * glow_2 * glow_2;
    light += environment.sun * (smoothstep(0.9985, 0.9994, to_sun) * 12.0 + glow_8 * glow_8 * 0.25);
    return shown(light * environment.exposure);
}
