#version 300 es
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec2 a_map;
layout(location = 3) in float a_distortion;
uniform mat4 u_matrix;
uniform mat3 u_turn;
uniform float u_squares;
out vec3 v_normal;
out vec2 v_check;
out vec3 v_edge;
flat out float v_distortion;
flat out int v_triangle;
void main() {
    gl_Position = u_matrix * vec4(a_position, 1.0);
    v_normal = u_turn * a_normal;
    v_check = a_map * u_squares;
    v_distortion = a_distortion;
    int corner = gl_VertexID % 3;
    v_edge = vec3(corner == 0, corner == 1, corner == 2);
    v_triangle = gl_VertexID / 3;
}
