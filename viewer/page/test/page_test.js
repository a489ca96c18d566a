// The page in a real browser: node page_test.js PROGRAM BROWSER FOLDER
import { strict as assert } from 'node:assert';
import { mkdtempSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { fail, number, open, run, startBrowser, until, view } from './program.js';

const [program, browserPath, folder] = process.argv.slice(2);
const work = mkdtempSync(join(folder, 'page-test-'));
const sequence = join(work, 'sequence');
const map = join(work, 'room.map');
const frames = 40;

const wide = { viewport: { width: 1280, height: 800 } };
const narrow = { viewport: { width: 400, height: 800 } };
const pixels = (page) => page.evaluate(() => document.getElementById('picture').toDataURL('image/png'));
const text = (page, selector) => page.textContent(selector);

async function pausesStepsAndGoesOn(page) {
  await until(page, () => document.getElementById('state').textContent === 'paused');
  assert.equal(await number(page, 'rows'), 0, 'the playback did not wait');
  let picture = null;
  for (let frame = 0; frame < 6; ++frame) {
    await page.keyboard.press('ArrowRight');
    await until(page, (wanted) => document.getElementById('picture').dataset.frame === wanted, String(frame));
    assert.equal(await number(page, 'frame'), frame);
    assert.equal(await number(page, 'rows'), frame + 1, 'the path did not grow by one');
    const now = await pixels(page);
    assert.ok(now !== picture, 'the picture did not change');
    picture = now;
  }
  await page.waitForTimeout(500);
  assert.equal(await number(page, 'frame'), 5, 'a paused page showed another frame');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await number(page, 'frame'), 4);
  await page.click('#pause');
  await until(page, () => Number(document.body.dataset.frame) > 5);
}

async function showsTheEnd(page) {
  await until(page, () => document.getElementById('state').textContent === 'finished');
  // A busy machine may leave frames out, but never the last.
  await until(page, (frame) => document.body.dataset.frame === String(frame), frames - 1);
  await until(page, () => document.getElementById('error-note').textContent.startsWith('RMSE'));
  assert.ok(Number((await text(page, '#error-note')).match(/[\d.]+/)[0]) < 50, 'the error is large');
  await page.focus('#scrub');
  await page.keyboard.press('Home');
  await until(page, () => document.body.dataset.frame === '0');
  await page.keyboard.press('End');
  await page.click('#live');
  await until(page, (frame) => document.body.dataset.frame === String(frame), frames - 1);
}

async function fits(page, width) {
  const wider = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wider <= width, `the page is ${wider} pixels wide, not ${width}`);
  for (const id of ['world-canvas', 'picture', 'pause', 'scrub', 'messages']) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box && box.width > 20 && box.x >= 0 && box.x + box.width <= width, `#${id} is outside`);
  }
}

async function test(browser, problems) {
  const live = await view(program, [sequence, '--paused', '--map', map]);
  try {
    const page = await open(browser, live.url, wide, problems);
    await pausesStepsAndGoesOn(page);
    // Drawn by software it is slow, so it goes again.
    const clouds = page.waitForResponse((answer) => answer.url().includes('/api/cloud') && answer.ok());
    await page.getByLabel('dense cloud').check();
    await clouds;
    await page.getByLabel('dense cloud').uncheck();
    await showsTheEnd(page);
    await fits(page, 1280);
    await page.reload();
    await until(page, (frame) => document.body.dataset.frame === String(frame), frames - 1);
    await page.close();

    // One browser has six connections to a server, and pages that wait for no other.
    const context = await browser.newContext(narrow);
    const ten = [];
    for (let i = 0; i < 10; ++i) ten.push(await open(context, live.url, undefined, problems));
    for (const one of ten) {
      await until(one, (frame) => document.getElementById('picture').dataset.frame === String(frame),
        frames - 1);
    }
    await fits(ten[9], 400);
    await context.close();
    assert.equal(await live.interrupt(), 0);
  } finally {
    live.kill();
  }
}

// A run that fuses its dense map shows that one, and not the keyframes' images.
async function testFused(browser, problems) {
  const live = await view(program, [sequence, '--dense', join(work, 'room.ply'), '--voxel', '0.04']);
  try {
    const page = await open(browser, live.url, wide, problems);
    let keyframes = 0;
    page.on('request', (request) => { if (request.url().includes('/api/cloud')) ++keyframes; });
    // The first ones may hold little: the run has just begun.
    const cloud = page.waitForResponse(async (answer) => answer.url().includes('/api/fused')
      && answer.status() === 200 && (await answer.body()).length > 10_000);
    await page.getByLabel('dense cloud').check();
    await cloud;
    await until(page, () => document.getElementById('state').textContent === 'finished');
    assert.equal(keyframes, 0, 'clouds of keyframes were fetched');
    assert.equal(await live.interrupt(), 0);
  } finally {
    live.kill();
  }
}

async function testMap(browser, problems) {
  const stored = await view(program, [map]);
  try {
    const page = await open(browser, stored.url, wide, problems);
    await until(page, () => document.getElementById('state').textContent === 'map');
    await until(page, () => /landmarks\s*[1-9]/.test(document.getElementById('numbers').textContent));
    assert.equal(await stored.interrupt(), 0);
  } finally {
    stored.kill();
  }
}

const problems = [];
let browser = null;
try {
  run(program, ['synth', 'walking_xyz', '--frames', String(frames), '--width', '320', '--height', '240',
    '--out', sequence]);
  browser = await startBrowser(browserPath);
  await test(browser, problems);
  await testFused(browser, problems);
  await testMap(browser, problems);
  // A program that has ended is no fault of the page.
  const own = problems.filter((text) => !/ERR_CONNECTION|ERR_INCOMPLETE|ERR_EMPTY/.test(text));
  if (own.length > 0) fail(own.join('\n'));
  console.log('page: all well');
} finally {
  await browser?.close();
  rmSync(work, { recursive: true, force: true });
}
