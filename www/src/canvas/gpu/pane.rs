//! A map on the graphics card; one for each that is shown at the same time.

use wasm_bindgen::JsValue;
use web_sys::{WebGl2RenderingContext as Gl, WebGlBuffer, WebGlVertexArrayObject};

use super::{MapData, fill};

/// Buffers of one map, and what binds them.
pub struct Pane {
    pub triangles: WebGlVertexArrayObject,
    pub outline: WebGlVertexArrayObject,
    pub painted_corners: i32,
    pub boundary_count: i32,
    maps: WebGlBuffer,
    distortions: WebGlBuffer,
    order: WebGlBuffer,
    outline_points: WebGlBuffer,
}

impl Pane {
    /// An empty one.
    pub fn new(gl: &Gl) -> Result<Self, JsValue> {
        let missing = || JsValue::from_str("WebGL is out of memory");
        let buffer = || gl.create_buffer().ok_or_else(missing);
        let array = || gl.create_vertex_array().ok_or_else(missing);
        let pane = Self {
            triangles: array()?,
            outline: array()?,
            painted_corners: 0,
            boundary_count: 0,
            maps: buffer()?,
            distortions: buffer()?,
            order: buffer()?,
            outline_points: buffer()?,
        };
        let attribute = |buffer: &WebGlBuffer, location: u32, width: i32| {
            gl.bind_buffer(Gl::ARRAY_BUFFER, Some(buffer));
            gl.enable_vertex_attrib_array(location);
            gl.vertex_attrib_pointer_with_i32(location, width, Gl::FLOAT, false, 0, 0);
        };
        gl.bind_vertex_array(Some(&pane.triangles));
        attribute(&pane.maps, 2, 2);
        attribute(&pane.distortions, 3, 1);
        gl.bind_buffer(Gl::ELEMENT_ARRAY_BUFFER, Some(&pane.order));
        gl.bind_vertex_array(Some(&pane.outline));
        attribute(&pane.outline_points, 0, 2);
        gl.bind_vertex_array(None);
        Ok(pane)
    }

    /// Takes a map.
    pub fn set(&mut self, gl: &Gl, map: &MapData<'_>) {
        fill(gl, &self.maps, map.corners);
        fill(gl, &self.distortions, map.distortions);
        fill(gl, &self.outline_points, map.boundary);
        gl.bind_vertex_array(Some(&self.triangles));
        gl.buffer_data_with_u8_array(
            Gl::ELEMENT_ARRAY_BUFFER,
            bytemuck::cast_slice(map.order),
            Gl::DYNAMIC_DRAW,
        );
        gl.bind_vertex_array(None);
        self.painted_corners = map.order.len() as i32;
        self.boundary_count = (map.boundary.len() / 2) as i32;
    }
}
