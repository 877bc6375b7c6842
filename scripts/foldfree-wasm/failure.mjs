// What went wrong, in one line that names the file or the argument.

/** An error that needs no stack. */
export class Failure extends Error {
  constructor(what) {
    super(what.replace(/\s+/g, ' ').trim());
  }
}

const SYSTEM = { ENOENT: 'no such file or folder', EACCES: 'permission denied', EISDIR: 'is a folder' };

/** Errors of `body` concern the file `path`. */
export function of(path, body) {
  try {
    return body();
  } catch (error) {
    mustBeTold(error);
    throw new Failure(`${path}: ${SYSTEM[error.code] ?? error.message}`);
  }
}

/** Errors of `body` are the user's to mend, and name what they concern themselves. */
export function told(body) {
  try {
    return body();
  } catch (error) {
    mustBeTold(error);
    throw new Failure(error.message);
  }
}

/** Errors of the library and of the system have a code; any other is a mistake of this program, and keeps its stack. */
function mustBeTold(error) {
  if (!(error instanceof Failure) && error.code === undefined) throw error;
}
