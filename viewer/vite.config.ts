import { defineConfig } from "vite";

// The server embeds dist/ and serves it at the root. No inline scripts: its policy is `default-src 'self'`.
const build = {
  target: "es2022",
  modulePreload: { polyfill: false },
  assetsInlineLimit: 0,
  chunkSizeWarningLimit: 1100,
  reportCompressedSize: false,
};

// `--mode film`: script and styles of recordings that play by themselves, each one file, which the page puts into them.
const film = {
  ...build,
  emptyOutDir: false,
  copyPublicDir: false,
  lib: { entry: "src/film/main.ts", formats: ["iife" as const], name: "film", fileName: () => "film.js", cssFileName: "film" },
};

export default defineConfig(({ mode }) => ({ base: "./", build: mode === "film" ? film : build }));
