// The program and the browser, as a test needs them.
import { spawn, spawnSync } from 'node:child_process';
import { chromium } from 'playwright-core';

// Milliseconds that a test waits for anything; ctest has it ten times as long under a sanitizer.
export const patience = 1000 * Number(process.env.DKP_SLAM_TEST_WAIT_S ?? 60);

export function fail(text) {
  throw new Error(text);
}

// Runs a command of the program to its end.
export function run(program, args) {
  const result = spawnSync(program, args, { encoding: 'utf8' });
  if (result.status !== 0) fail(`${args.join(' ')}: ${result.stderr}`);
}

// `dkp-slam view ...`: { url, interrupt } once it serves its page.
export function view(program, args) {
  const child = spawn(program, ['view', ...args], { stdio: ['ignore', 'ignore', 'pipe'] });
  const ended = new Promise((resolve) => child.on('exit', (code) => resolve(code)));
  let said = '';
  const url = new Promise((resolve, reject) => {
    child.stderr.on('data', (text) => {
      said += text;
      const found = said.match(/^view: (\S+)$/m);
      if (found) resolve(found[1]);
    });
    ended.then((code) => reject(new Error(`view ended with ${code}: ${said}`)));
  });
  const interrupt = () => {
    child.kill('SIGINT');
    return ended;
  };
  return url.then((address) => ({ url: address, interrupt, kill: () => child.kill('SIGKILL') }));
}

// With WebGL by software.
export function startBrowser(path) {
  return chromium.launch({
    executablePath: path,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });
}

// A page that notes everything that goes wrong in it.
export async function open(browserOrContext, url, options, problems) {
  const page = await browserOrContext.newPage(options);
  page.setDefaultTimeout(patience);
  page.on('console', (message) => {
    if (['error', 'warning'].includes(message.type()) && !/GPU stall|GL Driver|swiftshader/i.test(message.text()))
      problems.push(message.text());
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('response', (answer) => {
    if (answer.status() >= 400 && !answer.url().includes('/api/error'))
      problems.push(`${answer.status()} ${answer.url()}`);
  });
  await page.goto(url);
  return page;
}

export const number = (page, name) => page.evaluate((key) => Number(document.body.dataset[key]), name);
export const until = (page, condition, value) => page.waitForFunction(condition, value, { timeout: patience });
