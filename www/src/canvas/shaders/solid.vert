#version 300 es
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec2 a_mark;     // where on the ramp; edges not to draw
uniform mat4 u_matrix;
uniform mat3 u_turn;
uniform float u_scale;                   // one over the solid's radius
uniform vec4 u_plane;                    // normal and offset; what lies above is not drawn
out vec3 v_point;
out vec3 v_edge;
out float v_height;
flat out float v_distortion;
void main() {
    gl_Position = u_matrix * vec4(a_position, 1.0);
    v_point = u_turn * (a_position * u_scale);
    v_height = dot(u_plane.xyz, a_position) - u_plane.w;
    v_distortion = a_mark.x;
    int corner = gl_VertexID % 3;
    int hidden = int(a_mark.y);
    v_edge = vec3(corner == 0, corner == 1, corner == 2);
    for (int k = 0; k < 3; k++) if ((hidden & (1 << k)) != 0) v_edge[k] = 1.0;
}
