// What all shaders share. Positions are relative to the eye, in units of the distance between eye
// and target, along the world's axes; colours are linear light.

struct Globals {
    clip_from_scene: mat4x4<f32>,
    key_near: vec4<f32>,        // towards the key light; distance of the near plane
    fill: vec4<f32>,            // towards the fill light
    viewport: vec4<f32>,        // width and height in pixels; tangents of half the view's angles
    backdrop_top: vec4<f32>,
    backdrop_bottom: vec4<f32>,
    ground_center: vec4<f32>,   // and radius
    ground_grid: vec4<f32>,     // crossing of two strong lines (x, y), spacing, reach of occlusion
    section: vec4<f32>,         // plane of the cut: normal and offset; nothing is in front without
    overlap: vec4<f32>,         // colour of what two cut bodies share
}

@group(0) @binding(0) var<uniform> globals: Globals;

fn to_clip(position: vec3<f32>) -> vec4<f32> {
    return globals.clip_from_scene * vec4(position, 1.0);
}

// Above 0 in front of the section's plane, where whatever is cut is taken away.
fn before_section(position: vec3<f32>) -> f32 {
    return dot(globals.section.xyz, position) + globals.section.w;
}

// Brought nearer by a fraction of its distance, so that a mark on a surface wins against it.
fn nearer(clip: vec4<f32>, fraction: f32) -> vec4<f32> {
    return vec4(clip.xy, clip.z * (1.0 + fraction), clip.w);
}

// From pixels (y down) away from a clip position to clip coordinates.
fn offset_pixels(clip: vec4<f32>, pixels: vec2<f32>) -> vec4<f32> {
    return vec4(clip.xy + pixels * 2.0 / globals.viewport.xy * clip.w, clip.zw);
}

fn backdrop_at(pixel: vec2<f32>) -> vec3<f32> {
    let down = pixel.y / globals.viewport.y;
    return mix(globals.backdrop_top.rgb, globals.backdrop_bottom.rgb, down * down);
}

// 1 at the ground's centre, 0 from its radius on.
fn ground_fade(position: vec3<f32>) -> f32 {
    let away = distance(position.xy, globals.ground_center.xy) / globals.ground_center.w;
    return 1.0 - smoothstep(0.15, 1.0, away);
}
