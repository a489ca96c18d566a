import { defineConfig } from 'vite';

// One script, one style sheet and what public/ holds, under names that the program knows.
export default defineConfig({
  base: '/',
  build: {
    outDir: process.env.PAGE_FOLDER ?? 'built',
    emptyOutDir: true,
    target: 'es2022',
    sourcemap: false,
    modulePreload: false,
    cssCodeSplit: false,
    chunkSizeWarningLimit: 1200,
    rollupOptions: {
      output: {
        entryFileNames: 'page.js',
        chunkFileNames: 'page-[name].js',
        assetFileNames: 'page[extname]',
      },
    },
  },
});
