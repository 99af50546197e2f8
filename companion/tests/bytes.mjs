// Prints what the script writes for the cases on standard input: see src/tests/live_bytes.rs.
// Usage: node bytes.mjs SCRIPT.mjs < INPUT.json
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const script = await import(pathToFileURL(process.argv[2]));
const { data, tables = [], cases = [], blocks = [], times = [], turns = [] } = JSON.parse(readFileSync(0, "utf8"));
script.use(data);
const bytes = (base64) => new Uint8Array(Buffer.from(base64, "base64"));
const base64 = (array) => Buffer.from(array).toString("base64");
for (const stage of Object.values(data.stages)) stage.buffers = stage.buffers.map(bytes);

const table = ({ camera, size, origin }) => {
  const words = new DataView(new ArrayBuffer(data.records.Camera.stride));
  script.writeCamera(words, 0, camera, size, origin);
  return base64(new Uint8Array(words.buffer));
};

const written = ({ stage: id, settings, size, moves }) => {
  const stage = data.stages[id];
  let camera = settings.camera;
  for (const [right, up, factor] of moves) {
    const moved = script.dolly(script.orbit(camera, right, up), factor);
    if (script.isServed(stage, moved)) camera = moved;
  }
  const { buffers, overrides } = script.inputs(stage, { ...settings, camera }, size);
  return { camera, isServed: script.isServed(stage, camera), buffers: buffers.map(base64), overrides };
};

const split = ([wanted, most]) => {
  const all = [];
  for (let done = 0; done < wanted; done += all.at(-1).count) all.push(script.nextBlock(done, wanted, most));
  return all;
};

// The number of paths that a budget has learnt after dispatches whose time in ms is `start + paths / rate`.
const learnt = (dispatches) => {
  const budget = new script.Budget();
  return dispatches.map(([start, rate]) => {
    budget.learn(budget.paths, start + budget.paths / rate);
    return budget.paths;
  });
};

const turned = ([camera, right, up]) => script.orbit(camera, right, up).from;

const told = { tables: tables.map(table), cases: cases.map(written), blocks: blocks.map(split) };
console.log(JSON.stringify({ ...told, learnt: learnt(times), turned: turns.map(turned) }));
