// A browser on the built page, for the end-to-end tests.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { serve } from '../../scripts/serve.mjs';

export const root = join(fileURLToPath(import.meta.url), '../../..');
const dist = join(root, 'www/dist');

/** WebGL 2 without a graphics card. */
const ARGUMENTS = [
  '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-gpu-compositing',
  '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
];

function executable() {
  const places = [process.env.CHROME, '/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
  return places.find((path) => path && existsSync(path));
}

/** Starts a server and a browser; `close` ends both. */
export async function launch({ isolation = true } = {}) {
  const server = await serve(dist, { isolation });
  const browser = await chromium.launch({ executablePath: executable(), args: ARGUMENTS });
  return {
    url: server.url,
    browser,
    close: async () => {
      await browser.close();
      await server.close();
    },
  };
}

/**
 * Opens the page and collects what goes wrong on it. `ready` waits for the solver; `prepare(page)` runs
 * before the page is loaded.
 */
export async function openPage({ browser, url }, { query = '', ready = true, prepare, viewport, ...context } = {}) {
  const made = await browser.newContext({ viewport: viewport ?? { width: 900, height: 620 }, reducedMotion: 'reduce', ...context });
  const page = await made.newPage();
  page.setDefaultTimeout(60_000);
  const troubles = [];
  page.on('pageerror', (error) => troubles.push(String(error)));
  page.on('console', (message) => {
    if (message.type() === 'error') troubles.push(`${message.text()} ${message.location().url}`);
  });
  await prepare?.(page);
  await page.goto(new URL(query, url).href);
  if (ready) await page.waitForSelector('body[data-solver="ready"]', { state: 'attached' });
  return { page, troubles, close: () => made.close() };
}

/**
 * Makes tests on a page of their own, which must end without a word on the console: `(name, options, body)`;
 * `once(options, body)` is one such page without a test around it.
 */
export function onPageOf(site) {
  const once = async (options, body) => {
    const opened = await openPage(site(), options);
    try {
      await body(opened.page);
      assert.deepEqual(opened.troubles, []);
    } finally {
      await opened.close();
    }
  };
  return Object.assign((name, options, body) => test(name, () => once(options, body)), { once });
}

/** No accessibility violation that axe knows of. */
export async function audit(page, where) {
  await page.addScriptTag({ path: join(root, 'node_modules/axe-core/axe.min.js') });
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  assert.deepEqual(violations.map((v) => `${where}: ${v.id} ${v.nodes.map((n) => n.target).join(' ')}`), []);
}

/** The status line as numbers, when it has been drawn: what is shown is counted at once and drawn with the next frame. */
export async function status(page) {
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
  const text = await page.textContent('#status');
  const [, iteration, energy, inverted] = /iteration (\d+).*?energy ([\d.e∞-]+).*?(\d[\d\u00a0]*) inverted/.exec(text) ?? [];
  return { text, iteration: Number(iteration), energy: Number(energy), inverted: Number(inverted?.replaceAll('\u00a0', '')) };
}

/** Plays at full speed until the solver has nothing more to do. */
export async function playToTheEnd(page) {
  await page.selectOption('#pace', '0');
  await page.click('#play');
  await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
  await page.waitForSelector('#play:not(.playing)');
}

/** What a click on `selector` in the export menu saves, as bytes. */
export async function download(page, selector) {
  await page.click('#export');
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click(selector)]);
  const chunks = [];
  for await (const chunk of await saved.createReadStream()) chunks.push(chunk);
  return { name: saved.suggestedFilename(), bytes: Buffer.concat(chunks) };
}

/** Drops a file on the page, as from the desktop. */
export async function drop(page, name, text) {
  await page.evaluate(([name, text]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([text], name));
    for (const type of ['dragenter', 'dragover', 'drop']) {
      document.getElementById('canvas').dispatchEvent(new DragEvent(type, { dataTransfer: transfer, bubbles: true, cancelable: true }));
    }
  }, [name, text]);
}

/** A wavy sheet of n × n squares, as an OBJ file. */
export function wavySheet(n) {
  const lines = [];
  for (let j = 0; j <= n; j += 1) {
    for (let i = 0; i <= n; i += 1) lines.push(`v ${i / n} ${j / n} ${0.2 * Math.sin((7 * i) / n) * Math.cos((5 * j) / n)}`);
  }
  for (let j = 0; j < n; j += 1) {
    for (let i = 0; i < n; i += 1) {
      const a = j * (n + 1) + i + 1;
      lines.push(`f ${a} ${a + 1} ${a + n + 2} ${a + n + 1}`);
    }
  }
  return `${lines.join('\n')}\n`;
}
