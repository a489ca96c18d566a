// The picture of docs/view.md: node screenshot.js PROGRAM BROWSER OUT.png FRAME SEQUENCE [OPTION...]
// Runs the sequence to its end with its dense cloud and shows one of its frames.
import { open, startBrowser, until, view } from './program.js';

const [program, browserPath, out, frame, ...args] = process.argv.slice(2);
const size = { viewport: { width: 1280, height: 860 } };
const settle = 4000;  // milliseconds: drawn by software it is slow

const live = await view(program, args);
const browser = await startBrowser(browserPath);
try {
  const problems = [];
  const page = await open(browser, live.url, size, problems);
  await page.getByLabel('dense cloud').check();
  await page.waitForFunction(() => document.getElementById('state').textContent === 'finished', null,
    { timeout: 600_000 });
  await page.waitForTimeout(settle);
  // Pictures are kept of those frames that were shown: the nearest to the one that is wanted.
  await page.evaluate((wanted) => {
    const scrub = document.getElementById('scrub');
    scrub.value = wanted;
    scrub.dispatchEvent(new Event('input', { bubbles: true }));
  }, frame);
  await until(page, () => document.getElementById('picture').dataset.frame !== undefined);
  await page.keyboard.press('f');
  await page.waitForTimeout(settle);
  await page.screenshot({ path: out });
  if (problems.length > 0) console.error(problems.join('\n'));
} finally {
  await browser.close();
  await live.interrupt();
}
