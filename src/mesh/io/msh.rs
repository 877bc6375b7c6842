//! MSH (Gmsh) of the versions 2.2 and 4.1, as text and binary of either byte order: nodes, triangles,
//! quadrangles and tetrahedra; other elements and sections are passed over.

use super::contents::Contents;
use super::scan::quote;
use super::values::{Encoding, Scalar, Values};
use super::write::{Elements, Line};
use super::{ParseError, ParseErrorKind};
use std::io::Write;

/// Bytes of `$End` and the name of a section that is passed over: the search for the end compares so many
/// at every byte.
const LONGEST_NAME: usize = 64;

/// Nodes of an element by its type, from 0 on; 0: not known.
#[rustfmt::skip]
const NODES: [u8; 32] = [
    0, 2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1,
    8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56,
];

/// Nodes of an element of this type; `None`: not known.
fn nodes_of(kind: u64) -> Option<usize> {
    let known = NODES.get(usize::try_from(kind).ok()?)?;
    (*known > 0).then_some(usize::from(*known))
}

/// A file that is being read.
struct Reader<'a> {
    values: Values<'a>,
    /// How the data of the sections are stored.
    data: Encoding,
    /// Version 4.1, not 2.2.
    blocks: bool,
    contents: Contents,
    /// Tag and index of every node, in the order of the tags.
    tags: Vec<(u64, u32)>,
    has_nodes: bool,
}

pub(super) fn read(bytes: &[u8]) -> Result<Contents, ParseError> {
    let mut reader = Reader {
        values: Values::new(bytes),
        data: Encoding::Text { lines: true },
        blocks: false,
        contents: Contents::default(),
        tags: Vec::new(),
        has_nodes: false,
    };
    reader.sections()?;
    if !reader.has_nodes {
        return Err(reader.values.scanner.ends("the file has no section $Nodes"));
    }
    Ok(reader.contents)
}

impl Reader<'_> {
    fn sections(&mut self) -> Result<(), ParseError> {
        let mut has_format = false;
        loop {
            self.values.start_item();
            let Some(token) = self.values.scanner.token() else {
                return Ok(());
            };
            let Some(name) = token.text.strip_prefix(b"$") else {
                let what = format!(
                    "expected a section such as $Nodes, found {}",
                    quote(token.text)
                );
                return Err(self.values.error(ParseErrorKind::Syntax, what));
            };
            self.values.scanner.skip_line();
            let mut own = true;
            match name {
                b"MeshFormat" => {
                    self.format()?;
                    has_format = true;
                }
                b"NOD" | b"ELM" => {
                    let what = "MSH of version 1 is not read (2.2 and 4.1 are)";
                    return Err(self.values.error(ParseErrorKind::Unsupported, what));
                }
                b"Nodes" | b"Elements" if !has_format => {
                    let what = "the file does not begin with $MeshFormat";
                    return Err(self.values.error(ParseErrorKind::Syntax, what));
                }
                b"Nodes" if self.has_nodes => {
                    let what = "the nodes are there twice";
                    return Err(self.values.error(ParseErrorKind::Syntax, what));
                }
                b"Elements" if !self.has_nodes => {
                    let what = "the elements come before the nodes";
                    return Err(self.values.error(ParseErrorKind::Unsupported, what));
                }
                b"Nodes" => {
                    self.in_data(Self::nodes)?;
                    self.has_nodes = true;
                }
                b"Elements" => self.in_data(Self::elements)?,
                _ => own = false,
            }
            self.end(name, own)?;
        }
    }

    /// Reads what is stored as the file says.
    fn in_data(
        &mut self,
        read: impl Fn(&mut Self) -> Result<(), ParseError>,
    ) -> Result<(), ParseError> {
        let text = self.values.encoding;
        // The counts of version 2.2 are text even there.
        if self.blocks {
            self.values.encoding = self.data;
        }
        read(self)?;
        self.values.encoding = text;
        Ok(())
    }

    /// The end of a section: right here if the section was `own`, else anywhere.
    fn end(&mut self, name: &[u8], own: bool) -> Result<(), ParseError> {
        let end = [b"$End", name].concat();
        if own {
            self.values.start_item();
            let token = self.values.scanner.token();
            let found = token.is_some_and(|t| t.text == end);
            if let (Some(token), false) = (token, found) {
                let what = format!("expected {}, found {}", quote(&end), quote(token.text));
                return Err(self.values.error(ParseErrorKind::Syntax, what));
            }
            if found {
                self.values.scanner.skip_line();
                return Ok(());
            }
        } else if end.len() > LONGEST_NAME {
            let what = "the name of a section has more than 60 letters".to_string();
            return Err(self.values.error(ParseErrorKind::Syntax, what));
        } else if self.values.scanner.skip_past(&end).is_some() {
            self.values.scanner.skip_line();
            return Ok(());
        }
        let what = format!("section {} does not end", quote(&end[4..]));
        Err(self.values.error(ParseErrorKind::Truncated, what))
    }

    fn format(&mut self) -> Result<(), ParseError> {
        self.values.start_item();
        let Some(version) = self.values.scanner.token() else {
            return Err(self.values.scanner.ends("the version is missing"));
        };
        self.blocks = match version.text {
            b"2" | b"2.0" | b"2.1" | b"2.2" => false,
            b"4.1" => true,
            other => {
                let what = format!(
                    "MSH of version {} is not read (2.2 and 4.1 are)",
                    quote(other)
                );
                return Err(self.values.error(ParseErrorKind::Unsupported, what));
            }
        };
        let binary = self.values.count(Scalar::I32, "the file type")?;
        let size = self.values.count(Scalar::I32, "the size of the data")?;
        self.values.end_item();
        match (binary, size) {
            (0, _) => return Ok(()),
            (1, 8) => {}
            (1, _) => {
                let what = format!("binary data of size {size} are not read, only of size 8");
                return Err(self.values.error(ParseErrorKind::Unsupported, what));
            }
            _ => {
                let what = format!("the file type is {binary}, not 0 (text) or 1 (binary)");
                return Err(self.values.error(ParseErrorKind::Syntax, what));
            }
        }
        self.data = match self.values.scanner.take(4) {
            Some([1, 0, 0, 0]) => Encoding::Binary { big_endian: false },
            Some([0, 0, 0, 1]) => Encoding::Binary { big_endian: true },
            _ => {
                let what = "the number 1 that tells the byte order is missing";
                return Err(self.values.error(ParseErrorKind::Syntax, what));
            }
        };
        Ok(())
    }

    fn nodes(&mut self) -> Result<(), ParseError> {
        let mut tags: Vec<u64> = Vec::new();
        if self.blocks {
            let blocks = self.block_header()?;
            for _ in 0..blocks {
                self.node_block(&mut tags)?;
            }
        } else {
            self.values.start_item();
            let claimed = self.values.count(Scalar::I32, "the number of nodes")?;
            self.values.end_item();
            self.values.encoding = self.data;
            let count = self.values.check_claim(claimed, "nodes", 8, 28)?;
            tags.reserve_exact(count);
            self.contents.positions.reserve_exact(count);
            for number in 0..count {
                self.values.start_item();
                let tag = self.values.count(Scalar::I32, "the tag of a node");
                tags.push(tag.map_err(|e| e.within("node", number))?);
                self.position(0).map_err(|e| e.within("node", number))?;
            }
        }
        self.tags = tags.iter().copied().zip(0..).collect();
        self.tags.sort_unstable();
        match self.tags.array_windows().find(|[a, b]| a.0 == b.0) {
            Some([(tag, _), _]) => {
                let what = format!("node {tag} is there twice");
                Err(self.values.error(ParseErrorKind::Syntax, what))
            }
            None => Ok(()),
        }
    }

    /// The coordinates of a node, which may have parameters behind them.
    fn position(&mut self, parameters: u64) -> Result<(), ParseError> {
        let point = self.values.point(Scalar::F64, 3)?;
        self.contents.positions.push(point);
        self.values
            .skip(Scalar::F64, parameters, "a parameter of a node")?;
        self.values.end_item();
        Ok(())
    }

    /// The counts at the start of a section of version 4.1: the number of its blocks.
    fn block_header(&mut self) -> Result<u64, ParseError> {
        self.values.start_item();
        let blocks = self.values.count(Scalar::U64, "the number of blocks")?;
        for what in ["the number of items", "the least tag", "the greatest tag"] {
            self.values.count(Scalar::U64, what)?;
        }
        self.values.end_item();
        Ok(blocks)
    }

    /// The start of a block: the dimension of its entity, and the number behind the entity's tag.
    fn block_start(&mut self, what: &str) -> Result<[u64; 2], ParseError> {
        self.values.start_item();
        let dimension = self
            .values
            .count(Scalar::I32, "the dimension of an entity")?;
        self.values.integer(Scalar::I32, "the tag of an entity")?;
        Ok([dimension, self.values.count(Scalar::I32, what)?])
    }

    fn node_block(&mut self, tags: &mut Vec<u64>) -> Result<(), ParseError> {
        let [dimension, parametric] = self.block_start("whether nodes have parameters")?;
        let count = self.values.claim(Scalar::U64, "nodes", 8, 32)?;
        self.values.end_item();
        if parametric > 1 || dimension > 3 {
            let what = "a block of nodes of an unknown kind";
            return Err(self.values.error(ParseErrorKind::Unsupported, what));
        }
        tags.reserve(count);
        for _ in 0..count {
            self.values.start_item();
            tags.push(self.values.count(Scalar::U64, "the tag of a node")?);
            self.values.end_item();
        }
        self.contents.positions.reserve(count);
        for _ in 0..count {
            self.values.start_item();
            let number = self.contents.positions.len();
            self.position(parametric * dimension)
                .map_err(|e| e.within("node", number))?;
        }
        Ok(())
    }

    fn elements(&mut self) -> Result<(), ParseError> {
        if self.blocks {
            let blocks = self.block_header()?;
            for _ in 0..blocks {
                let [_, kind] = self.block_start("the type of the elements")?;
                let count = self.values.claim(Scalar::U64, "elements", 4, 8)?;
                self.values.end_item();
                self.element_block(kind, count, Scalar::U64, 0)?;
            }
            return Ok(());
        }
        self.values.start_item();
        let claimed = self.values.count(Scalar::I32, "the number of elements")?;
        self.values.end_item();
        self.values.encoding = self.data;
        let count = self.values.check_claim(claimed, "elements", 8, 8)?;
        if let Encoding::Text { .. } = self.data {
            for _ in 0..count {
                self.values.start_item();
                self.values.count(Scalar::I32, "the tag of an element")?;
                let kind = self.values.count(Scalar::I32, "the type of an element")?;
                let tags = self.values.count(Scalar::I32, "the number of tags")?;
                self.values.skip(Scalar::I32, tags, "a tag")?;
                self.element(kind, Scalar::I32)?;
                self.values.end_item();
            }
            return Ok(());
        }
        let mut left = count as u64;
        while left > 0 {
            let kind = self.values.count(Scalar::I32, "the type of elements")?;
            let count = self.values.count(Scalar::I32, "the number of elements")?;
            if count == 0 || count > left {
                let what = format!("a block of {count} elements where {left} are left");
                return Err(self.values.error(ParseErrorKind::Syntax, what));
            }
            let tags = self.values.count(Scalar::I32, "the number of tags")?;
            let count = self.values.check_claim(count, "elements", 4, 4)?;
            self.element_block(kind, count, Scalar::I32, tags)?;
            left -= count as u64;
        }
        Ok(())
    }

    /// Elements of one type, which begin with their tag.
    fn element_block(
        &mut self,
        kind: u64,
        count: usize,
        scalar: Scalar,
        tags: u64,
    ) -> Result<(), ParseError> {
        if matches!(self.data, Encoding::Binary { .. }) && nodes_of(kind).is_none() {
            let what = format!("elements of type {kind} have an unknown number of nodes");
            return Err(self.values.error(ParseErrorKind::Unsupported, what));
        }
        for number in 0..count {
            let within = |e: ParseError| e.within("element", number);
            self.values.start_item();
            self.values
                .count(scalar, "the tag of an element")
                .map_err(within)?;
            self.values.skip(scalar, tags, "a tag").map_err(within)?;
            self.element(kind, scalar).map_err(within)?;
            self.values.end_item();
        }
        Ok(())
    }

    /// The nodes of an element.
    fn element(&mut self, kind: u64, scalar: Scalar) -> Result<(), ParseError> {
        let size = match kind {
            2 => 3,
            3 | 4 => 4,
            _ => {
                // Points and lines bound what is read, whatever their order.
                if !matches!(kind, 1 | 8 | 15 | 26..=28) {
                    self.contents.pass(&format!("element of type {kind}"), 1);
                }
                let nodes = match self.values.encoding {
                    Encoding::Text { .. } => 0,
                    Encoding::Binary { .. } => nodes_of(kind).unwrap_or(0),
                };
                return self.values.skip(scalar, nodes as u64, "a node");
            }
        };
        let mut corners = [0; 4];
        for corner in &mut corners[..size] {
            let tag = self.values.count(scalar, "the tag of a node")?;
            *corner = self.node(tag)?;
        }
        if kind == 4 {
            self.contents.tetrahedra.push(corners);
            return Ok(());
        }
        self.contents.face(&self.values, &corners[..size])
    }

    /// The index of a node by its tag.
    #[inline]
    fn node(&self, tag: u64) -> Result<u32, ParseError> {
        // Most files number their nodes without gaps.
        let guess = self
            .tags
            .first()
            .map_or(0, |first| tag.wrapping_sub(first.0));
        if let Some(&(found, index)) = usize::try_from(guess).ok().and_then(|g| self.tags.get(g))
            && found == tag
        {
            return Ok(index);
        }
        match self.tags.binary_search_by_key(&tag, |&(tag, _)| tag) {
            Ok(at) => Ok(self.tags[at].1),
            Err(_) => {
                let what = format!("there is no node {tag}");
                Err(self.values.error(ParseErrorKind::IndexOutOfRange, what))
            }
        }
    }
}

/// Writes version 2.2 as text, which most programs read.
pub(super) fn write(mesh: Elements) -> Vec<u8> {
    let mut out = mesh.buffer();
    // Writing to a vector cannot fail.
    let _ = writeln!(
        out,
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}",
        mesh.positions.len()
    );
    let mut line = Line {
        number_from: Some(1),
        ..Line::default()
    };
    mesh.write_points(&mut out, line);
    let _ = writeln!(out, "$EndNodes\n$Elements\n{}", mesh.count());
    // The type, and two tags: a physical and an elementary entity.
    line.before = if mesh.is_solid() {
        "4 2 1 1 "
    } else {
        "2 2 1 1 "
    };
    mesh.write_elements(&mut out, 1, line);
    out.extend_from_slice(b"$EndElements\n");
    out
}
