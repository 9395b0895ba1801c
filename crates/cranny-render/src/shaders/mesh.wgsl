// Bodies, and the shadows that they cast on the ground.

struct MeshVertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) color: vec4<f32>,      // linear
    @location(3) row_x: vec4<f32>,
    @location(4) row_y: vec4<f32>,
    @location(5) row_z: vec4<f32>,
    @location(6) tint: vec4<f32>,
    @location(7) cut: f32,              // 1 for what a section cuts, 0 for what it leaves whole
}

struct MeshFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    @location(1) @interpolate(flat) normal: vec3<f32>,
    @location(2) @interpolate(flat) color: vec4<f32>,
    @location(3) before: f32,           // of the section's plane, where the body is cut
}

fn placed(v: MeshVertex) -> vec3<f32> {
    let p = vec4(v.position, 1.0);
    return vec3(dot(v.row_x, p), dot(v.row_y, p), dot(v.row_z, p));
}

@vertex
fn mesh_vertex(v: MeshVertex) -> MeshFragment {
    let position = placed(v);
    let n = v.normal.xyz;
    let normal = vec3(dot(v.row_x.xyz, n), dot(v.row_y.xyz, n), dot(v.row_z.xyz, n));
        let before = mix(-1.0, before_section(position), v.cut);
    return MeshFragment(to_clip(position), position, normalize(normal), v.color * v.tint, before);
}

// Light from the sky and the ground, a key light, a fill light, a highlight and a rim.
fn lit(albedo: vec3<f32>, normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    let sky = vec3(0.50, 0.53, 0.58);
    let earth = vec3(0.23, 0.22, 0.21);
    let key = globals.key_near.xyz;
    let diffuse = mix(earth, sky, 0.5 + 0.5 * normal.z)
        + vec3(0.62, 0.60, 0.57) * max(dot(normal, key), 0.0)
        + vec3(0.10, 0.11, 0.13) * max(dot(normal, globals.fill.xyz), 0.0);
    // Powers by multiplication: software adapters spend half their time in here.
    let glance = max(dot(normal, normalize(key + to_eye)), 0.0);
    let glance_8 = glance * glance * glance * glance * glance * glance * glance * glance;
    let highlight = 0.10 * glance_8 * glance_8 * glance_8 * glance_8 * glance_8;
    let edge_on = 1.0 - max(dot(normal, to_eye), 0.0);
    let rim = 0.12 * edge_on * edge_on * edge_on;
    return albedo * diffuse + vec3(highlight) + rim * sky;
}

fn shaded(f: MeshFragment, front: bool) -> vec3<f32> {
    let to_eye = normalize(-f.position);
    if front {
        return lit(f.color.rgb, f.normal, to_eye);
    }
    // The inside of an open surface.
    return 0.5 * lit(f.color.rgb, -f.normal, to_eye);
}

@fragment
fn opaque_fragment(f: MeshFragment, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return vec4(shaded(f, front), 1.0);
}

@fragment
fn cut_fragment(f: MeshFragment, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    if f.before > 0.0 {
        discard;
    }
    return vec4(shaded(f, front), 1.0);
}

// Denser where it is seen at a grazing angle, as glass is, so that outlines can be read.
@fragment
fn overlay_fragment(f: MeshFragment, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    if f.before > 0.0 {
        discard;
    }
    let facing = abs(dot(f.normal, normalize(-f.position)));
    let density = mix(1.0, 1.8, pow(1.0 - facing, 3.0)) * select(0.6, 1.0, front);
    return vec4(shaded(f, front), min(f.color.a * density, 1.0));
}

// Each layer takes away its share of the light behind it, so layers need no order.
@fragment
fn xray_fragment(f: MeshFragment) -> @location(0) vec4<f32> {
    if f.before > 0.0 {
        discard;
    }
    let facing = abs(dot(f.normal, normalize(-f.position)));
    let density = f.color.a * mix(0.14, 0.75, pow(1.0 - facing, 2.0));
    return vec4(mix(vec3(1.0), f.color.rgb, density), 1.0);
}

// Flattens the body onto the ground along the light. What is below the ground casts none. Only the
// stencil is written: where shadows overlap, the result is that of one.
@vertex
fn shadow_vertex(v: MeshVertex) -> @builtin(position) vec4<f32> {
    let p = placed(v);
    let height = max(p.z - globals.ground_center.z, 0.0);
    return to_clip(vec3(p.xy + vec2(0.22, 0.12) * height, globals.ground_center.z));
}

@fragment
fn shadow_fragment() {
}
