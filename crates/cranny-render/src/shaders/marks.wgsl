// Lines and points: sizes in pixels, wherever they are.

struct Line {
    @location(0) start: vec4<f32>,      // and width in pixels
    @location(1) end: vec4<f32>,        // and width in pixels
    @location(2) color: vec4<f32>,
    @location(3) cut: f32,              // 1 where a section takes away what is before its plane
}

struct LineFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    @location(1) before: f32,
}

@vertex
fn line_vertex(line: Line, @builtin(vertex_index) i: u32) -> LineFragment {
    var a = to_clip(line.start.xyz);
    var b = to_clip(line.end.xyz);
    var widths = vec2(line.start.w, line.end.w);
    var before = mix(vec2(-1.0), vec2(before_section(line.start.xyz), before_section(line.end.xyz)), line.cut);
    let near = globals.key_near.w;
    if max(a.w, b.w) < near {
        // All of it is behind the near plane: outside the clip volume.
        return LineFragment(vec4(2.0, 2.0, 2.0, 1.0), line.color, -1.0);
    }
    // The part before the near plane; clip.w is the depth.
    if a.w < near {
        let t = (near - a.w) / (b.w - a.w);
        a = mix(a, b, t);
        widths.x = mix(widths.x, widths.y, t);
        before.x = mix(before.x, before.y, t);
    } else if b.w < near {
        let t = (near - b.w) / (a.w - b.w);
        b = mix(b, a, t);
        widths.y = mix(widths.y, widths.x, t);
        before.y = mix(before.y, before.x, t);
    }
    let span = (b.xy / b.w - a.xy / a.w) * 0.5 * globals.viewport.xy;
    let extent = length(span);
    var along = vec2(1.0, 0.0);
    if extent > 1e-6 {
        along = span / extent;
    }
    let across = vec2(-along.y, along.x) * (f32(i & 1u) - 0.5);
    let beyond = along * 0.5 * min(widths.x, widths.y);
    if (i >> 1u) == 0u {
        let clip = nearer(offset_pixels(a, across * widths.x - beyond), 0.001);
        return LineFragment(clip, line.color, before.x);
    }
    let clip = nearer(offset_pixels(b, across * widths.y + beyond), 0.001);
    return LineFragment(clip, line.color, before.y);
}

@fragment
fn line_fragment(f: LineFragment) -> @location(0) vec4<f32> {
    if f.before > 0.0 {
        discard;
    }
    return f.color;
}

struct Point {
    @location(0) position: vec4<f32>,   // and radius in pixels
    @location(1) color: vec4<f32>,
}

struct PointFragment {
    @builtin(position) clip: vec4<f32>,
    @location(0) from_center: vec2<f32>,    // in pixels
    @location(1) @interpolate(flat) radius: f32,
    @location(2) @interpolate(flat) color: vec4<f32>,
}

@vertex
fn point_vertex(point: Point, @builtin(vertex_index) i: u32) -> PointFragment {
    let center = to_clip(point.position.xyz);
    let radius = point.position.w;
    let from_center = (vec2(f32(i & 1u), f32(i >> 1u)) * 2.0 - 1.0) * (radius + 1.0);
    if center.w < globals.key_near.w {
        return PointFragment(vec4(2.0, 2.0, 2.0, 1.0), from_center, radius, point.color);
    }
    let clip = nearer(offset_pixels(center, from_center), 0.002);
    return PointFragment(clip, from_center, radius, point.color);
}

@fragment
fn point_fragment(f: PointFragment) -> @location(0) vec4<f32> {
    let away = length(f.from_center);
    let inside = clamp(f.radius + 0.5 - away, 0.0, 1.0);
    // A rim of a pixel and a bit, so that the disc stands out from any surface.
    let rim = clamp(away - (f.radius - 1.4) + 0.5, 0.0, 1.0);
    return vec4(f.color.rgb * mix(1.0, 0.25, rim), f.color.a * inside);
}
