uniform vec3 u_skin;
uniform float u_tint;       // how much of the ramp's colour is taken, 0–1
uniform float u_opacity;    // facing the viewer
uniform float u_rim;        // at a grazing angle
uniform float u_row;        // which ramp
uniform float u_flat;       // 1 for cut faces, which are not lit
in vec3 v_point;
in vec3 v_edge;
in float v_height;
flat in float v_distortion;
out vec4 colour;

void main() {
    if (v_height > 0.0) discard;
    bool bad = v_distortion < 0.0;
    // Below -1: inverted, on the ground of a zone.
    vec3 ground = v_distortion < -1.5 ? ramp_at(-v_distortion - 2.0, u_row) : vec3(1.0, 0.90, 0.82);
    vec3 c = bad ? inverted(v_edge, ground) : mix(u_skin, ramp_at(min(v_distortion, 1.0), u_row), u_tint);
    if (!bad && u_tint > 0.0) {
        if (v_distortion > 2.5) c = clamped(mix(c, ramp_at(0.0, u_row), u_tint));
        else if (v_distortion > 1.0) c = clamped(c);
    }
    vec3 n = normalize(cross(dFdx(v_point), dFdy(v_point)));
    if (n.z < 0.0) n = -n;
    float key = 0.5 + 0.5 * dot(n, normalize(vec3(-0.35, 0.55, 0.75)));
    float fill = 0.5 + 0.5 * dot(n, normalize(vec3(0.8, 0.1, 0.4)));
    float light = 0.50 + 0.46 * key * key + 0.14 * fill;
    c *= mix(light, 1.0, u_flat);
    float rim = pow(1.0 - clamp(n.z, 0.0, 1.0), 2.5);
    float opacity = bad && u_opacity < 1.0 ? max(u_opacity, 0.75) : mix(u_opacity, u_rim, rim);
    if (!bad) {
        // Edges on dark colours are light.
        float bright = dot(c, vec3(0.3, 0.6, 0.1));
        c = wires(c, v_edge, u_wire, mix(vec3(0.80), u_outline, smoothstep(0.22, 0.38, bright)));
    }
    colour = vec4(c * opacity, opacity);
}
