/// <reference types="vitest/config" />
import react from "@vitejs/plugin-react";
import { defineConfig } from "vite";

// Nothing inline and nothing from elsewhere: the servers send a strict Content-Security-Policy.
export default defineConfig(({ mode }) => {
  const isUnit = mode === "operate";
  return {
    root: isUnit ? "operate" : ".",
    base: "./",
    plugins: [react()],
    build: {
      outDir: isUnit ? "../../jausml/live/operating/page" : "../jausml/authoring/studio/page",
      emptyOutDir: true,
      target: "es2022",
      assetsInlineLimit: 0,
      modulePreload: { polyfill: false },
      license: { fileName: "licenses.md" },
      chunkSizeWarningLimit: 1000,
    },
    test: {
      environment: "jsdom",
      // Files share what they import, which takes longer than their tests; setup.ts clears the page.
      isolate: false,
      // One preact for what is imported and what is required: hooks of a second one would find nothing.
      execArgv: ["--conditions=module"],
      setupFiles: ["src/testing/setup.ts"],
      restoreMocks: true,
      testTimeout: 60_000,
    },
  };
});
