// The background and the grid.

@vertex
fn backdrop_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the picture, at infinity (depth is reversed).
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn backdrop_fragment(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4(backdrop_at(pixel.xy), 1.0);
}

struct GridFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
}

@vertex
fn grid_vertex(@builtin(vertex_index) i: u32) -> GridFragment {
    let corner = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0 - 1.0;
    let center = globals.ground_center;
    let position = vec3(center.xy + corner * center.w, center.z);
    return GridFragment(nearer(to_clip(position), -0.0005), position);
}

// How much of a pixel lines at the whole numbers cover; they are `width` pixels wide. Where they
// are too dense to be told apart, they fade rather than flicker.
fn coverage(at: vec2<f32>, per_pixel: vec2<f32>, width: f32) -> f32 {
    let to_line = abs(at - round(at)) / per_pixel;
    let lines = clamp(vec2(0.5 * width + 0.5) - to_line, vec2(0.0), vec2(1.0))
        * (1.0 - smoothstep(vec2(0.15), vec2(0.5), per_pixel));
    return max(lines.x, lines.y);
}

@fragment
fn grid_fragment(f: GridFragment) -> @location(0) vec4<f32> {
    let at = (f.position.xy - globals.ground_grid.xy) / globals.ground_grid.z;
    let per_pixel = max(fwidth(at), vec2(1e-6));
    let weak = 0.20 * coverage(at, per_pixel, 1.0);
    let strong = 0.38 * coverage(at / 10.0, per_pixel / 10.0, 1.4);
    return vec4(0.10, 0.13, 0.18, max(weak, strong) * ground_fade(f.position));
}

// Darkens the bare backdrop where the stencil says that a shadow falls.
@fragment
fn shade_fragment(f: GridFragment) -> @location(0) vec4<f32> {
    return vec4(vec3(1.0 - 0.24 * ground_fade(f.position)), 1.0);
}
