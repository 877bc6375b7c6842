// npm start: builds what is out of date, then serves the page.
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { main, root, say } from './lib/progress.mjs';
import { build } from './build.mjs';
import { serveNear, serveOptions } from './serve.mjs';

main(async () => {
  const { values } = parseArgs({ options: serveOptions });
  await build();
  const { url } = await serveNear(join(root, 'www', 'dist'), Number(values.port), {
    host: values.host,
    isolation: !values['no-isolation'],
  });
  say(`the page is at ${url}  (Ctrl+C stops)`);
});
