// Licences and bans of all crates, by cargo-deny (deny.toml).
import { main, run } from './lib/progress.mjs';
import { cargoDeny } from './toolchain.mjs';

main(async () => {
  await run(await cargoDeny(), ['--all-features', 'check', 'licenses', 'bans', 'sources'], { label: 'cargo-deny', echo: true });
});
