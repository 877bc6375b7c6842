// Files in and out.

/** The largest file the page tries to open. */
const LARGEST = 512 * 2 ** 20;

/** Reads a mesh file, unpacking gzip: `{ name, format, bytes }`. */
export async function readMeshFile(file) {
  let name = file.name;
  if (file.size === 0) throw new Error('the file is empty');
  if (file.size > LARGEST) throw new Error(`the file has ${Math.round(file.size / 2 ** 20)} MB; this page opens up to 512 MB`);
  let stream = file.stream();
  if (/\.gz$/i.test(name)) {
    name = name.replace(/\.gz$/i, '');
    stream = stream.pipeThrough(new DecompressionStream('gzip'));
  }
  const format = /\.(obj|off|ply|stl|mesh|msh|vtk)$/i.exec(name)?.[1].toLowerCase();
  if (!format) throw new Error('this page reads OBJ, OFF, PLY, STL, MEDIT .mesh, MSH and VTK files (also .gz)');
  let bytes;
  try {
    bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new Error(/\.gz$/i.test(file.name) ? 'the gzip file is damaged' : 'the file could not be read');
  }
  return { name: file.name, format, bytes };
}

/** Lets the browser save `content` under `name`. */
export function save(content, name, type) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** Calls `onFile` for a file dropped anywhere; `veil` shows while one is dragged over the page. */
export function acceptDrops(veil, onFile) {
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
    const [file] = event.dataTransfer.files;
    if (file) onFile(file);
  });
}
