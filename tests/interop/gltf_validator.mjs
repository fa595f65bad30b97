// Khronos' validator over everything that lambake writes: nothing that the input did not have.
import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { findings, lambake, realFiles, realMeshes, root, scratchFolder } from "./gltf_files.mjs";

const scratch = scratchFolder();

const ways = [
  ["glb", []],
  ["glb", ["--color", "u8", "--no-unlit"]],
  ["glb", ["--method", "face", "--color", "f32"]],
  ["gltf", ["--attribute", "_LIGHT", "--color", "f32"]],
];

// A material that is marked unlit keeps the extensions that it has: the asset comes back complete.
const accepted = "MULTIPLE_EXTENSIONS";
const findingsBefore = new Map();

async function assertNothingNew(file, written, options) {
  if (!findingsBefore.has(file)) findingsBefore.set(file, await findings(file));
  const before = findingsBefore.get(file);
  for (const [code, count] of await findings(written))
    assert.ok(code === accepted || count <= (before.get(code) ?? 0), `${file} ${options.join(" ")}: ${count} × ${code}`);
}

for (const [extension, options] of ways)
  test(`real files baked to .${extension} ${options.join(" ")}: no new error or warning`, async () => {
    let written = 0;
    for (const name of realFiles()) {
      const file = join(realMeshes, name), out = join(scratch, `out.${extension}`);
      if (lambake(["bake", file, "--quiet", ...options, "-o", out], [0, 4]) === 4) continue; // No triangle in it.
      await assertNothingNew(file, out, options);
      ++written;
    }
    assert.ok(written >= 45, `only ${written} files were written`);
  });

test("new assets from mesh files: no error or warning", async () => {
  for (const name of ["torus_knot.ply", "rounded_box.stl", "dirty.ply", "uv_sphere.obj", "icosphere_2.off"])
    for (const color of ["u8", "u16", "f32"]) {
      const out = join(scratch, "new.glb");
      lambake(["bake", join(root, "meshes", name), "--quiet", "--color", color, "-o", out]);
      assert.deepEqual(await findings(out), new Map(), `${name} ${color}`);
    }
});

test("the gallery: no error or warning", async () => {
  assert.deepEqual(await findings(join(root, "meshes/gallery.glb")), new Map());
});
