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
await page.locator("figure:has(.reading)").nth(10).waitFor({ state: "attached" });

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
seen.linkCount = await page.locator("a.try").count();
console.log(JSON.stringify(seen));
await browser.close();
