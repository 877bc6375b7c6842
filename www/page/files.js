// Files in and out.

/** The largest file the page tries to open. */
const LARGEST = 512 * 2 ** 20;

/** A file's bytes, unpacked, and its format, one of `formats`; `kinds` says them in words. */
async function unpacked(file, formats, kinds) {
  if (file.size === 0) throw new Error('the file is empty');
  if (file.size > LARGEST) throw new Error(`the file has ${Math.round(file.size / 2 ** 20)} MB; this page opens up to 512 MB`);
  const zipped = /\.gz$/i.test(file.name);
  const extension = /\.([a-z]+)$/i.exec(file.name.replace(/\.gz$/i, ''))?.[1].toLowerCase();
  if (!formats.includes(extension)) throw new Error(`this mode reads ${kinds} files (also .gz)`);
  const stream = zipped ? file.stream().pipeThrough(new DecompressionStream('gzip')) : file.stream();
  try {
    return { format: extension, bytes: new Uint8Array(await new Response(stream).arrayBuffer()) };
  } catch {
    throw new Error(zipped ? 'the gzip file is damaged' : 'the file could not be read');
  }
}

/** Reads a surface: `{ name, format, bytes }`. */
export async function readMeshFile(file) {
  return { name: file.name, ...(await unpacked(file, ['obj', 'off', 'ply', 'stl', 'mesh', 'msh', 'vtk'], 'OBJ, OFF, PLY, STL, MESH, MSH and VTK')) };
}

/** Reads a solid: `{ name, format, bytes, elements }`; a NODE file wants its ELE file beside it. */
export async function readSolidFiles(files) {
  const kinds = 'MESH, MSH, VTK, and NODE with ELE';
  const read = await Promise.all(files.map(async (file) => ({ name: file.name, ...(await unpacked(file, ['mesh', 'msh', 'vtk', 'node', 'ele'], kinds)) })));
  const elements = read.find(({ format }) => format === 'ele');
  const first = read.find(({ format }) => format !== 'ele');
  if (!first) throw new Error('an ELE file needs its NODE file: open both together');
  if (first.format === 'node' && !elements) throw new Error('a NODE file needs its ELE file: open both together');
  return first.format === 'node' ? { ...first, elements: elements.bytes } : first;
}

/** A name that says of a file that it is where something starts. */
const STARTS = /init|start|tangled|folded/i;

/**
 * Reads what is to be untangled: `{ name, files, pins }`. One body at rest, and perhaps a second file of the same body as
 * it starts (the one whose name says so, else the second), and a text file of vertices to hold.
 */
export async function readUntangleFiles(files) {
  const lists = files.filter(({ name }) => /\.txt(\.gz)?$/i.test(name));
  const bodies = files.filter((file) => !lists.includes(file));
  if (bodies.length === 0) throw new Error('a list of pins needs its body: open both together');
  if (lists.length > 1) throw new Error('there are two lists of pins');
  const formats = ['mesh', 'msh', 'vtk', 'node', 'ele', 'obj', 'off', 'ply', 'stl'];
  const kinds = 'MESH, MSH, VTK, NODE with ELE, OBJ, OFF, PLY and STL';
  const read = await Promise.all(bodies.map(async (file) => ({ name: file.name, ...(await unpacked(file, formats, kinds)) })));
  const elements = read.filter(({ format }) => format === 'ele');
  const found = read.filter(({ format }) => format !== 'ele');
  if (found.length === 0) throw new Error('an ELE file needs its NODE file: open both together');
  if (found.length > 2) throw new Error('open one body, or two: at rest and as it starts');
  for (const one of found) {
    if (one.format === 'node' && elements.length === 0) throw new Error('a NODE file needs its ELE file: open both together');
    if (one.format === 'node') one.elements = (elements.find(({ name }) => stem(name) === stem(one.name)) ?? elements[0]).bytes;
  }
  if (STARTS.test(found[0].name) && found[1] && !STARTS.test(found[1].name)) found.reverse();
  const [list] = lists;
  const pins = list && { name: list.name, text: new TextDecoder().decode((await unpacked(list, ['txt'], 'TXT')).bytes) };
  return { name: found[0].name, files: found, ...(pins && { pins }) };
}

const stem = (name) => name.replace(/\.(node|ele)(\.gz)?$/i, '');

/** Lets the browser save `content` under `name`. */
export function save(content, name, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Calls `onFiles` for files dropped anywhere; `veil` shows while one is dragged over the page. */
export function acceptDrops(veil, onFiles) {
  const hasFile = (event) => event.dataTransfer?.types.includes('Files');
  let depth = 0;
  const listen = (name, act) =>
    window.addEventListener(name, (event) => {
      if (!hasFile(event)) return;
      event.preventDefault();
      event.stopPropagation(); // the canvas has its own idea of dropped files
      act(event);
      veil.hidden = depth === 0;
    }, { capture: true });
  listen('dragenter', () => { depth += 1; });
  listen('dragover', (event) => { event.dataTransfer.dropEffect = 'copy'; });
  listen('dragleave', () => { depth = Math.max(0, depth - 1); });
  listen('drop', (event) => {
    depth = 0;
    const files = [...event.dataTransfer.files];
    if (files.length) onFiles(files);
  });
}

/** Triangles (m×3) with their vertices (n×3) as an OBJ file. */
export function objOf(positions, indices) {
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < indices.length; i += 3) lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  return `${lines.join('\n')}\n`;
}
