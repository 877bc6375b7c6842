// Shared by both fragment shaders: what a distortion looks like.
precision highp float;
uniform sampler2D u_ramp;
uniform float u_end;        // ln of the distortion where the ramp ends
uniform float u_pixel;      // device pixels per point
uniform float u_wire;       // opacity of the wireframe
uniform int u_hover;        // triangle under the pointer, or -1
uniform vec3 u_accent;
uniform vec3 u_outline;
uniform vec3 u_vermilion;

// One of the ramps: row 0 cividis, row 1 for quantities with a middle, row 2 for zones.
vec3 ramp_at(float t, float row) {
    return texture(u_ramp, vec2(t * (255.0 / 256.0) + 0.5 / 256.0, (row + 0.5) / 4.0)).rgb;
}

vec3 ramp(float distortion) {
    return ramp_at(min(log(max(distortion, 1.0)) / u_end, 1.0), 0.0);
}

// Diagonal stripes, 6 points apart: never only a colour.
vec3 hatch(vec3 ground) {
    vec2 p = gl_FragCoord.xy / u_pixel;
    float d = abs(fract((p.x + p.y) / 6.0) - 0.5) * 6.0;
    return mix(u_vermilion, ground, smoothstep(1.2, 1.9, d));
}

// Dots where the ramp is clamped.
vec3 clamped(vec3 colour) {
    vec2 p = gl_FragCoord.xy / u_pixel / 5.0;
    p.x += 0.5 * mod(floor(p.y), 2.0);
    float d = length(fract(p) - 0.5) * 5.0;
    return mix(vec3(0.35, 0.28, 0.0), colour, smoothstep(0.7, 1.2, d));
}

vec3 wires(vec3 colour, vec3 edge, float weight, vec3 ink) {
    vec3 width = max(fwidth(edge), vec3(1e-5)); // an edge that is not drawn has none
    vec3 near = smoothstep(vec3(0.0), width * 1.1 * u_pixel, edge);
    float line = 1.0 - min(near.x, min(near.y, near.z));
    // A triangle of a few pixels would be all line: fade.
    float size = 1.0 / max(max(width.x, width.y), width.z) / u_pixel;
    return mix(colour, ink, line * weight * smoothstep(3.0, 12.0, size));
}

vec3 wires(vec3 colour, vec3 edge, float weight) {
    return wires(colour, edge, weight, u_outline);
}

// Hatched on a ground, with a dark outline wherever there is room for one.
vec3 inverted(vec3 edge, vec3 ground) {
    vec3 width = max(fwidth(edge), vec3(1e-5)); // an edge that is not drawn has none
    vec3 near = smoothstep(width * 0.5 * u_pixel, width * 1.3 * u_pixel, edge);
    float line = 1.0 - min(near.x, min(near.y, near.z));
    float size = 1.0 / max(max(width.x, width.y), width.z) / u_pixel;
    return mix(hatch(ground), u_outline, line * smoothstep(2.0, 9.0, size));
}

vec3 inverted(vec3 edge) {
    return inverted(edge, vec3(1.0, 0.90, 0.82));
}
