// What the tests of glTF share: the tool, the real meshes, a scratch folder, Khronos' validator.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { after } from "node:test";
import { fileURLToPath } from "node:url";
import validator from "gltf-validator";

export const root = resolve(dirname(fileURLToPath(import.meta.url)), "../..");
export const realMeshes = resolve(root, "../shared/meshes/gltf");
const tool = process.env.LAMBAKE_TOOL ?? join(root, "build/release/lambake");

/** Runs the tool; returns its exit code. What it says goes nowhere, unless it fails in a way not `allowed`. */
export function lambake(args, allowed = [0]) {
  try {
    execFileSync(tool, args.map(String), { stdio: ["ignore", "pipe", "pipe"] });
    return 0;
  } catch (error) {
    if (allowed.includes(error.status)) return error.status;
    throw new Error(`lambake ${args.join(" ")}: exit code ${error.status}\n${error.stderr}`);
  }
}

export function scratchFolder() {
  const folder = mkdtempSync(join(tmpdir(), "lambake-interop-"));
  after(() => rmSync(folder, { recursive: true }));
  return folder;
}

/** All glTF files below the folder of real meshes. */
export function realFiles() {
  return readdirSync(realMeshes, { recursive: true })
    .filter((name) => /\.(gltf|glb)$/.test(name))
    .sort();
}

/** The errors and warnings that the validator finds in a file, as a map from code to count. */
export async function findings(file) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(readFileSync(join(dirname(file), decodeURIComponent(uri)))),
  });
  const counts = new Map();
  for (const { code, severity } of report.issues.messages)
    if (severity <= 1) counts.set(code, (counts.get(code) ?? 0) + 1);
  return counts;
}
