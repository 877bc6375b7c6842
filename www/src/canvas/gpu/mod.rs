//! What the canvas keeps on the graphics card, and how it is drawn (WebGL 2, safe bindings only).

mod pane;
mod solid;

use pane::Pane;
pub use solid::{SolidData, SolidLook};

use std::cell::RefCell;

use glam::{Mat3, Mat4};
use wasm_bindgen::{JsCast as _, JsValue};
use web_sys::{
    HtmlCanvasElement, WebGl2RenderingContext as Gl, WebGlBuffer, WebGlProgram, WebGlTexture,
    WebGlVertexArrayObject,
};

use crate::colour::{self, Rgb, Theme};

thread_local! {
    // Paint callbacks must be `Send`; WebGL objects are not. The page has one thread and one canvas.
    static GPU: RefCell<Option<Gpu>> = const { RefCell::new(None) };
}

/// Runs `f` with the GPU, if there is one.
pub fn with<R>(f: impl FnOnce(&mut Gpu) -> R) -> Option<R> {
    GPU.with_borrow_mut(|gpu| gpu.as_mut().map(f))
}

/// Makes the programs and buffers on the canvas's WebGL 2 context.
pub fn start(canvas: &HtmlCanvasElement) -> Result<(), JsValue> {
    let gl: Gl = canvas
        .get_context("webgl2")?
        .ok_or_else(|| JsValue::from_str("this browser has no WebGL 2"))?
        .dyn_into()
        .map_err(|_| JsValue::from_str("the canvas has another context"))?;
    let gpu = Gpu::new(gl)?;
    GPU.with_borrow_mut(|slot| *slot = Some(gpu));
    Ok(())
}

/// How a view is drawn, beyond its matrix.
#[derive(Clone, Copy)]
pub struct Look {
    /// The theme.
    pub theme: Theme,
    /// Device pixels per point.
    pub pixel: f32,
    /// Whether all triangle edges are drawn.
    pub wireframe: bool,
    /// Triangle under the pointer.
    pub hover: Option<usize>,
    /// How much of the distortion colour the surface takes, 0–1.
    pub tint: f32,
}

/// The programs, buffers and vertex arrays.
pub struct Gpu {
    gl: Gl,
    shape: WebGlProgram,
    map: WebGlProgram,
    line: WebGlProgram,
    solid: solid::SolidGpu,
    ramp: WebGlTexture,
    triangles: WebGlVertexArrayObject,
    seam: WebGlVertexArrayObject,
    outline: WebGlVertexArrayObject,
    positions: WebGlBuffer,
    normals: WebGlBuffer,
    maps: WebGlBuffer,
    distortions: WebGlBuffer,
    order: WebGlBuffer,
    seam_points: WebGlBuffer,
    outline_points: WebGlBuffer,
    corners: i32,
    painted_corners: i32,
    seam_count: i32,
    boundary_count: i32,
    /// Maps that are shown side by side, made when they are first wanted.
    panes: Vec<Pane>,
}

fn fill(gl: &Gl, buffer: &WebGlBuffer, data: &[f32]) {
    gl.bind_buffer(Gl::ARRAY_BUFFER, Some(buffer));
    gl.buffer_data_with_u8_array(
        Gl::ARRAY_BUFFER,
        bytemuck::cast_slice(data),
        Gl::DYNAMIC_DRAW,
    );
}

/// The iterate on show, per corner, as the GPU takes it.
pub struct MapData<'a> {
    /// Two floats a corner.
    pub corners: &'a [f32],
    /// One float a corner; negative where inverted.
    pub distortions: &'a [f32],
    /// Corners in painting order.
    pub order: &'a [u32],
    /// Boundary segments: x y x y.
    pub boundary: &'a [f32],
}

impl Gpu {
    fn new(gl: Gl) -> Result<Self, JsValue> {
        let common = include_str!("../shaders/common.glsl");
        let fragment = |source: &str| format!("#version 300 es\n{common}\n{source}");
        let missing = || JsValue::from_str("WebGL is out of memory");
        let buffer = || gl.create_buffer().ok_or_else(missing);
        let array = || gl.create_vertex_array().ok_or_else(missing);
        let ramp = gl.create_texture().ok_or_else(missing)?;
        let gpu = Self {
            solid: solid::SolidGpu::new(&gl, common)?,
            shape: program(
                &gl,
                include_str!("../shaders/shape.vert"),
                &fragment(include_str!("../shaders/shape.frag")),
            )?,
            map: program(
                &gl,
                include_str!("../shaders/map.vert"),
                &fragment(include_str!("../shaders/map.frag")),
            )?,
            line: program(
                &gl,
                include_str!("../shaders/line.vert"),
                include_str!("../shaders/line.frag"),
            )?,
            ramp,
            triangles: array()?,
            seam: array()?,
            outline: array()?,
            positions: buffer()?,
            normals: buffer()?,
            maps: buffer()?,
            distortions: buffer()?,
            order: buffer()?,
            seam_points: buffer()?,
            outline_points: buffer()?,
            corners: 0,
            painted_corners: 0,
            seam_count: 0,
            boundary_count: 0,
            panes: Vec::new(),
            gl,
        };
        gpu.describe();
        gpu.upload_ramp()?;
        Ok(gpu)
    }

    /// Binds the buffers to the vertex arrays, once.
    fn describe(&self) {
        let gl = &self.gl;
        let attribute = |buffer: &WebGlBuffer, location: u32, width: i32| {
            gl.bind_buffer(Gl::ARRAY_BUFFER, Some(buffer));
            gl.enable_vertex_attrib_array(location);
            gl.vertex_attrib_pointer_with_i32(location, width, Gl::FLOAT, false, 0, 0);
        };
        gl.bind_vertex_array(Some(&self.triangles));
        attribute(&self.positions, 0, 3);
        attribute(&self.normals, 1, 3);
        attribute(&self.maps, 2, 2);
        attribute(&self.distortions, 3, 1);
        gl.bind_buffer(Gl::ELEMENT_ARRAY_BUFFER, Some(&self.order));
        gl.bind_vertex_array(Some(&self.seam));
        attribute(&self.seam_points, 0, 3);
        gl.bind_vertex_array(Some(&self.outline));
        attribute(&self.outline_points, 0, 2);
        gl.bind_vertex_array(None);
    }

    fn upload_ramp(&self) -> Result<(), JsValue> {
        let gl = &self.gl;
        gl.bind_texture(Gl::TEXTURE_2D, Some(&self.ramp));
        for (name, value) in [
            (Gl::TEXTURE_MIN_FILTER, Gl::LINEAR),
            (Gl::TEXTURE_MAG_FILTER, Gl::LINEAR),
            (Gl::TEXTURE_WRAP_S, Gl::CLAMP_TO_EDGE),
            (Gl::TEXTURE_WRAP_T, Gl::CLAMP_TO_EDGE),
        ] {
            gl.tex_parameteri(Gl::TEXTURE_2D, name, value as i32);
        }
        let texels = colour::ramp_texels(256);
        gl.tex_image_2d_with_i32_and_i32_and_i32_and_format_and_type_and_opt_u8_array(
            Gl::TEXTURE_2D,
            0,
            Gl::RGBA as i32,
            256,
            4,
            0,
            Gl::RGBA,
            Gl::UNSIGNED_BYTE,
            Some(&texels),
        )
    }

    fn fill(&self, buffer: &WebGlBuffer, data: &[f32]) {
        fill(&self.gl, buffer, data);
    }

    /// Uploads the map of one of those shown side by side.
    pub fn set_pane(&mut self, index: usize, map: &MapData<'_>) {
        while self.panes.len() <= index {
            // Without memory for it the pane stays empty.
            let Ok(pane) = Pane::new(&self.gl) else {
                return;
            };
            self.panes.push(pane);
        }
        self.panes[index].set(&self.gl, map);
    }

    /// Uploads a surface: corner positions and normals (three floats a corner), boundary segments.
    pub fn set_surface(&mut self, positions: &[f32], normals: &[f32], seam: &[f32]) {
        self.fill(&self.positions, positions);
        self.fill(&self.normals, normals);
        self.fill(&self.seam_points, seam);
        self.seam_count = (seam.len() / 3) as i32;
        (self.corners, self.painted_corners, self.boundary_count) = (0, 0, 0);
    }

    /// Uploads the iterate to show.
    pub fn set_map(&mut self, map: &MapData<'_>) {
        self.fill(&self.maps, map.corners);
        self.fill(&self.distortions, map.distortions);
        self.fill(&self.outline_points, map.boundary);
        self.gl.bind_vertex_array(Some(&self.triangles));
        self.gl.buffer_data_with_u8_array(
            Gl::ELEMENT_ARRAY_BUFFER,
            bytemuck::cast_slice(map.order),
            Gl::DYNAMIC_DRAW,
        );
        self.gl.bind_vertex_array(None);
        self.corners = map.distortions.len() as i32;
        self.painted_corners = map.order.len() as i32;
        self.boundary_count = (map.boundary.len() / 2) as i32;
    }

    /// Draws the surface into the current viewport.
    pub fn draw_shape(&self, matrix: Mat4, turn: Mat3, squares: f32, look: Look) {
        let gl = &self.gl;
        gl.depth_mask(true);
        gl.clear_depth(1.0);
        gl.clear(Gl::DEPTH_BUFFER_BIT);
        gl.enable(Gl::DEPTH_TEST);
        gl.depth_func(Gl::LEQUAL);
        gl.enable(Gl::POLYGON_OFFSET_FILL);
        gl.polygon_offset(1.0, 1.0);
        self.begin(&self.shape, matrix, look);
        let at = |name: &str| gl.get_uniform_location(&self.shape, name);
        gl.uniform_matrix3fv_with_f32_array(at("u_turn").as_ref(), false, &turn.to_cols_array());
        gl.uniform1f(at("u_squares").as_ref(), squares);
        gl.uniform1f(at("u_tint").as_ref(), look.tint);
        self.colour(&self.shape, "u_check_light", look.theme.check_light);
        self.colour(&self.shape, "u_check_dark", look.theme.check_dark);
        gl.bind_vertex_array(Some(&self.triangles));
        gl.draw_arrays(Gl::TRIANGLES, 0, self.corners);
        gl.disable(Gl::POLYGON_OFFSET_FILL);
        let edge = if look.theme.dark {
            look.theme.ink
        } else {
            look.theme.outline
        };
        self.lines(&self.seam, 0, self.seam_count, matrix, edge, 0.8);
        gl.disable(Gl::DEPTH_TEST);
        self.end();
    }

    /// Draws the map into the current viewport, inverted triangles last.
    pub fn draw_map(&self, matrix: Mat4, look: Look) {
        let own = (&self.triangles, self.painted_corners);
        self.draw_triangles(own, (&self.outline, self.boundary_count), matrix, look);
    }

    /// Draws one of the maps shown side by side.
    pub fn draw_pane(&self, index: usize, matrix: Mat4, look: Look) {
        if let Some(pane) = self.panes.get(index) {
            let triangles = (&pane.triangles, pane.painted_corners);
            self.draw_triangles(
                triangles,
                (&pane.outline, pane.boundary_count),
                matrix,
                look,
            );
        }
    }

    fn draw_triangles(
        &self,
        triangles: (&WebGlVertexArrayObject, i32),
        outline: (&WebGlVertexArrayObject, i32),
        matrix: Mat4,
        look: Look,
    ) {
        let gl = &self.gl;
        gl.disable(Gl::DEPTH_TEST);
        self.begin(&self.map, matrix, look);
        gl.bind_vertex_array(Some(triangles.0));
        gl.draw_elements_with_i32(Gl::TRIANGLES, triangles.1, Gl::UNSIGNED_INT, 0);
        let edge = if look.theme.dark {
            look.theme.ink
        } else {
            look.theme.outline
        };
        self.lines(outline.0, 0, outline.1, matrix, edge, 0.8);
        self.end();
    }

    fn begin(&self, program: &WebGlProgram, matrix: Mat4, look: Look) {
        let gl = &self.gl;
        gl.use_program(Some(program));
        gl.active_texture(Gl::TEXTURE0);
        gl.bind_texture(Gl::TEXTURE_2D, Some(&self.ramp));
        let at = |name: &str| gl.get_uniform_location(program, name);
        gl.uniform1i(at("u_ramp").as_ref(), 0);
        gl.uniform_matrix4fv_with_f32_array(
            at("u_matrix").as_ref(),
            false,
            &matrix.to_cols_array(),
        );
        gl.uniform1f(at("u_end").as_ref(), colour::DISTORTION_END.ln() as f32);
        gl.uniform1f(at("u_pixel").as_ref(), look.pixel);
        gl.uniform1f(
            at("u_wire").as_ref(),
            if look.wireframe { 0.55 } else { 0.0 },
        );
        gl.uniform1i(at("u_hover").as_ref(), look.hover.map_or(-1, |t| t as i32));
        self.colour(program, "u_accent", look.theme.accent);
        self.colour(program, "u_outline", look.theme.outline);
        self.colour(program, "u_vermilion", colour::VERMILION);
    }

    fn lines(
        &self,
        array: &WebGlVertexArrayObject,
        first: i32,
        count: i32,
        matrix: Mat4,
        colour: Rgb,
        opacity: f32,
    ) {
        if count <= 0 {
            return;
        }
        let gl = &self.gl;
        gl.use_program(Some(&self.line));
        let at = |name: &str| gl.get_uniform_location(&self.line, name);
        gl.uniform_matrix4fv_with_f32_array(
            at("u_matrix").as_ref(),
            false,
            &matrix.to_cols_array(),
        );
        let [r, g, b] = colour.map(|c| f32::from(c) / 255.0);
        gl.uniform4f(at("u_colour").as_ref(), r, g, b, opacity);
        gl.bind_vertex_array(Some(array));
        gl.draw_arrays(Gl::LINES, first, count);
    }

    fn colour(&self, program: &WebGlProgram, name: &str, colour: Rgb) {
        let [r, g, b] = colour.map(|c| f32::from(c) / 255.0);
        self.gl.uniform3f(
            self.gl.get_uniform_location(program, name).as_ref(),
            r,
            g,
            b,
        );
    }

    fn end(&self) {
        self.gl.bind_vertex_array(None);
        self.gl.use_program(None);
    }
}

fn program(gl: &Gl, vertex: &str, fragment: &str) -> Result<WebGlProgram, JsValue> {
    let program = gl
        .create_program()
        .ok_or_else(|| JsValue::from_str("WebGL is out of memory"))?;
    for (kind, source) in [(Gl::VERTEX_SHADER, vertex), (Gl::FRAGMENT_SHADER, fragment)] {
        let shader = gl
            .create_shader(kind)
            .ok_or_else(|| JsValue::from_str("WebGL is out of memory"))?;
        gl.shader_source(&shader, source);
        gl.compile_shader(&shader);
        if !gl
            .get_shader_parameter(&shader, Gl::COMPILE_STATUS)
            .is_truthy()
        {
            return Err(JsValue::from_str(
                &gl.get_shader_info_log(&shader).unwrap_or_default(),
            ));
        }
        gl.attach_shader(&program, &shader);
        gl.delete_shader(Some(&shader));
    }
    gl.link_program(&program);
    if !gl
        .get_program_parameter(&program, Gl::LINK_STATUS)
        .is_truthy()
    {
        return Err(JsValue::from_str(
            &gl.get_program_info_log(&program).unwrap_or_default(),
        ));
    }
    Ok(program)
}
