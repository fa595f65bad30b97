// three.js beside lambake: what lambake wrote, shown as it is, against its per-vertex picture; and the
// original scene, lit by three.js per pixel, against its per-fragment one. Linear floats are compared.
import assert from "node:assert/strict";
import { createReadStream, existsSync } from "node:fs";
import { createServer } from "node:http";
import { basename, dirname, extname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import { lambake, realMeshes, root, scratchFolder } from "./gltf_files.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const scratch = scratchFolder();
const size = { width: 240, height: 135 };
let server, browser, page;

before(async () => {
  server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
    const file = path.startsWith("/scratch/") ? join(scratch, basename(path)) : join(here, path);
    if (!existsSync(file)) return response.writeHead(404).end();
    const types = { ".html": "text/html", ".js": "text/javascript" };
    response.writeHead(200, { "Content-Type": types[extname(file)] ?? "application/octet-stream" });
    createReadStream(file).pipe(response);
  });
  await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
  browser = await chromium.launch({
    executablePath: "/usr/bin/chromium",
    args: ["--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
           "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
           "--disable-sync"],
  });
  page = await browser.newPage();
  page.on("pageerror", (error) => console.error(String(error)));
  page.setDefaultTimeout(240_000);
  await page.goto(`http://127.0.0.1:${server.address().port}/three_page.html`);
  await page.waitForFunction(() => window.isReady);
});

after(async () => {
  await browser?.close();
  server?.close();
});

/** The numbers of three.js' picture of `glb` against lambake's picture of `scene`. */
async function compare(t, { scene, glb, camera, shading, lit, finer, exposure = 0 }) {
  const exr = join(scratch, "reference.exr");
  lambake(["render", scene, "--quiet", "--shading", shading, "--camera", camera, "--exposure", exposure, "--size",
           `${size.width}x${size.height}`, "-o", exr]);
  const result = await page.evaluate((options) => window.compare(options), {
    glb: `/scratch/${basename(glb)}`, exr: "/scratch/reference.exr", camera, lit, finer, ...size,
  });
  t.diagnostic(JSON.stringify(result));
  if (process.env.LAMBAKE_SHOTS)
    await page.locator("canvas").last().screenshot({ path: join(process.env.LAMBAKE_SHOTS, `${t.name}.png`) });
  return result;
}

function assertEqual(result, least) {
  assert.ok(result.compared >= least, `only ${result.compared} pixels were compared`);
  assert.ok(result.median <= 1e-5, `median difference ${result.median} of the brightest pixel`);
  assert.ok(result.p999 <= 2, `99.9 % are within ${result.p999}/255`);
}

const scenes = [
  { name: "gallery", file: join(root, "meshes/gallery.glb"), camera: "room", least: 20000 },
  { name: "lights", file: join(realMeshes, "Lights.glb"), camera: "0", least: 1000 },
];

for (const { name, file, camera, least } of scenes) {
  test(`${name}: what bake wrote, in three.js as it is, is lambake's per-vertex picture`, async (t) => {
    const glb = join(scratch, `${name}.lit.glb`), exposure = -4; // Nothing is clipped then.
    lambake(["bake", file, "--quiet", "--color", "f32", "--exposure", exposure, "-o", glb]);
    assertEqual(await compare(t, { scene: file, glb, camera, shading: "vertex", lit: false, finer: 17, exposure }), least);
  });

  test(`${name}: three.js' Lambert per pixel is lambake's per-fragment picture`, async (t) => {
    const glb = join(scratch, `${name}.glb`);
    lambake(["bake", file, "--quiet", "--no-unlit", "--attribute", "_LIGHT", "-o", glb]);
    assertEqual(await compare(t, { scene: file, glb, camera, shading: "fragment", lit: true, finer: 9 }), least);
  });
}
