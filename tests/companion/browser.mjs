// Uses the companion as a reader would and prints what it saw as JSON: see browser.rs.
// Usage: node browser.mjs PAGE.html
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { delimiter, join } from "node:path";
import { pathToFileURL } from "node:url";

const { chromium } = createRequire(new URL("../web/package.json", import.meta.url))("playwright-core");
const executablePath = process.env.PATH.split(delimiter).map((path) => join(path, "chromium")).find(existsSync);
const flags = ["--no-sandbox", "--headless=new", "--enable-unsafe-webgpu", "--use-angle=swiftshader"];
const vulkan = ["--enable-features=Vulkan", "--use-vulkan=swiftshader"];
const browser = await chromium.launch({ executablePath, args: [...flags, ...vulkan] });
setTimeout(() => process.exit(1), 300_000).unref();
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

// Each handle is dragged and moved by keys, each slider is set: the reading must change.
for (const figure of await page.locator("figure:has(.reading)").all()) {
  const reading = figure.locator(".reading"), id = await figure.getAttribute("id");
  const changes = async (name, act) => {
    const before = await reading.textContent();
    await act();
    if ((await reading.textContent()) === before) seen.still.push(`${id}: ${name}`);
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

// Each link that sets a picture: the sliders then have the values.
for (const link of await page.locator("a.try").all()) {
  const wrong = await link.evaluate((link) => {
    link.click();
    const { live } = document.querySelector(link.hash).querySelector(`[data-stage="${link.dataset.stage}"]`);
    const wrong = [...new URLSearchParams(link.dataset.set)].filter(([key, value]) => {
      const sliders = live.stage.sliders.filter((slider) => slider.key === key.split(".")[0]);
      return sliders.length === 0 || !sliders.some((slider) => Math.abs(live.session.value(slider) - value) < 1e-9);
    });
    live.stop("");
    return wrong.map(([key, value]) => `${link.dataset.stage}: ${key}=${value}`);
  });
  seen.links.push(...wrong);
}
seen.linkCount = await page.locator("a.try").count();
console.log(JSON.stringify(seen));
await browser.close();
