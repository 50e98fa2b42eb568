// Pages in a browser: EXTREMAL is the program, VIEWER_MODULES a folder with the packages.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, test } from "node:test";
import { countFrames, openPage, withBrowser } from "./browser.mjs";

const program = resolve(process.env.EXTREMAL ?? "build/release/extremal");
const scenes = resolve(import.meta.dirname, "../../problems/scenes");
const folder = mkdtempSync(join(tmpdir(), "pages-"));
after(() => rmSync(folder, { recursive: true, force: true }));

const run = (...words) => execFileSync(program, words, { cwd: folder, encoding: "utf8" });

/** Result and page of one run of a scene. */
function made(verb, scene, ...words) {
  const name = scene.split("/").at(-1).replace(".toml", "");
  const file = join(folder, `${name}-${verb}.html`),
    output = join(folder, `${name}-${verb}.json`);
  run(
    verb,
    scene.includes("/") ? scene : join(scenes, `${scene}.toml`),
    "--quiet",
    "--plot",
    file,
    "--output",
    output,
    ...words,
  );
  return { file, result: JSON.parse(readFileSync(output, "utf8")) };
}

/** A page that is used, then asked for complaints and for what it wanted of the network. */
function withPage(file, hash, use, options) {
  return withBrowser(async (browser) => {
    const { page, complaints, requests } = await openPage(browser, file, hash);
    await use(page);
    assert.deepEqual(complaints, []);
    for (const request of requests) assert.match(request, /^(file|data|blob):/);
  }, options);
}

/** The fields that the page shows, as JSON. */
const fields = (page) =>
  page.$$eval("[data-field]", (nodes) =>
    Object.fromEntries(nodes.map((node) => [node.dataset.field, node.dataset.value])),
  );

async function showsFields(page, result) {
  const shown = await fields(page);
  for (const [key, value] of Object.entries(result)) {
    if (["samples", "about", "boundaries", "solutions", "title", "nodes"].includes(key)) continue;
    assert.equal(shown[key], JSON.stringify(value), key);
  }
  assert.equal(await page.textContent("[data-field=action]"), shownAs(result.action));
}

/** As a page writes a value: numbers to the last digit, small ones with an exponent. */
const shownAs = (value) =>
  typeof value === "number" && 0 < Math.abs(value) && Math.abs(value) < 1e-4
    ? value.toExponential()
    : String(value);

const number = (text) => Number(text.replace("\u2212", "-"));
const readout = async (page, column) => number(await page.textContent(`output[data-column="${column}"]`));
const time = (page) => page.$eval(".time", (node) => Number(node.dataset.value));
const large = ".stage div:not([hidden]) > canvas";
/** What the large picture shows now. */
const picture = (page) => page.$eval(large, (canvas) => canvas.toDataURL());

function near(found, wanted, range) {
  assert.ok(Math.abs(found - wanted) <= 1e-5 * range, `${found} instead of ${wanted}`);
}

async function moves(page) {
  if ((await page.getAttribute(".play", "aria-pressed")) !== "true") await page.keyboard.press("Space");
  const first = await picture(page);
  await page.waitForFunction(
    (before) => Number(document.querySelector(".time").dataset.value) !== before,
    await time(page),
  );
  await page.waitForFunction(
    ([canvas, before]) => document.querySelector(canvas).toDataURL() !== before,
    [large, first],
    { polling: 50 },
  );
  await page.keyboard.press("Space");
  await page.waitForFunction(() => document.querySelector(".play").getAttribute("aria-pressed") !== "true");
  await page.waitForTimeout(150);
  const still = await picture(page);
  await page.waitForTimeout(150);
  assert.equal(await picture(page), still, "the picture moves in a pause");
}

test("a transfer in the plane: numbers, motion, keys, themes", async () => {
  const { file, result } = made("solve", "kepler", "--samples", "5");
  await withPage(file, "pause&time=0.25", async (page) => {
    await showsFields(page, result);
    near(await time(page), result.samples.t[1], result.duration);
    near(await readout(page, 0), result.samples.x[1], 2);
    near(await readout(page, 1), result.samples.y[1], 2);
    await moves(page);
    const at = await time(page);
    await page.keyboard.press("ArrowRight");
    assert.ok((await time(page)) > at);
    await page.keyboard.press("Home");
    assert.equal(await time(page), 0);
    await page.keyboard.press("v");
    assert.equal(await page.getAttribute(".tabs button:nth-child(2)", "aria-pressed"), "true");
    await page.keyboard.press("]");
    assert.equal(await page.textContent(".speed"), "2\u00d7");
    const light = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const before = await picture(page);
    await page.keyboard.press("t");
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), light);
    assert.notEqual(await picture(page), before);
    await page.keyboard.press("?");
    assert.ok(await page.isVisible("dialog[open]"));
  });
});

test("the reader's system chooses between light and dark", async () => {
  const { file } = made("solve", "kepler");
  for (const colorScheme of ["light", "dark"])
    await withPage(
      file,
      "pause",
      async (page) => {
        assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), colorScheme);
      },
      { context: { colorScheme } },
    );
});

test("a search: every solution beside the others, one in front", async () => {
  const { file, result } = made("solve", "pendulum-solutions");
  await withPage(file, "pause&time=0.3", async (page) => {
    assert.equal(await page.locator(".solutions button").count(), result.solutions.length);
    const small = () => page.$$eval(".solutions canvas", (all) => all.map((canvas) => canvas.toDataURL()));
    const pictures = await small();
    assert.equal(new Set(pictures).size, pictures.length, "solutions look alike");
    const last = result.solutions.length - 1;
    await page.click(`.solutions button:nth-child(${last + 1})`);
    await showsFields(page, result.solutions[last]);
    await page.keyboard.press("ArrowDown");
    await showsFields(page, result.solutions[last - 1]);
    assert.equal(await page.locator(".conjugate").count(), result.solutions[last - 1].conjugate_times.length);
    assert.equal(await page.locator(".window").count(), result.solutions[last - 1].windows.length);
    await moves(page);
    assert.notDeepEqual(await small(), pictures);
  });
});

test("a family in space: slider, diagram, orbit", async () => {
  const { file, result } = made("continue", "halo-family");
  assert.ok(statSync(file).size <= 1.5e6, `${statSync(file).size} bytes`);
  await withPage(file, "pause", async (page) => {
    await showsFields(page, result.points[0]);
    const first = await picture(page);
    const last = result.points.length - 1;
    await page.locator(".figure input[type=range]").fill(String(last));
    await showsFields(page, result.points[last]);
    near(await readout(page, 0), result.points[last].start.x, 1);
    assert.notEqual(await picture(page), first);
    // A press on the diagram where the dot of the first point was.
    const over = await page.locator(".figure .u-over").boundingBox();
    await page.locator(".figure input[type=range]").fill("0");
    const dot = await page.locator(".chosen").boundingBox();
    await page.locator(".figure input[type=range]").fill(String(last));
    await page.mouse.click(dot.x + dot.width / 2, dot.y + dot.height / 2);
    await showsFields(page, result.points[0]);
    assert.ok(dot.x >= over.x - 8 && dot.y >= over.y - 8);
    // Turned by a drag.
    const stage = await page.locator(".deep").boundingBox();
    const before = await picture(page);
    await page.mouse.move(stage.x + 300, stage.y + 200);
    await page.mouse.down();
    await page.mouse.move(stage.x + 380, stage.y + 240, { steps: 4 });
    await page.mouse.up();
    assert.notEqual(await picture(page), before);
    await moves(page);
  });
});

test("bodies in the plane; a chain; a lone coordinate", async () => {
  for (const scene of ["figure-eight", "fpu-chain", "pendulum"]) {
    const { file, result } = made("solve", scene, "--samples", "3");
    await withPage(file, "pause&time=0.5", async (page) => {
      await showsFields(page, result);
      const name = Object.keys(result.samples)[1],
        range = Math.max(...result.samples[name].map(Math.abs));
      if (scene !== "fpu-chain") near(await readout(page, 0), result.samples[name][1], range);
      await moves(page);
    });
  }
});

test("a comparison and a spectrum", async () => {
  const { file, result } = made("compare", "kepler");
  await withPage(file, "", async (page) => {
    for (const [k, row] of result.rows.entries())
      for (const key of ["method", "seconds", "error", "status"])
        assert.equal(
          await page.textContent(`[data-row="${k}"][data-field=${key}]`),
          row[key] === null ? "\u2013" : shownAs(row[key]),
        );
    await page.locator(".figure canvas").first().waitFor();
  });
  const spectrum = made("spectrum", "henon-heiles");
  await withPage(spectrum.file, "pause", (page) => showsFields(page, spectrum.result));
});

test("a saved result has the same page; without samples it says what to do", async () => {
  const { result } = made("solve", "nbody-space", "--samples", "10000");
  const saved = join(folder, "nbody-space-solve.json"),
    file = join(folder, "saved.html");
  assert.ok(statSync(saved).size > 1.5e6);
  for (const page of [join(folder, "nbody-space-solve.html"), file]) {
    if (page === file) assert.equal(run("view", saved, "--output", file), `${file}\n`);
    assert.ok(statSync(page).size <= 1.5e6, `${statSync(page).size} bytes`);
  }
  await withPage(file, "pause", (page) => showsFields(page, result));
  made("solve", "kepler");
  assert.throws(
    () => execFileSync(program, ["view", "kepler-solve.json"], { cwd: folder, stdio: "pipe" }),
    (error) => error.status === 2 && /--samples 1000/.test(String(error.stderr)),
  );
});

test("a saved branch has its orbits; without samples its page says what to do", async () => {
  const remark = "extremal continue SCENE --samples 200 --output FILE";
  for (const words of [[], ["--samples", "60"]]) {
    const { result } = made("continue", "halo-family", "--set", "continuation.points=4", ...words);
    const file = join(folder, "saved-branch.html");
    run("view", join(folder, "halo-family-continue.json"), "--output", file);
    await withPage(file, "pause", async (page) => {
      const text = await page.textContent("main");
      assert.equal(text.includes(remark), words.length === 0);
      assert.equal(await page.locator(".stage canvas").count() > 0, words.length > 0);
      const last = result.points.length - 1;
      await page.locator(".figure input[type=range]").fill(String(last));
      const { samples, ...shown } = result.points[last];
      await showsFields(page, shown);
      if (words.length === 0) return;
      near(await readout(page, 0), samples.x[0], 1);
      await moves(page);
    });
  }
});

test("the work of a frame is small and does not grow with the result", async () => {
  const most = { calls: 600, changes: 40 };
  for (const scene of ["nbody", "pendulum-solutions", "kepler-tour"]) {
    const found = [];
    for (const samples of ["1000", "10000"])
      await withBrowser(async (browser) => {
        const { file } = made("solve", scene, "--samples", samples);
        const { page } = await openPage(browser, file, "pause", { frames: true });
        found.push(await countFrames(page, 500));
      });
    for (const { calls, changes } of found) {
      assert.ok(Math.max(...calls) <= most.calls, `${scene}: ${Math.max(...calls)} calls`);
      assert.ok(Math.max(...changes) <= most.changes, `${scene}: ${Math.max(...changes)} changes`);
    }
    const [few, many] = found.map(({ calls }) => Math.max(...calls));
    assert.ok(many <= 1.5 * few, `${scene}: ${few} calls, then ${many}`);
  }
});

test("walls, contacts and waypoints are drawn and marked", async () => {
  const walls = made("solve", "pendulum-walls");
  await withPage(walls.file, "pause", async (page) => {
    assert.equal(await page.locator(".marks .contact").count(), walls.result.contacts.length);
    assert.match(await page.textContent(".legend"), /contact/);
    const { windows, ...shown } = walls.result;
    assert.equal(windows, null);
    await showsFields(page, shown);
  });
  const tour = made("solve", "kepler-tour");
  await withPage(tour.file, "pause", async (page) => {
    assert.equal(await page.locator(".marks .waypoint").count(), tour.result.waypoints.length);
    const title = await page.locator(".marks .waypoint").first().getAttribute("title");
    for (const name of Object.keys(tour.result.waypoints[0].impulse)) assert.match(title, RegExp(name));
  });
});

/** How many pixels of the plain canvas have each of some colours of the style sheet. */
const coloured = (page, names) =>
  page.evaluate((names) => {
    const style = getComputedStyle(document.documentElement);
    const canvas = document.querySelector(".flat canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return names.map((name) => {
      const hex = style.getPropertyValue(`--${name}`).trim();
      const wanted = [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
      let count = 0;
      for (let k = 0; k < data.length; k += 4)
        count += wanted.every((part, channel) => data[k + channel] === part) ? 1 : 0;
      return count;
    });
  }, names);

test("contacts and waypoints are seen on the path", async () => {
  for (const [scene, ...seen] of [
    ["keep-out-transfer", true, false],
    ["kepler-tour", false, true],
    ["kepler", false, false],
  ])
    await withPage(made("solve", scene).file, "pause&theme=light", async (page) => {
      const counts = await coloured(page, ["contact", "waypoint"]);
      assert.deepEqual(
        counts.map((count) => count > 20),
        seen,
        `${scene}: ${counts}`,
      );
    });
});

test("small numbers have an exponent", async () => {
  const { file, result } = made("compare", "kepler");
  const row = result.rows.findIndex(({ seconds }) => seconds < 1e-4);
  await withPage(file, "", async (page) => {
    const text = await page.textContent(`[data-row="${row}"][data-field=seconds]`);
    assert.match(text, /^\d(\.\d+)?e-[5-9]$/);
    assert.equal(Number(text), result.rows[row].seconds);
  });
});

test("titles and names are texts", async () => {
  const title = "</script><script>alert(1)</script><img src=x onerror=alert(2)> & 'a' \"b\" \u2028 <!--";
  const scene = join(folder, "tags.toml");
  writeFileSync(
    scene,
    `title = ${JSON.stringify(title)}\n` +
      readFileSync(join(scenes, "kepler.toml"), "utf8").replace(/^title.*\n/, ""),
  );
  const { file } = made("solve", scene, "--samples", "3");
  run("view", "tags-solve.json", "--output", "tags-view.html");
  for (const page of [file, join(folder, "tags-view.html")])
    await withPage(page, "pause", async (opened) => {
      const alerts = [];
      opened.on("dialog", (dialog) => (alerts.push(dialog.message()), dialog.dismiss()));
      await opened.reload();
      await opened.waitForSelector("html[data-ready]");
      assert.ok((await opened.textContent("h1")).startsWith("</script><script>alert(1)</script><img"));
      assert.ok((await opened.title()).startsWith("</script><script>alert(1)</script><img"));
      assert.equal(await opened.locator("img").count(), 0);
      assert.equal(JSON.parse(await opened.textContent("#data")).title, title);
      assert.deepEqual(alerts, []);
    });
});

test("without WebGL space is drawn on a plain canvas", async () => {
  const { file, result } = made("solve", "cr3bp");
  await withPage(
    file,
    "pause&time=0.2",
    async (page) => {
      assert.match(await page.textContent(".hint"), /without WebGL/);
      await showsFields(page, result);
      await moves(page);
    },
    { flags: ["--disable-gpu", "--disable-webgl", "--disable-3d-apis"] },
  );
});

test("a narrow window has all of it", async () => {
  const { file } = made("solve", "cr3bp");
  await withPage(
    file,
    "pause",
    async (page) => {
      const wide = await page.evaluate(
        () => document.documentElement.scrollWidth - document.documentElement.clientWidth,
      );
      assert.ok(wide <= 0, `${wide} pixels too wide`);
      assert.ok(await page.isVisible(".stage div:not([hidden]) > canvas"));
    },
    { context: { viewport: { width: 390, height: 800 } } },
  );
});
