// What is being untangled in the worker.
import type { Client } from './client.js';
import { needTargets } from './input.js';
import { Stepper, type Wait } from './solver.js';
import type { Certificate, SolidCertificate, Targets } from './types.js';
import type { Flowed, UntangleInfo, UntangleResult, UntangleStep } from './untangle-types.js';

/** A solid, or (with `Certificate`) triangles in their plane, being untangled in the worker. */
export class Untangling<C extends SolidCertificate | Certificate = SolidCertificate> extends Stepper<UntangleStep> implements UntangleInfo {
  readonly notes: string[];
  readonly flowed: Flowed | undefined;

  /** @internal */
  constructor(client: Client, generation: number, id: number, info: UntangleInfo, wait: Wait, signal: AbortSignal | undefined) {
    super(client, generation, id, info, wait, signal);
    this.notes = info.notes;
    this.flowed = info.flowed;
  }

  /**
   * With `overlap`: has pinned vertices move to other places, also while a run goes on, between two of its steps. x follows
   * as soon as the way there is free, and the status goes back to `running`; a run that has ended is to be started again.
   * On an error nothing has changed.
   */
  async movePins(targets: Targets): Promise<void> {
    await this.callWith('movePins', { targets: needTargets(targets) });
    this.awake();
  }

  /** x̄, the primary solver's state, which may fold, n × 3. */
  primaryPositions(): Promise<Float64Array> {
    return this.call('primaryPositions');
  }

  /** The newest positions in double precision, with their certificate, and what stands in the way where elements are inverted. */
  result(): Promise<UntangleResult<C>> {
    return this.call('untangled') as Promise<UntangleResult<C>>;
  }
}
