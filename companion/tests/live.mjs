// Opens a page with live figures in Chromium and uses it as a reader would. Prints what it saw as JSON; films and
// screenshots go to the page's folder. What must hold is in src/tests/live_browser.rs.
// Usage: node live.mjs FOLDER
import { existsSync, writeFileSync } from "node:fs";
import { delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const folder = process.argv[2];
const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, "chromium")).find(existsSync);
const url = pathToFileURL(join(folder, "index.html")).href;
const flags = ["--no-sandbox", "--headless=new", "--enable-unsafe-webgpu", "--use-angle=swiftshader"];
const vulkan = ["--enable-features=Vulkan", "--use-vulkan=swiftshader", "--hide-scrollbars"];
const browser = await chromium.launch({ executablePath, args: [...flags, ...vulkan] });
// Whatever happens, this program and its browser end.
setTimeout(() => process.exit(1), 600_000).unref();
const seen = { console: [], films: {} };

// Remembers the device and the films, and makes films readable.
function remember() {
  const request = GPUAdapter.prototype.requestDevice;
  GPUAdapter.prototype.requestDevice = async function (...given) {
    return (window.device = await request.apply(this, given));
  };
  const create = GPUDevice.prototype.createBuffer;
  GPUDevice.prototype.createBuffer = function (given) {
    if (given.label !== "film") return create.call(this, given);
    return (window.film = create.call(this, { ...given, usage: given.usage | GPUBufferUsage.COPY_SRC }));
  };
}

async function readFilm() {
  const { device, film } = window;
  const usage = GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST;
  const copy = device.createBuffer({ size: film.size, usage });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(film, 0, copy, 0, film.size);
  device.queue.submit([encoder.finish()]);
  await copy.mapAsync(GPUMapMode.READ);
  const bytes = new Uint8Array(copy.getMappedRange());
  let text = "";
  for (let i = 0; i < bytes.length; i += 30000) text += String.fromCharCode(...bytes.subarray(i, i + 30000));
  copy.destroy();
  return btoa(text);
}

async function opened(...preparations) {
  const page = await browser.newPage({ viewport: { width: 1100, height: 800 } });
  page.on("console", (message) => seen.console.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => seen.console.push(`error: ${error}`));
  for (const prepare of preparations) await page.addInitScript(prepare);
  await page.goto(url);
  return page;
}

let page = await opened(remember);
const shot = (name) => page.screenshot({ path: join(folder, `${name}.png`) });
const panel = (id) => page.locator(`.panel[data-stage="${id}"]`);
const button = (id, name) => panel(id).getByRole("button", { name: name === "Run" ? /^(Run|Stop)$/ : name, exact: true });
const bar = async (id) => (await panel(id).locator(".live-bar").innerText()).replaceAll("\n", " ");
const settings = (id) => panel(id).evaluate((element) => element.live.session.settings);
const done = (id) => panel(id).evaluate((element) => element.live.session.film?.done ?? 0);
// Drawn, not measured: the picture as a reader sees it.
const picture = (id) => panel(id).evaluate((element) => element.querySelector("canvas").toDataURL());

async function until(what, is) {
  for (const end = Date.now() + 60_000; Date.now() < end; await page.waitForTimeout(50)) if (await is()) return;
  throw new Error(`waited for a minute: ${what}`);
}

// Waits until the film of the present settings is done, at full size.
const isFinished = (element) => {
  const { session, stage } = element.live;
  const { film, isStale, isMoving, settings } = session ?? {};
  return film !== undefined && !isStale && !isMoving && film.width === stage.width && film.done === settings.samples;
};
const finished = (id) => until(`${id} is finished`, () => panel(id).evaluate(isFinished));

async function live(id) {
  await panel(id).scrollIntoViewIfNeeded();
  await button(id, "Run").click();
}

async function keepFilm(id, name) {
  await finished(id);
  const file = `film-${name}.bin`, own = await settings(id);
  writeFileSync(join(folder, file), Buffer.from(await page.evaluate(readFilm), "base64"));
  // The text is written with the picture.
  await until("the picture", async () => (await bar(id)).includes(`${own.samples} of ${own.samples}`));
  const rgba = await panel(id).locator("canvas").first().evaluate((canvas) => {
    // A copy, as the page's own canvas is not made for being read.
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    return [...copy.getImageData(0, 0, canvas.width, canvas.height).data];
  });
  seen.films[name] = { file, id, rgba, settings: own };
}

async function drag(id, right, down) {
  const { x, y, width, height } = await panel(id).locator("canvas").boundingBox();
  const [from, to] = [[x + width / 3, y + height / 2], [x + width / 3 + right, y + height / 2 + down]];
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 8 });
  await page.mouse.up();
}

// Whether `act` changes something.
async function changes(look, act) {
  const before = JSON.stringify(await look());
  await act();
  return JSON.stringify(await look()) !== before;
}

const ids = await page.locator(".panel").evaluateAll((all) => all.map((element) => element.dataset.stage));
const glass = "hollow-glass";
await shot("stills");
const heights = () => page.locator("body > p").evaluateAll((all) => all.map((p) => p.offsetTop));
const heightsBefore = await heights();
for (const id of ids) {
  await live(id);
  await keepFilm(id, id);
  if (id !== glass) await button(id, "Run").click();
}

await panel(glass).scrollIntoViewIfNeeded();
// Running a figure moves no text; the sliders do, since they must not cover it.
seen.jumps = JSON.stringify(await heights()) !== JSON.stringify(heightsBefore);
await button(glass, "Adjust").click();
await shot("live");
seen.drag = await changes(() => picture(glass), async () => {
  await drag(glass, 120, 40);
  await finished(glass);
});
await panel(glass).locator("summary").click();
const slider = (id, label) => panel(id).getByRole("slider", { name: label });
seen.slider = await changes(() => picture(glass), async () => {
  await slider(glass, "Index of refraction").fill("1.31");
  await finished(glass);
});
await slider(glass, "Defocus angle").fill("2");
await slider(glass, "Fuzz (right)").fill("0.25");
await slider(glass, "Bounces").fill("6");
await keepFilm(glass, "changed");
await shot("changed");

const camera = async () => (await settings(glass)).camera;
seen.wheelWithoutFocus = await changes(camera, async () => {
  await page.evaluate(() => document.activeElement.blur());
  await page.mouse.wheel(0, 40);
});
await panel(glass).locator("canvas").focus();
seen.wheel = await changes(camera, async () => {
  await panel(glass).locator("canvas").hover();
  await page.mouse.wheel(0, -100);
  await page.waitForTimeout(100);
});
seen.key = await changes(camera, () => page.keyboard.press("ArrowLeft"));
await button(glass, "Reset").click();
seen.reset = JSON.stringify(await settings(glass)) === JSON.stringify(seen.films[glass].settings);

await slider(glass, "Samples per pixel").fill("12");
await until("samples", async () => (await done(glass)) > 0);
await page.evaluate(() => scrollTo(0, document.body.scrollHeight));
await page.waitForTimeout(1000);
seen.outOfView = await changes(() => done(glass), () => page.waitForTimeout(1500));
await panel(glass).scrollIntoViewIfNeeded();
const before = await done(glass);
await until("going on in view", async () => (await done(glass)) > before);

const [first, second] = ["view-close", "defocus"];
await live(first);
await live(second);
await finished(second);
await button(second, "Wipe").click();
seen.bothTurn = await changes(() => settings(first), () => drag(second, 100, 0));
seen.bothTurn &&= JSON.stringify((await settings(first)).camera.from) === JSON.stringify((await settings(second)).camera.from);
await finished(first);
await finished(second);
await panel(first).locator("canvas").scrollIntoViewIfNeeded();
await page.getByRole("slider", { name: "Wipe" }).fill("40");
await shot("wipe");
await button(second, "Wipe").click();

await page.evaluate(() => window.device.destroy());
await until("the loss is told", async () => (await bar(glass)).includes("was lost"));
seen.lost = [];
for (const id of [glass, first, second]) {
  seen.lost.push([await bar(id), await button(id, "Run").getAttribute("aria-pressed"), await panel(id).locator("canvas").isVisible()]);
}
await shot("lost");
await button(first, "Run").click();
await finished(first);
// The text follows the picture after a moment.
await until("the last count", async () => (await bar(first)).includes("16 of 16"));
seen.afterLoss = await bar(first);

for (const [name, width, colorScheme] of [["narrow-dark", 400, "dark"], ["middle-light", 800, "light"]]) {
  await page.setViewportSize({ width, height: 800 });
  await page.emulateMedia({ colorScheme });
  await panel(first).scrollIntoViewIfNeeded();
  await button(first, "Adjust").click();
  await finished(first);
  await shot(name);
  await button(first, "Adjust").click();
  await button(second, "Wipe").click();
  await panel(first).locator("canvas").scrollIntoViewIfNeeded();
  await shot(`${name}-wipe`);
  seen[name] = await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);
  await button(second, "Wipe").click();
}

// With few iterations in a dispatch, paths are suspended and resumed.
page = await opened(remember, () => {
  const { parse } = JSON;
  JSON.parse = (text) => {
    const given = parse(text);
    if (given.constants) given.constants.iteration_limit = 8 * 60;
    return given;
  };
});
await live(glass);
await keepFilm(glass, "suspended");

page = await opened(() => Object.defineProperty(Navigator.prototype, "gpu", { get: () => undefined }));
seen.without = await page.locator(".live-notice").innerText();
await shot("without");
await browser.close();
console.log(JSON.stringify(seen));
