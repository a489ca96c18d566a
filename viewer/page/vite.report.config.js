import { readFileSync } from 'node:fs';
import { defineConfig } from 'vite';

const licence = readFileSync(new URL('node_modules/uplot/LICENSE', import.meta.url), 'utf8').trim();

// One script and one style sheet, which the program puts into the pages of bench, demo and eval.
export default defineConfig({
  publicDir: false,
  build: {
    outDir: process.env.REPORT_FOLDER ?? '../../dkp_slam/evaluation/report/page',
    emptyOutDir: true,
    target: 'es2022',
    sourcemap: false,
    lib: { entry: 'report/main.js', formats: ['iife'], name: 'report', fileName: () => 'report.js', cssFileName: 'report' },
    rollupOptions: { output: { postBanner: `/*! Draws with uPlot 1.6.32.\n\n${licence} */` } },
  },
});
