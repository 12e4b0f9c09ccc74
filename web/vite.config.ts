import react from "@vitejs/plugin-react";
import { defineConfig } from "vitest/config";

// The built pages, operation and designer, are package data of the Python server, which serves them from its own folder.
export default defineConfig({
  base: "./",
  plugins: [react()],
  build: {
    outDir: "../src/seacrane/server/page",
    emptyOutDir: true,
    chunkSizeWarningLimit: 1200,
    rolldownOptions: { input: ["index.html", "designer.html"] },
  },
  // constants stay constants: tables whose place the compiler knows take the load chart's loops a third less time
  worker: { format: "es", rolldownOptions: { output: { topLevelVar: false } } },
  server: { proxy: { "/rpc": { target: "ws://127.0.0.1:8765", ws: true }, "/api": "http://127.0.0.1:8765" } },
  test: { environment: "happy-dom", include: ["{core,operation,designer}/**/*.test.{ts,tsx}"] },
});
