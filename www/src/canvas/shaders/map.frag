in vec3 v_edge;
flat in float v_distortion;
flat in int v_triangle;
out vec4 colour;
void main() {
    vec3 c;
    if (v_distortion < 0.0) {
        c = inverted(v_edge);
    } else {
        c = ramp(v_distortion);
        if (v_distortion > exp(u_end)) c = clamped(c);
    }
    if (v_triangle == u_hover) c = mix(c, u_accent, 0.75);
    colour = vec4(wires(c, v_edge, u_wire), 1.0);
}
