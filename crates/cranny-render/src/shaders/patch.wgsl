// Areas bounded by loops. The triangles of a fan cover each point of the area an odd number of
// times, whatever its shape: the stencil counts, then the same triangles paint.

struct PatchVertex {
    @location(0) position: vec3<f32>,
    @location(1) color: vec4<f32>,
}

struct PatchFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) before: f32,
}

@vertex
fn patch_vertex(v: PatchVertex) -> PatchFragment {
    return PatchFragment(nearer(to_clip(v.position), 0.002), v.color, before_section(v.position));
}

@fragment
fn patch_fragment(f: PatchFragment) -> @location(0) vec4<f32> {
    return f.color;
}
