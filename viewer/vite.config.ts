import { defineConfig } from "vite";

// The server embeds dist/ and serves it at the root. No inline scripts: its policy is `default-src 'self'`.
export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    modulePreload: { polyfill: false },
    assetsInlineLimit: 0,
    chunkSizeWarningLimit: 1100,
    reportCompressedSize: false,
  },
});
