// External forces on a robot are estimated from readings that are typed in the page, or streamed to softkin view while
// pages watch.
import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {connect} from 'node:net';
import {createInterface} from 'node:readline';
import {frames, open, violations} from './browser.mjs';
import {example, out, serve, softkin} from './softkin.mjs';

const scene = example('estimate', 'finger.yaml'), options = ['--unknown', 'touch:place', '--deviation', '0.2'];
const table = readFileSync(example('estimate', 'readings.csv'), 'utf8').trim().split('\n').map((row) => row.split(','));
const [columns, ...rows] = table;
const text = (page, id) => page.locator(`#${id}`).textContent();
const until = (page, id, pattern) => page.waitForFunction(([of, expected]) =>
  new RegExp(expected).test(document.getElementById(of).textContent), [id, pattern.source]);
/** Returns the numbers of a text such as "0.79 ± 0.42 N". */
const numbers = (text) => text.replaceAll('−', '-').match(/-?\d+(\.\d+)?/g).map(Number);

/** Returns the result of softkin estimate for one row. */
async function estimated(row) {
  writeFileSync(out('one_row.csv'), `${columns.join()}\n${row.join()}\n`);
  return JSON.parse(await softkin('estimate', scene, out('one_row.csv'), ...options, '--json')).rows[0];
}

async function typeRow(page, row) {
  await page.locator('.typed input').first().fill(row[1]);
  await page.keyboard.press('Enter');
  for (const [c, value] of row.slice(2).entries()) {
    await page.locator('#readings input').nth(c).fill(value);
    await page.keyboard.press('Tab');
  }
  await until(page, 'state', /^Estimated from 12 readings: converged/);
}

/** Each estimate starts from the previous one; the last one differs by less than half a standard deviation. */
async function checkTyped(page) {
  await until(page, 'live-words', /^You control/);
  assert.match(await text(page, 'told'), /There are no readings yet/);
  assert.ok(await page.locator('#target-section').isHidden());
  await typeRow(page, rows[0]);
  const expected = await estimated(rows[0]), cells = await page.locator('#told td').allTextContents();
  for (const [n, {name, value, deviation}] of expected.numbers.entries()) {
    assert.equal(cells[2 * n], name.replaceAll('_', ' '));
    const [shown] = numbers(cells[2 * n + 1]);
    assert.ok(Math.abs(shown - value) < 0.5 * deviation, `${name}: ${cells[2 * n + 1]}, not ${value}`);
    assert.match(cells[2 * n + 1], / ± .* N$/);
  }
  assert.match(await text(page, 'told'),
               /its direction within \d.*° \(90 %\).*Chi-square .* fit the model.*2\.15 standard deviations \(2-D/s);
  await frames(page);
  const label = page.locator('#labels .force');
  assert.match(await label.textContent(), /^touch \d.* ± .* N$/);
  assert.ok(await label.isVisible());
}

async function checkChanged(page) {
  const before = await page.locator('#told .force').textContent();
  await typeRow(page, rows[3]);
  await page.waitForFunction((previous) => document.querySelector('#told .force').textContent !== previous, before);
  const field = page.locator('#readings input').first(), estimate = await text(page, 'told');
  await field.fill('1e12');
  await page.keyboard.press('Tab');
  assert.match(await text(page, 'readings'), /m1 x mm: a number up to/);
  assert.equal(await text(page, 'told'), estimate);
  assert.equal(await field.getAttribute('aria-invalid'), 'true');
  await page.locator('#undo').click();
  await until(page, 'state', /^Estimated from 12 readings: converged/);
  assert.doesNotMatch(await text(page, 'readings'), /m1 x mm/);
  await page.getByText('Clear the readings', {exact: true}).click();
  await until(page, 'state', /^Estimated from 0 readings: converged/);
  assert.match(await text(page, 'told'), /touch_fz is known to 1 N only/);
}

/** Returns a client of the readings port: send() sends a row and returns the answer. */
function writerTo(output) {
  const [, port, token] = /lines at 127\.0\.0\.1:(\d+), the first (\{.*\})/.exec(output);
  const socket = connect(Number(port), '127.0.0.1'), lines = createInterface({input: socket})[Symbol.asyncIterator]();
  socket.write(`${token}\n`);
  return {send: async (row) => {
    const line = Object.fromEntries(columns.map((name, c) => [name, Number(row[c])]));
    socket.write(`${JSON.stringify(line)}\n`);
    return JSON.parse((await lines.next()).value);
  }, end: () => socket.end()};
}

async function checkStreamed(page, server) {
  const writer = writerTo(server.output());
  for (const row of rows.slice(0, 2)) {
    const answer = await writer.send(row);
    assert.equal(answer.status, 'converged');
    const shown = answer.numbers.map(({value}) => value);
    await page.waitForFunction(([expected]) => {
      const cells = [...document.querySelectorAll('#told td')].map((cell) => cell.textContent.replaceAll('−', '-'));
      return expected.every((value, n) => Math.abs(parseFloat(cells[2 * n + 1]) - value) < 0.01);
    }, [shown]);
  }
  await until(page, 'live-words', /^Another program streams readings/);
  assert.ok(await page.locator('#readings input').first().isDisabled());
  assert.equal(await page.locator('#readings input').first().inputValue(), rows[1][2]);
  await page.screenshot({path: out('estimate_streamed.png')});
  writer.end();
  await until(page, 'live-words', /^You control/);
}

async function checkLooks(browser, server) {
  for (const [width, scheme] of [[1280, 'dark'], [390, 'light']]) {
    const {page, watch, context} = await open(browser, server.url,
                                              {width, height: width < 600 ? 844 : 720, scheme, offline: false});
    await page.waitForSelector('#told .force');
    await frames(page, 3);
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= width, 'wider than its window');
    assert.ok(await page.evaluate(() => document.querySelector('#panel').scrollWidth <=
      document.querySelector('#panel').clientWidth), 'the panel is wider than it shows');
    await page.screenshot({path: out(`estimate_${width}_${scheme}.png`)});
    await page.getByLabel('estimated forces', {exact: true}).uncheck();
    await frames(page);
    assert.ok(await page.locator('#labels .force').isHidden());
    assert.deepEqual(watch.errors, []);
    await context.close();
  }
}

export async function estimateTests(browser, test) {
  const server = await serve(scene, 0, ...options, '--readings-port', '0');
  const {page, watch} = await open(browser, server.url, {offline: false});
  await test('estimate: typed readings determine the external force', () => checkTyped(page));
  await test('estimate: it changes with the typed readings', () => checkChanged(page));
  await test('estimate: pages follow streamed readings', () => checkStreamed(page, server));
  await test('estimate: accessible in both themes', () => checkLooks(browser, server));
  await test('estimate: no errors', () => assert.deepEqual(watch.errors, []));
  await page.context().close();
  await server.stop();
}
