import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

const apiPort = process.env.API_PORT ?? "8000";

export default defineConfig({
  // Relative addresses: the page works under any prefix (see index.html for the one thing the server sets).
  base: "./",
  plugins: [react()],
  // Modules that plotly.js brings along were written for Node.
  define: { global: "globalThis" },
  server: { host: "127.0.0.1", proxy: { "/api": `http://127.0.0.1:${apiPort}` } },
  // Plotly is one chunk of its own, loaded with the first plot.
  build: {
    chunkSizeWarningLimit: 2500,
    target: "es2022",
    rolldownOptions: {
      // A module that plotly.js brings along has a directive of its author's own, which means nothing to anyone.
      onLog: (level, log, handle) => log.code !== "MODULE_LEVEL_DIRECTIVE" && handle(level, log),
    },
  },
  test: {
    environment: "jsdom",
    include: ["src/**/*.test.{ts,tsx}"],
    setupFiles: ["src/testing.ts"],
    isolate: false,
    // Typing into forms takes its time on a busy machine.
    testTimeout: 30_000,
    maxWorkers: 2,
  },
});
