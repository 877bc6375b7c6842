//! Solids: skin, inverted tetrahedra, cut faces.

use glam::{Mat3, Mat4, Vec4};
use wasm_bindgen::JsValue;
use web_sys::{WebGl2RenderingContext as Gl, WebGlBuffer, WebGlProgram, WebGlVertexArrayObject};

use super::{Gpu, Look, program};
use crate::solid::slice::{Corner, Plane};

/// Floats a corner has.
const WIDTH: i32 = 5;

/// Triangles that are written anew with every iterate.
struct Batch {
    array: WebGlVertexArrayObject,
    buffer: WebGlBuffer,
    count: i32,
}

/// The program and buffers of solids.
pub struct SolidGpu {
    program: WebGlProgram,
    skin: Batch,
    inverted: Batch,
    cut: Batch,
    cut_upright: i32,
    creases: Batch,
}

/// The iterate on show, as the GPU takes it.
pub struct SolidData<'a> {
    /// Triangles of the skin.
    pub skin: &'a [Corner],
    /// All faces of the inverted tetrahedra.
    pub inverted: &'a [Corner],
    /// Sharp edges: x y z x y z.
    pub creases: &'a [f32],
}

/// How a solid is drawn, beyond what all views share.
#[derive(Clone, Copy)]
pub struct SolidLook {
    /// Model to clip space.
    pub matrix: Mat4,
    /// Model to view rotation.
    pub turn: Mat3,
    /// Radius of the solid.
    pub radius: f32,
    /// Which ramp: 0 cividis, 1 diverging, 2 zones.
    pub row: f32,
    /// How much of the field's colour the skin takes, 0–1.
    pub tint: f32,
    /// The plane that cuts it open.
    pub plane: Option<Plane>,
}

impl SolidGpu {
    pub(super) fn new(gl: &Gl, common: &str) -> Result<Self, JsValue> {
        let missing = || JsValue::from_str("WebGL is out of memory");
        let batch = |widths: &[i32]| -> Result<Batch, JsValue> {
            let array = gl.create_vertex_array().ok_or_else(missing)?;
            let buffer = gl.create_buffer().ok_or_else(missing)?;
            gl.bind_vertex_array(Some(&array));
            gl.bind_buffer(Gl::ARRAY_BUFFER, Some(&buffer));
            let stride = 4 * widths.iter().sum::<i32>();
            let mut at = 0;
            for (location, &width) in (0u32..).zip(widths) {
                gl.enable_vertex_attrib_array(location);
                gl.vertex_attrib_pointer_with_i32(location, width, Gl::FLOAT, false, stride, at);
                at += 4 * width;
            }
            gl.bind_vertex_array(None);
            Ok(Batch {
                array,
                buffer,
                count: 0,
            })
        };
        let corners = [3, WIDTH - 3];
        Ok(Self {
            program: program(
                gl,
                include_str!("../shaders/solid.vert"),
                &format!(
                    "#version 300 es\n{common}\n{}",
                    include_str!("../shaders/solid.frag")
                ),
            )?,
            skin: batch(&corners)?,
            inverted: batch(&corners)?,
            cut: batch(&corners)?,
            cut_upright: 0,
            creases: batch(&[3])?,
        })
    }
}

fn upload(gl: &Gl, batch: &mut Batch, floats: &[f32], width: i32) {
    gl.bind_buffer(Gl::ARRAY_BUFFER, Some(&batch.buffer));
    gl.buffer_data_with_u8_array(
        Gl::ARRAY_BUFFER,
        bytemuck::cast_slice(floats),
        Gl::DYNAMIC_DRAW,
    );
    batch.count = floats.len() as i32 / width;
}

impl Gpu {
    /// Uploads the iterate to show.
    pub fn set_solid(&mut self, data: &SolidData<'_>) {
        let solid = &mut self.solid;
        upload(&self.gl, &mut solid.skin, data.skin.as_flattened(), WIDTH);
        upload(
            &self.gl,
            &mut solid.inverted,
            data.inverted.as_flattened(),
            WIDTH,
        );
        upload(&self.gl, &mut solid.creases, data.creases, 3);
    }

    /// Uploads the cut faces, the first `upright` corners of which belong to upright tetrahedra.
    pub fn set_cut(&mut self, corners: &[Corner], upright: usize) {
        upload(&self.gl, &mut self.solid.cut, corners.as_flattened(), WIDTH);
        self.solid.cut_upright = upright as i32;
    }

    /// Draws the translucent skin with the inverted tetrahedra inside into the current viewport.
    pub fn draw_skin(&self, solid: SolidLook, look: Look) {
        let gl = &self.gl;
        self.open(solid, look);
        self.paint(solid.tint, 1.0, 1.0, 0.0);
        gl.enable(Gl::POLYGON_OFFSET_FILL);
        gl.polygon_offset(1.0, 1.0);
        self.triangles(&self.solid.inverted, 0, self.solid.inverted.count);
        // All layers of the skin, faintly; then the nearest one, found by its depth, on top.
        let thick = if solid.tint > 0.0 { 0.30 } else { 0.0 };
        gl.depth_mask(false);
        self.wire(0.0);
        self.paint(solid.tint, 0.14, 0.30, 0.0);
        self.triangles(&self.solid.skin, 0, self.solid.skin.count);
        gl.depth_mask(true);
        gl.color_mask(false, false, false, false);
        self.triangles(&self.solid.skin, 0, self.solid.skin.count);
        gl.color_mask(true, true, true, true);
        self.wire(if look.wireframe { 0.55 } else { 0.0 });
        self.paint(solid.tint, 0.34 + thick, 0.80, 0.0);
        self.triangles(&self.solid.skin, 0, self.solid.skin.count);
        gl.disable(Gl::POLYGON_OFFSET_FILL);
        self.crease_lines(solid, look, 0.55);
        gl.disable(Gl::DEPTH_TEST);
        self.crease_lines(solid, look, 0.14);
        self.end();
    }

    /// Draws triangles of a plane, those that are inverted on top.
    pub fn draw_planar(&self, solid: SolidLook, look: Look) {
        self.open(solid, look);
        self.gl.disable(Gl::DEPTH_TEST);
        self.wire(if look.wireframe { 0.75 } else { 0.30 });
        self.paint(1.0, 1.0, 0.0, 1.0);
        self.triangles(&self.solid.skin, 0, self.solid.skin.count);
        self.triangles(&self.solid.inverted, 0, self.solid.inverted.count);
        self.crease_lines(solid, look, 0.8);
        self.end();
    }

    /// Draws what is left of the solid under its plane, with the faces of the cut.
    pub fn draw_cut(&self, solid: SolidLook, look: Look) {
        let gl = &self.gl;
        self.open(solid, look);
        gl.enable(Gl::POLYGON_OFFSET_FILL);
        gl.polygon_offset(2.0, 2.0);
        self.paint(1.0, 1.0, 1.0, 0.0);
        self.triangles(&self.solid.skin, 0, self.solid.skin.count);
        if solid.plane.is_some() {
            // The faces lie in the plane itself: nothing of them may fall to rounding.
            self.plane(None);
            self.wire(if look.wireframe { 0.75 } else { 0.38 });
            self.paint(1.0, 1.0, 1.0, 1.0);
            let cut = &self.solid.cut;
            let upright = self.solid.cut_upright;
            gl.polygon_offset(1.0, 1.0);
            self.triangles(cut, 0, upright);
            gl.polygon_offset(0.0, 0.0);
            self.triangles(cut, upright, cut.count - upright);
        }
        gl.disable(Gl::POLYGON_OFFSET_FILL);
        gl.disable(Gl::DEPTH_TEST);
        self.crease_lines(solid, look, 0.22);
        self.end();
    }

    fn open(&self, solid: SolidLook, look: Look) {
        let gl = &self.gl;
        gl.depth_mask(true);
        gl.clear_depth(1.0);
        gl.clear(Gl::DEPTH_BUFFER_BIT);
        gl.enable(Gl::DEPTH_TEST);
        gl.depth_func(Gl::LEQUAL);
        self.begin(&self.solid.program, solid.matrix, look);
        let at = |name: &str| gl.get_uniform_location(&self.solid.program, name);
        gl.uniform_matrix3fv_with_f32_array(
            at("u_turn").as_ref(),
            false,
            &solid.turn.to_cols_array(),
        );
        gl.uniform1f(at("u_scale").as_ref(), 1.0 / solid.radius);
        gl.uniform1f(at("u_row").as_ref(), solid.row);
        self.colour(&self.solid.program, "u_skin", look.theme.skin);
        self.plane(solid.plane);
    }

    /// What lies above the plane is left out from now on.
    fn plane(&self, plane: Option<Plane>) {
        let p = plane.map_or(Vec4::W, |p| p.normal.extend(p.offset));
        let at = self.gl.get_uniform_location(&self.solid.program, "u_plane");
        self.gl.uniform4f(at.as_ref(), p.x, p.y, p.z, p.w);
    }

    fn wire(&self, opacity: f32) {
        let at = self.gl.get_uniform_location(&self.solid.program, "u_wire");
        self.gl.uniform1f(at.as_ref(), opacity);
    }

    fn paint(&self, tint: f32, opacity: f32, rim: f32, flat: f32) {
        for (name, value) in [
            ("u_tint", tint),
            ("u_opacity", opacity),
            ("u_rim", rim),
            ("u_flat", flat),
        ] {
            let at = self.gl.get_uniform_location(&self.solid.program, name);
            self.gl.uniform1f(at.as_ref(), value);
        }
    }

    fn triangles(&self, batch: &Batch, first: i32, count: i32) {
        if count > 0 {
            self.gl.bind_vertex_array(Some(&batch.array));
            self.gl.draw_arrays(Gl::TRIANGLES, first, count);
        }
    }

    fn crease_lines(&self, solid: SolidLook, look: Look, opacity: f32) {
        let edge = if look.theme.dark {
            look.theme.ink
        } else {
            look.theme.outline
        };
        let creases = &self.solid.creases;
        self.lines(
            &creases.array,
            0,
            creases.count,
            solid.matrix,
            edge,
            opacity,
        );
    }
}
