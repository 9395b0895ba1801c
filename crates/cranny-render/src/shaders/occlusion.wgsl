// How much of the light from all sides is held off by what stands nearby, read from the depths
// alone (after McGuire, Osman, Bukowski and Hennessy, 'The Alchemy Screen-Space Ambient Obscurance
// Algorithm', HPG 2011).

@group(1) @binding(0) var depths: texture_multisampled_2d<f32>;

@vertex
fn occlusion_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Right, down, forward of what is seen at a pixel; endlessly far where nothing is.
fn seen_at(pixel: vec2<i32>) -> vec3<f32> {
    let inside = clamp(pixel, vec2(0), vec2<i32>(globals.viewport.xy) - 1);
    let depth = max(textureLoad(depths, inside, 0).x, 1e-9);
    let forward = globals.key_near.w / depth;
    let at = (vec2<f32>(inside) + 0.5) / globals.viewport.xy * 2.0 - 1.0;
    return vec3(at * globals.viewport.zw, 1.0) * forward;
}

// The shorter of two steps to neighbours: it stays on the surface.
fn shorter(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return select(b, a, abs(a.z) < abs(b.z));
}

const SAMPLES: i32 = 10;

@fragment
fn occlusion_fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(at.xy);
    let here = seen_at(pixel);
    // Blending costs more than reading: what stays as it is is left alone.
    if here.z > 1e6 {
        discard;
    }
    let across = shorter(seen_at(pixel + vec2(1, 0)) - here, here - seen_at(pixel - vec2(1, 0)));
    let down = shorter(seen_at(pixel + vec2(0, 1)) - here, here - seen_at(pixel - vec2(0, 1)));
    let normal = normalize(cross(down, across));
    let reach = globals.ground_grid.w;
    let pixels = min(0.5 * reach / (here.z * globals.viewport.w) * globals.viewport.y, 60.0);
    // Neighbours look in other directions, in a pattern of four by four.
    let turn = f32((pixel.x & 3) + 4 * (pixel.y & 3)) * 2.399963;
    var held_off = 0.0;
    for (var i = 0; i < SAMPLES; i++) {
        let away = (f32(i) + 0.5) / f32(SAMPLES) * pixels;
        let angle = f32(i) * 2.399963 + turn;
        let there = seen_at(pixel + vec2<i32>(round(away * vec2(cos(angle), sin(angle)))));
        let step = there - here;
        let square = dot(step, step) + 1e-12;
        let near = max(1.0 - square / (reach * reach), 0.0);
        held_off += near * max(dot(step, normal) / sqrt(square) - 0.12, 0.0);
    }
    if held_off < 0.02 {
        discard;
    }
    return vec4(vec3(1.0 - min(1.1 * held_off / f32(SAMPLES), 0.65)), 1.0);
}
