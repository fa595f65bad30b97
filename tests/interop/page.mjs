// The pages of `lambake compare` and `lambake chart` in Chromium, from disk, as a reader has them.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import Ajv from "ajv/dist/2020.js";
import { chromium } from "playwright-core";

const root = fileURLToPath(new URL("../..", import.meta.url));
const widths = [1440, 900, 390];
let folder, browser, compare, chart;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "lambake-page-"));
  const tool = (...args) => execFileSync(process.env.LAMBAKE_TOOL, args, { stdio: "pipe" });
  compare = join(folder, "compare");
  chart = join(folder, "chart");
  const model = join(root, "meshes", "torus_knot.ply");
  const lights = ["--sun", "0.4,1,0.3", "--lamp", "2,1,2,3,2,1"];
  tool("compare", model, ...lights, "--method", "auto", "--size", "1920x1080", "-o", compare);
  tool("chart", model, ...lights, "--budget-seconds", "8", "-o", chart);
  browser = await chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/// Opens index.html of a folder; everything that the console or the network says ends up in `said`.
async function open(where, width, colorScheme = "light", javaScriptEnabled = true) {
  const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme, javaScriptEnabled });
  const page = await context.newPage();
  const said = [];
  page.on("console", (message) => said.push(message.text()));
  page.on("pageerror", (error) => said.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data):/.test(request.url())) said.push(request.url());
  });
  await page.goto(pathToFileURL(join(where, "index.html")).href);
  return { page, said, context };
}

/// Fails unless `json` is as the schema in docs/ says; and unless the schema notices what is wrong.
function check(name, json) {
  const schema = JSON.parse(readFileSync(join(root, "docs", `${name}.schema.json`), "utf8"));
  const validate = new Ajv({ allErrors: true, allowUnionTypes: true, strictTypes: false }).compile(schema);
  assert.ok(validate(json), `${name}: ${JSON.stringify(validate.errors, null, 1)}`);
  const without = { ...json };
  delete without.triangles;
  for (const wrong of [{ ...json, triangles: -1 }, { ...json, triangles: "many" }, { ...json, unheard_of: 1 }, without])
    assert.ok(!validate(wrong), `${name}: should not be valid`);
}

test("report.json and chart.json are as the schemas in docs/ say", () => {
  check("report", JSON.parse(readFileSync(join(compare, "report.json"), "utf8")));
  check("chart", JSON.parse(readFileSync(join(chart, "chart.json"), "utf8")));
  // One that leaves time for every part, with a lamp on the surface: what has no bound is null.
  const whole = JSON.parse(execFileSync(process.env.LAMBAKE_TOOL, ["chart", join(root, "meshes", "uv_sphere.obj"),
    "--lamp", "0,1,0", "--methods", "face,sample", "--budget-seconds", "20", "-o", join(folder, "whole"), "--json"], { stdio: "pipe" }).toString());
  assert.ok(whole.methods.length > 0 && whole.pictures.length > 0 && whole.over_lights.length > 0);
  assert.equal(whole.methods[0].surface_display.max_bound, null);
  check("chart", whole);
});

test("what --json prints is as the schemas in docs/ say", () => {
  const model = (name) => join(root, "meshes", name);
  const say = (...args) => JSON.parse(execFileSync(process.env.LAMBAKE_TOOL, args, { stdio: "pipe" }).toString());
  const glb = join(folder, "lit.glb");
  for (const name of ["gallery.glb", "dirty.ply", "uv_sphere.obj"]) check("info", say("info", model(name), "--json"));
  check("render", say("render", model("dirty.ply"), "-o", join(folder, "a.png"), "--size", "64x48", "--json"));
  for (const method of ["sample", "adaptive", "auto"])
    check("bake", say("bake", model("icosphere_2.off"), "-o", glb, "--method", method, "--max-vertices", "200", "--json"));
  // A lamp on the surface: what has no bound is null.
  const lit = say("bake", model("uv_sphere.obj"), "--lamp", "0,1,0", "--method", "auto", "--max-vertices", "2000", "-o", glb, "--json");
  assert.equal(lit.auto.trials[0].max_bound, null);
  check("bake", lit);
});

test("a page of a 1920x1080 comparison is at most 5 MB", () => {
  assert.ok(statSync(join(compare, "index.html")).size <= 5e6);
});

for (const width of widths)
  for (const scheme of ["light", "dark"])
    for (const name of ["compare", "chart"])
      test(`${name}, ${width} wide, ${scheme}: pictures shown, nothing cut off, contrast, no message`, async () => {
        const { page, said, context } = await open(name === "compare" ? compare : chart, width, scheme);
        const found = await page.evaluate(() => {
          const visible = (element) => element.checkVisibility() && getComputedStyle(element).visibility === "visible";
          const rgb = (color) => color.match(/[\d.]+/g).map(Number);
          const luminance = (color) => rgb(color).slice(0, 3).map((c) => c / 255)
            .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
            .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
          const background = (element) => {
            for (let e = element; e; e = e.parentElement) {
              const color = getComputedStyle(e).backgroundColor;
              if ((rgb(color)[3] ?? 1) > 0) return color;
            }
            return "rgb(255, 255, 255)";
          };
          const contrast = (a, b) => {
            const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y);
            return (high + 0.05) / (low + 0.05);
          };
          const texts = [...document.querySelectorAll("body *")].filter((element) =>
            visible(element) && [...element.childNodes].some((n) => n.nodeType === 3 && n.data.trim()) &&
            !["SCRIPT", "STYLE", "TITLE"].includes(element.nodeName.toUpperCase()));
          const faint = texts.map((element) => {
            const style = getComputedStyle(element);
            const color = element.ownerSVGElement ? style.fill : style.color;
            return [element.textContent.trim().slice(0, 40), contrast(color, background(element))];
          }).filter(([, value]) => value < 4.5);
          const cut = texts.filter((element) => {
            const box = element.getBoundingClientRect();
            if (element.matches(".skip")) return false;
            return box.width > 0 && (box.left < -0.5 || box.right > innerWidth + 0.5);
          }).map((element) => element.textContent.trim().slice(0, 40));
          // Texts of charts must also stay inside of their drawing.
          const outside = [...document.querySelectorAll("svg text")].filter(visible).filter((text) => {
            const box = text.getBoundingClientRect(), frame = text.ownerSVGElement.getBoundingClientRect();
            return box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 ||
              box.bottom > frame.bottom + 1;
          }).map((text) => text.textContent);
          return {
            faint, cut, outside,
            n_texts: texts.length,
            overflow: document.documentElement.scrollWidth - innerWidth,
            blank: [...document.images].filter((image) => !(image.complete && image.naturalWidth > 0)).length,
            n_images: document.images.length,
            unnamed: [...document.images].filter((image) => !image.alt).length,
            landmarks: ["header", "main", "footer", "h1"].filter((name) => !document.querySelector(name)),
          };
        });
        assert.ok(found.n_texts > 30);
        assert.deepEqual(found.faint, []);
        assert.deepEqual(found.cut, []);
        assert.deepEqual(found.outside, []);
        assert.ok(found.overflow <= 0, `${found.overflow} pixels wider than the window`);
        assert.equal(found.blank, 0);
        assert.equal(found.unnamed, 0);
        assert.deepEqual(found.landmarks, []);
        assert.deepEqual(said, []);
        if (name === "compare") assert.ok(found.n_images >= 4);
        await context.close();
      });

/// The share of the stage that the left picture covers, in percent.
const split = (page) => page.$eval(".stage", (stage) => parseFloat(stage.style.getPropertyValue("--split")));

test("the slider follows keys, the mouse and a finger", async () => {
  const { page, said, context } = await open(compare, 1440);
  const range = page.getByLabel("Line between the two pictures");
  await range.focus();
  for (let i = 0; i < 10; ++i) await page.keyboard.press("ArrowRight");
  assert.equal(await split(page), 55);
  await page.keyboard.press("Home");
  assert.equal(await split(page), 0);
  assert.match(await range.getAttribute("aria-valuetext"), /^0 % per vertex, the rest per pixel$/);

  const stage = await page.locator(".stage").boundingBox();
  const at = (share) => [stage.x + share * stage.width, stage.y + stage.height / 2];
  await page.mouse.move(...at(0.2));
  await page.mouse.down();
  await page.mouse.move(...at(0.75), { steps: 5 });
  await page.mouse.up();
  assert.ok(Math.abs((await split(page)) - 75) < 1);
  await page.mouse.move(...at(0.1));
  assert.ok(Math.abs((await split(page)) - 75) < 1, "without a button the line stays");
  assert.deepEqual(said, []);
  await context.close();

  const touch = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
  const phone = await touch.newPage();
  await phone.goto(pathToFileURL(join(compare, "index.html")).href);
  await phone.locator(".stage").scrollIntoViewIfNeeded();
  const box = await phone.locator(".stage").boundingBox();
  await phone.touchscreen.tap(box.x + 0.3 * box.width, box.y + box.height / 2);
  assert.ok(Math.abs((await split(phone)) - 30) < 1);
  await touch.close();
});

test("the slider shows the picture that it says: per vertex on the left, per pixel on the right", async () => {
  const { page, context } = await open(compare, 1440);
  const shown = async (name) => {
    await page.getByLabel(name, { exact: true }).check();
    return page.$$eval(".stage img", (images) => Object.fromEntries(images.map((image) =>
      [image.dataset.layer, image.classList.contains("left") ? "left" : image.classList.contains("right") ? "right" : ""])));
  };
  assert.deepEqual(await shown("per vertex and per pixel"), { vertex: "left", fragment: "right", difference: "" });
  assert.deepEqual(await shown("per pixel and difference"), { vertex: "", fragment: "left", difference: "right" });
  // Each shows the pixels of its file; the background, which is black there, in a grey of its own.
  for (const [layer, file] of [["vertex", "per_vertex.png"], ["fragment", "per_fragment.png"]]) {
    const whole = "data:image/png;base64," + readFileSync(join(compare, file)).toString("base64");
    const isSame = await page.evaluate(async ([layer, whole]) => {
      const isLit = (data, i) => data[i] + data[i + 1] + data[i + 2] > 0;
      const isGrey = (data, i) => data[i] === 58 && data[i + 1] === 60 && data[i + 2] === 66;
      // The pixels within the box of those that `isModel`.
      const model = async (source, isModel) => {
        const image = new Image();
        image.src = source;
        await image.decode();
        const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
        canvas.drawImage(image, 0, 0);
        const { data } = canvas.getImageData(0, 0, image.width, image.height);
        let [left, top, right, bottom] = [image.width, image.height, -1, -1];
        for (let y = 0; y < image.height; ++y)
          for (let x = 0; x < image.width; ++x) {
            if (!isModel(data, 4 * (y * image.width + x))) continue;
            [left, top, right, bottom] = [Math.min(left, x), Math.min(top, y), Math.max(right, x), Math.max(bottom, y)];
          }
        return [right - left, bottom - top,
          canvas.getImageData(left, top, right - left + 1, bottom - top + 1).data];
      };
      const shown = document.querySelector(`img[data-layer="${layer}"]`).src;
      const a = await model(shown, (data, i) => isLit(data, i) && !isGrey(data, i)), b = await model(whole, isLit);
      let nGrey = 0;
      for (let i = 0; i < a[2].length; i += 4) {
        if (isGrey(a[2], i) && !isLit(b[2], i)) { ++nGrey; continue; }
        if ([0, 1, 2].some((k) => a[2][i + k] !== b[2][i + k])) return false;
      }
      return a[0] > 100 && a[0] === b[0] && a[1] === b[1] && nGrey > 1000;
    }, [layer, whole]);
    assert.ok(isSame, layer);
  }
  await context.close();
});

test("without scripts every picture is still there", async () => {
  const { page, context } = await open(compare, 1440, "light", false);
  assert.ok(await page.locator("#difference").isVisible());
  assert.ok(await page.locator(".stage img.right").isVisible());
  await context.close();
});

test("labels of the charts keep clear of each other", async () => {
  for (const width of widths) {
    const { page, context } = await open(chart, width);
    const clashes = await page.evaluate(() => {
      const clashes = [];
      for (const svg of document.querySelectorAll("svg.chart")) {
        if (!svg.checkVisibility()) continue;
        const boxes = [...svg.querySelectorAll(".label")].map((text) => [text.textContent, text.getBoundingClientRect()]);
        for (const [i, [a, p]] of boxes.entries())
          for (const [b, q] of boxes.slice(i + 1))
            if (Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 &&
                Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 4) clashes.push(`${a} / ${b}`);
      }
      return clashes;
    });
    assert.deepEqual(clashes, []);
    await context.close();
  }
});

test("chart.csv has a line for each method of chart.json", () => {
  const json = JSON.parse(readFileSync(join(chart, "chart.json"), "utf8"));
  const lines = readFileSync(join(chart, "chart.csv"), "utf8").trimEnd().split("\r\n");
  assert.equal(lines.length, 1 + json.methods.length + 2 * json.pictures.length);
  const columns = lines[0].split(",").length;
  for (const line of lines) assert.equal(line.split(",").length, columns, line);
  assert.equal(Number(lines[1].split(",")[10]), json.methods[0].surface_display.rmse);
});
