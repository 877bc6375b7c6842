// A static server for the built page, with the headers that allow threads (COOP and COEP).
// node scripts/serve.mjs [folder] [--port 8080] [--host 127.0.0.1] [--no-isolation]
import { createReadStream, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { main, root } from './lib/progress.mjs';

const TYPES = {
  '.css': 'text/css; charset=utf-8',
  '.html': 'text/html; charset=utf-8',
  '.ico': 'image/x-icon',
  '.js': 'text/javascript; charset=utf-8',
  '.json': 'application/json',
  '.map': 'application/json',
  '.mjs': 'text/javascript; charset=utf-8',
  '.obj': 'model/obj',
  '.off': 'text/plain; charset=utf-8',
  '.png': 'image/png',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
  '.webmanifest': 'application/manifest+json',
};

/** Starts serving and resolves with `{ url, close }`; port 0 takes a free one. */
export function serve(folder, { port = 0, host = '127.0.0.1', isolation = true } = {}) {
  const top = resolve(folder);
  const server = createServer((request, response) => {
    const headers = { 'Cache-Control': 'no-cache', 'X-Content-Type-Options': 'nosniff' };
    if (isolation) {
      headers['Cross-Origin-Opener-Policy'] = 'same-origin';
      headers['Cross-Origin-Embedder-Policy'] = 'require-corp';
      headers['Cross-Origin-Resource-Policy'] = 'same-origin';
    }
    const refuse = (status, text) => {
      response.writeHead(status, { ...headers, 'Content-Type': 'text/plain; charset=utf-8' });
      response.end(text);
    };
    if (request.method !== 'GET' && request.method !== 'HEAD') return refuse(405, 'only GET and HEAD');
    let file;
    let stats;
    try {
      const path = normalize(decodeURIComponent(new URL(request.url, 'http://localhost').pathname));
      file = join(top, path);
      if (!file.startsWith(top)) return refuse(403, 'outside of the served folder');
      stats = statSync(file);
      if (stats.isDirectory()) {
        file = join(file, 'index.html');
        stats = statSync(file);
      }
    } catch {
      return refuse(404, 'not found');
    }
    const tag = `"${stats.size.toString(36)}-${stats.mtimeMs.toString(36)}"`;
    headers.ETag = tag;
    if (request.headers['if-none-match'] === tag) {
      response.writeHead(304, headers);
      response.end();
      return;
    }
    headers['Content-Type'] = TYPES[extname(file)] ?? 'application/octet-stream';
    headers['Content-Length'] = stats.size;
    response.writeHead(200, headers);
    if (request.method === 'HEAD') response.end();
    else createReadStream(file).on('error', () => response.destroy()).pipe(response);
  });
  return new Promise((resolvePromise, reject) => {
    server.on('error', reject);
    server.listen(port, host, () => {
      const shown = host === '0.0.0.0' || host === '127.0.0.1' ? 'localhost' : host;
      resolvePromise({
        url: `http://${shown}:${server.address().port}/`,
        close: () => new Promise((done) => {
          server.closeAllConnections();
          server.close(done);
        }),
      });
    });
  });
}

/** Serves on the wished port, or on the next free one. */
export async function serveNear(folder, port, options) {
  for (let tried = port; ; tried++) {
    try {
      return await serve(folder, { ...options, port: tried });
    } catch (error) {
      if (error.code !== 'EADDRINUSE' || tried > port + 20) throw error;
    }
  }
}

/** The command line options of `serve` and `start`. */
export const serveOptions = {
  port: { type: 'string', default: process.env.PORT ?? '8080' },
  host: { type: 'string', default: '127.0.0.1' },
  'no-isolation': { type: 'boolean', default: false },
};

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  main(async () => {
    const { values, positionals } = parseArgs({ options: serveOptions, allowPositionals: true });
    const folder = positionals[0] ?? join(root, 'www', 'dist');
    const { url } = await serveNear(folder, Number(values.port), { host: values.host, isolation: !values['no-isolation'] });
    console.log(`${url}  (${values['no-isolation'] ? 'not isolated: one thread' : 'isolated: threads'}; Ctrl+C stops)`);
  });
}
