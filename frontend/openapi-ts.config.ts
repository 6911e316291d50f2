import { defineConfig } from "@hey-api/openapi-ts";

export default defineConfig({
  input: "openapi.json",
  // DROPFLOW_CLIENT: where `scripts/check-client.mjs` has the client made, to compare it with the committed one.
  output: process.env.DROPFLOW_CLIENT ?? "src/client",
  plugins: [
    { name: "@hey-api/client-fetch", throwOnError: true },
    "@hey-api/typescript",
    "@hey-api/sdk",
    "@tanstack/react-query",
  ],
});
