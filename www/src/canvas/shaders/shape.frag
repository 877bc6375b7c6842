uniform vec3 u_check_light;
uniform vec3 u_check_dark;
uniform float u_tint;
in vec3 v_normal;
in vec2 v_check;
in vec3 v_edge;
flat in float v_distortion;
flat in int v_triangle;
out vec4 colour;

// A checkerboard averaged over the pixel's footprint, so that it never shimmers.
float checker(vec2 p) {
    vec2 w = max(abs(dFdx(p)) + abs(dFdy(p)), vec2(1e-4));
    vec2 i = (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * 0.5) - 0.5)) * 2.0 / w;
    float checks = 0.5 - 0.5 * clamp(i.x, -1.0, 1.0) * clamp(i.y, -1.0, 1.0);
    // Squares smaller than a pixel or so are an even grey, without moiré.
    return mix(checks, 0.5, smoothstep(0.6, 1.4, max(w.x, w.y)));
}

void main() {
    float check = checker(v_check);
    vec3 grey = mix(u_check_dark, u_check_light, check);
    vec3 c;
    if (v_distortion < 0.0) {
        c = inverted(v_edge);
    } else {
        c = mix(grey, ramp(v_distortion) * mix(0.80, 1.12, check), u_tint);
    }
    vec3 n = normalize(v_normal);
    if (!gl_FrontFacing) n = -n;
    float key = 0.5 + 0.5 * dot(n, normalize(vec3(-0.35, 0.55, 0.75)));
    float fill = 0.5 + 0.5 * dot(n, normalize(vec3(0.8, 0.1, 0.4)));
    float shine = pow(max(dot(n, normalize(vec3(-0.2, 0.3, 1.0))), 0.0), 40.0);
    c *= 0.50 + 0.46 * key * key + 0.14 * fill;
    c += 0.05 * shine;
    if (!gl_FrontFacing) c *= 0.78;
    if (v_triangle == u_hover) c = mix(c, u_accent, 0.75);
    colour = vec4(wires(c, v_edge, u_wire), 1.0);
}
