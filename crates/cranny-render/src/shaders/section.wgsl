// What a section shows of a closed body: the cut face. A ray that meets the plane inside the body
// leaves the rest of it once more often than it enters; the stencil counts.

@fragment
fn winding_fragment(f: MeshFragment) {
    if f.before > 0.0 {
        discard;
    }
}

struct CutFace {
    @location(0) center: vec4<f32>,     // and the direction of the hatching, in radians
    @location(1) u: vec4<f32>,          // half a side of a square that holds the cut face
    @location(2) v: vec4<f32>,
    @location(3) color: vec4<f32>,
}

struct CutFaceFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) @interpolate(flat) hatching: f32,
}

@vertex
fn cut_face_vertex(face: CutFace, @builtin(vertex_index) i: u32) -> CutFaceFragment {
    let corner = vec2(f32(i & 1u), f32(i >> 1u)) * 2.0 - 1.0;
    let position = face.center.xyz + corner.x * face.u.xyz + corner.y * face.v.xyz;
    return CutFaceFragment(to_clip(position), face.color, face.center.w);
}

// Thin lines, as in a technical drawing; each body has its own direction.
fn hatched(pixel: vec2<f32>, hatching: f32, spacing: f32) -> f32 {
    let across = dot(pixel, vec2(cos(hatching), sin(hatching))) / spacing;
    let away = abs(fract(across) - 0.5) * spacing;
    return clamp(1.1 - away, 0.0, 1.0);
}

@fragment
fn cut_face_fragment(f: CutFaceFragment) -> @location(0) vec4<f32> {
    let line = hatched(f.clip.xy, f.hatching, 7.0);
    return vec4(f.color.rgb * mix(0.92, 0.52, line), 1.0);
}

@fragment
fn overlap_fragment(f: CutFaceFragment) -> @location(0) vec4<f32> {
    return vec4(globals.overlap.rgb, 1.0);
}

@fragment
fn mark_fragment(f: CutFaceFragment) {
}
