//! The forms of mesh files that the library reads and does not write, written plainly: binary files of
//! both byte orders, newer and older versions, nodes with tags that have gaps.
#![allow(dead_code)]

use foldfree::mesh::io::{Format, write, write_solid};
use foldfree::mesh::{SolidMesh, SurfaceMesh};
use glam::DVec3;
use std::fmt::Write;

/// Triangles and tetrahedra on common vertices.
#[derive(Debug, Clone, Default)]
pub struct Mixed {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub tetrahedra: Vec<[u32; 4]>,
}

impl Mixed {
    pub fn surface(&self) -> SurfaceMesh {
        SurfaceMesh {
            positions: self.positions.clone(),
            simplices: self.triangles.clone(),
        }
    }

    pub fn solid(&self) -> SolidMesh {
        SolidMesh {
            positions: self.positions.clone(),
            simplices: self.tetrahedra.clone(),
        }
    }
}

/// A block of n³ cells of six tetrahedra each, and its boundary.
pub fn block(n: u32) -> Mixed {
    let vertex = |x: u32, y: u32, z: u32| x + (n + 1) * (y + (n + 1) * z);
    let mut solid = SolidMesh::default();
    for z in 0..=n {
        for y in 0..=n {
            for x in 0..=n {
                let p = DVec3::new(x.into(), y.into(), z.into());
                solid.positions.push(p * 0.3 + DVec3::new(-0.1, 1e-3, 1e6));
            }
        }
    }
    for z in 0..n {
        for y in 0..n {
            for x in 0..n {
                // Kuhn's six tetrahedra along the diagonal.
                for [i, j, k] in [
                    [0, 1, 2],
                    [1, 2, 0],
                    [2, 0, 1],
                    [0, 2, 1],
                    [2, 1, 0],
                    [1, 0, 2],
                ] {
                    let mut at = [x, y, z];
                    let mut corners = vec![vertex(at[0], at[1], at[2])];
                    for axis in [i, j, k] {
                        at[axis] += 1;
                        corners.push(vertex(at[0], at[1], at[2]));
                    }
                    let even = (j + 3 - i) % 3 == 1;
                    let [a, b, c, d] = [corners[0], corners[1], corners[2], corners[3]];
                    solid
                        .simplices
                        .push(if even { [a, b, c, d] } else { [a, c, b, d] });
                }
            }
        }
    }
    let boundary = solid.boundary().unwrap();
    let to_solid = |t: &[u32; 3]| t.map(|v| boundary.vertices[v as usize]);
    Mixed {
        triangles: boundary.mesh.simplices.iter().map(to_solid).collect(),
        positions: solid.positions,
        tetrahedra: solid.simplices,
    }
}

/// Numbers of either byte order.
pub struct Bytes {
    pub out: Vec<u8>,
    pub big: bool,
}

impl Bytes {
    pub fn new(big: bool, text: &str) -> Self {
        let out = text.as_bytes().to_vec();
        Self { out, big }
    }
    pub fn text(&mut self, text: &str) {
        self.out.extend_from_slice(text.as_bytes());
    }
    fn push<const N: usize>(&mut self, mut little: [u8; N]) {
        if self.big {
            little.reverse();
        }
        self.out.extend_from_slice(&little);
    }
    pub fn i32(&mut self, value: i32) {
        self.push(value.to_le_bytes());
    }
    pub fn u64(&mut self, value: u64) {
        self.push(value.to_le_bytes());
    }
    pub fn f32(&mut self, value: f32) {
        self.push(value.to_le_bytes());
    }
    pub fn f64(&mut self, value: f64) {
        self.push(value.to_le_bytes());
    }
    pub fn point(&mut self, point: DVec3) {
        point.to_array().into_iter().for_each(|c| self.f64(c));
    }
}

/// A PLY file with properties and elements that nobody asked for.
pub fn ply(mesh: &Mixed, big: bool) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut b = Bytes::new(
        big,
        &format!(
            "ply\nformat binary_{order}_endian 1.0\ncomment x y z\nobj_info # none\n\
             element camera 2\nproperty list uchar short rays\nproperty float fov\n\
             element vertex {}\nproperty float confidence\nproperty double z\nproperty uchar red\n\
             property double x\nproperty double y\nproperty list int uchar hair\n\
             element face {}\nproperty uchar kind\nproperty list uchar int vertex_indices\n\
             property list ushort float weights\nelement nothing 99999999999\nend_header\n",
            mesh.positions.len(),
            mesh.triangles.len()
        ),
    );
    for _ in 0..2 {
        b.out.extend_from_slice(&[3, 0, 1, 0, 2, 0, 3]);
        b.f32(1.5);
    }
    for p in &mesh.positions {
        b.f32(f32::NAN);
        b.f64(p.z);
        b.out.push(b'\n');
        b.f64(p.x);
        b.f64(p.y);
        b.i32(2);
        b.out.extend_from_slice(&[13, 10]);
    }
    for t in &mesh.triangles {
        b.out.extend_from_slice(&[7, 3]);
        t.iter().for_each(|&v| b.i32(v as i32));
        b.push(1u16.to_le_bytes());
        b.f32(0.5);
    }
    b.out
}

/// A binary STL file; coordinates lose digits.
pub fn stl(mesh: &Mixed) -> Vec<u8> {
    let mut b = Bytes::new(false, &format!("{:80}", "solid in name only"));
    b.i32(mesh.triangles.len() as i32);
    for t in &mesh.triangles {
        (0..3).for_each(|_| b.f32(f32::NAN));
        for &v in t {
            let p = mesh.positions[v as usize];
            p.to_array().into_iter().for_each(|c| b.f32(c as f32));
        }
        b.out.extend_from_slice(&[0, 0]);
    }
    b.out
}

/// A binary VTK file of both kinds of cells, in the older form or that of version 5.
pub fn vtk(mesh: &Mixed, five: bool) -> Vec<u8> {
    let version = if five { "5.1" } else { "3.0" };
    let mut b = Bytes::new(
        true,
        &format!(
            "# vtk DataFile Version {version}\na title: CELLS 7\nBINARY\n\
             DATASET UNSTRUCTURED_GRID\nFIELD FieldData 1\nTIME 1 1 double\n"
        ),
    );
    b.f64(0.25);
    b.text(&format!("\nPOINTS {} double\n", mesh.positions.len()));
    mesh.positions.iter().for_each(|&p| b.point(p));
    let cells: Vec<(&[u32], i32)> = (mesh.triangles.iter().map(|t| (&t[..], 5)))
        .chain(mesh.tetrahedra.iter().map(|t| (&t[..], 10)))
        .chain([(&[0][..], 1), (&[0, 1][..], 3)])
        .collect();
    let numbers: usize = cells.iter().map(|c| c.0.len()).sum();
    if five {
        b.text("\nMETADATA\nINFORMATION 0\n\n");
        b.text(&format!(
            "CELLS {} {numbers}\nOFFSETS vtktypeint64\n",
            cells.len() + 1
        ));
        let mut offset = 0;
        b.u64(0);
        for (cell, _) in &cells {
            offset += cell.len() as u64;
            b.u64(offset);
        }
        b.text("\nCONNECTIVITY vtktypeint64\n");
        cells
            .iter()
            .flat_map(|c| c.0)
            .for_each(|&v| b.u64(v.into()));
    } else {
        b.text(&format!(
            "\nCELLS {} {}\n",
            cells.len(),
            numbers + cells.len()
        ));
        for (cell, _) in &cells {
            b.i32(cell.len() as i32);
            cell.iter().for_each(|&v| b.i32(v as i32));
        }
    }
    b.text(&format!("\nCELL_TYPES {}\n", cells.len()));
    cells.iter().for_each(|c| b.i32(c.1));
    b.text(&format!(
        "\nPOINT_DATA {}\nSCALARS s double 1\n",
        mesh.positions.len()
    ));
    b.out
}

/// The tag of a node: descending, with gaps.
fn tag(vertex: usize) -> u64 {
    1_000_003 - 7 * vertex as u64
}

/// Type and nodes of all elements: a point, a line, triangles, tetrahedra.
fn elements(mesh: &Mixed) -> Vec<(i32, Vec<u64>)> {
    let tags = |vertices: &[u32]| vertices.iter().map(|&v| tag(v as usize)).collect();
    let mut all: Vec<(i32, Vec<u64>)> = vec![(15, tags(&[0])), (1, tags(&[0, 1]))];
    all.extend(mesh.triangles.iter().map(|t| (2, tags(t))));
    all.extend(mesh.tetrahedra.iter().map(|t| (4, tags(t))));
    all
}

/// A binary MSH file of version 2.2.
pub fn msh2(mesh: &Mixed, big: bool) -> Vec<u8> {
    let mut b = Bytes::new(big, "$MeshFormat\n2.2 1 8\n");
    b.i32(1);
    b.text("\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"\n$EndPhysicalNames\n");
    b.text(&format!("$Nodes\n{}\n", mesh.positions.len()));
    for (vertex, &p) in mesh.positions.iter().enumerate() {
        b.i32(tag(vertex) as i32);
        b.point(p);
    }
    let elements = elements(mesh);
    b.text(&format!("\n$EndNodes\n$Elements\n{}\n", elements.len()));
    let mut number = 0;
    for run in elements.chunk_by(|a, b| a.0 == b.0) {
        b.i32(run[0].0);
        b.i32(run.len() as i32);
        b.i32(2);
        for (_, nodes) in run {
            number += 1;
            b.i32(number);
            b.i32(1);
            b.i32(1);
            nodes.iter().for_each(|&n| b.i32(n as i32));
        }
    }
    b.text("\n$EndElements\n");
    b.out
}

/// The two blocks of version 4.1 that the nodes are in.
fn node_blocks(mesh: &Mixed) -> [std::ops::Range<usize>; 2] {
    let middle = mesh.positions.len() / 3;
    [0..middle, middle..mesh.positions.len()]
}

/// A binary MSH file of version 4.1, its first nodes with parameters.
pub fn msh4(mesh: &Mixed, big: bool) -> Vec<u8> {
    let mut b = Bytes::new(big, "$MeshFormat\n4.1 1 8\n");
    b.i32(1);
    b.text("\n$EndMeshFormat\n$Entities\n");
    (0..4).for_each(|_| b.u64(0));
    b.text("\n$EndEntities\n$Nodes\n");
    [2, mesh.positions.len() as u64, 1, 1_000_003]
        .into_iter()
        .for_each(|n| b.u64(n));
    for (number, block) in node_blocks(mesh).into_iter().enumerate() {
        let parametric = number == 0;
        b.i32(2);
        b.i32(-4);
        b.i32(parametric.into());
        b.u64(block.len() as u64);
        block.clone().for_each(|v| b.u64(tag(v)));
        for v in block {
            b.point(mesh.positions[v]);
            if parametric {
                b.f64(f64::NAN);
                b.f64(0.5);
            }
        }
    }
    b.text("\n$EndNodes\n$Elements\n");
    let elements = elements(mesh);
    let runs: Vec<_> = elements.chunk_by(|a, b| a.0 == b.0).collect();
    [runs.len(), elements.len(), 1, elements.len()]
        .into_iter()
        .for_each(|n| b.u64(n as u64));
    let mut number = 0;
    for run in runs {
        b.i32(2);
        b.i32(1);
        b.i32(run[0].0);
        b.u64(run.len() as u64);
        for (_, nodes) in run {
            number += 1;
            b.u64(number);
            nodes.iter().for_each(|&n| b.u64(n));
        }
    }
    b.text("\n$EndElements\n");
    b.out
}

/// The same as text.
pub fn msh4_text(mesh: &Mixed) -> Vec<u8> {
    let mut out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n".to_string();
    writeln!(out, "2 {} 1 1000003", mesh.positions.len()).unwrap();
    for (number, block) in node_blocks(mesh).into_iter().enumerate() {
        let parametric = usize::from(number == 0);
        writeln!(out, "2 -4 {parametric} {}", block.len()).unwrap();
        block
            .clone()
            .for_each(|v| writeln!(out, "{}", tag(v)).unwrap());
        for v in block {
            let [x, y, z] = mesh.positions[v].to_array();
            let behind = if parametric == 1 { " 0.5 0.25" } else { "" };
            writeln!(out, "{x:e} {y:e} {z:e}{behind}").unwrap();
        }
    }
    let elements = elements(mesh);
    let runs: Vec<_> = elements.chunk_by(|a, b| a.0 == b.0).collect();
    let n = elements.len();
    writeln!(out, "$EndNodes\n$Elements\n{} {n} 1 {n}", runs.len()).unwrap();
    for run in runs {
        writeln!(out, "2 1 {} {}", run[0].0, run.len()).unwrap();
        for (_, nodes) in run {
            let nodes: Vec<String> = nodes.iter().map(u64::to_string).collect();
            writeln!(out, "1 {}", nodes.join(" ")).unwrap();
        }
    }
    writeln!(out, "$EndElements").unwrap();
    out.into_bytes()
}

/// A MEDIT file of both kinds of elements.
pub fn medit(mesh: &Mixed) -> Vec<u8> {
    let mut out = "# a comment\nMeshVersionFormatted\n2\n\nDimension\n3 # of space\n".to_string();
    writeln!(out, "Vertices {}", mesh.positions.len()).unwrap();
    for p in &mesh.positions {
        writeln!(out, "\t{:e}  {:?} {} 7", p.x, p.y, p.z).unwrap();
    }
    writeln!(out, "Corners\n2\n1\n2\nEdges 1\n1 2 0").unwrap();
    writeln!(out, "Triangles\n{}", mesh.triangles.len()).unwrap();
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| v + 1)) {
        writeln!(out, "{a} {b} {c}").unwrap();
    }
    writeln!(out, "Tetrahedra\n{}", mesh.tetrahedra.len()).unwrap();
    for [a, b, c, d] in mesh.tetrahedra.iter().map(|t| t.map(|v| v + 1)) {
        writeln!(out, "{a} {b} {c} {d} 3").unwrap();
    }
    writeln!(out, "End").unwrap();
    out.into_bytes()
}

/// A file and what it is.
pub struct Sample {
    pub name: &'static str,
    pub format: Format,
    pub bytes: Vec<u8>,
}

/// The mesh in every form that holds its elements and all digits.
pub fn samples(mesh: &Mixed) -> Vec<Sample> {
    let sample = |name, format, bytes| Sample {
        name,
        format,
        bytes,
    };
    let solid = |format| write_solid(&mesh.solid(), format).unwrap();
    let surface = |format| write(&mesh.surface(), format);
    vec![
        sample("obj", Format::Obj, surface(Format::Obj)),
        sample("off", Format::Off, surface(Format::Off)),
        sample("ply", Format::Ply, surface(Format::Ply)),
        sample("stl", Format::Stl, surface(Format::Stl)),
        sample("surface mesh", Format::Medit, surface(Format::Medit)),
        sample("surface msh", Format::Msh, surface(Format::Msh)),
        sample("surface vtk", Format::Vtk, surface(Format::Vtk)),
        sample("solid mesh", Format::Medit, solid(Format::Medit)),
        sample("solid msh", Format::Msh, solid(Format::Msh)),
        sample("solid vtk", Format::Vtk, solid(Format::Vtk)),
        sample("little ply", Format::Ply, ply(mesh, false)),
        sample("big ply", Format::Ply, ply(mesh, true)),
        sample("binary stl", Format::Stl, stl(mesh)),
        sample("mixed vtk 3", Format::Vtk, vtk(mesh, false)),
        sample("mixed vtk 5", Format::Vtk, vtk(mesh, true)),
        sample("mixed msh 2 little", Format::Msh, msh2(mesh, false)),
        sample("mixed msh 2 big", Format::Msh, msh2(mesh, true)),
        sample("mixed msh 4 little", Format::Msh, msh4(mesh, false)),
        sample("mixed msh 4 big", Format::Msh, msh4(mesh, true)),
        sample("mixed msh 4 text", Format::Msh, msh4_text(mesh)),
        sample("mixed mesh", Format::Medit, medit(mesh)),
    ]
}
