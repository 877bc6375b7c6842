// Headless Chromium for tests and benchmarks.
import { chromium as driver } from 'playwright-core';
import { chromium } from '../toolchain.mjs';

/** A browser of playwright-core on the Chromium that is installed. */
export async function browser() {
  const { browser: executablePath } = await chromium();
  return driver.launch({
    executablePath,
    args: [
      '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync',
    ],
  });
}
