#version 300 es
precision mediump float;
uniform vec4 u_colour;
out vec4 colour;
void main() {
    colour = vec4(u_colour.rgb * u_colour.a, u_colour.a);
}
