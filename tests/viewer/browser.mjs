// Debian's Chromium, without anything of the network.
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createRequire } from "node:module";

const { chromium } = createRequire(join(resolve(process.env.VIEWER_MODULES ?? "."), "x.js"))(
  "playwright-core",
);

const patience = 90000; // ms, on a machine that draws WebGL by its processor and has other work

const flags = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--disable-domain-reliability",
  "--use-gl=angle",
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];

/** Calls `use` with a browser context that has a profile of its own. */
export async function withBrowser(use, options = {}) {
  const profile = mkdtempSync(join(tmpdir(), "viewer-"));
  const browser = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    headless: true,
    args: [...flags, ...(options.flags ?? [])],
    viewport: { width: 1360, height: 900 },
    ...options.context,
  });
  try {
    return await use(browser);
  } finally {
    await browser.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

/** A page from disk, with what went wrong on it and what it asked of the network. */
export async function openPage(browser, file, hash = "", { frames = false } = {}) {
  const page = await browser.newPage();
  if (frames) await page.addInitScript(watchFrames);
  page.setDefaultTimeout(patience);
  const complaints = [],
    requests = [];
  page.on(
    "console",
    (message) => ["error", "warning"].includes(message.type()) && complaints.push(message.text()),
  );
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(`file://${file}${hash && `#${hash}`}`);
  await page.waitForSelector("html[data-ready]", { timeout: patience });
  return { page, complaints, requests };
}

/** In the page, before its own scripts: what happens in each frame that it asks for. */
function watchFrames() {
  const frames = { gaps: [], scripts: [], calls: [], changes: [] };
  window.watchedFrames = frames;
  let calls = 0,
    changes = 0,
    before = null;
  for (const kind of [CanvasRenderingContext2D, WebGLRenderingContext, WebGL2RenderingContext])
    for (const name of Object.getOwnPropertyNames(kind.prototype)) {
      const { value } = Object.getOwnPropertyDescriptor(kind.prototype, name);
      if (typeof value !== "function") continue;
      kind.prototype[name] = function (...words) {
        ++calls;
        return value.apply(this, words);
      };
    }
  new MutationObserver((list) => (changes += list.length)).observe(document, {
    subtree: true,
    childList: true,
    characterData: true,
    attributes: true,
  });
  const ask = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (work) =>
    ask((now) => {
      const begin = performance.now();
      calls = changes = 0;
      work(now);
      // Work that the frame puts off is done before this: microtasks keep their order, twice.
      queueMicrotask(() =>
        queueMicrotask(() => {
          if (before !== null) frames.gaps.push(now - before);
          before = now;
          frames.scripts.push(performance.now() - begin);
          frames.calls.push(calls);
          frames.changes.push(changes);
        }),
      );
    });
}

/**
 * Plays a page that was opened with `frames` for so long (ms), and until ten frames are drawn, which a slow machine
 * may take longer for; what each frame took.
 */
export async function countFrames(page, milliseconds) {
  const drawn = (count) =>
    page.waitForFunction((count) => window.watchedFrames.scripts.length >= count, count, { polling: 50 });
  await page.keyboard.press("Space");
  await drawn(2); // the first ones make what the later ones use
  await page.evaluate(() => Object.values(window.watchedFrames).forEach((list) => (list.length = 0)));
  await page.waitForTimeout(milliseconds);
  await drawn(10);
  const found = await page.evaluate(() => window.watchedFrames);
  await page.keyboard.press("Space");
  return { frames: found.scripts.length, ...found };
}
