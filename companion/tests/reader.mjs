// Uses the companion as a reader would and prints what it saw as JSON: see src/tests/reader.rs.
// Usage: node reader.mjs PAGE.html
import { existsSync } from "node:fs";
import { delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { Picture, claims } from "./claims.mjs";

const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, "chromium")).find(existsSync);
const flags = ["--no-sandbox", "--headless=new", "--enable-unsafe-webgpu", "--use-angle=swiftshader"];
const vulkan = ["--enable-features=Vulkan", "--use-vulkan=swiftshader"];
const browser = await chromium.launch({ executablePath, args: [...flags, ...vulkan] });
setTimeout(() => process.exit(1), 1_500_000).unref();
const seen = { console: [], cut: [], still: [], links: [] };
const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
page.on("console", (message) => seen.console.push(message.text()));
page.on("pageerror", (error) => seen.console.push(String(error)));
await page.goto(pathToFileURL(process.argv[2]).href);

// Code that is wider than its box, in each language; and a page that is wider than the window.
for (const width of [400, 800, 1280, 1920]) {
  await page.setViewportSize({ width, height: 900 });
  const cut = await page.evaluate(() => {
    const all = [...document.querySelectorAll("pre")];
    all.forEach((pre) => pre.parentElement.classList.add("shown"));
    document.querySelectorAll(".fold").forEach((fold) => (fold.open = true));
    const wide = all.filter((pre) => pre.scrollWidth > pre.clientWidth).map((pre) => pre.textContent.slice(0, 60));
    return [...wide, ...(document.documentElement.scrollWidth > innerWidth ? ["the page"] : [])];
  });
  seen.cut.push(...cut.map((text) => `${width}: ${text}`));
}
await page.setViewportSize({ width: 1280, height: 900 });

// Chapters that come near get their height, and the page moves until then.
const placed = async (element) => {
  await element.scrollIntoViewIfNeeded();
  for (let box, before; ; before = box) {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    await page.waitForTimeout(100);
    box = await element.boundingBox();
    if (box.y === before?.y) return box;
  }
};

// Diagrams start when the reader comes near.
for (const figure of await page.locator("figure:is(.diagram, .timeline)").all()) {
  await placed(figure);
}
await page.locator("figure:has(.reading)").nth(28).waitFor({ state: "attached" });

// Each handle is dragged and moved by keys, each slider is set: the drawing or its reading must change.
for (const figure of await page.locator("figure:has(.reading)").all()) {
  const id = await figure.getAttribute("id");
  const changes = async (name, act) => {
    // What is drawn may change without the reading, but not the handle alone.
    const look = () => figure.evaluate((figure) => figure.querySelector(".reading").textContent + figure.querySelector("svg > g")?.innerHTML);
    const before = await look();
    await act();
    if ((await look()) === before) seen.still.push(`${id}: ${name}`);
  };
  for (const knob of await figure.locator(".knob").all()) {
    const name = await knob.getAttribute("aria-label");
    await changes(`drag ${name}`, async () => {
      const { x, y, width } = await placed(knob);
      await page.mouse.move(x + width / 2, y + width / 2);
      await page.mouse.down();
      await page.mouse.move(x + 40, y + 45, { steps: 4 });
      await page.mouse.up();
    });
    await changes(`keys ${name}`, async () => {
      await knob.focus();
      for (const key of ["ArrowLeft", "ArrowUp"]) for (let i = 0; i < 6; i++) await page.keyboard.press(key);
    });
  }
  for (const slider of await figure.locator("input").all()) {
    await changes("slider", async () => {
      await slider.focus();
      await page.keyboard.press((await slider.inputValue()) === (await slider.getAttribute("max")) ? "Home" : "End");
    });
  }
}
seen.diagrams = await page.locator("figure:has(.reading)").count();

// Two still pictures can be wiped, too.
const pair = page.locator("[id^=denoised-]");
await pair.getByRole("button", { name: "Wipe" }).click();
if ((await pair.locator(".live-wiping").count()) !== 1) seen.still.push("the wipe of a denoised picture");

// The seam follows a pointer that moves fast, from its handle and from anywhere on the pictures.
const seam = () => pair.locator(".panels").evaluate((panels) => parseFloat(panels.style.getPropertyValue("--live-wipe")));
const { x, y, width, height } = await placed(pair.locator(".panels"));
for (const from of [0.5, 0.2]) {
  await page.mouse.move(x + from * width, y + height / 3);
  await page.mouse.down();
  await page.mouse.move(x + 0.9 * width, y + height / 3);
  await page.mouse.up();
  if (Math.abs((await seam()) - 90) > 2) seen.still.push(`the seam, dragged from ${from}`);
  await page.mouse.move(x + 0.9 * width, y + height / 3);
  await page.mouse.down();
  await page.mouse.move(x + 0.5 * width, y + height / 3);
  await page.mouse.up();
}

// Find leads to a text by Enter and says when it finds nothing. Back leads to where the reader was, and so does a reload.
const field = page.getByRole("searchbox");
const topOf = (id) => page.evaluate((id) => Math.round(document.getElementById(id).getBoundingClientRect().top), id);
const settled = () => page.waitForTimeout(600);
await field.fill("zyzzyva");
if (!(await page.locator(".count").innerText()).includes("Nothing")) seen.still.push("a search for nothing");
await field.fill("archimedes");
await field.press("Enter");
await settled();
if ((await page.locator(".found-here").count()) !== 1) seen.still.push("a search in the text");
await page.locator("#figure-metal").scrollIntoViewIfNeeded();
await settled();
const before = await topOf("figure-metal");
await page.locator("#figure-metal ~ p a[href='#camera']").first().click();
await settled();
await page.goBack();
await settled();
if (Math.abs((await topOf("figure-metal")) - before) > 3) seen.still.push(`Back: ${await topOf("figure-metal")} instead of ${before}`);
await page.reload();
await settled();
if (Math.abs((await topOf("figure-metal")) - before) > 3) seen.still.push(`reload: ${await topOf("figure-metal")} instead of ${before}`);
await page.goto(`${page.url().split("#")[0]}#term-lane`);
await settled();
await page.mouse.wheel(0, 30);
await settled();
if (!page.url().endsWith("#term-lane")) seen.still.push("a deep link");

// Each link that sets a picture: what its text says must hold of the picture.
const shown = (link, isAsLinked, samples) => link.evaluate(async (link, [isAsLinked, samples]) => {
  const { live } = document.querySelector(`:is(${link.hash}, .live-dock) [data-stage="${link.dataset.stage}"]`);
  if (isAsLinked) link.click();
  else live.start();
  // A picture that is far away comes to the reader.
  const isNear = () => {
    const { top, bottom } = live.canvas.parentElement.getBoundingClientRect();
    return top < innerHeight && bottom > 0;
  };
  const wasNear = isNear();
  if (!isAsLinked) live.canvas.parentElement.scrollIntoView();
  const { settings } = live.session, isAboutSamples = link.dataset.set.startsWith("samples");
  if (!isAboutSamples) settings.samples = Math.min(settings.samples, samples);
  live.session.change(false);
  const isDone = () => {
    const { session, stage, told } = live, { film, isStale } = session ?? {};
    return film && !isStale && film.width === stage.width && told.textContent.startsWith(`${settings.samples} of`);
  };
  for (let i = 0; i < 6000 && live.session && !isDone(); i++) await new Promise((passed) => setTimeout(passed, 50));
  if (!isDone()) throw new Error(`${link.dataset.stage} was not rendered: ${live.said.textContent}`);
  const canvas = new OffscreenCanvas(480, Math.round((480 * live.stage.height) / live.stage.width)), context = canvas.getContext("2d");
  context.drawImage(live.canvas, 0, 0, canvas.width, canvas.height);
  const data = [...context.getImageData(0, 0, canvas.width, canvas.height).data];
  live.stop("");
  dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
  const isBack = document.querySelector(link.hash).contains(live.root);
  return { picture: { width: canvas.width, height: canvas.height, data }, isGood: wasNear && isBack };
}, [isAsLinked, samples]);
const samplesOf = (stage) => (stage === "book" ? 1 : 4);
const found = new Set(), usual = new Map();
for (const link of await page.locator("a.try").all()) {
  const key = await link.evaluate(({ dataset }) => `${dataset.stage}?${dataset.set}`), stage = key.split("?")[0];
  const text = (await link.evaluate((link) => link.closest("p, li, figcaption").textContent)).replace(/\s+/g, " ");
  const rows = claims.filter(([wanted, words]) => wanted === key && text.includes(words));
  if (rows.length === 0) seen.links.push(`${key}: claims.mjs has no words of “${text}”`);
  await placed(link);
  const now = await shown(link, true, samplesOf(stage));
  if (!now.isGood) seen.links.push(`${key}: the picture does not come and return`);
  // A claim that compares has the usual picture as a parameter.
  if (!usual.has(stage) && rows.some((row) => row[2].length > 1)) usual.set(stage, new Picture((await shown(link, false, samplesOf(stage))).picture));
  for (const row of rows) {
    found.add(row);
    const holds = row[2](new Picture(now.picture), usual.get(stage), usual);
    if (holds !== true) seen.links.push(`${key}: “${row[1]}” is not true: ${JSON.stringify(holds)}`);
  }
}
seen.links.push(...claims.filter((row) => !found.has(row)).map(([key, words]) => `${key}: no link says “${words}”`));

// A label says what its picture shows, and Reset and Stop bring the usual numbers back.
const linked = page.locator('a.try[data-set="samples=1"]'), named = page.locator('#figure-antialiasing .panel[data-stage="antialiased"] .label');
await placed(linked);
await linked.click();
if ((await named.innerText()) !== "1 sample per pixel") seen.still.push(`a label: ${await named.innerText()}`);
await page.locator('#figure-antialiasing .panel[data-stage="antialiased"]').evaluate((panel) => panel.live.stop(""));
if ((await named.innerText()) !== "64 samples per pixel") seen.still.push(`a label after Stop: ${await named.innerText()}`);

// The right picture beside a mistake comes by keys, too.
const mistake = page.locator(".mistakes[data-has-right] img[tabindex]").first();
await mistake.focus();
if ((await mistake.locator("xpath=following-sibling::img").evaluate((right) => getComputedStyle(right).opacity)) !== "1") seen.still.push("a mistake, by keys");

// A dropped file does not replace the page, and one line says what to do instead.
const dropped = await page.evaluate(() => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File(["P6"], "mine.ppm"));
  const event = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
  document.querySelector("#figure-metal").dispatchEvent(event);
  return event.defaultPrevented && document.querySelectorAll(".check-missing, .cover .check-box").length === 1;
});
if (!dropped) seen.still.push("a drop");

// [ and ] make a place to come back to.
await page.evaluate(() => document.getElementById("diffuse").scrollIntoView());
await settled();
await page.keyboard.press("]");
await settled();
if (!page.url().endsWith("#metal")) seen.still.push(`] leads to ${page.url()}`);

// Without WebGPU, a link shows a still of its state.
const plain = await browser.newPage({ viewport: { width: 1280, height: 900 } });
await plain.addInitScript(() => Object.defineProperty(Navigator.prototype, "gpu", { get: () => undefined }));
await plain.goto(pathToFileURL(process.argv[2]).href);
await plain.locator(".live-notice").waitFor();
await plain.locator('a.try[data-stage="antialiased"]').first().click();
const shows = plain.locator('.panel[data-stage="antialiased"]:has(.live-back)');
if (!(await shows.locator("img").first().getAttribute("src")).includes("antialiased-try")) seen.still.push("a link without WebGPU");
if ((await shows.locator(".label").innerText()) !== "1 sample per pixel") seen.still.push("a label without WebGPU");
await shows.locator(".live-back").click();
if ((await shows.locator("img").first().getAttribute("src")).includes("try")) seen.still.push("the usual picture without WebGPU");
if (await plain.locator(".runs:visible, .live-bar button:visible:text-is('Run')").count()) seen.still.push("Run, where nothing runs");
seen.linkCount = await page.locator("a.try").count();
console.log(JSON.stringify(seen));
await browser.close();
