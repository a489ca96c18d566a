// The pages of bench, demo and eval in a real browser: node report_test.js PROGRAM BROWSER FOLDER [PICTURE]
import { strict as assert } from 'node:assert';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { fail, open, run, startBrowser } from './program.js';

const [program, browserPath, folder, picture] = process.argv.slice(2);
const work = mkdtempSync(join(folder, 'report-test-'));
const name = '<img src=x onerror=alert(1)>';  // of the sequence
const sequence = join(work, name);
const bench = join(work, 'bench');
const demo = join(work, 'demo');
const evaluation = join(work, 'eval.html');
const frames = 30;

const stamps = (file) => readFileSync(file, 'utf8').split('\n').filter((line) => /^\d/.test(line)).map(parseFloat);
const poses = (file) => stamps(file).length;
// Poses of the truth within the time of an estimate.
const during = (truth, file) => {
  const own = stamps(file);
  return stamps(truth).filter((t) => t >= own[0] - 0.02 && t <= own.at(-1) + 0.02).length;
};

// Names and counts of points of each chart's lines, as they are drawn.
const drawn = (page) => page.evaluate(() => [...document.querySelectorAll('.chart')].map(({ chart }) => (
  chart.plot.series.slice(1).map((series, i) => {
    const values = chart.plot.data[i + 1];
    const list = Array.isArray(values[0]) ? values[1] : values;
    return [series.label, list.filter((v) => v != null).length];
  }))));

const legend = (page, chart) => page.locator('.chart').nth(chart).locator('.u-legend tr');
const scale = (page, chart, axis) => page.evaluate(([i, key]) => {
  const { min, max } = document.querySelectorAll('.chart')[i].chart.plot.scales[key];
  return [min, max];
}, [chart, axis]);
const length = ([low, high]) => high - low;

// Where the pose of a path, or the value of a chart over time, is drawn.
async function hover(page, chart, series, point) {
  const box = page.locator('.chart').nth(chart);
  await box.scrollIntoViewIfNeeded();
  const at = await page.evaluate(([c, s, p]) => {
    const { plot } = document.querySelectorAll('.chart')[c].chart;
    const [xs, ys] = plot.mode === 2 ? plot.data[s] : [plot.data[0], plot.data[s]];
    return { x: plot.valToPos(xs[p], 'x'), y: plot.valToPos(ys[p], 'y') };
  }, [chart, series, point]);
  const { x, y } = await box.locator('.u-over').boundingBox();
  await page.mouse.move(x + at.x, y + at.y);
}

async function drag(page, chart) {
  const area = page.locator('.chart').nth(chart).locator('.u-over');
  await area.scrollIntoViewIfNeeded();
  const { x, y, width, height } = await area.boundingBox();
  await page.mouse.move(x + width * 0.3, y + height * 0.3);
  await page.mouse.down();
  await page.mouse.move(x + width * 0.5, y + height * 0.5, { steps: 4 });
  await page.mouse.up();
}

async function showsValues(page) {
  await hover(page, 0, 2, 10);
  const path = await page.evaluate(() => {
    const { chart } = document.querySelector('.chart');
    const one = chart.spec.series[1];
    return { t: one.t[10], across: one[chart.plane[0]][10] };
  });
  const said = await legend(page, 0).nth(1).innerText();
  assert.ok(said.includes(`${path.t.toFixed(2)} s: ${path.across.toFixed(3)}, `), `the legend says ${said}`);
  await hover(page, 1, 1, 12);
  const error = await page.evaluate(() => document.querySelectorAll('.chart')[1].chart.spec.series[0].error[12]);
  const value = await legend(page, 1).nth(1).innerText();
  assert.ok(value.includes(`${(error * 1000).toFixed(1)} mm`), `the legend says ${value}`);
}

async function hidesALine(page) {
  const shown = () => page.evaluate(() => document.querySelectorAll('.chart')[1].chart.plot.series[1].show);
  const label = legend(page, 1).nth(1).locator('th');
  await label.click();
  assert.equal(await shown(), false);
  await label.press('Enter');
  assert.equal(await shown(), true);
  await label.click();
  await page.locator('.chart').nth(1).getByText('log', { exact: true }).click();
  assert.equal(await shown(), false, 'another axis showed the hidden line again');
  await label.click();
}

async function zooms(page) {
  const time = await scale(page, 1, 'x');
  await drag(page, 1);
  const near = await scale(page, 1, 'x');
  assert.ok(Math.abs(length(near) / length(time) - 0.2) < 0.02, `zoomed to ${near} of ${time}`);
  await page.locator('.chart').nth(1).locator('.u-over').dblclick();
  assert.deepEqual(await scale(page, 1, 'x'), time);
  const all = await scale(page, 0, 'x');
  await drag(page, 0);
  assert.ok(length(await scale(page, 0, 'x')) < 0.6 * length(all));
  const metre = await page.evaluate(() => {
    const { plot } = document.querySelector('.chart').chart;
    return ['x', 'y'].map((axis) => Math.abs(plot.valToPos(1, axis) - plot.valToPos(0, axis)));
  });
  assert.ok(Math.abs(metre[0] / metre[1] - 1) < 0.02, `a metre is ${metre} pixels long`);
  await page.locator('.chart').first().locator('.u-over').dblclick();
  const again = await scale(page, 0, 'x');
  assert.ok(again.every((v, i) => Math.abs(v - all[i]) < 1e-6), `${again}, not ${all}`);
  await page.locator('.chart').first().getByText('x-z').click();
  assert.equal(await page.evaluate(() => document.querySelector('.chart').chart.plane.join('')), 'xz');
}

async function fits(page, width) {
  const wider = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wider <= width, `the page is ${wider} pixels wide, not ${width}`);
  for (const box of await page.locator('.chart .uplot').all()) {
    const { x, width: own } = await box.boundingBox();
    assert.ok(own > 200 && x >= 0 && x + own <= width, `a chart lies from ${x} to ${x + own}`);
  }
}

// A page at both widths; `expected` as `drawn` gives it.
async function test(browser, file, expected, problems) {
  for (const width of [1280, 400]) {
    const page = await open(browser, pathToFileURL(file).href, { viewport: { width, height: 800 } }, problems);
    page.on('dialog', () => problems.push('a name became a script'));
    assert.deepEqual(await drawn(page), expected);
    await fits(page, width);
    await showsValues(page);
    await hidesALine(page);
    await zooms(page);
    if (picture) await page.screenshot({ path: `${picture}-${file.split('/').at(-2)}-${width}.png`, fullPage: true });
    await page.close();
  }
}

const problems = [];
let browser = null;
try {
  run(program, ['synth', 'walking_xyz', '--frames', String(frames), '--width', '320', '--height', '240',
    '--out', sequence]);
  run(program, ['bench', sequence, '--modes', 'off,dkp+', '--detector', 'motion', '--repeat', '1', '--out', bench]);
  const made = (mode) => join(bench, 'runs', name, mode, 'seed1', 'trajectory.txt');
  run(program, ['eval', join(sequence, 'groundtruth.txt'), made('dkp+-motion'), '--html', evaluation]);
  run(program, ['demo', '--frames', '16', '--out', demo]);
  browser = await startBrowser(browserPath);
  const truth = during(join(sequence, 'groundtruth.txt'), made('off-none'));
  assert.ok(truth >= frames);
  const off = poses(made('off-none'));
  const best = poses(made('dkp+-motion'));
  await test(browser, join(bench, 'report.html'), [
    [['true path', truth], ['off', off], ['dkp+, motion', best]],
    [['off', off], ['dkp+, motion', best]],
    [['off', 51], ['dkp+, motion', 51]],
  ], problems);
  await test(browser, evaluation, [
    [['true path', truth], ['estimate', best]],
    [['estimate', best]],
    [['over 1 f', best - 2]],
  ], problems);
  const path = (mode) => poses(join(demo, mode, 'trajectory.txt'));
  await test(browser, join(demo, 'report.html'), [
    [['true path', during(join(demo, 'sequence', 'groundtruth.txt'), join(demo, 'off', 'trajectory.txt'))], ['mode off', path('off')], ['mode dkp+', path('dkp+')]],
    [['mode off', path('off')], ['mode dkp+', path('dkp+')]],
  ], problems);
  if (problems.length > 0) fail(problems.join('\n'));
  console.log('reports: all well');
} finally {
  await browser?.close();
  rmSync(work, { recursive: true, force: true });
}
