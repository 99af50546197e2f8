// Live figures: renders the stages of a page in the browser, with the shaders of the program.
//
// The page holds the shaders and the contents of their buffers; this script runs them through WebGPU. It knows nothing
// of spheres, materials or light. What it computes itself is the camera, the samples of the next dispatch, and which
// bytes a slider changes. Names and offsets of all bytes come with the data.
//
// Twins: src/prepared/camera.rs, src/app/model/navigation.rs, src/render_gpu/schedule.rs and trace.rs

let data;

// Must be called first; `given` is what web::live_data writes.
export function use(given) {
  data = given;
}

// ---- Vectors and the camera, in double precision ----

const plus = (a, b) => a.map((x, i) => x + b[i]);
const minus = (a, b) => a.map((x, i) => x - b[i]);
const times = (a, s) => a.map((x) => x * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const length = (a) => Math.sqrt(dot(a, a));
const cross = ([a, b, c], [x, y, z]) => [b * z - y * c, c * x - z * a, a * y - x * b];
const radians = (degrees) => degrees * (Math.PI / 180);
const clamped = (x, low, high) => Math.min(high, Math.max(low, x));

function unit(v) {
  const largest = Math.max(...v.map(Math.abs));
  const scaled = v.map((x) => x / largest);
  return times(scaled, 1 / length(scaled));
}

// Unit vectors to the right, up and backwards.
function basis({ from, at, up }) {
  const w = unit(minus(from, at));
  const u = unit(cross(unit(up), w));
  return { u, v: cross(w, u), w };
}

const defocusTangent = (camera) => Math.tan(radians(camera.defocus) / 2);
export const focusDistance = (camera) => camera.focus ?? length(minus(camera.from, camera.at));
const lensRadius = (camera) => focusDistance(camera) * defocusTangent(camera);

// Writes the shaders' record `Camera` at byte `at`.
export function writeCamera(bytes, at, camera, [width, height], origin) {
  const { u, v, w } = basis(camera);
  const halfHeight = Math.tan(radians(camera.vfov) / 2);
  const halfWidth = (halfHeight * width) / height;
  writeFloats(bytes, at, "Camera", {
    eye: minus(camera.from, origin),
    tau: defocusTangent(camera),
    u,
    lens_radius: lensRadius(camera),
    v,
    scale_x: (2 * halfWidth) / width,
    w,
    scale_y: (-2 * halfHeight) / height,
    offset: [-halfWidth, halfHeight],
    size: [width, height],
  });
}

function turned(v, axis, angle) {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  return plus(plus(times(v, cosine), times(cross(axis, v), sine)), times(axis, dot(axis, v) * (1 - cosine)));
}

// Moves the eye around `at`, in radians, so that the scene appears to turn right and up.
export function orbit(camera, right, up) {
  const pole = unit(camera.up);
  const away = turned(minus(camera.from, camera.at), pole, -right);
  const angle = Math.acos(clamped(dot(unit(away), pole), -1, 1));
  const wanted = clamped(angle - up, radians(1), radians(179));
  return { ...camera, from: plus(camera.at, turned(away, unit(cross(away, pole)), angle - wanted)) };
}

// Moves the eye towards `at` (`factor` below 1) or away from it.
export function dolly(camera, factor) {
  return { ...camera, from: plus(camera.at, times(minus(camera.from, camera.at), factor)) };
}

// Whether the stage's buffers serve this camera. The program sorts and anchors the spheres for an eye outside all of
// them, and measures coordinates from a point that is close enough for the smallest length around the eye. Below the
// smallest spheres, it would move the anchor of the ground to the eye.
export function isServed(stage, camera) {
  const { stride, reference, inward, radius } = data.records.ShadingRecord;
  const bytes = view(stage.buffers[3]);
  const vector = (at) => [0, 4, 8].map((i) => bytes.getFloat32(at + i, true));
  const eye = minus(camera.from, stage.origin);
  let [smallest, lowest, lowestAnchored] = [Infinity, Infinity, Infinity];
  for (let row = 0; row < bytes.byteLength; row += stride) {
    const r = bytes.getFloat32(row + radius, true);
    if (r === 0) continue;
    const point = vector(row + reference);
    const toCentre = times(vector(row + inward), r);
    const height = length(minus(eye, plus(point, toCentre))) - r;
    if (height < lensRadius(camera) + 0.002 * length(minus(eye, point))) return false;
    smallest = Math.min(smallest, r);
    lowest = Math.min(lowest, height);
    if (length(toCentre) > 0) lowestAnchored = Math.min(lowestAnchored, height);
  }
  const [distance, first] = [camera, stage.camera].map(({ from, at }) => length(minus(from, at)));
  const isNear = Math.max(...eye.map(Math.abs)) < 125 * Math.min(smallest, lowest);
  return isNear && lowestAnchored >= 1.01 * smallest && distance > first / 20 && distance < first * 5;
}

// ---- Bytes ----

const view = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

function writeFields(bytes, at, record, fields, write) {
  for (const [name, value] of Object.entries(fields)) {
    [value].flat().forEach((x, i) => bytes[write](at + data.records[record][name] + 4 * i, x, true));
  }
}
const writeFloats = (bytes, at, record, fields) => writeFields(bytes, at, record, fields, "setFloat32");
const writeWords = (bytes, at, record, fields) => writeFields(bytes, at, record, fields, "setUint32");

const decoded = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

const MATERIAL_FIELDS = {
  fuzz: (fuzz) => ({ weight: -fuzz }),
  index: (index) => ({
    refraction_index: index,
    inverse_index: 1 / index,
    f0: ((1 - index) / (1 + index)) * ((1 - index) / (1 + index)),
  }),
};

// The stage's five buffers and its overrides for the reader's settings and picture size.
export function inputs(stage, settings, [width, height]) {
  const [job, spheres, anchored, records, nodes] = stage.buffers.map((buffer) => buffer.slice());
  const { Job, ShadingRecord } = data.records;
  writeWords(view(job), 0, "Job", { width, height, max_depth: settings.depth });
  writeCamera(view(job), Job.camera, settings.camera, [width, height], stage.origin);
  stage.sliders.forEach(({ key, rows, inverse_rows }, i) => {
    if (!(key in MATERIAL_FIELDS) || settings.material[i] === undefined) return;
    const write = (value) => (row) =>
      writeFloats(view(records), row * ShadingRecord.stride, "ShadingRecord", MATERIAL_FIELDS[key](value));
    rows.forEach(write(settings.material[i]));
    inverse_rows.forEach(write(1 / settings.material[i]));
  });
  let isFuzzy = false;
  for (let row = 0; row < records.length; row += ShadingRecord.stride) {
    isFuzzy ||= view(records).getFloat32(row + ShadingRecord.weight, true) < 0;
  }
  const overrides = { ...stage.overrides, LENS: +(settings.camera.defocus > 0), FUZZ: +isFuzzy };
  return { buffers: [job, spheres, anchored, records, nodes], overrides };
}
