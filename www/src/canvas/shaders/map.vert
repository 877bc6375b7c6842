#version 300 es
layout(location = 2) in vec2 a_map;
layout(location = 3) in float a_distortion;
uniform mat4 u_matrix;
out vec3 v_edge;
flat out float v_distortion;
flat out int v_triangle;
void main() {
    gl_Position = u_matrix * vec4(a_map, 0.0, 1.0);
    v_distortion = a_distortion;
    int corner = gl_VertexID % 3;
    v_edge = vec3(corner == 0, corner == 1, corner == 2);
    v_triangle = gl_VertexID / 3;
}
