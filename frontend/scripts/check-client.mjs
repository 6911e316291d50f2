// Fails when src/client is not what openapi.json gives: run `npm run client` and commit.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { join } from "node:path";

const committed = "src/client";
const made = mkdtempSync(join(process.cwd(), "node_modules", ".client-"));
try {
  execFileSync("openapi-ts", ["--silent"], {
    env: { ...process.env, DROPFLOW_CLIENT: made },
    stdio: ["ignore", "ignore", "inherit"],
    shell: process.platform === "win32",
  });
  const differing = [...new Set([...filesOf(made), ...filesOf(committed)])].filter(
    (name) => read(made, name) !== read(committed, name),
  );
  if (differing.length > 0) {
    console.error(`src/client does not fit openapi.json (${differing.join(", ")}). Run: npm run client`);
    process.exitCode = 1;
  }
} finally {
  rmSync(made, { recursive: true, force: true });
}

function filesOf(folder) {
  return readdirSync(folder, { recursive: true, withFileTypes: true })
    .filter((entry) => entry.isFile())
    .map((entry) => join(entry.parentPath, entry.name).slice(join(folder).length + 1));
}

function read(folder, name) {
  try {
    return readFileSync(join(folder, name), "utf8");
  } catch {
    return null;
  }
}
