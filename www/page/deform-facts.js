// What the inspector says of the solid on the bench. No DOM here.
import { ending, number, whole } from './words.js';

/** Pairs of names and values. `title` is the solid's; `threads` how many there are. */
export function factsOf(session, { title, threads }) {
  const { problem, certificate, newest, solid } = session;
  const pairs = [
    [session.planar ? 'figure' : 'solid', title],
    ['vertices', whole(solid.positions.length / 3)],
    ['held', `${whole(problem.pins)} vertices`],
    ['setup', `${number(1000 * problem.setupSeconds, 3)} ms`],
    ['threads', String(threads)],
    ...problem.notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
  ];
  if (session.finished && newest.iteration > 0) pairs.push(['ended', `${ending(newest)} after ${newest.iteration}`]);
  if (certificate) pairs.push(...proofOf(certificate, session.planar));
  return pairs;
}

/** What a certificate says, of triangles in a plane or of tetrahedra. */
export function proofOf(certificate, planar) {
  const wrong = certificate.inverted.length + certificate.degenerate.length;
  if (wrong > 0) return [['certificate', `${whole(wrong)} inverted (exact)`]];
  const verdict = planar
    ? (certificate.globallyInjective ? 'injective as a whole (exact)' : 'parts of it lie on each other (exact)')
    : (certificate.locallyInjective ? 'injective around every vertex (exact)' : 'it overlaps around an edge or a vertex (exact)');
  return [['certificate', `no ${planar ? 'triangle' : 'tetrahedron'} inverted (exact)`], ['', verdict]];
}
