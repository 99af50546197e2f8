// Checks what a reader's changes start again. Usage: node session.mjs SCRIPT.mjs
import assert from "node:assert";
import { pathToFileURL } from "node:url";

const timers = new Set();
globalThis.setTimeout = (run) => {
  timers.add(run);
  return run;
};
globalThis.clearTimeout = (run) => timers.delete(run);

const { Session } = await import(pathToFileURL(process.argv[2]));
const camera = { from: [0, 0, 1], at: [0, 0, 0], up: [0, 1, 0], vfov: 40, defocus: 0, focus: null };
const session = new Session({}, { camera, depth: 10, samples: 64, sliders: [] });

// A film goes on to as many samples as it has or more; with fewer, it starts again.
for (const [samples, isStale] of [[128, false], [64, false], [32, true]]) {
  session.film = { done: 64 };
  session.isStale = false;
  session.set({ key: "samples" }, samples);
  assert.deepStrictEqual([session.settings.samples, session.isStale], [samples, isStale], `${samples} samples`);
}

// Of several changes, only the last one ends the movement.
session.change();
session.change();
assert.strictEqual(timers.size, 1);
assert(session.isMoving);
timers.forEach((run) => run());
assert(!session.isMoving);
session.end();
assert.strictEqual(timers.size, 0);
